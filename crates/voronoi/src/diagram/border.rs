//! Follows the border between two cells through a triangle, one bisector after the other.

use std::cell::RefCell;

use super::arrange::{FACE_SLACK, FaceTriangle};
use super::curve::{Bisector, newton_across};
use super::sites::{FaceSites, NearestSite};
use super::table::{MeasuredSites, SiteTable};
use geobench_mesh::vector::{Point, between, cross_2d, dot, norm, sub};

/// Greatest number of steps along a border to find where its bisectors change. Each change takes at
/// most about 90.
const MOST_STEPS: u32 = 600;

/// A part of a border that is about to become a [`Piece`](super::arrange::Piece).
#[derive(Clone, Copy, Debug)]
pub(super) struct BorderPart {
    pub(super) to: Point,
    pub(super) sites: Option<[usize; 2]>,
}

/// Traces the border between two cells in a triangle that holds nothing else.
pub(super) struct BorderTracer<'a> {
    pub(super) sites: &'a FaceSites,
    pub(super) measured: &'a MeasuredSites<'a>,
    pub(super) triangle: &'a FaceTriangle,
    pub(super) slack: f64,
    pub(super) sources: [u32; 2],
    /// The sites near the part of the border that was looked at last.
    pub(super) near: RefCell<SiteTable>,
}

