//! Upper bounds of the difference of two distance functions on a line.

use crate::ball::{Ball, BallVector, norm};
use crate::field::SidePiece;
use crate::interval::{Interval, greater, lesser};

/// A distance function on a line, the abscissa axis: `sigma` plus the distance to `image`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Distance {
    /// A point of the plane. The sign of its ordinate does not matter.
    pub(crate) image: BallVector<2>,
    pub(crate) sigma: Ball,
}

impl Distance {
    /// The value at abscissa `t`.
    pub(crate) fn at(&self, t: Ball) -> Ball {
        self.sigma + norm([t - self.image[0], self.image[1]])
    }

    /// The same function in rounded arithmetic, up to rounding.
    pub(crate) fn rounded(&self) -> RoundedDistance {
        RoundedDistance {
            image: self.image.map(Ball::middle),
            sigma: self.sigma.middle(),
        }
    }

    /// The abscissa of `t` relative to the image, and the distance from the image to `t`.
    fn relative(&self, t: f64) -> [Ball; 2] {
        let x = Ball::exact(t) - self.image[0];
        [x, norm([x, self.image[1]])]
    }
}

/// The slope of a distance function, given the result of [`Distance::relative`].
fn slope([x, length]: [Ball; 2]) -> Ball {
    x / length
}

/// The difference of two slopes, which are between -1 and 1.
fn turn(f: Ball, g: Ball) -> Interval {
    let turn = (f - g).interval();
    Interval {
        lo: turn.lo.max(-2.0),
        hi: turn.hi.min(2.0),
    }
}

/// As [`Distance`], in rounded arithmetic.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoundedDistance {
    pub(crate) image: [f64; 2],
    pub(crate) sigma: f64,
}

impl RoundedDistance {
    pub(crate) fn at(&self, t: f64) -> f64 {
        self.sigma + self.relative(t)[1]
    }

    /// As [`Distance::relative`].
    fn relative(&self, t: f64) -> [f64; 2] {
        let [x, y] = [t - self.image[0], self.image[1]];
        [x, (x * x + y * y).sqrt()]
    }

    /// The slope at abscissa `t`; 0 at the image.
    pub(crate) fn slope(&self, t: f64) -> f64 {
        let [x, length] = self.relative(t);
        if length > 0.0 { x / length } else { 0.0 }
    }

    /// The value and the slope at abscissa `t`. The function is convex, so it lies nowhere below
    /// this tangent, except by rounding.
    pub(crate) fn tangent(&self, t: f64) -> [f64; 2] {
        let [x, length] = self.relative(t);
        [
            self.sigma + length,
            if length > LEAST_LENGTH {
                x / length
            } else {
                0.0
            },
        ]
    }

    /// An upper bound, up to rounding, of the difference of a convex function to this one over
    /// `from <= t <= to`; the convex function has the values `at_ends`.
    ///
    /// The one function is nowhere above its chord, the other nowhere below a tangent. So no sign
    /// of a slope has to be known.
    pub(crate) fn below_chord(&self, [from, to]: [f64; 2], [first, last]: [f64; 2]) -> f64 {
        let width = to - from;
        let [value, slope] = self.tangent(from);
        let by_first = greater(first - value, last - (value + slope * width));
        let [value, slope] = self.tangent(to);
        let by_last = greater(last - value, first - (value - slope * width));
        lesser(by_first, by_last)
    }

    /// An upper bound, up to rounding, of how much `other` is above this distance; any greater
    /// number if the bound exceeds `limit`.
    pub(crate) fn below(&self, other: &SidePiece, limit: f64) -> f64 {
        let (from, to) = (other.from, other.to);
        let [first, last] = other.at_ends();
        let above_first = first - self.at(from);
        if above_first > limit {
            return f64::INFINITY;
        }
        let above_last = last - self.at(to);
        if above_last > limit {
            return f64::INFINITY;
        }
        let bound = self.below_chord([from, to], [first, last]);
        if bound > limit {
            other.distance.peak(self)
        } else {
            bound
        }
    }

    /// An upper bound of the difference to `other` on the whole line, by the triangle inequality:
    /// the difference of the sigmas plus the distance between the images, reflected to one side of
    /// the line.
    pub(crate) fn peak(&self, other: &Self) -> f64 {
        let x = self.image[0] - other.image[0];
        let y = self.image[1].abs() - other.image[1].abs();
        self.sigma - other.sigma + (x * x + y * y).sqrt()
    }

    /// Where the line through both images, reflected to one side of the axis, meets the axis: the
    /// only critical point that the difference can have. NaN or infinite without such a point.
    pub(crate) fn critical(&self, other: &Self) -> f64 {
        let [a, b] = [self, other].map(|d| [d.image[0], d.image[1].abs()]);
        (a[0] * b[1] - b[0] * a[1]) / (b[1] - a[1])
    }

