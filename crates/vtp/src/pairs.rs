//! Rules 2 and 3: neighbouring windows of one list compared with each other.
//!
//! Both rest on one lemma: where a ray of a window crosses a path that is shorter up to the
//! crossing, the ray is useless from there on. The rules differ in the paper in whether the two
//! windows came through one edge or through two; seen from the edge on which they lie the checks
//! are the same, so one pass over the whole list does both.

use geobench_window::Window;

use crate::orient::{is_clearly_left, is_clearly_right};

/// How much shorter the winner of a comparison must be, relatively. Without it, rounding lets two
/// equal windows delete each other.
const MARGIN: f64 = 1.0 - 1e-12;

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
pub(crate) struct Edge {
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
        return if a.b1 < b.b0 {
            check_disjoint(a, b, edge)
        } else {
            match check_disjoint(b, a, edge) {
                Verdict::FirstDies => Verdict::SecondDies,
                Verdict::SecondDies => Verdict::FirstDies,
                Verdict::BothStay => Verdict::BothStay,
            }
        };
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

/// Compares windows whose intervals do not meet, `left` before `right`. If their nearest rays have
/// crossed inside the triangle behind the edge, the one that is longer up to there dies.
fn check_disjoint(left: &Window, right: &Window, edge: &Edge) -> Verdict {
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

/// Appends `new` to the checked windows of a list, comparing it with the last one until both of
/// them stay or it dies. Returns how many windows died.
pub(crate) fn push_checked(checked: &mut Vec<Window>, mut new: Window, edge: &Edge) -> u64 {
    let mut died = 0;
    while let Some(last) = checked.last_mut() {
        match check_pair(last, &mut new, edge) {
            Verdict::BothStay => break,
            Verdict::FirstDies => {
                checked.pop();
                died += 1;
            }
            Verdict::SecondDies => return died + 1,
        }
    }
    checked.push(new);
    died
}
