//! Defects of a model: fatal, repaired or noted.

use std::fmt;

/// Longest edge, in the model's units, that a mesh may have. Up to this length the products of up
/// to four lengths, with which windows are computed, stay finite.
pub const LONGEST_EDGE: f64 = 1e60;

/// Shortest edge, in the model's units, that a mesh may have. Down to this length the products of
/// up to four lengths, with which windows are computed, do not underflow.
pub const SHORTEST_EDGE: f64 = 1e-60;

/// How severe a [`Defect`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// No mesh can be built.
    Fatal,
    /// The defect was repaired, so the mesh differs from the model.
    Repaired,
    /// The model is used as it is, and distances are exact. It may not be what the user intended.
    Noted,
}

/// A defect of a model, with the elements concerned.
///
/// Vertices and faces have the file's numbers, counted from 0. Where polygons of the file were cut
/// into triangles, a face is the polygon. A triangle is left out of the other checks if it names a
/// vertex that does not exist, or one vertex twice.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Defect {
    /// Fatal: the model has no vertex.
    NoVertices,
    /// Fatal: the model has no face, as in a point cloud.
    NoFaces,
    /// Fatal: there are more elements than 4-byte numbers can address.
    TooLarge {
        /// Number of vertices, at most 2³² - 1.
        vertices: usize,
        /// Number of triangles, at most (2³² - 1) / 3.
        triangles: usize,
    },
    /// Fatal: in a mesh given by its lengths, the number of triples of lengths is not the number of
    /// triangles.
    LengthCount {
        /// Number of triangles.
        triangles: usize,
        /// Number of triples of lengths.
        lengths: usize,
    },
    /// Fatal: a face names a vertex that does not exist.
    IndexOutOfRange {
        /// The face.
        face: u32,
        /// The vertex it names.
        vertex: u32,
        /// How many vertices there are.
        vertex_count: u32,
    },
    /// Fatal: a coordinate of a vertex of a face is infinite or not a number.
    NonFiniteCoordinate {
        /// The vertex.
        vertex: u32,
    },
    /// Fatal: in a mesh given by its lengths, a face names one vertex several times.
    RepeatedVertex {
        /// The face.
        face: u32,
        /// The vertex it repeats.
        vertex: u32,
    },
    /// Fatal: an edge longer than [`LONGEST_EDGE`] or shorter than [`SHORTEST_EDGE`]; or, in a
    /// mesh given by its lengths, a length that is negative or not a number.
    LengthOutOfRange {
        /// The ends.
        vertices: [u32; 2],
        /// The length.
        length: f64,
    },
    /// Fatal: in a mesh given by its lengths, two triangles give one edge different lengths.
    UnequalLengths {
        /// The ends.
        vertices: [u32; 2],
        /// The two lengths, each given by the triangle at the same index of `faces`.
        lengths: [f64; 2],
        /// The triangles.
        faces: [u32; 2],
    },
    /// Fatal: in a mesh given by its lengths, one side of a triangle is longer than the sum of the
    /// others, by more than rounding explains (1e-12 of it).
    TriangleInequality {
        /// The triangle.
        face: u32,
        /// Its lengths.
        lengths: [f64; 3],
    },
    /// Noted: more than two faces share an edge. A path may go on from any of them into any other.
    NonManifoldEdge {
        /// The ends.
        vertices: [u32; 2],
        /// All faces along the edge.
        faces: Vec<u32>,
    },
    /// Noted: a surface has one side only, such as a Möbius strip. Reported once for each part
    /// connected across edges, with an edge at which the orientations of its faces contradict.
    NotOrientable {
        /// The ends of such an edge.
        vertices: [u32; 2],
        /// The two faces along it.
        faces: [u32; 2],
    },
    /// Noted: a face has the same vertices as an earlier one. Two such faces alone make a closed
    /// two-sided surface, which is used as it is.
    DuplicateFace {
        /// The later face.
        face: u32,
        /// The first one with these vertices.
        first: u32,
    },
    /// Noted: a face has the same vertices as an earlier one, and a third face shares one of its
    /// edges. It is left out, which changes no distance of vertices.
    RepeatedFace {
        /// The later face.
        face: u32,
        /// The first one with these vertices.
        first: u32,
    },
    /// Noted: a face names one vertex several times, or its corners were made one vertex. It is a
    /// segment or a point, and is left out.
    CollapsedFace {
        /// The face.
        face: u32,
        /// The vertex at two of its corners.
        vertex: u32,
    },
    /// Noted: both ends of an edge have the same position. They are made one vertex, the lower one.
    ZeroLengthEdge {
        /// The ends.
        vertices: [u32; 2],
        /// The faces along the edge.
        faces: Vec<u32>,
    },
    /// Noted: vertices were [welded](crate::Weld) to others, as was asked for.
    WeldedVertices {
        /// How many.
        count: u32,
    },
    /// Noted: vertices lie at the place of another one, on boundaries or in several components. No
    /// path leads from one to the other there unless they are [welded](crate::Weld).
    CoincidentVertices {
        /// How many lie exactly there.
        exact: u32,
        /// How many more lie within the tolerance.
        near: u32,
        /// A fraction of the diagonal of the bounding box, 1e-7 or more.
        tolerance: f64,
        /// The number of components that welding all of them would leave.
        components: u32,
        /// The number of boundary edges that it would leave.
        boundary_edges: u32,
        /// The number of edges of more than two faces that it would leave.
        non_manifold_edges: u32,
    },
    /// Repaired: a face was oriented against the majority of its part of the surface, and is used
    /// turned over. If both orientations are equally frequent, that of the first face of the part
    /// is kept.
    FlippedFace {
        /// The face.
        face: u32,
    },
    /// Noted: a face has fewer than three corners. It is left out.
    ShortFace {
        /// The face.
        face: u32,
    },
    /// Noted: the corners of a face are collinear within rounding. Its edges keep their lengths,
    /// and paths may run along them.
    FlatFace {
        /// The face.
        face: u32,
    },
    /// Noted: several fans of faces meet at a vertex and share no edge there. A path may pass from
    /// any of them into any other. Faces around a non-manifold edge count as one fan.
    PinchedVertex {
        /// The vertex.
        vertex: u32,
        /// How many fans meet there.
        fans: u32,
    },
    /// Noted: the surface has components that share no vertex. From a source in one component the
    /// others cannot be reached.
    SeveralComponents {
        /// The number of triangles of each component, in the order of their first vertices.
        triangles: Vec<u32>,
    },
    /// Noted: a vertex is in no face. It is kept. No other vertex reaches it.
    IsolatedVertex {
        /// The vertex.
        vertex: u32,
    },
    /// Noted: a vertex in no face has a coordinate that is infinite or not a number. It is kept, at
    /// the place of the first corner of the first face.
    UnplacedVertex {
        /// The vertex.
        vertex: u32,
    },
    /// Noted: the file departs from its format in a way that has one meaning only.
    FileForm {
        /// The first line, counted from 1; 0 in a binary file.
        line: u64,
        /// The departure.
        form: FileForm,
    },
    /// Noted: the file has several meshes, or its scene places one several times.
    Parts {
        /// How many meshes are parts of the model.
        parts: u32,
    },
    /// Noted: meshes have skins or morphs, which are not applied: they have their shape at rest.
    Unposed {
        /// How many.
        meshes: u32,
    },
}

