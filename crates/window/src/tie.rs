//! Tie points: where two windows of one edge offer the same distance.

use crate::window::Window;

/// Up to two abscissae, ascending.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TiePoints {
    points: [f64; 2],
    len: usize,
}

impl TiePoints {
    /// The tie points, in ascending order.
    #[inline]
    pub fn as_slice(&self) -> &[f64] {
        &self.points[..self.len]
    }

    #[inline]
    fn push(&mut self, x: f64) {
        if x.is_finite() {
            self.points[self.len] = x;
            self.len += 1;
        }
    }
}

/// The abscissae, anywhere on the line of the edge, at which the curves σ + |p x| of two windows
/// cross.
///
/// With a = x1 - x0, D = σ1 - σ0 and u measured from x1, equality of the distances squares to
/// (a·u + b)² = D²·(u² + y1²), where A = (a - D)(a + D) and b = (A + (y0 - y1)(y0 + y1)) / 2. Its
/// roots are u = n± / A with n± = -a·b ± D·√(b² + A·y1²), and of each pair the one that loses no
/// digits is divided directly, the other through the product of the roots,
/// (b - D·y1)(b + D·y1) / A. A root counts only if (a·u + b)·D ≥ 0; squaring brought in the other
/// branch. Degenerate cases:
///
/// * D = 0: the perpendicular bisector, u = -b/a; no tie when a = 0 too.
/// * A = 0 (an asymptote is parallel to the edge): the one finite root, by the same formulas.
/// * Sources on the edge itself (y = 0): piecewise linear curves, by the same formulas; where they
///   coincide over a range there is no point to name and its ends may be returned.
///
/// Two windows that travel in the same direction cross at most once in theory; with a σ that is
/// not final yet they can cross twice.
pub fn tie_points(w0: &Window, w1: &Window) -> TiePoints {
    let mut ties = TiePoints::default();
    let a = w1.px - w0.px;
    let delta = w1.sigma - w0.sigma;
    let y1 = w1.py;
    let leading = (a - delta) * (a + delta);
    let b = 0.5 * (leading + (w0.py - y1) * (w0.py + y1));
    if delta == 0.0 {
        ties.push(w1.px - b / a);
        return ties;
    }
    let radicand = b * b + leading * y1 * y1;
    if radicand < 0.0 {
        return ties;
    }
    let root = delta * radicand.sqrt();
    let numerators = [-a * b + root, -a * b - root];
    let product = (b - delta * y1) * (b + delta * y1);
    for s in [0, 1] {
        let (own, other) = (numerators[s], numerators[1 - s]);
        let u = if own.abs() >= other.abs() {
            own / leading
        } else {
            product / other
        };
        if (a * u + b) * delta >= 0.0 {
            ties.push(w1.px + u);
        }
    }
    if ties.len == 2 && ties.points[0] > ties.points[1] {
        ties.points.swap(0, 1);
    }
    ties
}
