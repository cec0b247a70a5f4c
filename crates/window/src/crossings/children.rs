//! Children of windows that are crossed several at a time.

use crate::frame::ExitEdge;
use crate::precision;
use crate::window::{Window, norm};

/// How much shorter than a window a path through a vertex must be, relatively, to beat it. As in
/// [the filter](crate::is_beaten_from_ends).
const MARGIN: f64 = 1.0 - precision::MARGIN;

/// The child of a window at one exit, in the frame of the neighbour's half-edge.
#[derive(Clone, Copy, Debug)]
pub struct CrossedChild {
    /// The edge through which the window leaves the triangle.
    pub exit_edge: ExitEdge,
    /// The window; empty if `b0` is not less than `b1`.
    pub window: Window,
    /// Its [least distance](Window::min_distance).
    pub label: f64,
    /// Upper bounds of the vertex distances that beat the window; see
    /// [`is_beaten`](Self::is_beaten).
    pub(super) limits: [f64; 3],
}

impl CrossedChild {
    /// Whether a path through one of the corners of the exit edge is shorter than every ray of the
    /// window: the vertex filter of Xin and Wang 2009, theorem 3.2. `distances` are those of the
    /// tail, the head and the third vertex.
    ///
    /// Each of the three tests compares a distance with a limit that depends on the window alone,
    /// so limits can be computed before distances are known.
    #[inline]
    #[allow(clippy::needless_bitwise_bool)] // Few windows are beaten: one branch for all three.
    pub fn is_beaten(&self, distances: [f64; 3]) -> bool {
        let [tail, head, behind] = self.limits;
        (distances[0] < tail) | (distances[1] < head) | (distances[2] < behind)
    }
}

/// The edge through which a window leaves a triangle.
#[derive(Clone, Copy)]
pub(super) struct ExitSide {
    /// 1 if the exit is the left one, else 0.
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) length: f64,
    /// Position of the third vertex of the triangle in the frame by which the window leaves.
    pub(super) behind: [f64; 2],
}

/// The label of `window`, which has left through `edge`, and the limits for
/// [`CrossedChild::is_beaten`].
#[inline(always)]
#[allow(clippy::inline_always)] // It is compiled for the instructions of its caller.
pub(super) fn measure(window: &Window, edge: &ExitSide) -> (f64, [f64; 3]) {
    let Window {
        b0,
        b1,
        px,
        py,
        sigma,
    } = *window;
    let ExitSide {
        left,
        right,
        length,
        behind: [behind_x, behind_y],
    } = *edge;
    let (from_b0, from_b1) = (norm(b0 - px, py), norm(b1 - px, py));
    let (at_b0, at_b1) = ((sigma + from_b0) * MARGIN, (sigma + from_b1) * MARGIN);
    let (far, at_far) = (left * b0 + right * b1, left * at_b0 + right * at_b1);
    let limits = [
        at_b1 - b1,
        at_b0 - (length - b0),
        at_far - norm(far - behind_x, behind_y),
    ];
    // The nearest point is the foot of the source, or the end beyond which that lies.
    let nearest = if px > b1 { from_b1 } else { -py };
    let nearest = if px < b0 { from_b0 } else { nearest };
    (sigma + nearest, limits)
}
