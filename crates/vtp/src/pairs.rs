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

/// What the two compared windows are to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kinship {
    /// Neighbours in a list, as in rules 2 and 3.
    Neighbours,
    /// Any two of a list.
    Strangers,
}

/// The edge on which the compared windows lie.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Its length.
    pub(crate) l: f64,
    /// The third vertex of the triangle that the windows have just crossed, below the edge.
    pub(crate) behind: [f64; 2],
}

impl Edge {
    /// Whether `point` lies inside the triangle behind the edge.
    fn is_behind(&self, point: [f64; 2]) -> bool {
        let depth = point[1] / self.behind[1];
        let leftmost = depth * self.behind[0];
        let rightmost = self.l + depth * (self.behind[0] - self.l);
        let slack = INSIDE * self.l;
        INSIDE < depth
            && depth < 1.0 - INSIDE
            && leftmost + slack < point[0]
            && point[0] < rightmost - slack
    }

    /// Where the ray from `source` to abscissa `x` enters the triangle behind the edge: the source
    /// itself if that is inside.
    fn entry(&self, source: [f64; 2], x: f64) -> [f64; 2] {
        let [dx, dy] = [source[0] - x, source[1]];
        let depth = dy / self.behind[1];
        // Going back by the fraction k of the ray, it leaves where k * outwards reaches the way.
        let leaves = |way: f64, outwards: f64| if outwards > 0.0 { way / outwards } else { 1.0 };
        let k = leaves(x, depth * self.behind[0] - dx)
            .min(leaves(self.l - x, dx - depth * (self.behind[0] - self.l)))
            .min(1.0)
            * (1.0 - INSIDE);
        [x + k * dx, k * dy]
    }
}

/// Compares two windows of one edge, cuts what each loses to the other, and says whether one of
/// them has lost everything (Qin et al. 2016, section 4.1, cases 1 to 6).
pub(crate) fn check_pair(a: &mut Window, b: &mut Window, edge: &Edge, kinship: Kinship) -> Verdict {
    let (lo, hi) = (a.b0.max(b.b0), a.b1.min(b.b1));
    if lo > hi {
        return check_disjoint(a, b, edge, kinship);
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

/// Compares windows whose intervals do not meet (cases 3 and 6). If their nearest rays have crossed
/// inside the triangle behind the edge, the one that is longer up to there dies; of strangers it loses
/// only what the ray of the other one crosses inside that triangle.
fn check_disjoint(a: &mut Window, b: &mut Window, edge: &Edge, kinship: Kinship) -> Verdict {
    if a.b1 < b.b0 {
        return check_in_order(a, b, edge, kinship);
    }
    match check_in_order(b, a, edge, kinship) {
        Verdict::FirstDies => Verdict::SecondDies,
        Verdict::SecondDies => Verdict::FirstDies,
        Verdict::BothStay => Verdict::BothStay,
    }
}

/// As [`check_disjoint`], for `left` before `right`.
///
/// Beyond the crossing the ray of the dearer window is useless, and so is every other ray of it
/// that meets the same ray of the cheaper one: its way to there and on to the first crossing is
/// longer. In the paper the whole window dies. For strangers that is too much: on the horse it made
/// 14 vertices of 48,485 wrong, by up to 3e-6. Which rays meet is certain inside the triangle, up to
/// the point where the cheaper ray entered it, and they lose no more than that.
fn check_in_order(left: &mut Window, right: &mut Window, edge: &Edge, kinship: Kinship) -> Verdict {
    let (v, u) = (left.source(), right.source());
    let Some([s, t]) = meet((v, left.b1), (u, right.b0)) else {
        return Verdict::BothStay;
    };
    if !edge.is_behind([v[0] + s * (left.b1 - v[0]), v[1] - s * v[1]]) {
        return Verdict::BothStay;
    }
    let to_left = left.sigma + s * length(v, left.b1);
    let to_right = right.sigma + t * length(u, right.b0);
    if to_left < to_right * MARGIN {
        if kinship == Kinship::Neighbours {
            return Verdict::SecondDies;
        }
        let last = shadow(u, edge.entry(v, left.b1)).unwrap_or(f64::INFINITY);
        right.b0 = right.b0.max(last);
        if right.b0 >= right.b1 {
            return Verdict::SecondDies;
        }
    } else if to_right < to_left * MARGIN {
        if kinship == Kinship::Neighbours {
            return Verdict::FirstDies;
        }
        let last = shadow(v, edge.entry(u, right.b0)).unwrap_or(f64::NEG_INFINITY);
        left.b1 = left.b1.min(last);
        if left.b0 >= left.b1 {
            return Verdict::FirstDies;
        }
    }
    Verdict::BothStay
}

/// Where the ray from `source` through `point` meets the edge, if it does.
fn shadow(source: [f64; 2], point: [f64; 2]) -> Option<f64> {
    let rise = point[1] - source[1];
    (rise > 0.0).then(|| source[0] - source[1] * (point[0] - source[0]) / rise)
}

/// Distance from `source` to abscissa `x` of the edge.
fn length(source: [f64; 2], x: f64) -> f64 {
    let (dx, dy) = (x - source[0], source[1]);
    (dx * dx + dy * dy).sqrt()
}

/// Where two rays, each given by its source and its abscissa on the edge, cross before the edge:
/// the fractions of their lengths. `None` if they do not, or not beyond doubt.
fn meet((v, x): ([f64; 2], f64), (u, y): ([f64; 2], f64)) -> Option<[f64; 2]> {
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
    let on_both_rays = 0.0 < s && s < 1.0 && 0.0 < t && t < 1.0;
    let beyond_doubt = denominator * denominator > CROSSING * square(r) * square(q);
    (on_both_rays && beyond_doubt).then_some([s, t])
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
        let verdict = check_pair(&mut a, &mut b, &EDGE, Kinship::Neighbours);
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
        let verdict = check_pair(
            &mut left.clone(),
            &mut right.clone(),
            &flat,
            Kinship::Neighbours,
        );
        assert_eq!(verdict, Verdict::BothStay);
    }

    /// When all of a window died that a stranger had crossed with one ray, vertices of the horse came
    /// out too far.
    #[test]
    fn a_stranger_loses_only_the_rays_crossed_inside_the_triangle() {
        // The ray from (0.9, -1) to 0.3 crosses the one from (-1, -2) to 0.7 inside the triangle,
        // which it enters where the ray from (-1, -2) to 0.883 passes.
        let edge = Edge {
            l: 1.0,
            behind: [0.5, -0.4],
        };
        let mut cheap = window(0.1, 0.3, 0.9, -1.0, 0.0);
        let dear = window(0.7, 0.95, -1.0, -2.0, 5.0);
        let mut cut = dear;
        let verdict = check_pair(&mut cheap, &mut cut, &edge, Kinship::Strangers);
        assert_eq!((verdict, cut.b1), (Verdict::BothStay, 0.95));
        assert!((cut.b0 - 0.883).abs() < 1e-3, "{cut:?}");
        let mut whole = dear;
        let verdict = check_pair(&mut cheap, &mut whole, &edge, Kinship::Neighbours);
        assert_eq!(verdict, Verdict::SecondDies);
        let mut narrow = Window { b1: 0.85, ..dear };
        let verdict = check_pair(&mut narrow, &mut cheap, &edge, Kinship::Strangers);
        assert_eq!(verdict, Verdict::FirstDies);
        assert_eq!(cheap, window(0.1, 0.3, 0.9, -1.0, 0.0));
    }
}
