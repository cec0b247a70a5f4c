//! Lists of sources and of targets, as a user gives them.

use std::collections::HashSet;
use std::fmt;
use std::str::FromStr;

use geobench_mesh::{SplitMix64, VertexId};
use geobench_registry::UsageError;

use crate::exec::point::PointSpec;
use crate::schema::SourceLabel;
use crate::usage::quoted;

/// Seed of `random:N` where none is given.
const DEFAULT_SEED: u64 = 1;

/// The forms of targets, for messages. Sources have `largest` as well.
fn forms(takes_largest: bool) -> String {
    let largest = if takes_largest { "`largest`, " } else { "" };
    format!(
        "give `first`, a vertex number, a list such as `0,17`, `random:N[,seed=S]`, `all`, \
         {largest}`edge:A-B,T`, `face:F,U,V,W`, `at:X,Y,Z` or `far:X,Y,Z`"
    )
}

/// A part of a [`SourceSpec`].
#[derive(Clone, Copy, Debug, PartialEq)]
enum SourcePart {
    /// The first vertex of the file.
    First,
    /// The first vertex of the component with the most vertices.
    Largest,
    Point(PointSpec),
    /// Different vertices drawn at random, the same ones on every machine.
    Random {
        count: usize,
        seed: u64,
    },
    /// Every vertex.
    All,
}

/// Sources as a user gives them: `first`, `largest`, a vertex number, `random:N[,seed=S]`, `all`,
/// points of the surface, or a list of these. Vertices and faces are numbered from 0 in the file's
/// order.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceSpec(Vec<SourcePart>);

impl From<PointSpec> for SourceSpec {
    fn from(point: PointSpec) -> Self {
        Self(vec![SourcePart::Point(point)])
    }
}

impl From<VertexId> for SourceSpec {
    fn from(vertex: VertexId) -> Self {
        PointSpec::Vertex(vertex.raw()).into()
    }
}

impl From<&SourceLabel> for SourceSpec {
    /// The sources of a label that [`label`](SourceSpec::label) gave; other texts name none.
    fn from(label: &SourceLabel) -> Self {
        match label {
            SourceLabel::Vertex(v) => PointSpec::Vertex(*v).into(),
            SourceLabel::Other(text) => text.parse().unwrap_or(Self(Vec::new())),
        }
    }
}

/// The source points, each once, and a note for each that is named again.
pub fn distinct(points: Vec<PointSpec>) -> (Vec<PointSpec>, Vec<String>) {
    distinct_by(points, |point| Some(*point))
}

/// The items without those whose `point` an earlier one names, and a note for each such point.
fn distinct_by<T>(
    mut items: Vec<T>,
    point: impl Fn(&T) -> Option<PointSpec>,
) -> (Vec<T>, Vec<String>) {
    let mut seen = HashSet::new();
    let mut noted = HashSet::new();
    let mut notes = Vec::new();
    items.retain(|item| {
        let Some(point) = point(item) else {
            return true;
        };
        let is_new = seen.insert(point.to_string());
        if !is_new && noted.insert(point.to_string()) {
            let name = match point {
                PointSpec::Vertex(v) => format!("vertex {v}"),
                _ => point.to_string(),
            };
            notes.push(format!("source {name} is named twice and counts once"));
        }
        is_new
    });
    (items, notes)
}

impl SourceSpec {
    /// The first vertex.
    pub fn first() -> Self {
        Self(vec![SourcePart::First])
    }

    /// The first vertex of the largest component.
    pub fn largest() -> Self {
        Self(vec![SourcePart::Largest])
    }

    /// The same sources, with the vertex `first()` for `largest`.
    #[must_use]
    pub fn with_largest(&self, first: impl FnOnce() -> u32) -> Self {
        let mut parts = self.0.clone();
        if parts.contains(&SourcePart::Largest) {
            let vertex = SourcePart::Point(PointSpec::Vertex(first()));
            let largest = parts
                .iter_mut()
                .filter(|part| **part == SourcePart::Largest);
            largest.for_each(|part| *part = vertex);
        }
        Self(parts)
    }

