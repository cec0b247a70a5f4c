//! A run for tests.

use geobench_mesh::generate::generate;
use geobench_mesh::{Mesh, Numbering};

use super::placement::Placement;
use super::shared::Shared;
use super::thread_view::{ThreadState, ThreadView};
use crate::engine::layout::{MeshLayout, half_edge, next, parts};
use crate::fast::FastOptions;
use crate::wavefront::{Improvement, SurfaceState, Wavefront};

/// The state of a thread.
pub(super) struct Thread {
    pub(super) wavefront: Wavefront,
    pub(super) state: ThreadState,
}

impl Thread {
    pub(super) fn view<'a>(
        &'a mut self,
        shared: &'a Shared,
    ) -> (&'a mut Wavefront, ThreadView<'a>) {
        (
            &mut self.wavefront,
            ThreadView::new(shared, &mut self.state),
        )
    }

    /// Finds a path and applies its effects.
    pub(super) fn find(&mut self, shared: &Shared, path: Improvement) {
        let (wavefront, mut view) = self.view(shared);
        if view.offer(path.vertex, path.distance) {
            wavefront.take_over(&mut view, path, &mut ());
            wavefront.settle(&mut view, &mut ());
        }
    }
}

/// A run of two threads on a terrain, before its first turn.
pub(super) fn two_threads() -> (Shared, [Thread; 2]) {
    let soup = generate(&"gen:terrain,n=20,seed=2".parse().unwrap()).unwrap();
    let (mesh, _) = Mesh::from_soup(soup).unwrap();
    let numbering = Numbering::breadth_first(&mesh);
    let layout = MeshLayout::new(&mesh, &numbering);
    let placement = Placement::new(&mesh, &numbering, 2);
    let options = FastOptions {
        bucket: 1.0 / layout.typical_length,
        ..FastOptions::default()
    };
    let threads = [0, 1].map(|_| {
        let mut thread = Thread {
            wavefront: Wavefront::new(&layout, &options),
            state: ThreadState::new(&layout),
        };
        thread.wavefront.reset();
        thread.state.reset();
        thread
    });
    let mut shared = Shared::new(layout, &options, 2, placement);
    shared.start(2);
    (shared, threads)
}

/// An interior vertex that sends windows into a spawn wedge.
pub(super) fn saddle(layout: &MeshLayout) -> u32 {
    let mut vertices = (0..).zip(&layout.vertices);
    let saddle = vertices.find(|(_, v)| v.pseudo_source && !v.all_around);
    saddle.unwrap().0
}

/// A path of length `distance` to `vertex`, across the face at index `place` of its ring.
pub(super) fn path(layout: &MeshLayout, vertex: u32, place: usize, distance: f64) -> Improvement {
    let (f, corner) = parts(layout.ring(vertex)[place]);
    Improvement {
        vertex,
        h: half_edge(f as u32, next(corner)),
        entry: 0.0,
        distance,
    }
}