/// A departure from a file format that has one meaning only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FileForm {
    /// A vertex has two coordinates; the third is 0.
    TwoCoordinates,
    /// Lines have more numbers than the header declares; they are ignored.
    MoreNumbers,
    /// The header of a binary STL counts no triangles, but some follow; they are read.
    NoCount,
    /// A text STL begins without `solid`.
    NoSolid,
    /// A text STL ends without `endsolid`.
    NoEnd,
    /// A count beside a list is not that of its elements; all are read.
    OtherCount,
}

impl fmt::Display for FileForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TwoCoordinates => "a vertex has two coordinates; the third is 0",
            Self::MoreNumbers => "more numbers than the header declares; they are ignored",
            Self::NoCount => "the header counts no triangles; those that follow are read",
            Self::NoSolid => "a facet comes before the first solid",
            Self::NoEnd => "the file ends without endsolid",
            Self::OtherCount => "a count is not that of the elements that are there; all are read",
        })
    }
}

/// The kind of a [`Defect`], without its elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)] // Documented at the variants of `Defect`.
#[non_exhaustive]
pub enum DefectKind {
    NoVertices,
    NoFaces,
    TooLarge,
    LengthCount,
    IndexOutOfRange,
    NonFiniteCoordinate,
    RepeatedVertex,
    LengthOutOfRange,
    UnequalLengths,
    TriangleInequality,
    NonManifoldEdge,
    NotOrientable,
    FlippedFace,
    DuplicateFace,
    RepeatedFace,
    CollapsedFace,
    ZeroLengthEdge,
    WeldedVertices,
    CoincidentVertices,
    ShortFace,
    FlatFace,
    PinchedVertex,
    SeveralComponents,
    IsolatedVertex,
    UnplacedVertex,
    FileForm,
    Parts,
    Unposed,
}

