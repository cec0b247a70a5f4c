//! The traversed area: the faces that windows may cross.

use std::collections::VecDeque;

use geobench_mesh::{FaceId, HalfEdgeId, Mesh};

use crate::lists::WindowLists;

/// The faces that have been taken so far. A list of windows crosses the face ahead of it as soon
/// as that face belongs to the area; else it waits on the wavefront, the border of the area.
#[derive(Clone, Debug)]
pub(crate) struct Area {
    /// For each face the step in which it joined; 0 if it has not.
    joined: Vec<u32>,
    step: u32,
    /// Half-edges whose lists are about to cross a face of the area, and who they are.
    ready: VecDeque<HalfEdgeId>,
    is_ready: Vec<bool>,
}

impl Area {
    /// No face of `mesh`.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        Self {
            joined: vec![0; mesh.face_count()],
            step: 0,
            ready: VecDeque::new(),
            is_ready: vec![false; mesh.half_edge_count()],
        }
    }

    /// Forgets the last run, at the end of which no list was ready.
    pub(crate) fn reset(&mut self) {
        self.joined.fill(0);
        self.step = 0;
    }

    /// Begins a step.
    pub(crate) fn advance(&mut self) {
        self.step += 1;
    }

    /// Whether `face` has joined.
    #[inline]
    pub(crate) fn contains(&self, face: FaceId) -> bool {
        self.joined[face.index()] != 0
    }

    /// Whether `face` joined in this step.
    #[inline]
    pub(crate) fn is_new(&self, face: FaceId) -> bool {
        self.joined[face.index()] == self.step
    }

    /// `face` joins in this step, if it has not yet, and the lists that wait for it are ready.
    pub(crate) fn join(&mut self, face: FaceId, lists: &WindowLists) {
        if !self.contains(face) {
            self.joined[face.index()] = self.step;
            for corner in 0..3 {
                self.make_ready(face.half_edge(corner), lists);
            }
        }
    }

    /// Queues the list on `h` if it has windows and its face has joined.
    #[inline]
    pub(crate) fn make_ready(&mut self, h: HalfEdgeId, lists: &WindowLists) {
        if self.contains(h.face()) && !self.is_ready[h.index()] && !lists.is_empty(h) {
            self.is_ready[h.index()] = true;
            self.ready.push_back(h);
        }
    }

    /// Takes the half-edge that has been ready longest.
    #[inline]
    pub(crate) fn next_ready(&mut self) -> Option<HalfEdgeId> {
        let h = self.ready.pop_front()?;
        self.is_ready[h.index()] = false;
        Some(h)
    }
}
