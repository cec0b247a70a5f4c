//! Crossing a triangle: the separating abscissa of a window, its two children, and the distance
//! that it offers to the apex.

use crate::frame::Frame;
use crate::window::{Window, norm};

/// The abscissa at which the ray from the window's source to the apex C meets the edge. It may be
/// outside the window.
///
/// With e = cy - py: sp = (cy·px - py·cx) / e. Rays left of it leave through AC, rays right of it
/// through CB.
#[inline]
pub fn separating_abscissa(frame: &Frame, w: &Window) -> f64 {
    (frame.cy * w.px - w.py * frame.cx) / (frame.cy - w.py)
}

/// The part of `w` left of `hi` (at most `min(w.b1, sp)`) as it arrives at AC, in the frame of the
/// neighbour's half-edge A → C; `None` if its interval is empty.
///
/// The ray through abscissa s meets AC at u(s) = la·n / (n + m) from A, with n = -py·s and
/// m = (sp - s)·e. The source turns to (û·p, û×p), where û is the unit vector from A to C.
#[inline]
pub fn left_child(frame: &Frame, w: &Window, sp: f64, hi: f64) -> Option<Window> {
    let at = |s: f64| {
        let (n, m) = (-w.py * s, (sp - s) * (frame.cy - w.py));
        frame.la * n / (n + m)
    };
    let [ux, uy] = frame.left;
    let child = Window {
        b0: at(w.b0).max(0.0),
        b1: if hi >= sp {
            frame.la
        } else {
            at(hi).min(frame.la)
        },
        px: ux * w.px + uy * w.py,
        py: -(ux * w.py - uy * w.px).abs(),
        sigma: w.sigma,
    };
    (w.b0 < hi && child.b0 < child.b1).then_some(child)
}

/// The part of `w` right of `lo` (at least `max(w.b0, sp)`) as it arrives at CB, in the frame of
/// the neighbour's half-edge C → B; `None` if its interval is empty.
///
/// The ray through abscissa s meets CB at v(s) = lb·m / (n + m) from C, with n = -py·(l - s) and
/// m = (s - sp)·e. The source turns to (v̂·(p - C), v̂×(p - C)), where v̂ is the unit vector from C
/// to B.
#[inline]
pub fn right_child(frame: &Frame, w: &Window, sp: f64, lo: f64) -> Option<Window> {
    let at = |s: f64| {
        let (n, m) = (-w.py * (frame.l - s), (s - sp) * (frame.cy - w.py));
        frame.lb * m / (n + m)
    };
    let [vx, vy] = frame.right;
    let (x, y) = (w.px - frame.cx, w.py - frame.cy);
    let child = Window {
        b0: if lo <= sp { 0.0 } else { at(lo).max(0.0) },
        b1: at(w.b1).min(frame.lb),
        px: vx * x + vy * y,
        py: -(vx * y - vy * x).abs(),
        sigma: w.sigma,
    };
    (lo < w.b1 && child.b0 < child.b1).then_some(child)
}

/// The length of the shortest path of `w` to the apex C inside the triangle: straight if the
/// window sees C, else bent at the end of its interval that is nearest to the straight ray.
///
/// Both are lengths of real paths, so the offer is never too small. The bent path must be offered
/// as well: it carries a distance past a vertex that is hit exactly. Only saddle vertices then need
/// windows of their own.
#[inline]
pub fn apex_distance(frame: &Frame, w: &Window, sp: f64) -> f64 {
    if w.b0 <= sp && sp <= w.b1 {
        w.sigma + norm(frame.cx - w.px, frame.cy - w.py)
    } else {
        let bend = if sp < w.b0 { w.b0 } else { w.b1 };
        w.distance(bend) + norm(frame.cx - bend, frame.cy)
    }
}
