//! Rules 2 and 3: comparison of two windows of one edge.
//!
//! Both rules follow from one lemma: where a ray of a window crosses a path that is shorter up to
//! the crossing, the ray is useless from there on. In the paper the rules differ in whether the
//! windows came through one edge or through two. The checks are made on the edge on which both
//! windows lie, and are the same. [`Pairs`](crate::Pairs) selects the pairs that are compared.

use geobench_window::Window;

use crate::engine::layout::MeshLayout;
use crate::orient::{is_clearly_left, is_clearly_right};
use crate::precision::{MARGIN, WINS, blur};

/// Least distance of a crossing from the border of the triangle, as a fraction of its size, for
/// rays that cross at a right angle in a triangle as high as it is long. The limit grows as the
/// sine of the angle falls, as does the error of the crossing: two rays through one corner of the
/// triangle seem to cross beside it. It also grows with the slenderness of the triangle.
pub(crate) const INSIDE: f64 = MARGIN;

/// The greatest such distance. Rays that would need more count as parallel.
pub(crate) const BLURRED: f64 = 1e-3;

/// The result of a comparison. Either window may also have been cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PairOutcome {
    BothStay,
    FirstDies,
    SecondDies,
}

/// The edge on which the compared windows lie.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SharedEdge {
    /// Its length.
    pub(crate) l: f64,
    /// The third vertex of the triangle that the windows have just crossed, below the edge.
    pub(crate) behind: [f64; 2],
    /// The [rounding error](blur) of the sources of windows on the edge.
    pub(crate) blur: f64,
    /// The longest edge of the mesh, to which errors of positions are relative, divided by the
    /// height of the triangle, to which depths inside are.
    pub(crate) slenderness: f64,
}

impl SharedEdge {
    /// An edge of length `l` with the vertex `behind` below it, on a mesh with edges up to
    /// `longest`.
    pub(crate) const fn new(l: f64, behind: [f64; 2], longest: f64) -> Self {
        Self {
            l,
            behind,
            blur: blur(longest),
            slenderness: longest / -behind[1],
        }
    }

    /// Half-edge `h` of `layout`.
    pub(crate) fn of(layout: &MeshLayout, h: u32) -> Self {
        Self::new(layout.length(h), layout.behind(h), layout.longest_edge)
    }

    /// Whether `point` lies inside the triangle behind the edge, at a distance of more than
    /// `margin` of its size from the border.
    fn is_behind(&self, point: [f64; 2], margin: f64) -> bool {
        let depth = point[1] / self.behind[1];
        let leftmost = depth * self.behind[0];
        let rightmost = self.l + depth * (self.behind[0] - self.l);
        let slack = margin * self.l;
        margin < depth
            && depth < 1.0 - margin
            && leftmost + slack < point[0]
            && point[0] < rightmost - slack
    }
}

/// Compares two windows of one edge, and cuts what each loses to the other (Qin et al. 2016,
/// section 4.1, cases 1 to 6). Returns whether one of them has lost everything.
pub(crate) fn check_pair(a: &mut Window, b: &mut Window, edge: &SharedEdge) -> PairOutcome {
    let (lo, hi) = (a.b0.max(b.b0), a.b1.min(b.b1));
    if lo > hi {
        return check_disjoint(a, b, edge);
    }
    for x in [lo, hi] {
        // An earlier cut may have removed x from an interval.
        if x < a.b0.max(b.b0) || x > a.b1.min(b.b1) {
            continue;
        }
        let (da, db) = (a.distance(x), b.distance(x));
        if da < db * WINS - edge.blur {
            if !cut(b, a, x, edge) {
                return PairOutcome::SecondDies;
            }
        } else if db < da * WINS - edge.blur && !cut(a, b, x, edge) {
            return PairOutcome::FirstDies;
        }
        if lo == hi {
            break;
        }
    }
    PairOutcome::BothStay
}

/// Cuts the rays of `loser` that cross the path of `winner` to `x`. `winner` must be shorter at
/// `x`, which must be in both intervals. Returns whether any ray is left.
///
/// With the winner's source on the left, these are the rays left of x, if the source is beyond the
/// loser's last ray on that side, so that the path to x enters the cone there. The right side is
/// symmetric. The side at x alone does not decide: x is often on a ray through both sources, where
/// the sign is a rounding error.
fn cut(loser: &mut Window, winner: &Window, x: f64, edge: &SharedEdge) -> bool {
    let (from, to) = (loser.source(), winner.source());
    let blur = edge.blur;
    if is_clearly_left(from, [x, 0.0], to, blur) && is_clearly_left(from, [loser.b0, 0.0], to, blur)
    {
        loser.b0 = x;
    } else if is_clearly_right(from, [x, 0.0], to, blur)
        && is_clearly_right(from, [loser.b1, 0.0], to, blur)
    {
        loser.b1 = x;
    }
    loser.b0 < loser.b1
}