impl Defect {
    /// The kind of this defect.
    pub fn kind(&self) -> DefectKind {
        match self {
            Self::NoVertices => DefectKind::NoVertices,
            Self::NoFaces => DefectKind::NoFaces,
            Self::TooLarge { .. } => DefectKind::TooLarge,
            Self::LengthCount { .. } => DefectKind::LengthCount,
            Self::IndexOutOfRange { .. } => DefectKind::IndexOutOfRange,
            Self::NonFiniteCoordinate { .. } => DefectKind::NonFiniteCoordinate,
            Self::RepeatedVertex { .. } => DefectKind::RepeatedVertex,
            Self::ZeroLengthEdge { .. } => DefectKind::ZeroLengthEdge,
            Self::LengthOutOfRange { .. } => DefectKind::LengthOutOfRange,
            Self::UnequalLengths { .. } => DefectKind::UnequalLengths,
            Self::TriangleInequality { .. } => DefectKind::TriangleInequality,
            Self::NonManifoldEdge { .. } => DefectKind::NonManifoldEdge,
            Self::NotOrientable { .. } => DefectKind::NotOrientable,
            Self::DuplicateFace { .. } => DefectKind::DuplicateFace,
            Self::RepeatedFace { .. } => DefectKind::RepeatedFace,
            Self::CollapsedFace { .. } => DefectKind::CollapsedFace,
            Self::WeldedVertices { .. } => DefectKind::WeldedVertices,
            Self::CoincidentVertices { .. } => DefectKind::CoincidentVertices,
            Self::FlippedFace { .. } => DefectKind::FlippedFace,
            Self::ShortFace { .. } => DefectKind::ShortFace,
            Self::FlatFace { .. } => DefectKind::FlatFace,
            Self::PinchedVertex { .. } => DefectKind::PinchedVertex,
            Self::SeveralComponents { .. } => DefectKind::SeveralComponents,
            Self::IsolatedVertex { .. } => DefectKind::IsolatedVertex,
            Self::UnplacedVertex { .. } => DefectKind::UnplacedVertex,
            Self::FileForm { .. } => DefectKind::FileForm,
            Self::Parts { .. } => DefectKind::Parts,
            Self::Unposed { .. } => DefectKind::Unposed,
        }
    }

    /// The severity of this defect.
    pub fn severity(&self) -> Severity {
        self.kind().severity()
    }

