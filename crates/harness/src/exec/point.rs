//! A point of a surface, as a user gives it, and where it is on a mesh.

use std::fmt;
use std::sync::Arc;

use geobench_mesh::{Mesh, NearestPoint, Place, SurfacePoint, VertexId};
use geobench_registry::UsageError;

use crate::schema::SourceLabel;

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

impl PointSpec {
    /// The point whose form begins with `word`, in lower case. Takes its further coordinates from
    /// `words`. `None` if this is no form of a point.
    pub(crate) fn parse<'w>(word: &str, words: &mut impl Iterator<Item = &'w str>) -> Option<Self> {
        let number = |word: &str| word.parse().ok().filter(|x: &f64| x.is_finite());
        let mut next = || number(words.next()?);
        Some(match word.split_once(':') {
            None => Self::Vertex(word.parse().ok()?),
            Some(("edge", ends)) => {
                let (a, b) = ends.split_once('-')?;
                let end = |end: &str| end.trim().parse().ok();
                Self::Edge([end(a)?, end(b)?], next()?)
            }
            Some(("face", face)) => {
                let face = face.trim().parse().ok()?;
                Self::Face(face, [next()?, next()?, next()?])
            }
            Some(("at", x)) => Self::At([number(x.trim())?, next()?, next()?]),
            Some(("far", x)) => Self::Far([number(x.trim())?, next()?, next()?]),
            Some(_) => return None,
        })
    }

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exec::source::SourceSpec;

    #[test]
    fn points_are_located_and_moved_ones_are_noted() {
        let positions = vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let mesh = Mesh::new(positions, vec![[0, 1, 2]]).unwrap();
        let mut locator = Locator::new(&mesh);
        let mut note = |text: &str| {
            let sources: SourceSpec = text.parse().unwrap();
            let [point] = sources.points(3).unwrap()[..] else {
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