    /// An upper bound of the difference to `other` over `from <= t <= to`, up to rounding and twice
    /// the length `tiny`.
    pub(crate) fn excess(&self, other: &Self, from: f64, to: f64, tiny: f64) -> f64 {
        let at_both = [from, to].map(|t| [self.relative(t), other.relative(t)]);
        let sigma = self.sigma - other.sigma;
        let [first, last] = at_both.map(|[ours, theirs]| sigma + (ours[1] - theirs[1]));
        let at_ends = greater(first, last);
        // An image within `tiny` of an end has no reliable slope there. Inside the interval the
        // slope is 1 or -1, except on a part no longer than `tiny`.
        let slope =
            |[x, length]: [f64; 2], otherwise| if length > tiny { x / length } else { otherwise };
        let rises = slope(at_both[0][0], 1.0) - slope(at_both[0][1], 1.0);
        let falls = slope(at_both[1][0], -1.0) - slope(at_both[1][1], -1.0);
        // See [`greatest_difference`].
        if rises <= 0.0 || falls >= 0.0 {
            return at_ends;
        }
        // Both functions are 1-Lipschitz, so their difference is 2-Lipschitz.
        let roughly = first / 2.0 + last / 2.0 + (to - from);
        greater(lesser(self.peak(other), roughly), at_ends)
    }
}

/// Squares of shorter lengths underflow. Distances to an image change by no more on this length.
const LEAST_LENGTH: f64 = 1e-150;

/// An upper bound of a distance function on an interval of the line: the linear function with the
/// values `at_ends` at its ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chord {
    pub(crate) middle: f64,
    half: f64,
    pub(crate) at_ends: [f64; 2],
}

impl Chord {
    pub(crate) fn new([from, to]: [f64; 2], at_ends: [f64; 2]) -> Self {
        Self {
            middle: from / 2.0 + to / 2.0,
            half: (to - from) / 2.0,
            at_ends,
        }
    }

    /// Whether the distance from the middle of the interval to the image exceeds the interval's
    /// length.
    pub(crate) fn is_shorter_than_distance(&self, distance: &RoundedDistance) -> bool {
        let [x, y] = [self.middle - distance.image[0], distance.image[1]];
        x * x + y * y > 4.0 * self.half * self.half
    }

    /// Whether the chord is everywhere less than `distance` by more than `clear`.
    ///
    /// A distance function is convex, so it lies nowhere below its tangent in the middle of the
    /// interval. The chord is below the tangent if it is at both ends. Let w be the distance from
    /// the image to the middle, x its component along the line, h half the length of the interval,
    /// and a and b the values of the chord at the ends. The conditions are `a + x/w h < sigma + w`
    /// and `b - x/w h < sigma + w`, here multiplied by w. They are never met if w is 0.
    pub(crate) fn is_below(&self, distance: &RoundedDistance, clear: f64) -> bool {
        let [x, y] = [self.middle - distance.image[0], distance.image[1]];
        let square = x * x + y * y;
        let length = square.sqrt();
        let rise = x * self.half;
        let [a, b] = self.at_ends;
        let more = clear - distance.sigma;
        (a + more) * length + rise < square && (b + more) * length - rise < square
    }
}

/// An upper bound of `f(t) - g(t)` over `from <= t <= to`.
///
/// The difference has at most one critical point, where the line through both images, reflected to
/// one side, meets the axis. There it is [`peak`]. This is a maximum if the slope of the difference
/// changes from positive to negative.
pub(crate) fn greatest_difference(f: &Distance, g: &Distance, from: f64, to: f64) -> f64 {
    bound(f, g, from, to, &mut { BISECTIONS })
}

/// Greatest number of bisections of intervals on which the signs of the slopes are uncertain.
const BISECTIONS: u32 = 100;

/// A bound within this fraction of the distances of the value at an end is not improved.
pub(crate) const CLOSE: f64 = 2.5e-16;