    /// The key that sorts defects by kind and then by elements.
    pub(crate) fn sort_key(&self) -> (DefectKind, [u32; 2]) {
        let elements = match *self {
            Self::NoVertices
            | Self::NoFaces
            | Self::TooLarge { .. }
            | Self::LengthCount { .. }
            | Self::SeveralComponents { .. }
            | Self::WeldedVertices { .. }
            | Self::CoincidentVertices { .. } => [0, 0],
            Self::IndexOutOfRange { face, vertex, .. }
            | Self::RepeatedVertex { face, vertex }
            | Self::CollapsedFace { face, vertex } => [face, vertex],
            Self::ZeroLengthEdge { vertices, .. }
            | Self::LengthOutOfRange { vertices, .. }
            | Self::UnequalLengths { vertices, .. }
            | Self::NonManifoldEdge { vertices, .. }
            | Self::NotOrientable { vertices, .. } => vertices,
            Self::DuplicateFace { face, first } | Self::RepeatedFace { face, first } => {
                [face, first]
            }
            Self::TriangleInequality { face, .. }
            | Self::FlippedFace { face }
            | Self::ShortFace { face }
            | Self::FlatFace { face } => [face, 0],
            Self::NonFiniteCoordinate { vertex }
            | Self::PinchedVertex { vertex, .. }
            | Self::IsolatedVertex { vertex }
            | Self::UnplacedVertex { vertex } => [vertex, 0],
            Self::Parts { parts: count } | Self::Unposed { meshes: count } => [count, 0],
            Self::FileForm { line, .. } => [(line >> 32) as u32, line as u32],
        };
        (self.kind(), elements)
    }
}

impl DefectKind {
    /// The severity of defects of this kind.
    pub fn severity(self) -> Severity {
        match self {
            Self::NoVertices
            | Self::NoFaces
            | Self::TooLarge
            | Self::LengthCount
            | Self::IndexOutOfRange
            | Self::NonFiniteCoordinate
            | Self::RepeatedVertex
            | Self::LengthOutOfRange
            | Self::UnequalLengths
            | Self::TriangleInequality => Severity::Fatal,
            Self::FlippedFace => Severity::Repaired,
            Self::NonManifoldEdge
            | Self::NotOrientable
            | Self::DuplicateFace
            | Self::RepeatedFace
            | Self::CollapsedFace
            | Self::ZeroLengthEdge
            | Self::WeldedVertices
            | Self::CoincidentVertices
            | Self::ShortFace
            | Self::FlatFace
            | Self::PinchedVertex
            | Self::SeveralComponents
            | Self::IsolatedVertex
            | Self::UnplacedVertex
            | Self::FileForm
            | Self::Parts
            | Self::Unposed => Severity::Noted,
        }
    }

    /// Whether the mesh lacks such faces of the model, or has them turned over.
    pub fn changes_faces(self) -> bool {
        matches!(
            self,
            Self::FlippedFace | Self::RepeatedFace | Self::CollapsedFace | Self::ShortFace
        )
    }

    /// The name in machine-readable output, such as `non-manifold-edge`.
    pub fn code(self) -> &'static str {
        match self {
            Self::NoVertices => "no-vertices",
            Self::NoFaces => "no-faces",
            Self::TooLarge => "too-large",
            Self::LengthCount => "length-count",
            Self::IndexOutOfRange => "index-out-of-range",
            Self::NonFiniteCoordinate => "non-finite-coordinate",
            Self::RepeatedVertex => "repeated-vertex",
            Self::ZeroLengthEdge => "zero-length-edge",
            Self::LengthOutOfRange => "length-out-of-range",
            Self::UnequalLengths => "unequal-lengths",
            Self::TriangleInequality => "triangle-inequality",
            Self::NonManifoldEdge => "non-manifold-edge",
            Self::NotOrientable => "not-orientable",
            Self::DuplicateFace => "duplicate-face",
            Self::RepeatedFace => "repeated-face",
            Self::CollapsedFace => "collapsed-face",
            Self::WeldedVertices => "welded-vertices",
            Self::CoincidentVertices => "coincident-vertices",
            Self::FlippedFace => "flipped-face",
            Self::ShortFace => "short-face",
            Self::FlatFace => "flat-face",
            Self::PinchedVertex => "pinched-vertex",
            Self::SeveralComponents => "several-components",
            Self::IsolatedVertex => "isolated-vertex",
            Self::UnplacedVertex => "unplaced-vertex",
            Self::FileForm => "file-form",
            Self::Parts => "parts",
            Self::Unposed => "unposed",
        }
    }
}

