//! Sources and targets, as a user gives them.

use std::collections::HashSet;
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use geobench_mesh::{Mesh, NearestPoint, Place, SplitMix64, SurfacePoint, VertexId};
use geobench_registry::UsageError;

use crate::schema::SourceLabel;
use crate::usage::quoted;

/// Seed of `random:N` where none is given.
const DEFAULT_SEED: u64 = 1;

/// The forms of targets, for messages.
const TARGETS: &str = "give `first`, a vertex number, a list such as `0,17`, `random:N[,seed=S]`, \
    `all`, `edge:A-B,T`, `face:F,U,V,W`, `at:X,Y,Z` or `far:X,Y,Z`";

/// The forms of sources.
const SOURCES: &str = "give `first`, a vertex number, a list such as `0,17`, `random:N[,seed=S]`, \
    `all`, `largest`, `edge:A-B,T`, `face:F,U,V,W`, `at:X,Y,Z` or `far:X,Y,Z`";

/// One point of a surface, not looked up yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointSpec {
    /// A vertex; `17`.
    Vertex(u32),
    /// A point on the edge between two vertices, at a fraction of the way from the first to the
    /// second; `edge:4-9,0.25`.
    Edge([u32; 2], f64),
    /// A point in a face, by its barycentric coordinates; `face:12,0.2,0.3,0.5`.
    Face(u32, [f64; 3]),
    /// The point of the surface nearest to a position, which is no farther than the size of the
    /// model; `at:1,2,3`.
    At([f64; 3]),
    /// The same, however far the position is; `far:1,2,3`.
    Far([f64; 3]),
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

/// A point found on a surface.
#[derive(Clone, Debug)]
pub struct LocatedPoint {
    /// As it was asked for.
    pub spec: PointSpec,
    /// The point.
    pub point: SurfacePoint,
    /// Its distance from the position asked for, if one was.
    pub from_position: Option<f64>,
    /// Where it is, in the form of a source, if that is not what was asked for.
    pub place: Option<String>,
}

impl LocatedPoint {
    /// What the user should know: how far the surface is from a position, and to which edge or
    /// vertex the point was moved. `None` if it is exactly as asked for.
    pub fn note(&self) -> Option<String> {
        let Self { spec, place, .. } = self;
        let place = place.as_ref()?;
        let moved = self.point.moved();
        Some(match self.from_position {
            Some(0.0) => format!("{spec} is on the surface, {place}"),
            Some(distance) => format!(
                "{spec} is {} from the surface; its nearest point is {place}",
                Number(distance)
            ),
            None if moved > 0.0 => {
                format!("{spec} is taken for {place}, which is {moved:.1e} away")
            }
            None => format!("{spec} is {place}"),
        })
    }
}

/// Finds points on one mesh; the tree for nearest points is built when the first one is looked for.
#[derive(Debug)]
pub struct Locator<'m> {
    mesh: &'m Mesh,
    nearest: Option<Arc<NearestPoint>>,
}

impl<'m> Locator<'m> {
    /// For points on `mesh`.
    pub const fn new(mesh: &'m Mesh) -> Self {
        Self {
            mesh,
            nearest: None,
        }
    }

    /// Uses this tree, which must be that of the mesh, for positions.
    pub fn set_tree(&mut self, tree: Arc<NearestPoint>) {
        self.nearest = Some(tree);
    }

    /// The point itself.
    ///
    /// # Errors
    ///
    /// When there is no such vertex, edge or face, a coordinate is out of range, or a position is
    /// asked for on a mesh without positions.
    pub fn locate(&mut self, spec: PointSpec) -> Result<LocatedPoint, UsageError> {
        let mesh = self.mesh;
        let mut from_position = None;
        let point = match spec {
            PointSpec::Vertex(v) => mesh.point_at_vertex(VertexId::new(v)),
            PointSpec::Edge(ends, t) => mesh.point_on_edge(ends.map(VertexId::new), t),
            PointSpec::Face(face, weights) => mesh.point_in_file_triangle(face, weights),
            PointSpec::At(position) | PointSpec::Far(position) => {
                self.nearest(position).map(|(point, distance)| {
                    from_position = Some(distance);
                    point
                })
            }
        };
        let point = point.map_err(|error| UsageError(format!("{spec}: {error}")))?;
        if let (PointSpec::At(position), Some(distance)) = (spec, from_position)
            && let Some(size) = self.nearest.as_ref().map(|tree| tree.diagonal())
            && distance > size
        {
            return Err(UsageError(format!(
                "{spec} is {} from the surface, whose size is {}; {} or the option --far accepts \
                 that (in Python, far=True)",
                Number(distance),
                Number(size),
                PointSpec::Far(position)
            )));
        }
        let as_asked = matches!(
            (spec, point.place()),
            (PointSpec::Vertex(_), _)
                | (PointSpec::Edge(..), Place::Edge(..))
                | (PointSpec::Face(..), Place::Face(..))
        );
        Ok(LocatedPoint {
            spec,
            point,
            from_position,
            place: (!as_asked).then(|| place_of(mesh, &point)),
        })
    }

    fn nearest(
        &mut self,
        position: [f64; 3],
    ) -> Result<(SurfacePoint, f64), geobench_mesh::PointError> {
        if let Some(nearest) = &self.nearest {
            return nearest.to(position);
        }
        let nearest = Arc::new(NearestPoint::new(self.mesh)?);
        self.nearest.insert(nearest).to(position)
    }
}

