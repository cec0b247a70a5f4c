//! The leaves of the sequence tree: windows that wait to be propagated.

use geobench_mesh::{HalfEdgeId, VertexId};
use geobench_window::continuous::Side;
use geobench_window::{Window, prefetch};

/// The nearest split above a window: if another window has taken that angle since, the subtree on
/// its wrong side is dead.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guard {
    /// Where the split window's ray to the apex met the half-edge, as a fraction of its length.
    entry: f64,
    /// Twice the number of the half-edge through which that window came, which is the angle's, and
    /// 1 more for the right child of the split.
    place: u32,
}

impl Guard {
    /// Of a window above which there is no split.
    pub(crate) const NONE: Self = Self {
        entry: 0.0,
        place: u32::MAX,
    };

    /// Of the child on this side of a window that was split at `angle`.
    pub(crate) const fn new(angle: HalfEdgeId, entry: f64, side: Side) -> Self {
        let side = match side {
            Side::Left => 0,
            Side::Right => 1,
        };
        Self {
            entry,
            place: 2 * angle.raw() + side,
        }
    }

    /// The number of the angle; that of no angle if there is no split.
    #[inline]
    pub(crate) fn angle_index(self) -> usize {
        self.place as usize / 2
    }

    /// The angle, the fraction at which the ray to its apex came in, and the side of the child.
    #[inline]
    pub(crate) fn split(self) -> Option<(HalfEdgeId, f64, Side)> {
        let side = if self.place.is_multiple_of(2) {
            Side::Left
        } else {
            Side::Right
        };
        (self.place != u32::MAX).then(|| (HalfEdgeId::new(self.place / 2), self.entry, side))
    }
}

/// What tells whether a window still matters when its turn comes.
#[derive(Clone, Copy, Debug)]
pub struct Lineage {
    /// The (pseudo-)source.
    pub(crate) root: VertexId,
    /// Triangles crossed since the root.
    pub(crate) level: u32,
    pub(crate) guard: Guard,
}

/// A window that waits to be propagated: one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Node {
    pub(crate) window: Window,
    pub(crate) lineage: Lineage,
}

/// Nodes in reused slots.
#[derive(Clone, Debug, Default)]
pub(crate) struct Leaves {
    nodes: Vec<Node>,
    free: Vec<u32>,
}

impl Leaves {
    #[inline]
    pub(crate) fn insert(&mut self, node: Node) -> u32 {
        if let Some(slot) = self.free.pop() {
            self.nodes[slot as usize] = node;
            slot
        } else {
            self.nodes.push(node);
            (self.nodes.len() - 1) as u32
        }
    }

    #[inline]
    pub(crate) fn remove(&mut self, slot: u32) -> Node {
        self.free.push(slot);
        self.nodes[slot as usize]
    }

    /// Asks for the node that is to be [removed](Self::remove) soon.
    #[inline]
    pub(crate) fn announce(&self, slot: u32) {
        prefetch(&self.nodes, slot as usize);
    }

    /// What the node that is to be removed soon has inherited.
    #[inline]
    pub(crate) fn lineage(&self, slot: u32) -> &Lineage {
        &self.nodes[slot as usize].lineage
    }

    pub(crate) fn len(&self) -> usize {
        self.nodes.len() - self.free.len()
    }

    pub(crate) fn clear(&mut self) {
        self.nodes.clear();
        self.free.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_keeps_the_split() {
        assert_eq!(Guard::NONE.split(), None);
        for side in [Side::Left, Side::Right] {
            for angle in [0, 7, (1 << 31) - 2].map(HalfEdgeId::new) {
                let guard = Guard::new(angle, 0.25, side);
                assert_eq!(guard.split(), Some((angle, 0.25, side)));
            }
        }
        assert_eq!(size_of::<Node>(), 64);
    }
}