fn bound(f: &Distance, g: &Distance, from: f64, to: f64, bisections: &mut u32) -> f64 {
    let relatives = |t| [f.relative(t), g.relative(t)];
    let values = |[of_f, of_g]: [[Ball; 2]; 2]| [f.sigma + of_f[1], g.sigma + of_g[1]];
    // Rounding is harmless here: `close` only decides when a bound is good enough.
    let close = CLOSE * (f.rounded().at(from) + g.rounded().at(from));
    // Both functions are 1-Lipschitz, so their difference is 2-Lipschitz.
    let change = (2.0 * (to - from).max(0.0)).next_up();
    let is_point = change <= close / 8.0;
    let peak = peak(f, g);
    if !is_point && peak.abs() <= close {
        return peak;
    }
    let first = relatives(from);
    let [f0, g0] = values(first);
    if is_point {
        return ((f0 - g0).upper() + change).next_up();
    }
    let last = relatives(to);
    let [f1, g1] = values(last);
    let differences = [(f0 - g0).upper(), (f1 - g1).upper()];
    let at_ends = lesser(greater(differences[0], differences[1]), peak);
    if peak - at_ends <= close {
        return peak;
    }
    let [[f0, g0], [f1, g1]] = [first, last].map(|of_both| of_both.map(slope));
    let (rises, falls) = (turn(f0, g0), turn(f1, g1));
    // There is at most one critical point. The difference is monotone, or it has a minimum inside.
    if falls.lo >= 0.0 || rises.hi <= 0.0 {
        return at_ends;
    }
    if rises.lo > 0.0 && falls.hi < 0.0 {
        return peak;
    }
    // Slopes of distance functions increase along the line. So the difference rises from `from`,
    // and falls to `to`, with at most these slopes.
    let width = Interval::exact(to) - Interval::exact(from);
    let up = Interval::exact(turn(f1, g0).hi.max(0.0));
    let down = Interval::exact(turn(g1, f0).hi.max(0.0));
    let from_first = Interval::exact(differences[0]) + width * up;
    let from_last = Interval::exact(differences[1]) + width * down;
    let loose = from_first.hi.min(from_last.hi).min(peak).max(at_ends);
    let middle = f64::midpoint(from, to);
    if loose - at_ends <= close || *bisections == 0 || middle <= from || middle >= to {
        return loose;
    }
    *bisections -= 1;
    let halves = [(from, middle), (middle, to)];
    halves
        .map(|(from, to)| bound(f, g, from, to, bisections))
        .into_iter()
        .fold(f64::NEG_INFINITY, f64::max)
}

/// As [`RoundedDistance::peak`].
pub(crate) fn peak(f: &Distance, g: &Distance) -> f64 {
    let x = f.image[0] - g.image[0];
    let y = f.image[1].abs() - g.image[1].abs();
    (f.sigma - g.sigma + norm([x, y])).upper()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn distance(x: f64, y: f64, sigma: f64) -> Distance {
        Distance {
            image: [x, y].map(Ball::exact),
            sigma: Ball::exact(sigma),
        }
    }

    prop_compose! {
        fn distances()(
            x in -2.0..3.0f64, y in prop_oneof![Just(0.0), -2.0..2.0f64], sigma in 0.0..1.0f64,
        ) -> Distance {
            distance(x, y, sigma)
        }
    }

    proptest! {
        #[test]
        fn the_bound_is_above_all_samples_and_close_to_the_greatest(
            f in distances(), g in distances(), ends in (0.0..1.0f64, 0.0..1.0f64),
        ) {
            let (from, to) = (ends.0.min(ends.1), ends.0.max(ends.1));
            let found = greatest_difference(&f, &g, from, to);
            // The last sum may be rounded beyond the end.
            let samples = (0..=1000).map(|i| (from + (to - from) * f64::from(i) / 1000.0).min(to));
            let most = samples
                .map(|t| (f.at(Ball::exact(t)) - g.at(Ball::exact(t))).lower())
                .fold(f64::NEG_INFINITY, f64::max);
            prop_assert!(found >= most);
            prop_assert!(found <= most + 2e-3 * (to - from) + 1e-12);
            let rounded = f.rounded().excess(&g.rounded(), from, to, 1e-13);
            prop_assert!(rounded >= most - 1e-12);
        }
    }

    #[test]
    fn equal_distances_differ_by_rounding_only() {
        let f = distance(0.3, -1.0, 0.25);
        assert!(greatest_difference(&f, &f, 0.0, 1.0) < 1e-14);
        assert!(greatest_difference(&f, &distance(0.3, 1.0, 0.25), 0.0, 1.0) < 1e-14);
    }

    #[test]
    fn a_single_point_has_no_peak() {
        // The images are far apart, and both functions have the same value at 0.25.
        let (f, g) = (distance(0.25, 3.0, 0.0), distance(0.25, 1.0, 2.0));
        assert!(greatest_difference(&f, &g, 0.25, 0.25) < 1e-14);
        let g = distance(3.25, 4.0, -2.0);
        assert!(greatest_difference(&f, &g, 0.25, 0.25) < 1e-14);
    }

    #[test]
    fn a_peak_between_the_ends_is_found() {
        // One source above the other: the difference is greatest at their common foot.
        let (far, near) = (distance(0.5, 2.0, 0.0), distance(0.5, 1.0, 1.0));
        let found = greatest_difference(&far, &near, 0.0, 1.0);
        assert!(found.abs() < 1e-14, "{found}");
        assert!(greatest_difference(&near, &far, 0.0, 1.0) > 0.0);
    }
}
