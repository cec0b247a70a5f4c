//! Rules 2 and 3: two windows of one edge compared with each other.
//!
//! Both rest on one lemma: where a ray of a window crosses a path that is shorter up to the
//! crossing, the ray is useless from there on. The rules differ in the paper in whether the two
//! windows came through one edge or through two; seen from the edge on which they lie the checks
//! are the same. Which pairs are compared is up to [`Pairs`](crate::Pairs).

use geobench_window::Window;

use crate::orient::{is_clearly_left, is_clearly_right};

/// How much shorter the winner of a comparison must be, relatively. Without it, rounding lets two
/// equal windows delete each other.
pub(crate) const MARGIN: f64 = 1.0 - 1e-12;

/// Least distance of a crossing from the border of the triangle, as a fraction of its height.
const INSIDE: f64 = 1e-10;

/// Square of the least sine between two rays whose crossing is taken for real.
const CROSSING: f64 = 1e-18;

/// What came of a comparison; either window may have been cut as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    BothStay,
    FirstDies,
    SecondDies,
}

/// The edge on which the compared windows lie.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Its length.
    pub(crate) l: f64,
    /// The third vertex of the triangle that the windows have just crossed, below the edge.
    pub(crate) behind: [f64; 2],
}

/// Compares two windows of one edge, cuts what each loses to the other, and says whether one of
/// them has lost everything (Qin et al. 2016, section 4.1, cases 1 to 6).
pub(crate) fn check_pair(a: &mut Window, b: &mut Window, edge: &Edge) -> Verdict {
    let (lo, hi) = (a.b0.max(b.b0), a.b1.min(b.b1));
    if lo > hi {
        return check_disjoint(a, b, edge);
    }
    for x in [lo, hi] {
        // An earlier cut may have taken x out of an interval.
        if x < a.b0.max(b.b0) || x > a.b1.min(b.b1) {
            continue;
        }
        let (da, db) = (a.distance(x), b.distance(x));
        if da < db * MARGIN {
            if !cut(b, a, x) {
                return Verdict::SecondDies;
            }
        } else if db < da * MARGIN && !cut(a, b, x) {
            return Verdict::FirstDies;
        }
        if lo == hi {
            break;
        }
    }
    Verdict::BothStay
}

/// `winner` is shorter at `x` in both intervals: cuts the rays of `loser` that the winner's path
/// to `x` crosses. Returns whether anything is left.
///
/// With the winner's source on the left these are the rays left of x, provided that the source
/// lies beyond the loser's last ray on that side, so that the path to x enters the cone there;
/// mirrored on the right. The side at x alone does not tell: x often lies on a ray through both
/// sources, where the sign is noise.
fn cut(loser: &mut Window, winner: &Window, x: f64) -> bool {
    let (from, to) = (loser.source(), winner.source());
    if is_clearly_left(from, [x, 0.0], to) && is_clearly_left(from, [loser.b0, 0.0], to) {
        loser.b0 = x;
    } else if is_clearly_right(from, [x, 0.0], to) && is_clearly_right(from, [loser.b1, 0.0], to) {
        loser.b1 = x;
    }
    loser.b0 < loser.b1
}

/// Compares windows whose intervals do not meet. If their nearest rays have crossed inside the
/// triangle behind the edge, the one that is longer up to there dies (cases 3 and 6).
fn check_disjoint(a: &Window, b: &Window, edge: &Edge) -> Verdict {
    if a.b1 < b.b0 {
        return check_in_order(a, b, edge);
    }
    match check_in_order(b, a, edge) {
        Verdict::FirstDies => Verdict::SecondDies,
        Verdict::SecondDies => Verdict::FirstDies,
        Verdict::BothStay => Verdict::BothStay,
    }
}

