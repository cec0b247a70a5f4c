//! The filter that windows pass before they are merged into a list.

use geobench_window::{VertexFilter, Window, is_beaten_from_ends};

/// Drops windows before the list of their half-edge is searched.
///
/// A merge would drop the same windows, because windows from the vertex, or others as near, beat
/// the same rays. It would need a search in a list, and if those windows arrive later, the beaten
/// window and its children would have been propagated by then.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prefilter {
    pub(super) filter: VertexFilter,
    /// Children narrower than this are dropped.
    pub(super) threshold: f64,
}

impl Default for Prefilter {
    /// Drops nothing.
    fn default() -> Self {
        Self {
            filter: VertexFilter::Off,
            threshold: 0.0,
        }
    }
}

impl Prefilter {
    /// The filter beside a thin face, where it is always on: windows that are not taken nearest
    /// first would wind around needles.
    pub(super) fn beside_thin_face(self) -> Self {
        Self {
            filter: VertexFilter::On,
            ..self
        }
    }

    /// Whether a child on an edge of length `l` is dropped; `ends` are the known distances of the
    /// edge's tail and head.
    #[inline]
    pub(super) fn drops_child(&self, child: &Window, l: f64, ends: [f64; 2]) -> bool {
        child.b1 - child.b0 < self.threshold || self.drops(child, l, ends)
    }

    /// Whether the vertex filter drops `window`, however narrow it is.
    ///
    /// It applies the two tests of Xin and Wang's theorem 3.2 that use the ends of the edge. The
    /// third needs a square root; with it a run takes 1 to 7 % longer.
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
        let prefilter = Prefilter::default().beside_thin_face();
        assert!(!prefilter.drops(&WINDOW, 1.0, [f64::INFINITY; 2]));
        assert!(!prefilter.drops(&WINDOW, 1.0, [1.5, 1.5]));
        assert!(prefilter.drops(&WINDOW, 1.0, [1.25, 1.5]));
        assert!(prefilter.drops(&WINDOW, 1.0, [1.5, 1.25]));
        assert!(!Prefilter::default().drops(&WINDOW, 1.0, [0.0; 2]));
    }

    #[test]
    fn only_children_can_be_too_narrow() {
        let prefilter = Prefilter {
            threshold: 0.6,
            ..Prefilter::default()
        };
        let far = [f64::INFINITY; 2];
        assert!(prefilter.drops_child(&WINDOW, 1.0, far));
        assert!(!prefilter.drops(&WINDOW, 1.0, far));
    }
}