    /// All of these together.
    pub fn of_all(specs: impl IntoIterator<Item = Self>) -> Self {
        Self(specs.into_iter().flat_map(|spec| spec.0).collect())
    }

    /// The same sources, each once, and a note for each that is named again.
    pub fn distinct(self) -> (Self, Vec<String>) {
        let point = |form: &SourcePart| match form {
            SourcePart::Point(point) => Some(*point),
            _ => None,
        };
        let (forms, notes) = distinct_by(self.0, point);
        (Self(forms), notes)
    }

    /// The same sources, whose positions may be [far](PointSpec::Far) from the surface.
    #[must_use]
    pub fn even_far(mut self) -> Self {
        for part in &mut self.0 {
            if let SourcePart::Point(point) = part {
                *point = point.even_far();
            }
        }
        self
    }

    /// The points; `None` if one is drawn at random, all vertices are named, or one depends on the
    /// model.
    pub(crate) fn single_points(&self) -> Option<Vec<PointSpec>> {
        let points = self.0.iter().map(|part| match *part {
            SourcePart::First => Some(PointSpec::Vertex(0)),
            SourcePart::Point(point) => Some(point),
            SourcePart::Largest | SourcePart::Random { .. } | SourcePart::All => None,
        });
        points.collect()
    }

    /// Number of sources; every `all` counts as one.
    pub fn count(&self) -> usize {
        let counts = self.0.iter().map(|form| match form {
            SourcePart::Random { count, .. } => *count,
            _ => 1,
        });
        counts.fold(0, usize::saturating_add)
    }

    /// Whether the number of sources depends on the model.
    pub fn has_all(&self) -> bool {
        self.0.contains(&SourcePart::All)
    }

    /// The name of all sources together in tables and files. A single vertex is its number.
    pub fn label(&self) -> SourceLabel {
        match self.0[..] {
            [SourcePart::First] => SourceLabel::Vertex(0),
            [SourcePart::Point(point)] => point.label(),
            _ => SourceLabel::Other(self.to_string()),
        }
    }

    /// The names of all sources, as far as they are known without the model: `None` stands for
    /// all of them if some are drawn or counted in the model.
    pub fn labels(&self) -> Vec<Option<SourceLabel>> {
        self.single_points().map_or_else(
            || vec![None],
            |points| points.iter().map(|point| Some(point.label())).collect(),
        )
    }

    /// The sources in a mesh of `vertices` vertices, all different. Other points than vertices are
    /// not looked up.
    ///
    /// # Errors
    ///
    /// When the mesh lacks one of the vertices, or has fewer than `random:N`, or one is still
    /// [`largest`](Self::with_largest).
    pub fn points(&self, vertices: usize) -> Result<Vec<PointSpec>, UsageError> {
        let mut points = self.points_as("source", vertices)?;
        if self.0.len() > 1 {
            let mut seen = HashSet::new();
            points.retain(|point| seen.insert(point.to_string()));
        }
        Ok(points)
    }

    /// The points, called `noun` in messages.
    fn points_as(&self, noun: &str, vertices: usize) -> Result<Vec<PointSpec>, UsageError> {
        let mut points = Vec::new();
        for form in &self.0 {
            match *form {
                SourcePart::First => points.push(PointSpec::Vertex(0)),
                SourcePart::Largest => {
                    let text = format!("the largest component is no {noun} here");
                    return Err(UsageError(text));
                }
                SourcePart::Point(point) => points.push(point),
                SourcePart::All => points.extend((0..vertices as u32).map(PointSpec::Vertex)),
                SourcePart::Random { count, seed } => {
                    if count > vertices {
                        return Err(UsageError(format!(
                            "{count} different {noun}s are asked for, but the model has {vertices} vertices"
                        )));
                    }
                    points.extend(draw(count, seed, vertices).map(PointSpec::Vertex));
                }
            }
        }
        let missing = points.iter().find_map(|point| match point {
            PointSpec::Vertex(v) => (*v as usize >= vertices).then_some(*v),
            _ => None,
        });
        if let Some(vertex) = missing {
            return Err(UsageError(format!(
                "{noun} vertex {vertex} does not exist: the model has {vertices} vertices, numbered from 0"
            )));
        }
        Ok(points)
    }