impl BorderTracer<'_> {
    /// The nearest sites of both cells, if `x` is on the border: both are equally near and no other
    /// site is nearer. `None` if it is not.
    fn pair(&self, x: Point) -> Option<[usize; 2]> {
        let nearest = self.measured.nearest(self.sources, x);
        let most = nearest.least + self.sites.rounding(nearest.least);
        let is_border = nearest.each.iter().all(|site| site.length <= most);
        (is_border && self.triangle.contains(x, self.slack))
            .then(|| nearest.each.map(|site| site.site))
    }

    /// Whether the straight paths of both sites are the shortest to `x`. `least` is the length of
    /// the shortest path of all sites. Both straight paths must pass their gates: if one misses its
    /// gate, its path through the gate is longer.
    fn holds(&self, pair: [usize; 2], x: Point, least: f64) -> bool {
        let slack = self.sites.rounding(least);
        pair.into_iter().all(|site| {
            let site = &self.sites.sites[site];
            (site.straight(x) - least).abs() <= slack && site.path(x).length <= least + slack
        })
    }

    /// The point of the border on the perpendicular at fraction `t` of the chord between two of its
    /// points.
    fn beside(&self, [from, to]: [Point; 2], t: f64) -> Option<Point> {
        let start = between(from, to, t);
        newton_across(start, sub(to, from), |x| {
            let [a, b] = self.measured.nearest(self.sources, x).each;
            let value = a.length - b.length;
            value
                .is_finite()
                .then(|| (value, sub(a.direction(x), b.direction(x))))
        })
    }

    /// Whether the straight line between `ends` is the border, up to rounding.
    ///
    /// If two images coincide, the border is no bisector. Both gates then end at the same vertex,
    /// and the border is the ray that separates the points that one site sees from those that the
    /// other one sees.
    pub(super) fn is_straight(&self, [from, to]: [Point; 2]) -> bool {
        // A curve may cross its chord at a few points, in symmetric faces at simple fractions. So
        // the fractions are irregular.
        [0.5, 0.125, 0.875, 0.04, 0.27, 0.37, 0.66, 0.81, 0.97]
            .into_iter()
            .all(|t| self.pair(between(from, to, t)).is_some())
    }

    /// Appends the parts of the border between `ends`, one bisector after the other. If the next
    /// part is in doubt, the rest is cut in two. `None` if the border cannot be traced within
    /// [`MOST_STEPS`].
    pub(super) fn trace(
        &self,
        [mut at, to]: [Point; 2],
        steps: &mut u32,
        parts: &mut Vec<BorderPart>,
    ) -> Option<()> {
        let mut follows = false;
        loop {
            *steps += 1;
            if *steps > MOST_STEPS {
                return None;
            }
            let expected = follows.then(|| self.expected([at, to])).flatten();
            let part = expected.and_then(|pair| self.next_part([at, to], Some(pair)));
            let Some((end, pair)) = part.or_else(|| self.next_part([at, to], None)) else {
                break;
            };
            follows = true;
            append(parts, end, Some(pair));
            if end == to {
                return Some(());
            }
            at = end;
        }
        if norm(sub(to, at)) <= FACE_SLACK * self.sites.size {
            append(parts, to, None);
            return Some(());
        }
        let middle = self.beside([at, to], 0.5)?;
        self.pair(middle)?;
        self.trace([at, middle], steps, parts)?;
        self.trace([middle, to], steps, parts)
    }

    /// The sites of the part that begins at the first of `ends`, if they are near the part before
    /// it, as nearly always. A part that they fit all the way needs no search among all sites.
    fn expected(&self, [from, to]: [Point; 2]) -> Option<[usize; 2]> {
        let x = between(from, to, AHEAD);
        let near = self.near.borrow();
        self.measured.nearest_in(&near, self.sources, x).pair()
    }

    /// The end of the first part between `ends` and its sites; `None` if that is in doubt.
    /// `expected` are the sites that it probably has.
    fn next_part(
        &self,
        [from, to]: [Point; 2],
        expected: Option<[usize; 2]>,
    ) -> Option<(Point, [usize; 2])> {
        let chord = sub(to, from);
        let place = |x: Point| dot(sub(x, from), chord) / dot(chord, chord);
        let touch = TOUCHING * self.sites.size;
        let are_apart = |a: Point, b: Point| norm(sub(a, b)) > touch;
        let mut ahead = AHEAD;
        let (pair, mut end, mut most) = loop {
            let pair = match expected {
                Some(pair) if ahead == AHEAD => pair,
                _ => {
                    let x = between(from, to, ahead);
                    let nearest = self.measured.nearest(self.sources, x);
                    nearest.pair()?
                }
            };
            // The part ends where one of the sites is no longer visible through its gate.
            let [a, b] = pair.map(|site| &self.sites.sites[site]);
            let (mut end, mut most, mut entry) = (to, 1.0, 0.0);
            for x in [a.exits(b), b.exits(a)].into_iter().flatten().flatten() {
                let t = place(x);
                if t <= 0.0 || t >= most || !are_apart(x, from) || !are_apart(x, to) {
                    continue;
                }
                if t > ahead {
                    (end, most) = (x, t);
                } else {
                    entry = f64::max(entry, t);
                }
            }
            if entry == 0.0 {
                break (pair, end, most);
            }
            // The pair is not visible before `entry`, so other sites come first.
            ahead = 0.5 * entry;
        };
        // The part also ends where another site becomes nearer.
        for attempt in 0..MOST_RIVALS {
            // Most nearer sites are near the part before, or the longer one tried last.
            let known = (attempt > 0 || expected.is_some())
                .then(|| {
                    self.measured
                        .nearest_in(&self.near.borrow(), self.sources, end)
                })
                .filter(|nearest| {
                    nearest.pair().is_some() && !self.holds(pair, end, nearest.least)
                });
            let nearest = match known {
                Some(nearest) => nearest,
                None if self.is_whole(pair, [from, end]) => return Some((end, pair)),
                None => self.measured.nearest(self.sources, end),
            };
            if self.holds(pair, end, nearest.least) {
                // Another site is nearer before the end, or at the beginning.
                return None;
            }
            let [first, second] = nearest.each;
            let lead = |k: usize, site: &NearestSite| {
                self.sites.sites[pair[k]].straight(end) - site.length
            };
            let rival = if lead(0, &first) > lead(1, &second) {
                first.site
            } else {
                second.site
            };
            let three = [pair[0], pair[1], rival];
            let middle = between(from, end, 0.5);
            end = meeting_point(middle, self.triangle.size(), |x| {
                three.map(|site| self.sites.sites[site].straight_path(x))
            })?;
            let t = place(end);
            if !(0.0 < t && t < most && are_apart(end, from)) {
                return None;
            }
            most = t;
        }
        None
    }

    /// Whether the bisector of one pair of sites is the border all the way between `ends`.
    fn is_whole(&self, pair: [usize; 2], ends: [Point; 2]) -> bool {
        let curve = Bisector::of(pair.map(|site| &self.sites.sites[site]));
        let Some(middle) = curve.beside(ends[0], ends[1], 0.5) else {
            return false;
        };
        // The curve must not turn back on itself, so that it can be followed along its chord.
        let [first, second] = [sub(middle, ends[0]), sub(ends[1], middle)];
        let turns_back = dot(first, second) < 0.5 * norm(first) * norm(second);
        let is_inside = |x: Point| self.triangle.contains(x, self.slack);
        if turns_back || !is_inside(middle) || !is_inside(ends[1]) {
            return false;
        }
        // A curve that bends to one side only is nowhere farther from its chord than twice the
        // distance in the middle.
        let beside = 2.0 * norm(sub(middle, between(ends[0], ends[1], 0.5)));
        let mut near = self.near.borrow_mut();
        let rounding = |length| self.sites.rounding(length);
        self.measured
            .near_chord(pair[0], ends, beside, rounding, &mut near);
        let holds = |x: Point| self.holds(pair, x, self.measured.least(&near, x));
        [ends[1], ends[0], middle].into_iter().all(holds)
            && [0.2, 0.8].into_iter().all(|t| {
                let x = curve.beside(ends[0], ends[1], t);
                x.is_some_and(holds)
            })
    }
}

