//! The result of a run: the distance and the source of every vertex, and windows on edges.

use geobench_mesh::{Mesh, VertexId};
use geobench_window::SolveError;

use crate::store::EdgeWindows;

/// The label of a vertex that no source reaches.
pub const NO_SOURCE: u32 = u32::MAX;

/// The result of a run: the distance and the nearest source of every vertex, and windows on edges.
/// All windows are stored from which the borders of cells are computed: those on the edges of faces
/// that several cells share.
#[derive(Clone, Copy, Debug)]
pub struct LabelledField<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) distances: &'a [f64],
    pub(crate) labels: &'a [u32],
    pub(crate) store: &'a EdgeWindows,
}

impl<'a> LabelledField<'a> {
    /// The mesh.
    pub const fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// The distance of every vertex from the nearest source, in the units of the mesh and the order
    /// of its vertices; infinite where no path leads.
    pub const fn distances(&self) -> &'a [f64] {
        self.distances
    }

    /// The nearest source of every vertex, as an index into the list of sources; [`NO_SOURCE`]
    /// where no path leads. If several sources are equally near, it is one of them.
    pub const fn labels(&self) -> &'a [u32] {
        self.labels
    }

    /// Number of windows that are stored on edges.
    pub fn stored_windows(&self) -> usize {
        self.store.stored()
    }
}

/// An algorithm that stores the windows from which a diagram is computed.
pub trait FieldSolver: Send {
    /// Finds the distance and the nearest of `sources` for every vertex, and the windows from which
    /// the [diagram](crate::Diagram) is computed. Labels are indices into `sources`.
    ///
    /// # Errors
    ///
    /// If `sources` is empty or has a vertex that does not exist, or if the mesh has a
    /// [junction](Mesh::junction).
    fn field(&mut self, sources: &[VertexId]) -> Result<LabelledField<'_>, SolveError>;
}