    /// Parses a list. `noun` is `source` or `target`.
    fn parse(text: &str, noun: &str) -> Result<Self, UsageError> {
        let takes_largest = noun == "source";
        let shown = quoted(text);
        let syntax = || {
            let known = forms(takes_largest);
            UsageError(format!("`{shown}` is not a {noun}: {known}"))
        };
        let lower = text.trim().to_lowercase();
        let mut words = lower.split(',').map(str::trim).peekable();
        let mut forms = Vec::new();
        while let Some(word) = words.next() {
            forms.push(match word.strip_prefix("random:") {
                None if word == "first" => SourcePart::First,
                None if word == "largest" && takes_largest => SourcePart::Largest,
                None if word == "all" => SourcePart::All,
                None => SourcePart::Point(PointSpec::parse(word, &mut words).ok_or_else(syntax)?),
                Some(count) => {
                    let count = count.trim().parse().map_err(|_| syntax())?;
                    if count == 0 {
                        return Err(UsageError(format!(
                            "`{shown}` asks for no {noun}; ask for at least one"
                        )));
                    }
                    let mut seed = DEFAULT_SEED;
                    if let Some(word) = words.peek() {
                        if let Some(given) = word.strip_prefix("seed=") {
                            seed = given.trim().parse().map_err(|_| syntax())?;
                            words.next();
                        } else if word.parse::<f64>().is_ok() || word.is_empty() {
                            // A seed without its name, or a vertex?
                            return Err(syntax());
                        }
                    }
                    SourcePart::Random { count, seed }
                }
            });
        }
        Ok(Self(forms))
    }
}

/// Different vertices in the order drawn (Floyd's sampling, 1987, would lose the order; meshes
/// are small enough to shuffle the front of the whole list).
fn draw(count: usize, seed: u64, vertices: usize) -> impl Iterator<Item = u32> {
    let mut random = SplitMix64::new(seed);
    let mut all: Vec<u32> = (0..vertices as u32).collect();
    for i in 0..count {
        all.swap(i, i + random.below(vertices - i));
    }
    all.into_iter().take(count)
}

impl FromStr for SourceSpec {
    type Err = UsageError;

    fn from_str(text: &str) -> Result<Self, UsageError> {
        Self::parse(text, "source")
    }
}

impl fmt::Display for SourceSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, form) in self.0.iter().enumerate() {
            if i > 0 {
                f.write_str(",")?;
            }
            match form {
                SourcePart::First => f.write_str("first")?,
                SourcePart::Largest => f.write_str("largest")?,
                SourcePart::Point(point) => write!(f, "{point}")?,
                SourcePart::Random { count, seed } => write!(f, "random:{count},seed={seed}")?,
                SourcePart::All => f.write_str("all")?,
            }
        }
        Ok(())
    }
}

/// Targets as a user gives them, in the forms of sources.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetSpec(SourceSpec);

impl TargetSpec {
    /// The targets in a mesh of `vertices` vertices. Other points than vertices are not looked up.
    ///
    /// # Errors
    ///
    /// When the mesh lacks one of the vertices, or has fewer than `random:N`.
    pub fn points(&self, vertices: usize) -> Result<Vec<PointSpec>, UsageError> {
        self.0.points_as("target", vertices)
    }

    /// The same, each once.
    ///
    /// # Errors
    ///
    /// As [`points`](Self::points).
    pub(crate) fn different(&self, vertices: usize) -> Result<Vec<PointSpec>, UsageError> {
        let mut points = self.points(vertices)?;
        let mut seen = HashSet::new();
        points.retain(|point| seen.insert(point.to_string()));
        Ok(points)
    }

