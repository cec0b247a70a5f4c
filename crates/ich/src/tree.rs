//! The leaves of the sequence tree: windows that wait to be propagated.

use geobench_mesh::{HalfEdgeId, VertexId};
use geobench_window::Window;
use geobench_window::continuous::Side;

/// The nearest split above a window: if another window has taken that angle since, the subtree on
/// its wrong side is dead.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guard {
    /// The angle, by the half-edge through which the split window came.
    pub(crate) angle: HalfEdgeId,
    /// How often the angle had been taken then.
    pub(crate) stamp: u32,
    /// Where the split window's ray to the apex met the half-edge.
    pub(crate) entry: f64,
    /// The child of the split from which this window descends.
    pub(crate) side: Side,
}

/// What tells whether a window still matters when its turn comes.
#[derive(Clone, Copy, Debug)]
pub struct Lineage {
    /// The (pseudo-)source.
    pub(crate) root: VertexId,
    /// How often the root's distance had improved when the line of descent began.
    pub(crate) root_stamp: u32,
    /// Triangles crossed since the root.
    pub(crate) level: u32,
    pub(crate) guard: Option<Guard>,
}

/// A window that waits to be propagated.
#[derive(Clone, Copy, Debug)]
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
    pub(crate) fn insert(&mut self, node: Node) -> u32 {
        if let Some(slot) = self.free.pop() {
            self.nodes[slot as usize] = node;
            slot
        } else {
            self.nodes.push(node);
            (self.nodes.len() - 1) as u32
        }
    }

    pub(crate) fn remove(&mut self, slot: u32) -> Node {
        self.free.push(slot);
        self.nodes[slot as usize]
    }

    pub(crate) fn len(&self) -> usize {
        self.nodes.len() - self.free.len()
    }

    pub(crate) fn clear(&mut self) {
        self.nodes.clear();
        self.free.clear();
    }
}
