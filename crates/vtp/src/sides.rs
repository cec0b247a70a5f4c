//! Rule 1, one angle, two sides: the best path to an apex parts the windows of a list.

use geobench_window::Window;

use crate::orient::{is_clearly_left, is_clearly_right};

/// The window with the shortest path to the apex, and where that path enters the triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BestPath {
    /// Length of the path from the source of the run to the apex.
    pub(crate) distance: f64,
    /// Abscissa S at which it crosses the half-edge.
    pub(crate) entry: f64,
    /// Image of the window's (pseudo-)source.
    pub(crate) source: [f64; 2],
}

/// Limits within which a window may go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sides {
    /// Right limit of the rays for the left exit, if any of them may go there.
    pub(crate) left: Option<f64>,
    /// Left limit of the rays for the right exit, if any of them may go there.
    pub(crate) right: Option<f64>,
}

impl BestPath {
    /// What rule 1 leaves of `w`, whose separating abscissa is `sp`.
    ///
    /// Every path of `w` to the apex C is at least as long as the best one. A ray of `w` that
    /// enters left of S but heads for the right exit crosses the segment S → C of the best path,
    /// and is useless from there on; so rays left of S may only go left, and rays right of S only
    /// right. Rays on their own side survive, unless the best path has crossed them before it
    /// reached S: that is certain for all rays right of S if the best source lies right of the
    /// window's last ray and the window's source left of the best path, and mirrored on the left.
    #[inline]
    pub(crate) fn sides(&self, w: &Window, sp: f64) -> Sides {
        let s = self.entry;
        let crossed_left = || {
            is_clearly_left(w.source(), [w.b0, 0.0], self.source)
                && is_clearly_right(self.source, [s, 0.0], w.source())
        };
        let crossed_right = || {
            is_clearly_right(w.source(), [w.b1, 0.0], self.source)
                && is_clearly_left(self.source, [s, 0.0], w.source())
        };
        let left = w.b0 < s && !(s < sp.min(w.b1) && crossed_left());
        let right = w.b1 > s && !(s > sp.max(w.b0) && crossed_right());
        Sides {
            left: left.then(|| w.b1.min(sp).min(s)),
            right: right.then(|| w.b0.max(sp).max(s)),
        }
    }
}
