//! The entries of a queue: windows, lists of windows, and vertices.

use geobench_mesh::{HalfEdgeId, VertexId};

/// A window to be propagated or a vertex to become a pseudo-source, packed into 8 bytes so that a
/// queue's node takes 16.
///
/// ```
/// use geobench_mesh::HalfEdgeId;
/// use geobench_window::queue::{Event, EventKind};
///
/// let h = HalfEdgeId::new(12);
/// assert_eq!(Event::window(h, 3).kind(), EventKind::Window(h, 3));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Event {
    /// The half-edge of a window, or the vertex with [`VERTEX`] set.
    place: u32,
    id: u32,
}

/// The bit that marks a vertex in [`Event`]. Half-edge ids stay below it: a mesh with 2³¹ of them
/// would not fit into memory beside its queue.
const VERTEX: u32 = 1 << 31;

/// An unpacked [`Event`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// A vertex whose distance has improved.
    Vertex(VertexId),
    /// A window that waits on this half-edge, with the id that its solver uses; the id is 0 where
    /// the whole list of the half-edge waits.
    Window(HalfEdgeId, u32),
}

impl Event {
    /// The event of vertex `v`.
    #[inline]
    pub const fn vertex(v: VertexId) -> Self {
        Self {
            place: v.raw() | VERTEX,
            id: 0,
        }
    }

    /// The event of window `id` on half-edge `h`.
    #[inline]
    pub const fn window(h: HalfEdgeId, id: u32) -> Self {
        Self { place: h.raw(), id }
    }

    /// Whether it is the event of a window.
    #[inline]
    pub(crate) const fn is_window(self) -> bool {
        self.place & VERTEX == 0
    }

    /// The unpacked event.
    #[inline]
    pub const fn kind(self) -> EventKind {
        if self.is_window() {
            EventKind::Window(HalfEdgeId::new(self.place), self.id)
        } else {
            EventKind::Vertex(VertexId::new(self.place & !VERTEX))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_keeps_everything() {
        let h = HalfEdgeId::new(0x7fff_ffff);
        assert_eq!(Event::window(h, 7).kind(), EventKind::Window(h, 7));
        let v = VertexId::new(12);
        assert_eq!(Event::vertex(v).kind(), EventKind::Vertex(v));
        assert_eq!(size_of::<(f64, Event)>(), 16);
    }
}