/// The place of a point in the form of a source.
fn place_of(mesh: &Mesh, point: &SurfacePoint) -> String {
    match point.place() {
        Place::Vertex(v) => format!("vertex {v}"),
        Place::Edge(h, [_, t]) => {
            PointSpec::Edge([mesh.tail(h).raw(), mesh.head(h).raw()], t).to_string()
        }
        Place::Face(face, weights) => {
            let (triangle, weights) = mesh.in_file(face, weights);
            PointSpec::Face(triangle, weights).to_string()
        }
    }
}

impl PointSpec {
    /// Its name in tables and files.
    pub fn label(&self) -> SourceLabel {
        match self {
            Self::Vertex(v) => SourceLabel::Vertex(*v),
            other => SourceLabel::Other(other.to_string()),
        }
    }

    /// The same point, which may be [far](Self::Far) from the surface.
    #[must_use]
    pub const fn even_far(self) -> Self {
        match self {
            Self::At(position) => Self::Far(position),
            other => other,
        }
    }
}

impl fmt::Display for PointSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Vertex(v) => write!(f, "{v}"),
            Self::Edge([a, b], t) => write!(f, "edge:{a}-{b},{}", Number(*t)),
            Self::Face(face, weights) => {
                let [u, v, w] = weights.map(Number);
                write!(f, "face:{face},{u},{v},{w}")
            }
            Self::At(position) => write!(f, "at:{}", coordinates(position)),
            Self::Far(position) => write!(f, "far:{}", coordinates(position)),
        }
    }
}

fn coordinates(position: &[f64; 3]) -> String {
    position.map(|x| Number(x).to_string()).join(",")
}

/// A number as in texts, but with an exponent where that saves a row of zeros.
struct Number(f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            // Of both zeros, which are equal, the text is one.
            0.0 => f.write_str("0"),
            x if (1e-15..1e21).contains(&x.abs()) => write!(f, "{x}"),
            x => write!(f, "{x:e}"),
        }
    }
}

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

    fn parse(text: &str, noun: &str) -> Result<Self, UsageError> {
        let takes_largest = noun == "source";
        let known = if takes_largest { SOURCES } else { TARGETS };
        let shown = quoted(text);
        let syntax = || UsageError(format!("`{shown}` is not a {noun}: {known}"));
        let lower = text.trim().to_lowercase();
        let mut words = lower.split(',').map(str::trim).peekable();
        let mut forms = Vec::new();
        while let Some(word) = words.next() {
            let mut number = |first: Option<&str>| -> Result<f64, UsageError> {
                let word = first.or_else(|| words.next()).ok_or_else(syntax)?;
                let number: f64 = word.parse().map_err(|_| syntax())?;
                if number.is_finite() {
                    Ok(number)
                } else {
                    Err(syntax())
                }
            };
            forms.push(match word.split_once(':') {
                None if word == "first" => SourcePart::First,
                None if word == "largest" && takes_largest => SourcePart::Largest,
                None if word == "all" => SourcePart::All,
                None => SourcePart::Point(PointSpec::Vertex(word.parse().map_err(|_| syntax())?)),
                Some(("edge", ends)) => {
                    let (a, b) = ends.split_once('-').ok_or_else(syntax)?;
                    let end = |end: &str| end.trim().parse().map_err(|_| syntax());
                    SourcePart::Point(PointSpec::Edge([end(a)?, end(b)?], number(None)?))
                }
                Some(("face", face)) => {
                    let face = face.trim().parse().map_err(|_| syntax())?;
                    let weights = [number(None)?, number(None)?, number(None)?];
                    SourcePart::Point(PointSpec::Face(face, weights))
                }
                Some((kind @ ("at" | "far"), x)) => {
                    let position = [number(Some(x.trim()))?, number(None)?, number(None)?];
                    SourcePart::Point(match kind {
                        "at" => PointSpec::At(position),
                        _ => PointSpec::Far(position),
                    })
                }
                Some(("random", count)) => {
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
                Some(_) => return Err(syntax()),
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

    #[test]
    fn points_are_located_and_moved_ones_are_noted() {
        let positions = vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let mesh = Mesh::new(positions, vec![[0, 1, 2]]).unwrap();
        let mut locator = Locator::new(&mesh);
        let mut note = |text: &str| {
            let [point] = parse(text).points(3).unwrap()[..] else {
                panic!("one point");
            };
            locator.locate(point).map(|found| found.note())
        };
        let said = |text: &str| Ok(Some(text.to_owned()));
        assert_eq!(note("1"), Ok(None));
        assert_eq!(note("edge:0-1,0.5"), Ok(None));
        assert_eq!(note("face:0,0.5,0.25,0.25"), Ok(None));
        assert_eq!(note("face:0,0,1,0"), said("face:0,0,1,0 is vertex 1"));
        assert_eq!(
            note("face:0,0.5,0.5,0"),
            said("face:0,0.5,0.5,0 is edge:0-1,0.5")
        );
        assert_eq!(
            note("at:1,0,3"),
            said("at:1,0,3 is 3 from the surface; its nearest point is edge:0-1,0.25")
        );
        assert_eq!(
            note("at:4,0,0"),
            said("at:4,0,0 is on the surface, vertex 1")
        );
        assert_eq!(
            note("edge:0-1,1e-13").unwrap().unwrap(),
            "edge:0-1,0.0000000000001 is taken for vertex 0, which is 4.0e-13 away"
        );
        assert_eq!(
            note("face:1,1,0,0").unwrap_err().to_string(),
            "face:1,1,0,0: face 1 does not exist: the mesh has 1 faces, numbered from 0"
        );
    }
}
