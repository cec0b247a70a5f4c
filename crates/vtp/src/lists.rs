//! Where windows wait: a list for each half-edge.

use geobench_mesh::HalfEdgeId;
use geobench_window::Window;

/// Stands for a list without windows.
const EMPTY: u32 = u32::MAX;

/// From which side of the face below its half-edge a window came.
///
/// A half-edge is the left exit of one half-edge and the right exit of another. Seen from below,
/// the windows that come as left children lie before those that come as right children, so that
/// keeping two lists and reading one after the other keeps windows in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// Through the left exit of a face.
    AsLeftChild = 0,
    /// Through the right exit of a face, or from the vertex opposite the half-edge.
    AsRightChild = 1,
}

/// The windows that wait on each half-edge to enter its face, in buffers that are used again.
#[derive(Clone, Debug)]
pub struct WindowLists {
    /// For each half-edge the buffers of its two lists.
    heads: Vec<[u32; 2]>,
    buffers: Vec<Vec<Window>>,
    free: Vec<u32>,
    waiting: usize,
}

impl WindowLists {
    pub(crate) fn new(half_edges: usize) -> Self {
        Self {
            heads: vec![[EMPTY; 2]; half_edges],
            buffers: Vec::new(),
            free: Vec::new(),
            waiting: 0,
        }
    }

    /// Number of windows in all lists.
    pub(crate) fn waiting(&self) -> usize {
        self.waiting
    }

    /// The windows in all lists.
    pub(crate) fn windows(&self) -> impl Iterator<Item = &Window> {
        self.buffers.iter().flatten()
    }

    pub(crate) fn is_empty(&self, h: HalfEdgeId) -> bool {
        self.heads[h.index()] == [EMPTY; 2]
    }

    /// Adds `window` behind those that came to `h` the same way.
    #[inline]
    pub(crate) fn push(&mut self, h: HalfEdgeId, arrival: Arrival, window: Window) {
        self.buffer(h, arrival).push(window);
        self.waiting += 1;
    }

    /// Adds `window` to those on `h` in the order of the left ends, which is the order of the whole
    /// list from then on until it is taken.
    pub(crate) fn insert_in_order(&mut self, h: HalfEdgeId, window: Window) {
        let second = self.heads[h.index()][Arrival::AsRightChild as usize];
        let mut right = Vec::new();
        if second != EMPTY {
            right.append(&mut self.buffers[second as usize]);
            self.free.push(second);
            self.heads[h.index()][Arrival::AsRightChild as usize] = EMPTY;
        }
        let all = self.buffer(h, Arrival::AsLeftChild);
        all.append(&mut right);
        let place = all.partition_point(|w| w.b0 <= window.b0);
        all.insert(place, window);
        self.waiting += 1;
    }

    /// The buffer of those that came to `h` this way.
    #[inline]
    fn buffer(&mut self, h: HalfEdgeId, arrival: Arrival) -> &mut Vec<Window> {
        let head = &mut self.heads[h.index()][arrival as usize];
        if *head == EMPTY {
            *head = self.free.pop().unwrap_or_else(|| {
                self.buffers.push(Vec::new());
                (self.buffers.len() - 1) as u32
            });
        }
        &mut self.buffers[*head as usize]
    }

    /// The windows that wait on `h`, in order.
    pub(crate) fn on(&self, h: HalfEdgeId) -> impl Iterator<Item = &Window> {
        let heads = self.heads[h.index()].into_iter();
        heads
            .filter(|&head| head != EMPTY)
            .flat_map(|head| &self.buffers[head as usize])
    }

    /// Moves the windows of `h` into `into`, in order.
    pub(crate) fn take(&mut self, h: HalfEdgeId, into: &mut Vec<Window>) {
        for head in &mut self.heads[h.index()] {
            if *head != EMPTY {
                let buffer = &mut self.buffers[*head as usize];
                self.waiting -= buffer.len();
                into.append(buffer);
                self.free.push(*head);
                *head = EMPTY;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(b0: f64) -> Window {
        Window {
            b0,
            b1: b0 + 1.0,
            px: 0.0,
            py: -1.0,
            sigma: 0.0,
        }
    }

    #[test]
    fn left_children_come_first_and_buffers_are_reused() {
        let mut lists = WindowLists::new(2);
        let h = HalfEdgeId::new(1);
        for round in 0..3 {
            lists.push(h, Arrival::AsRightChild, window(3.0));
            lists.push(h, Arrival::AsLeftChild, window(1.0));
            lists.push(h, Arrival::AsLeftChild, window(2.0));
            assert_eq!(lists.waiting(), 3, "round {round}");
            let mut taken = Vec::new();
            lists.take(h, &mut taken);
            assert_eq!(
                taken.iter().map(|w| w.b0).collect::<Vec<_>>(),
                [1.0, 2.0, 3.0]
            );
            assert!(lists.is_empty(h));
        }
        assert_eq!(lists.waiting(), 0);
        assert_eq!(lists.buffers.len(), 2);
    }
}