/// Lists the elements of the defect. A headline that names the defect goes before the list.
impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoVertices
            | Self::NoFaces
            | Self::WeldedVertices { .. }
            | Self::Parts { .. }
            | Self::Unposed { .. } => Ok(()),
            Self::TooLarge {
                vertices,
                triangles,
            } => write!(f, "{vertices} vertices, {triangles} triangles"),
            Self::LengthCount { triangles, lengths } => {
                write!(f, "{triangles} triangles, {lengths} triples of lengths")
            }
            Self::IndexOutOfRange {
                face,
                vertex,
                vertex_count,
            } => write!(f, "face {face} names vertex {vertex} of {vertex_count}"),
            Self::NonFiniteCoordinate { vertex }
            | Self::IsolatedVertex { vertex }
            | Self::UnplacedVertex { vertex } => write!(f, "vertex {vertex}"),
            Self::FileForm { line: 0, form } => form.fmt(f),
            Self::FileForm { line, form } => write!(f, "line {line}: {form}"),
            Self::RepeatedVertex { face, vertex } | Self::CollapsedFace { face, vertex } => {
                write!(f, "face {face}: vertex {vertex}")
            }
            Self::ZeroLengthEdge { vertices, faces }
            | Self::NonManifoldEdge { vertices, faces } => {
                write!(f, "{} in {}", Ends(vertices), SomeFaces(faces))
            }
            Self::LengthOutOfRange { vertices, length } => {
                write!(f, "{}: {length:.3e}", Ends(vertices))
            }
            Self::UnequalLengths {
                vertices,
                lengths,
                faces,
            } => write!(
                f,
                "{}: {:?} in face {}, {:?} in face {}",
                Ends(vertices),
                lengths[0],
                faces[0],
                lengths[1],
                faces[1]
            ),
            Self::TriangleInequality { face, lengths } => write!(f, "face {face}: {lengths:?}"),
            Self::NotOrientable { vertices, faces } => {
                write!(f, "at {} in {}", Ends(vertices), SomeFaces(faces))
            }
            Self::DuplicateFace { face, first } | Self::RepeatedFace { face, first } => {
                write!(f, "face {face} repeats face {first}")
            }
            Self::CoincidentVertices {
                exact,
                near,
                tolerance,
                components,
                boundary_edges,
                non_manifold_edges,
                ..
            } => {
                let some =
                    |n: &u32, one: &str| format!("{n} {one}{}", if *n == 1 { "" } else { "s" });
                if *exact > 0 {
                    write!(f, "and {near} within {tolerance:e} of the size; ")?;
                }
                write!(
                    f,
                    "welding would leave {} and {}",
                    some(components, "component"),
                    some(boundary_edges, "boundary edge")
                )?;
                if *non_manifold_edges > 0 {
                    let edges = some(non_manifold_edges, "edge");
                    write!(f, ", and {edges} of more than two faces")?;
                }
                Ok(())
            }
            Self::FlippedFace { face } | Self::ShortFace { face } | Self::FlatFace { face } => {
                write!(f, "face {face}")
            }
            Self::PinchedVertex { vertex, fans } => write!(f, "vertex {vertex}: {fans} fans"),
            Self::SeveralComponents { triangles } => {
                f.write_str("of ")?;
                write_list(f, triangles)?;
                f.write_str(" triangles")
            }
        }
    }
}

/// The ends of an edge.
struct Ends<'a>(&'a [u32; 2]);

impl fmt::Display for Ends<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "vertices {} and {}", self.0[0], self.0[1])
    }
}

/// Some faces. Long lists are shortened.
struct SomeFaces<'a>(&'a [u32]);

impl fmt::Display for SomeFaces<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.len() == 1 { "face " } else { "faces " })?;
        write_list(f, self.0)
    }
}

/// Writes the first few of `numbers`, and how many more there are.
fn write_list(f: &mut fmt::Formatter<'_>, numbers: &[u32]) -> fmt::Result {
    const SHOWN: usize = 6;
    for (i, number) in numbers.iter().take(SHOWN).enumerate() {
        write!(f, "{}{number}", if i == 0 { "" } else { ", " })?;
    }
    match numbers.len().saturating_sub(SHOWN) {
        0 => Ok(()),
        more => write!(f, " and {more} more"),
    }
}