/// Compares windows with disjoint intervals (cases 3 and 6). If their nearest rays have crossed
/// inside the triangle behind the edge, the window whose path to the crossing is longer is deleted.
fn check_disjoint(a: &Window, b: &Window, edge: &SharedEdge) -> PairOutcome {
    if a.b1 < b.b0 {
        return check_in_order(a, b, edge);
    }
    match check_in_order(b, a, edge) {
        PairOutcome::FirstDies => PairOutcome::SecondDies,
        PairOutcome::SecondDies => PairOutcome::FirstDies,
        PairOutcome::BothStay => PairOutcome::BothStay,
    }
}

/// As [`check_disjoint`], for `left` before `right`.
///
/// Beyond the crossing U the ray of the longer window is useless. So is every other ray of that
/// window: it ends on the far side of the shorter ray and started on the near side, so it has
/// crossed that ray before U. If the windows entered the triangle through two edges, it did so in
/// the triangle, because the shorter ray separates the one edge from what lies beyond. If they
/// entered through one edge, the shorter ray entered at a point that both windows reach. The rays
/// that do not cross it in the triangle are those beyond that point. The path from there to the
/// source crosses them, as in [`cut`].
fn check_in_order(left: &Window, right: &Window, edge: &SharedEdge) -> PairOutcome {
    let (v, u) = (left.source(), right.source());
    let Some(Meeting { s, t, blur }) = meet((v, left.b1), (u, right.b0), edge.slenderness) else {
        return PairOutcome::BothStay;
    };
    if !edge.is_behind([v[0] + s * (left.b1 - v[0]), v[1] - s * v[1]], blur) {
        return PairOutcome::BothStay;
    }
    let to_left = left.sigma + s * length(v, left.b1);
    let to_right = right.sigma + t * length(u, right.b0);
    if to_left < to_right * WINS - edge.blur {
        PairOutcome::SecondDies
    } else if to_right < to_left * WINS - edge.blur {
        PairOutcome::FirstDies
    } else {
        PairOutcome::BothStay
    }
}

/// Distance from `source` to abscissa `x` of the edge.
fn length(source: [f64; 2], x: f64) -> f64 {
    let (dx, dy) = (x - source[0], source[1]);
    (dx * dx + dy * dy).sqrt()
}

/// The crossing of two rays.
struct Meeting {
    /// Its position as a fraction of the first ray's length.
    s: f64,
    /// Its position as a fraction of the second ray's length.
    t: f64,
    /// Bound of the error of the position.
    blur: f64,
}

