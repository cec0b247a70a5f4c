//! The state of the surface under a single wavefront.

use geobench_mesh::{Mesh, Numbering};

use crate::engine::layout::MeshLayout;
use crate::engine::prefetch::prefetch;
use crate::wavefront::SurfaceState;
use geobench_window::prefetch_line;

/// The surface state of a single wavefront. The state of each face is stored in its layout record.
#[derive(Clone, Debug)]
pub(super) struct SerialState {
    pub(super) layout: MeshLayout,
    /// The number of this run. Faces with this number belong to the traversed area.
    run: u8,
    pub(super) distances: Vec<f64>,
}

impl SerialState {
    pub(super) fn new(mesh: &Mesh, numbering: &Numbering) -> Self {
        Self {
            layout: MeshLayout::new(mesh, numbering),
            run: 0,
            distances: Vec::new(),
        }
    }

    /// Clears the state of the last run.
    pub(super) fn reset(&mut self) {
        if self.run == u8::MAX {
            self.run = 0;
            for face in &mut self.layout.faces {
                face.state.leave();
            }
        }
        self.run += 1;
        self.distances.clear();
        let vertices = self.layout.vertices.len();
        self.distances.resize(vertices, f64::INFINITY);
    }
}

impl SurfaceState for SerialState {
    const IS_ALONE: bool = true;

    #[inline(always)]
    fn layout(&self) -> &MeshLayout {
        &self.layout
    }

    #[inline(always)]
    fn list(&self, f: usize, corner: usize) -> u32 {
        self.layout.faces[f].state.list(corner)
    }

    #[inline(always)]
    fn set_list(&mut self, f: usize, corner: usize, list: u32) {
        self.layout.faces[f].state.set_list(corner, list);
    }

    #[inline(always)]
    fn take_list(&mut self, f: usize, corner: usize) -> u32 {
        self.layout.faces[f].state.take_list(corner)
    }

    #[inline(always)]
    fn enqueue(&mut self, f: usize, corner: usize) -> bool {
        self.layout.faces[f].state.enqueue(corner, self.run)
    }

    #[inline(always)]
    fn join(&mut self, f: usize) -> bool {
        self.layout.faces[f].state.join(self.run)
    }

    #[inline(always)]
    fn distance(&self, v: u32) -> f64 {
        self.distances[v as usize]
    }

    /// Whether a path is the shortest is hard to predict, so there is no branch on it.
    #[inline(always)]
    fn offer(&mut self, v: u32, d: f64) -> bool {
        let known = &mut self.distances[v as usize];
        let nearer = d < *known;
        *known = if nearer { d } else { *known };
        nearer
    }

    /// The distance itself: no other thread finds paths.
    #[inline(always)]
    fn reached(&self, v: u32) -> f64 {
        self.distance(v)
    }

    #[inline(always)]
    fn prefetch_face(&self, f: usize) {
        self.layout.prefetch(f);
    }

    #[inline(always)]
    fn prefetch_lists(&self, f: usize) {
        if let Some(face) = self.layout.faces.get(f) {
            prefetch_line(face);
        }
    }

    #[inline(always)]
    fn prefetch_distance(&self, v: u32) {
        prefetch(&self.distances, v as usize);
    }
}