/// The point at which the sites of a part are determined: this fraction of the chord of the border
/// after its beginning.
const AHEAD: f64 = 1e-3;

/// Distance up to which two points are the same up to rounding, as a fraction of the face.
const TOUCHING: f64 = 1e-12;

/// Greatest number of nearer sites found at the end of a part before the search fails.
const MOST_RIVALS: u32 = 8;

/// Appends a part that ends at `to`. Consecutive parts of one bisector are merged. A part without a
/// bisector, which is too short to have one, is merged with its neighbour.
fn append(parts: &mut Vec<BorderPart>, to: Point, sites: Option<[usize; 2]>) {
    match parts.last_mut() {
        Some(last) if last.sites == sites || last.sites.is_none() => {
            *last = BorderPart { to, sites }
        }
        Some(last) if sites.is_none() => last.to = to,
        _ => parts.push(BorderPart { to, sites }),
    }
}

/// A point at which three paths are equally long, by Newton's method from `x` in steps of at most
/// `size`. `paths` gives their lengths and directions. `None` if a step is not finite. The caller
/// has to check the point: the method may not have converged.
pub(super) fn meeting_point(
    mut x: Point,
    size: f64,
    paths: impl Fn(Point) -> [(f64, Point); 3],
) -> Option<Point> {
    let mut last = f64::INFINITY;
    for _ in 0..60 {
        let [a, b, c] = paths(x);
        let [p, q] = [b, c].map(|other| sub(a.1, other.1));
        let values = [a.0 - b.0, a.0 - c.0];
        let determinant = cross_2d(p, q);
        let step = [
            -(values[0] * q[1] - values[1] * p[1]) / determinant,
            -(p[0] * values[1] - q[0] * values[0]) / determinant,
        ];
        let long = norm(step);
        if !long.is_finite() {
            return None;
        }
        let scale = (size / long).min(1.0);
        x = [x[0] + scale * step[0], x[1] + scale * step[1]];
        if long <= 1e-15 * size || long >= last && long <= 1e-7 * size {
            return Some(x);
        }
        last = long;
    }
    Some(x)
}
