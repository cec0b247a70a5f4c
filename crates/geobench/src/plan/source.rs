//! Source vertices, as a user gives them.

use std::fmt;
use std::str::FromStr;

use geobench_mesh::{SplitMix64, VertexId};

use crate::UsageError;

/// Seed of `random:N` where none is given.
const DEFAULT_SEED: u64 = 1;

/// Sources as a user gives them: `first`, a vertex number, a list of numbers, or
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
        /// Seed of the choice.
        seed: u64,
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
    /// When the mesh lacks one of the vertices, or has fewer than `random:N`.
    pub fn resolve(&self, vertices: usize) -> Result<Vec<VertexId>, UsageError> {
        match self {
            Self::First => self::resolve(&[0], vertices),
            Self::List(list) => self::resolve(list, vertices),
            &Self::Random { count, seed } => {
                if count > vertices {
                    return Err(UsageError(format!(
                        "{count} different sources are asked for, but the model has {vertices} vertices"
                    )));
                }
                Ok(draw(count, seed, vertices))
            }
        }
    }
}

fn resolve(list: &[u32], vertices: usize) -> Result<Vec<VertexId>, UsageError> {
    match list.iter().find(|&&vertex| vertex as usize >= vertices) {
        Some(vertex) => Err(UsageError(format!(
            "source vertex {vertex} does not exist: the model has {vertices} vertices, numbered from 0"
        ))),
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
    type Err = UsageError;

    fn from_str(text: &str) -> Result<Self, UsageError> {
        let syntax = || {
            UsageError(format!(
                "`{text}` is not a source: give `first`, a vertex number, a list such as `0,17`, or \
                 `random:N[,seed=S]`"
            ))
        };
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
                return Err(UsageError(format!(
                    "`{text}` asks for no source; ask for at least one"
                )));
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
                return Err(UsageError(format!("source vertex {vertex} is named twice")));
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

    fn refused(text: &str) -> String {
        text.parse::<SourceSpec>().unwrap_err().to_string()
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
            let start = format!("`{text}` is not a source: give `first`, ");
            assert!(refused(text).starts_with(&start), "{text}");
        }
        assert_eq!(
            refused("random:0"),
            "`random:0` asks for no source; ask for at least one"
        );
        assert_eq!(refused("1,2,1"), "source vertex 1 is named twice");
    }

    #[test]
    fn vertices_must_exist() {
        assert_eq!(
            parse("0,8").resolve(8).unwrap_err().to_string(),
            "source vertex 8 does not exist: the model has 8 vertices, numbered from 0"
        );
        assert!(parse("first").resolve(0).is_err());
        assert_eq!(
            parse("random:9").resolve(8).unwrap_err().to_string(),
            "9 different sources are asked for, but the model has 8 vertices"
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
