//! Tie points: the abscissae at which two windows of one edge offer the same distance.

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

    /// The single tie point `x`.
    pub(crate) fn one(x: f64) -> Self {
        let mut ties = Self::default();
        ties.push(x);
        ties
    }

    /// The finite ones of `points`.
    pub(crate) fn of(points: [f64; 2]) -> Self {
        let mut ties = Self::default();
        let [x, y] = points;
        let ascending = if y < x { [y, x] } else { points };
        for x in ascending {
            ties.push(x);
        }
        ties
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
/// (b - D·y1)(b + D·y1) / A. Squaring brought in other branches: a root counts only if its
/// |p1 x| = (a·u + b)/D is a distance, so (a·u + b)·D ≥ 0, and if its |p0 x| = D + |p1 x| is one,
/// so (D² + a·u + b)·D ≥ 0. Degenerate cases:
///
/// * D = 0: the perpendicular bisector, u = -b/a; no tie when a = 0 too.
/// * A = 0 (an asymptote is parallel to the edge): the one finite root, by the same formulas.
/// * Sources on the edge itself (y = 0): piecewise linear curves, by the same formulas; where they
///   coincide over a range there is no point to name and its ends may be returned.
///
/// Two windows that travel in the same direction cross at most once in theory; with a σ that is
/// not final yet they can cross twice.
///
/// ```
/// use geobench_window::{Window, tie_points};
///
/// let left = Window { b0: 0.0, b1: 4.0, px: 0.0, py: -1.0, sigma: 0.0 };
/// let right = Window { px: 4.0, ..left };
/// assert_eq!(tie_points(&left, &right).as_slice(), [2.0]);
/// ```
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
        // D·|p1 x|, and D² + D·|p1 x| = D·|p0 x|: neither may be negative.
        let scaled = a * u + b;
        if scaled * delta >= 0.0 && (delta * delta + scaled) * delta >= 0.0 {
            ties.push(w1.px + u);
        }
    }
    if ties.len == 2 && ties.points[0] > ties.points[1] {
        ties.points.swap(0, 1);
    }
    ties
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::tests::windows;
    use proptest::prelude::*;

    fn window(px: f64, py: f64, sigma: f64) -> Window {
        Window {
            b0: 0.0,
            b1: 1.0,
            px,
            py,
            sigma,
        }
    }

    fn gap(w0: &Window, w1: &Window, x: f64) -> f64 {
        w0.distance(x) - w1.distance(x)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn distances_agree_at_every_tie_point(w0 in windows(), w1 in windows()) {
            for &x in tie_points(&w0, &w1).as_slice() {
                // Distant curves may run almost parallel. The tie is then uncertain, but the
                // distances agree.
                let size = w0.distance(x) + x.abs();
                prop_assert!(gap(&w0, &w1, x).abs() <= 1e-11 * size, "{x}: {}", gap(&w0, &w1, x));
            }
        }

        #[test]
        fn no_crossing_is_missed(w0 in windows(), w1 in windows()) {
            let ties = tie_points(&w0, &w1);
            let steps = 400;
            let xs = (0..=steps).map(|i| -4.0 + 9.0 * f64::from(i) / f64::from(steps));
            let (mut last, mut last_x) = (0.0f64, f64::NEG_INFINITY);
            for x in xs {
                let now = gap(&w0, &w1, x);
                if now.abs() < 1e-9 {
                    continue;
                }
                if last * now < 0.0 {
                    let found = ties.as_slice().iter().any(|&t| last_x <= t && t <= x);
                    prop_assert!(found, "between {last_x} and {x}: {ties:?}");
                }
                (last, last_x) = (now, x);
            }
        }

        #[test]
        fn order_of_the_windows_does_not_matter(w0 in windows(), w1 in windows()) {
            let (there, back) = (tie_points(&w0, &w1), tie_points(&w1, &w0));
            for (x, y) in there.as_slice().iter().zip(back.as_slice()) {
                let size = w0.distance(*x) + x.abs();
                prop_assert!(there.as_slice().len() == back.as_slice().len());
                // Almost parallel curves leave the abscissa uncertain, not the distance.
                prop_assert!((w0.distance(*x) - w0.distance(*y)).abs() <= 1e-6 * size);
            }
        }
    }

    #[test]
    fn equal_sigmas_tie_on_the_bisector() {
        let ties = tie_points(&window(0.0, -1.0, 0.5), &window(1.0, -1.0, 0.5));
        assert_eq!(ties.as_slice(), [0.5]);
    }

    #[test]
    fn sources_above_each_other_with_equal_sigma_never_tie() {
        let ties = tie_points(&window(0.5, -1.0, 0.0), &window(0.5, -2.0, 0.0));
        assert_eq!(ties.as_slice(), [0.0; 0]);
    }

    #[test]
    fn one_window_ties_with_itself_nowhere() {
        let w = window(0.3, -1.0, 1.0);
        assert_eq!(tie_points(&w, &w).as_slice(), [0.0; 0]);
    }

    /// A widely used program divides by B instead of 2B in this case and returns 2.5.
    #[test]
    fn asymptote_parallel_to_the_edge_leaves_one_tie() {
        let (w0, w1) = (window(0.0, -3.0, 0.0), window(2.0, -1.0, 2.0));
        let ties = tie_points(&w0, &w1);
        assert_eq!(ties.as_slice(), [1.25]);
        assert_eq!(w0.distance(1.25), w1.distance(1.25));
    }

    #[test]
    fn opposite_directions_can_tie_twice() {
        let (near, far) = (window(0.5, -0.1, 1.0), window(0.5, -2.0, 0.0));
        let ties = tie_points(&near, &far);
        let [x, y] = ties.as_slice() else {
            panic!("{ties:?}")
        };
        assert!(x < y && (x + y - 1.0).abs() < 1e-14);
    }

    /// Where the difference of σ exceeds the distance of the sources, one window is always shorter.
    /// The roots of the squared equation are then points whose distances *add up* to the
    /// difference.
    #[test]
    fn points_at_which_distances_add_up_are_no_ties() {
        let ties = tie_points(&window(-2.75, 0.0, 2.5), &window(-2.5, 0.0, 0.0));
        assert_eq!(ties.as_slice(), [0.0; 0]);
    }

    #[test]
    fn sources_on_the_edge_tie_between_them() {
        let ties = tie_points(&window(0.0, 0.0, 0.0), &window(1.0, 0.0, 0.5));
        assert!(ties.as_slice().contains(&0.75), "{ties:?}");
    }
}
