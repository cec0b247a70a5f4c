//! Which vertices distances are measured from.

use std::fmt;
use std::str::FromStr;

use geobench_mesh::VertexId;

use crate::measure::rng::SplitMix64;

/// Seed of `random:N` where none is given.
const DEFAULT_SEED: u64 = 1;

/// Sources as a user asks for them: `first`, a vertex number, a list of numbers, or
/// `random:N[,seed=S]`. Vertices are numbered from 0 in the file's order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SourceSpec {
    /// The first vertex of the file.
    First,
    /// These vertices.
    List(Vec<u32>),
    /// Different vertices drawn at random, the same ones on every machine.
    Random {
        /// How many.
        count: usize,
        /// What the choice is drawn from.
        seed: u64,
    },
}

/// Why sources were not understood or do not exist.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SourceError {
    /// The text is none of the forms.
    #[error(
        "`{text}` is not a source: give `first`, a vertex number, a list such as `0,17`, or `random:N[,seed=S]`"
    )]
    Syntax {
        /// The text as given.
        text: String,
    },
    /// No source at all is asked for.
    #[error("`{text}` asks for no source; ask for at least one")]
    None {
        /// The text as given.
        text: String,
    },
    /// A vertex is named twice.
    #[error("source vertex {vertex} is named twice")]
    Twice {
        /// The vertex.
        vertex: u32,
    },
    /// The vertex does not exist.
    #[error(
        "source vertex {vertex} does not exist: the model has {vertices} vertices, numbered from 0"
    )]
    NoSuchVertex {
        /// The vertex asked for.
        vertex: u32,
        /// Vertices that there are.
        vertices: usize,
    },
    /// The model has fewer vertices than are asked for.
    #[error("{count} different sources are asked for, but the model has {vertices} vertices")]
    TooMany {
        /// How many are asked for.
        count: usize,
        /// Vertices that there are.
        vertices: usize,
    },
}

impl SourceSpec {
    /// Number of sources.
    pub fn count(&self) -> usize {
        match self {
            Self::First => 1,
            Self::List(list) => list.len(),
            Self::Random { count, .. } => *count,
        }
    }

    /// The sources in a mesh of `vertices` vertices, all different.
    ///
    /// # Errors
    ///
    /// When the mesh does not have a vertex asked for, or not as many.
    pub fn resolve(&self, vertices: usize) -> Result<Vec<VertexId>, SourceError> {
        match self {
            Self::First => self::resolve(&[0], vertices),
            Self::List(list) => self::resolve(list, vertices),
            &Self::Random { count, seed } => {
                if count > vertices {
                    return Err(SourceError::TooMany { count, vertices });
                }
                Ok(draw(count, seed, vertices))
            }
        }
    }
}

fn resolve(list: &[u32], vertices: usize) -> Result<Vec<VertexId>, SourceError> {
    match list.iter().find(|&&vertex| vertex as usize >= vertices) {
        Some(&vertex) => Err(SourceError::NoSuchVertex { vertex, vertices }),
        None => Ok(list.iter().map(|&v| VertexId::new(v)).collect()),
    }
}

/// Different vertices in the order drawn (Floyd's sampling, 1987, would lose the order; meshes
/// are small enough to shuffle the front of the whole list).
fn draw(count: usize, seed: u64, vertices: usize) -> Vec<VertexId> {
    let mut random = SplitMix64::new(seed);
    let mut all: Vec<u32> = (0..vertices as u32).collect();
    for i in 0..count {
        all.swap(i, i + random.below(vertices - i));
    }
    all[..count].iter().map(|&v| VertexId::new(v)).collect()
}

impl FromStr for SourceSpec {
    type Err = SourceError;

    fn from_str(text: &str) -> Result<Self, SourceError> {
        let syntax = || SourceError::Syntax { text: text.into() };
        let lower = text.trim().to_lowercase();
        if lower == "first" {
            return Ok(Self::First);
        }
        if let Some(rest) = lower.strip_prefix("random:") {
            let (count, seed) = match rest.split_once(',') {
                None => (rest, None),
                Some((count, option)) => (
                    count,
                    Some(option.trim().strip_prefix("seed=").ok_or_else(syntax)?),
                ),
            };
            let count = count.trim().parse().map_err(|_| syntax())?;
            if count == 0 {
                return Err(SourceError::None { text: text.into() });
            }
            let seed = seed.map_or(Ok(DEFAULT_SEED), |s| s.trim().parse().map_err(|_| syntax()))?;
            return Ok(Self::Random { count, seed });
        }
        let list = lower
            .split(',')
            .map(|number| number.trim().parse().map_err(|_| syntax()))
            .collect::<Result<Vec<u32>, _>>()?;
        for (i, vertex) in list.iter().enumerate() {
            if list[..i].contains(vertex) {
                return Err(SourceError::Twice { vertex: *vertex });
            }
        }
        Ok(Self::List(list))
    }
}

impl fmt::Display for SourceSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::First => f.write_str("first"),
            Self::List(list) => {
                let numbers: Vec<String> = list.iter().map(u32::to_string).collect();
                f.write_str(&numbers.join(","))
            }
            Self::Random { count, seed } => write!(f, "random:{count},seed={seed}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> SourceSpec {
        text.parse().unwrap()
    }

    #[test]
    fn every_form_is_read() {
        assert_eq!(parse("first"), SourceSpec::First);
        assert_eq!(parse("17"), SourceSpec::List(vec![17]));
        assert_eq!(parse("3, 0,17"), SourceSpec::List(vec![3, 0, 17]));
        assert_eq!(parse("random:5").to_string(), "random:5,seed=1");
        assert_eq!(parse("Random:5,seed=9").to_string(), "random:5,seed=9");
    }

    #[test]
    fn other_forms_are_refused() {
        for text in [
            "",
            "x",
            "-1",
            "1.5",
            "1,,2",
            "random",
            "random:",
            "random:2,9",
            "4294967296",
        ] {
            assert!(
                matches!(text.parse::<SourceSpec>(), Err(SourceError::Syntax { .. })),
                "{text}"
            );
        }
        assert!(matches!(
            "random:0".parse::<SourceSpec>(),
            Err(SourceError::None { .. })
        ));
        assert_eq!(
            "1,2,1".parse::<SourceSpec>(),
            Err(SourceError::Twice { vertex: 1 })
        );
    }

    #[test]
    fn vertices_must_exist() {
        assert_eq!(
            parse("0,8").resolve(8).unwrap_err().to_string(),
            "source vertex 8 does not exist: the model has 8 vertices, numbered from 0"
        );
        assert!(parse("first").resolve(0).is_err());
        assert_eq!(
            parse("random:9").resolve(8),
            Err(SourceError::TooMany {
                count: 9,
                vertices: 8
            })
        );
    }

    #[test]
    fn random_sources_are_different_and_fixed_by_the_seed() {
        let mut all = parse("random:8").resolve(8).unwrap();
        assert_eq!(all, parse("random:8,seed=1").resolve(8).unwrap());
        assert_ne!(all, parse("random:8,seed=2").resolve(8).unwrap());
        assert_eq!(all[..3], parse("random:3").resolve(8).unwrap());
        all.sort_unstable();
        assert_eq!(all, (0..8).map(VertexId::new).collect::<Vec<_>>());
    }
}