/// As [`check_disjoint`], for `left` before `right`.
fn check_in_order(left: &Window, right: &Window, edge: &Edge) -> Verdict {
    let (v, u) = (left.source(), right.source());
    let r = [left.b1 - v[0], -v[1]];
    let q = [right.b0 - u[0], -u[1]];
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let square = |a: [f64; 2]| a[0] * a[0] + a[1] * a[1];
    let between = [u[0] - v[0], u[1] - v[1]];
    let denominator = cross(r, q);
    let (s, t) = (
        cross(between, q) / denominator,
        cross(between, r) / denominator,
    );
    let on_both_rays = 0.0 < s && s < 1.0 && 0.0 < t && t < 1.0;
    if !on_both_rays || denominator * denominator <= CROSSING * square(r) * square(q) {
        return Verdict::BothStay;
    }
    let crossing = [v[0] + s * r[0], v[1] + s * r[1]];
    let depth = crossing[1] / edge.behind[1];
    let leftmost = depth * edge.behind[0];
    let rightmost = edge.l + depth * (edge.behind[0] - edge.l);
    let slack = INSIDE * edge.l;
    let inside = INSIDE < depth
        && depth < 1.0 - INSIDE
        && leftmost + slack < crossing[0]
        && crossing[0] < rightmost - slack;
    if !inside {
        return Verdict::BothStay;
    }
    let to_left = left.sigma + s * square(r).sqrt();
    let to_right = right.sigma + t * square(q).sqrt();
    if to_left < to_right * MARGIN {
        Verdict::SecondDies
    } else if to_right < to_left * MARGIN {
        Verdict::FirstDies
    } else {
        Verdict::BothStay
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGE: Edge = Edge {
        l: 1.0,
        behind: [0.5, -1.0],
    };

    fn window(b0: f64, b1: f64, px: f64, py: f64, sigma: f64) -> Window {
        Window {
            b0,
            b1,
            px,
            py,
            sigma,
        }
    }

    fn check(mut a: Window, mut b: Window) -> (Verdict, [f64; 2], [f64; 2]) {
        let verdict = check_pair(&mut a, &mut b, &EDGE);
        (verdict, [a.b0, a.b1], [b.b0, b.b1])
    }

    #[test]
    fn a_better_window_from_the_left_takes_the_left_part() {
        let dear = window(0.2, 0.9, 0.9, -1.0, 1.0);
        let cheap = window(0.0, 0.5, 0.1, -1.0, 0.0);
        let (verdict, dear_left, cheap_left) = check(dear, cheap);
        assert_eq!(verdict, Verdict::BothStay);
        assert_eq!(dear_left, [0.5, 0.9]);
        assert_eq!(cheap_left, [0.0, 0.5]);
    }

    #[test]
    fn a_better_window_over_the_whole_of_another_kills_it() {
        let dear = window(0.2, 0.4, 0.9, -1.0, 1.0);
        let cheap = window(0.0, 0.5, 0.1, -1.0, 0.0);
        assert_eq!(check(dear, cheap).0, Verdict::FirstDies);
        assert_eq!(check(cheap, dear).0, Verdict::SecondDies);
    }

    #[test]
    fn equal_windows_both_stay_whole() {
        let w = window(0.2, 0.4, 0.9, -1.0, 1.0);
        assert_eq!(check(w, w), (Verdict::BothStay, [0.2, 0.4], [0.2, 0.4]));
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
            assert_eq!(verdict, Verdict::BothStay);
            assert_eq!((kept, also_kept), ([0.2, 0.6], [0.4, 0.8]));
        }
    }

    #[test]
    fn a_source_between_the_rays_of_the_loser_cuts_nothing() {
        // The winner stands inside the loser's cone: it can only be on its border in truth, and
        // on which side the rays that it beats lie is open.
        let dear = window(0.0, 1.0, 0.5, -2.0, 5.0);
        let cheap = window(0.4, 0.6, 0.5, -0.5, 0.0);
        let (verdict, kept, _) = check(dear, cheap);
        assert_eq!((verdict, kept), (Verdict::BothStay, [0.0, 1.0]));
    }

    #[test]
    fn of_disjoint_windows_that_crossed_in_the_triangle_the_dearer_dies() {
        // Rays from (0.9, -1) to 0.3 and from (0.1, -1) to 0.7 cross at (0.5, -1/3).
        let left = window(0.1, 0.3, 0.9, -1.0, 0.0);
        let right = window(0.7, 0.9, 0.1, -1.0, 0.5);
        assert_eq!(check(left, right).0, Verdict::SecondDies);
        assert_eq!(check(right, left).0, Verdict::FirstDies);
        // With a flatter triangle behind the edge they crossed before it, perhaps on other faces.
        let flat = Edge {
            l: 1.0,
            behind: [0.5, -0.2],
        };
        let verdict = check_pair(&mut left.clone(), &mut right.clone(), &flat);
        assert_eq!(verdict, Verdict::BothStay);
    }
}
