//! The origin of the shortest path to each vertex.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};

use crate::frame::Frame;
use crate::probe::Probe;
use crate::window::Window;

/// How a path crosses the last face before the vertex at which it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// Along the edge from the tail of the half-edge opposite to the vertex.
    FromTail,
    /// Along the edge from the head of that half-edge.
    FromHead,
    /// Straight from the image of a (pseudo-)source, in the frame of that half-edge.
    From([f64; 2]),
}

impl Way {
    /// How the shortest path of `window` to the apex crosses the triangle of `frame`.
    ///
    /// A path that bends at an end of the window bends at a vertex, up to rounding.
    pub fn of(window: &Window, frame: &Frame) -> Self {
        Self::through(window.entry(frame), window.source(), frame.l)
    }

    /// The path through abscissa `entry` of a half-edge of length `l`, from a source at `image`.
    #[inline]
    pub fn through(entry: f64, image: [f64; 2], l: f64) -> Self {
        if entry <= 0.0 {
            Self::FromTail
        } else if entry >= l {
            Self::FromHead
        } else {
            Self::From(image)
        }
    }
}

/// Where the shortest path to a vertex comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// The vertex is a source, or no path leads to it.
    None,
    /// Along the edge from this vertex.
    Vertex(VertexId),
    /// Through a half-edge opposite to the vertex.
    Window {
        /// The half-edge.
        h: HalfEdgeId,
        /// The image of the source, or of the last vertex at which the path bends, in the frame of
        /// the half-edge.
        image: [f64; 2],
    },
}

/// The origins of the shortest paths to all vertices of a mesh; 24 bytes a vertex.
///
/// [`Solver::trace`](crate::Solver::trace) returns them. `geobench-paths` traces paths back with
/// them.
///
/// ```
/// use geobench_ich::ich;
/// use geobench_mesh::{Mesh, VertexId};
/// use geobench_window::{Goal, Origin, Solver};
///
/// let mesh = Mesh::generate("grid,n=2")?;
/// let [source, beside, across] = [0, 1, 5].map(VertexId::new);
/// let (_, origins) = ich(&mesh).trace(&[source], &Goal::everything())?;
/// assert_eq!(origins.of(&mesh, source), Origin::None);
/// assert_eq!(origins.of(&mesh, beside), Origin::Vertex(source));
/// assert!(matches!(origins.of(&mesh, across), Origin::Window { .. }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Origins {
    of: Vec<OriginRecord>,
    along_edges: bool,
}

#[derive(Clone, Copy, Debug)]
struct OriginRecord {
    way: [f64; 2],
    /// The half-edge that starts at the vertex, in the face that the path crosses last; [`NONE`] if
    /// there is no path.
    corner: u32,
}

const NONE: u32 = u32::MAX;

impl OriginRecord {
    const NONE: Self = Self {
        way: [0.0; 2],
        corner: NONE,
    };
}

impl Origins {
    pub(crate) fn new(vertices: usize, along_edges: bool) -> Self {
        Self {
            of: vec![OriginRecord::NONE; vertices],
            along_edges,
        }
    }

    /// No origins for this number of vertices.
    pub fn none(vertices: usize) -> Self {
        Self::new(vertices, false)
    }

    /// Whether the algorithm knows only paths along edges, which are not straight.
    pub const fn are_along_edges(&self) -> bool {
        self.along_edges
    }

    /// The origin of the shortest path to vertex `v`. `mesh` must be the mesh of the run.
    ///
    /// # Panics
    ///
    /// If the mesh of the run has no vertex `v`.
    pub fn of(&self, mesh: &Mesh, v: VertexId) -> Origin {
        let OriginRecord { way, corner } = self.of[v.index()];
        if corner == NONE {
            return Origin::None;
        }
        let h = HalfEdgeId::new(corner).next();
        if !way[0].is_nan() {
            Origin::Window { h, image: way }
        } else if way[1] == 0.0 {
            Origin::Vertex(mesh.tail(h))
        } else {
            Origin::Vertex(mesh.head(h))
        }
    }

    /// Records that the shortest path to `v` crosses the face of `corner`, a half-edge that starts
    /// at `v`, last.
    #[inline]
    pub(crate) fn set(&mut self, v: VertexId, corner: HalfEdgeId, way: Way) {
        self.of[v.index()] = OriginRecord {
            way: match way {
                Way::FromTail => [f64::NAN, 0.0],
                Way::FromHead => [f64::NAN, 1.0],
                Way::From(image) => image,
            },
            corner: corner.raw(),
        };
    }

    /// Replaces the solver's numbers by those of `mesh`.
    pub(crate) fn renumber(
        &mut self,
        mesh: &Mesh,
        vertex: impl Fn(VertexId) -> VertexId,
        corner: impl Fn(VertexId, usize) -> HalfEdgeId,
    ) {
        let of = mesh.vertices().map(|v| {
            let record = self.of[vertex(v).index()];
            if record.corner == NONE {
                return record;
            }
            let ring = mesh.outgoing(v);
            let place = (0..ring.len()).find(|&i| corner(v, i).raw() == record.corner);
            let corner = place.map_or(NONE, |i| ring[i].raw());
            OriginRecord { corner, ..record }
        });
        self.of = of.collect();
    }
}

/// Records the origins of the paths of a run.
impl Probe for Origins {
    const TRACES: bool = true;

    #[inline]
    fn reach(&mut self, v: VertexId, corner: HalfEdgeId, way: Way) {
        self.set(v, corner, way);
    }

    fn renumber(
        &mut self,
        mesh: &Mesh,
        vertex: impl Fn(VertexId) -> VertexId,
        corner: impl Fn(VertexId, usize) -> HalfEdgeId,
    ) {
        Self::renumber(self, mesh, vertex, corner);
    }
}