    /// The same targets, whose positions may be [far](PointSpec::Far) from the surface.
    #[must_use]
    pub fn even_far(self) -> Self {
        Self(self.0.even_far())
    }

    /// All of these together.
    pub fn of_all(specs: impl IntoIterator<Item = Self>) -> Self {
        let forms = specs.into_iter().flat_map(|Self(SourceSpec(forms))| forms);
        Self(SourceSpec(forms.collect()))
    }

    /// Number of targets; every `all` counts as one.
    pub fn count(&self) -> usize {
        self.0.count()
    }
}

impl fmt::Display for TargetSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl FromStr for TargetSpec {
    type Err = UsageError;

    fn from_str(text: &str) -> Result<Self, UsageError> {
        SourceSpec::parse(text, "target").map(Self)
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
        assert_eq!(parse("first"), SourceSpec::first());
        assert_eq!(parse("17"), PointSpec::Vertex(17).into());
        assert_eq!(parse("3, 0,17").to_string(), "3,0,17");
        assert_eq!(parse("ALL").to_string(), "all");
        let points = "edge:4-9,0.25,face:12,0.2,0.3,0.5,at:-1,2.5,3e-7,17";
        assert_eq!(
            parse(points).to_string(),
            "edge:4-9,0.25,face:12,0.2,0.3,0.5,at:-1,2.5,0.0000003,17"
        );
        assert_eq!(parse(points).count(), 4);
        let far = "at:1e300,0,-2e-30";
        assert_eq!(parse(far).to_string(), far);
        assert_eq!(parse("at:-0,0,-0.0").to_string(), "at:0,0,0");
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
            "edge:4,0.5",
            "edge:4-9",
            "edge:4-9,x",
            "face:1,0.5,0.5",
            "face:1,0.5,0.5,nan",
            "at:1,2",
            "at:1,2,inf",
            "vertex:3",
        ] {
            let start = format!("`{text}` is not a source: give `first`, ");
            assert!(refused(text).starts_with(&start), "{text}");
        }
        assert_eq!(
            refused("random:0"),
            "`random:0` asks for no source; ask for at least one"
        );
        let target = "x".parse::<TargetSpec>().unwrap_err().to_string();
        assert!(target.starts_with("`x` is not a target: "), "{target}");
    }

    #[test]
    fn a_source_named_twice_is_one_source() {
        let all = ["1,2,1", "at:1,2,3,at:1,2,3.0,1", "random:2"].map(parse);
        let (sources, notes) = SourceSpec::of_all(all).distinct();
        assert_eq!(sources.to_string(), "1,2,at:1,2,3,random:2,seed=1");
        assert_eq!(
            notes,
            [
                "source vertex 1 is named twice and counts once",
                "source at:1,2,3 is named twice and counts once"
            ]
        );
        assert_eq!(parse("3").distinct(), (parse("3"), Vec::new()));
    }

    #[test]
    fn vertices_must_exist() {
        assert_eq!(
            parse("0,8").points(8).unwrap_err().to_string(),
            "source vertex 8 does not exist: the model has 8 vertices, numbered from 0"
        );
        assert!(parse("first").points(0).is_err());
        assert_eq!(
            parse("random:9").points(8).unwrap_err().to_string(),
            "9 different sources are asked for, but the model has 8 vertices"
        );
    }

    #[test]
    fn random_sources_are_different_and_fixed_by_the_seed() {
        let mut all = parse("random:8").points(8).unwrap();
        assert_eq!(all, parse("random:8,seed=1").points(8).unwrap());
        assert_ne!(all, parse("random:8,seed=2").points(8).unwrap());
        assert_eq!(all[..3], parse("random:3").points(8).unwrap());
        all.sort_unstable_by_key(ToString::to_string);
        assert_eq!(all, (0..8).map(PointSpec::Vertex).collect::<Vec<_>>());
        assert_eq!(parse("3,all").points(4).unwrap().len(), 4);
        assert_eq!(parse("random:4,seed=1,3").points(4).unwrap().len(), 4);
    }
}
