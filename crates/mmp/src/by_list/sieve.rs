//! Which windows are dropped before they are merged into a list.

use geobench_window::{VertexFilter, Window, is_beaten_from_ends};

/// What is asked of a window that comes to a half-edge, before its list is looked at.
///
/// A merge finds out sooner or later what the vertex filter tells at once, since the windows that
/// start from the vertex, or others as near, beat the same rays. But it takes a search in a list
/// for that, and where they come later the window has gone on by then, and its children after it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sieve {
    pub(super) filter: VertexFilter,
    /// Children narrower than this are dropped.
    pub(super) threshold: f64,
}

impl Sieve {
    /// The same beside a thin face, where windows are always filtered: those that come in any order
    /// but nearest first would wind around needles otherwise.
    pub(super) fn beside_thin_face(self) -> Self {
        Self {
            filter: VertexFilter::On,
            ..self
        }
    }

    /// Whether a child that has come to an edge of length `l` is dropped; `ends` are the distances
    /// known of the edge's tail and head.
    #[inline]
    pub(super) fn drops_child(&self, child: &Window, l: f64, ends: [f64; 2]) -> bool {
        child.b1 - child.b0 < self.threshold || self.drops(child, l, ends)
    }

    /// The same for a window that starts from a vertex, however narrow it is.
    ///
    /// Of the three tests of Xin and Wang's theorem 3.2 it makes the two that know the ends of the
    /// edge: with the third, which takes a square root, a run takes 1 to 7 % longer.
    #[inline]
    pub(super) fn drops(&self, window: &Window, l: f64, [tail, head]: [f64; 2]) -> bool {
        self.filter == VertexFilter::On && is_beaten_from_ends(window, l, tail, head)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From a source one below the middle of an edge of length 1.
    const WINDOW: Window = Window {
        b0: 0.25,
        b1: 0.75,
        px: 0.5,
        py: -1.0,
        sigma: 1.0,
    };

    #[test]
    fn a_window_is_dropped_if_an_end_of_its_edge_is_near_enough() {
        let sieve = Sieve::default();
        assert!(!sieve.drops(&WINDOW, 1.0, [f64::INFINITY; 2]));
        assert!(!sieve.drops(&WINDOW, 1.0, [1.5, 1.5]));
        assert!(sieve.drops(&WINDOW, 1.0, [1.25, 1.5]));
        assert!(sieve.drops(&WINDOW, 1.0, [1.5, 1.25]));
        let off = Sieve {
            filter: VertexFilter::Off,
            ..sieve
        };
        assert!(!off.drops(&WINDOW, 1.0, [0.0; 2]));
    }

    #[test]
    fn only_children_can_be_too_narrow() {
        let sieve = Sieve {
            threshold: 0.6,
            ..Sieve::default()
        };
        let far = [f64::INFINITY; 2];
        assert!(sieve.drops_child(&WINDOW, 1.0, far));
        assert!(!sieve.drops(&WINDOW, 1.0, far));
    }
}