/// The crossing before the edge of two rays, each given by its source and its abscissa on the edge.
/// `None` if they do not cross by more than rounding.
fn meet((v, x): ([f64; 2], f64), (u, y): ([f64; 2], f64), slenderness: f64) -> Option<Meeting> {
    let r = [x - v[0], -v[1]];
    let q = [y - u[0], -u[1]];
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let square = |a: [f64; 2]| a[0] * a[0] + a[1] * a[1];
    let between = [u[0] - v[0], u[1] - v[1]];
    let denominator = cross(r, q);
    let (s, t) = (
        cross(between, q) / denominator,
        cross(between, r) / denominator,
    );
    if !(0.0 < s && s < 1.0 && 0.0 < t && t < 1.0) {
        return None;
    }
    let sine = denominator.abs() / (square(r) * square(q)).sqrt();
    let blur = INSIDE / sine * slenderness;
    (blur < BLURRED).then_some(Meeting { s, t, blur })
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGE: SharedEdge = SharedEdge::new(1.0, [0.5, -1.0], 2.0);

    fn window(b0: f64, b1: f64, px: f64, py: f64, sigma: f64) -> Window {
        Window {
            b0,
            b1,
            px,
            py,
            sigma,
        }
    }

    fn check(mut a: Window, mut b: Window) -> (PairOutcome, [f64; 2], [f64; 2]) {
        let verdict = check_pair(&mut a, &mut b, &EDGE);
        (verdict, [a.b0, a.b1], [b.b0, b.b1])
    }

    #[test]
    fn a_better_window_from_the_left_takes_the_left_part() {
        let dear = window(0.2, 0.9, 0.9, -1.0, 1.0);
        let cheap = window(0.0, 0.5, 0.1, -1.0, 0.0);
        let (verdict, dear_left, cheap_left) = check(dear, cheap);
        assert_eq!(verdict, PairOutcome::BothStay);
        assert_eq!(dear_left, [0.5, 0.9]);
        assert_eq!(cheap_left, [0.0, 0.5]);
    }

    #[test]
    fn a_better_window_over_the_whole_of_another_kills_it() {
        let dear = window(0.2, 0.4, 0.9, -1.0, 1.0);
        let cheap = window(0.0, 0.5, 0.1, -1.0, 0.0);
        assert_eq!(check(dear, cheap).0, PairOutcome::FirstDies);
        assert_eq!(check(cheap, dear).0, PairOutcome::SecondDies);
    }

    #[test]
    fn equal_windows_both_stay_whole() {
        let w = window(0.2, 0.4, 0.9, -1.0, 1.0);
        assert_eq!(check(w, w), (PairOutcome::BothStay, [0.2, 0.4], [0.2, 0.4]));
    }

    #[test]
    fn windows_of_one_source_seen_twice_keep_each_other() {
        let w = window(0.2, 0.6, 0.3, -1.0, 1.0);
        for noise in [-2e-16, 2e-16] {
            let twin = Window {
                px: w.px + noise,
                py: w.py - noise,
                ..w
            };
            let (verdict, kept, also_kept) = check(
                w,
                Window {
                    b0: 0.4,
                    b1: 0.8,
                    ..twin
                },
            );
            assert_eq!(verdict, PairOutcome::BothStay);
            assert_eq!((kept, also_kept), ([0.2, 0.6], [0.4, 0.8]));
        }
    }

    #[test]
    fn a_source_between_the_rays_of_the_loser_cuts_nothing() {
        // The winner's source is in the loser's cone. It can only be on the border of the cone, up
        // to rounding, so it is unknown on which side the rays are that it beats.
        let dear = window(0.0, 1.0, 0.5, -2.0, 5.0);
        let cheap = window(0.4, 0.6, 0.5, -0.5, 0.0);
        let (verdict, kept, _) = check(dear, cheap);
        assert_eq!((verdict, kept), (PairOutcome::BothStay, [0.0, 1.0]));
    }

    #[test]
    fn of_disjoint_windows_that_crossed_in_the_triangle_the_dearer_dies() {
        // Rays from (0.9, -1) to 0.3 and from (0.1, -1) to 0.7 cross at (0.5, -1/3).
        let left = window(0.1, 0.3, 0.9, -1.0, 0.0);
        let right = window(0.7, 0.9, 0.1, -1.0, 0.5);
        assert_eq!(check(left, right).0, PairOutcome::SecondDies);
        assert_eq!(check(right, left).0, PairOutcome::FirstDies);
        // With a flatter triangle behind the edge they crossed before it, possibly on other faces.
        let flat = SharedEdge::new(1.0, [0.5, -0.2], 2.0);
        let verdict = check_pair(&mut left.clone(), &mut right.clone(), &flat);
        assert_eq!(verdict, PairOutcome::BothStay);
    }

    /// Two windows bounded by one corner of the triangle seemed to cross beside it, and one of them
    /// was deleted: 14 vertices of the horse were too far by up to 3e-6 when all pairs were
    /// compared.
    #[test]
    fn rays_through_one_corner_of_the_triangle_do_not_cross() {
        let edge = SharedEdge::new(
            0.001_242_778_450_191_567_6,
            [0.000_946_561_819_209_68, -0.000_857_571_584_925_322_3],
            0.003,
        );
        let cheap = window(
            0.000_522_468_547_622_407_4,
            0.000_531_472_942_503_447_3,
            0.039_563_106_619_131_11,
            -0.080_639_163_881_954_15,
            0.0,
        );
        let dear = window(
            0.000_531_490_313_928_555_6,
            0.000_654_897_367_502_843_2,
            0.009_138_583_408_541_382,
            -0.017_782_956_364_946_558,
            0.069_832_371_716_493_88,
        );
        for [mut a, mut b] in [[cheap, dear], [dear, cheap]] {
            assert_eq!(check_pair(&mut a, &mut b, &edge), PairOutcome::BothStay);
        }
    }
}
