//! Cutting polygons into triangles.
//!
//! Distances on a flat polygon do not depend on how it is cut. On a warped one they do, because it
//! folds along the cuts. The rule is therefore simple, and agrees with most programs on convex
//! faces:
//!
//! * A polygon is cut into the **fan from its first corner** (0 1 2, 0 2 3, 0 3 4, ...) if none of
//!   these triangles is folded over or flat, seen along the polygon's normal.
//! * Otherwise its **ears are clipped**, in turn around the polygon. An ear is a corner whose
//!   triangle with its two neighbours is convex and contains no other corner. This covers many
//!   concave polygons, and polygons with corners collinear with the first one. A concave quad is
//!   cut at its reflex corner.
//!
//! The normal of the polygon is its vector area (Newell). For a slightly warped polygon it is that
//! of the best-fitting plane. Polygons with missing or non-finite corners, or without area, become
//! fans, for validation to report. A polygon whose corners lie on one line is cut **in halves**, so
//! that a path along it passes few triangles. A polygon that repeats corners may have holes, with
//! bridges to them. Any other one becomes a fan from the repeated corner, so that a triangle names
//! it twice. Self-intersecting polygons are cut in some way. A polygon of k corners always becomes
//! k - 2 triangles with its orientation.

use crate::vector::{cross, dot, sub};

/// Twice the area, relative to the polygon's squared extent or to the product of two sides, up to
/// which a triangle counts as flat.
/// It decides between cuts only; no triangle is dropped.
const FLAT: f64 = 1e-12;

/// The total number of steps of ear clipping for the polygons of a file, some nanoseconds each.
///
/// Clipping the ears of k corners takes O(k²) steps at worst. A file of 3 MB could hold a polygon
/// that takes minutes, and one of 30 MB a polygon that takes hours.
#[derive(Debug)]
pub(super) struct Budget(u64);

/// The budget is exhausted.
#[derive(Debug)]
pub(super) struct TooComplex;

impl Budget {
    /// The budget of a file with this many corners: some seconds for a polygon, and more than any
    /// number of small polygons needs.
    pub(super) fn for_corners(corners: usize) -> Self {
        Self((1 << 29) + 1000 * corners as u64)
    }

    fn take(&mut self, steps: usize) -> Result<(), TooComplex> {
        self.0 = self.0.checked_sub(steps as u64).ok_or(TooComplex)?;
        Ok(())
    }
}

/// Appends the triangles of the polygon `corners` to `triangles`; none if it has fewer than three
/// corners.
///
/// Takes O(k) time for k corners if the polygon is cut into a fan, and O(k²) at worst, within the
/// budget.
pub(super) fn triangulate(
    positions: &[[f64; 3]],
    corners: &[u32],
    triangles: &mut Vec<[u32; 3]>,
    budget: &mut Budget,
) -> Result<(), TooComplex> {
    let k = corners.len();
    let fan_from = |first: usize| {
        (1..k.saturating_sub(1)).map(move |i| [0, i, i + 1].map(|j| (first + j) % k))
    };
    let fan = fan_from(0);
    let name = |t: [usize; 3]| t.map(|i| corners[i]);
    if k > 3
        && let Some(repeated) = repeated_corner(corners)
    {
        match with_bridges(positions, corners, budget)? {
            Some(cut) => triangles.extend(cut),
            None => triangles.extend(fan_from(repeated).map(name)),
        }
    } else if k > 3 {
        match Polygon::new(positions, corners) {
            Some(polygon) if fan.clone().any(|t| polygon.is_folded(t)) => {
                triangles.extend(clip_ears(&polygon, budget)?.into_iter().map(name));
            }
            None if are_on_one_line(positions, corners) => {
                cut_in_halves([0, k - 1], &mut |t| triangles.push(name(t)));
            }
            _ => triangles.extend(fan.map(name)),
        }
    } else {
        triangles.extend(fan.map(name));
    }
    Ok(())
}

/// Whether all corners exist and lie on one line.
fn are_on_one_line(positions: &[[f64; 3]], corners: &[u32]) -> bool {
    let places = corners.iter().map(|&v| positions.get(v as usize).copied());
    let Some(places) = places.collect::<Option<Vec<_>>>() else {
        return false;
    };
    let offsets = places.iter().map(|&p| sub(p, places[0]));
    let extent = |p: &[f64; 3]| p.iter().fold(0.0, |extent: f64, x| extent.max(x.abs()));
    let Some(farthest) = offsets
        .clone()
        .max_by(|p, q| extent(p).total_cmp(&extent(q)))
    else {
        return false;
    };
    let size = extent(&farthest);
    let along = farthest.map(|x| x / size);
    // Comparisons with NaN are false: a corner that is not finite is not on the line.
    let is_on_line = |p: [f64; 3]| {
        let across = cross(along, p.map(|x| x / size));
        across.iter().all(|x| x.abs() <= FLAT)
    };
    size > 0.0 && size.is_finite() && offsets.clone().all(is_on_line)
}

/// The triangles of the part of a polygon from the one corner to the other, and a cut between
/// these.
///
/// Behind each cut lie half of the corners. Of a fan on one line, each corner sends windows through
/// all triangles behind it: 9 million windows for 3,000 corners.
fn cut_in_halves([first, last]: [usize; 2], push: &mut impl FnMut([usize; 3])) {
    if last - first < 2 {
        return;
    }
    let middle = (first + last).div_ceil(2);
    cut_in_halves([first, middle], push);
    push([first, middle, last]);
    cut_in_halves([middle, last], push);
}

/// The triangles of a polygon with holes that repeats corners where bridges lead to its holes;
/// `None` if it is no such polygon.
///
/// Its ears are clipped. If all triangles face as the polygon does, they cover each of its points
/// once, because their areas add up to that of the polygon.
fn with_bridges(
    positions: &[[f64; 3]],
    corners: &[u32],
    budget: &mut Budget,
) -> Result<Option<Vec<[u32; 3]>>, TooComplex> {
    let Some(polygon) = Polygon::new(positions, corners) else {
        return Ok(None);
    };
    let triangles = clip_ears(&polygon, budget)?;
    let is_sound = |&t: &[usize; 3]| {
        let [a, b, c] = t.map(|i| corners[i]);
        !polygon.is_folded(t) && a != b && b != c && c != a
    };
    let is_tiled = triangles.iter().all(is_sound);
    Ok(is_tiled.then(|| {
        triangles
            .into_iter()
            .map(|t| t.map(|i| corners[i]))
            .collect()
    }))
}

/// Other ways to cut a polygon without folds than that of [`triangulate`]: the fans from its other
/// corners, then its ears in turn from each of them. None for polygons of many corners, which would
/// take long.
pub(super) fn other_cuts(
    positions: &[[f64; 3]],
    corners: &[u32],
) -> impl Iterator<Item = Vec<[u32; 3]>> {
    const MOST: usize = 64;
    let k = corners.len();
    let tries = if k <= MOST { k } else { 0 };
    let turned =
        move |first: usize| -> Vec<u32> { (0..k).map(|i| corners[(first + i) % k]).collect() };
    let fans = (1..tries).filter_map(move |first| {
        let corners = turned(first);
        let polygon = Polygon::new(positions, &corners)?;
        let fan: Vec<[usize; 3]> = (1..k - 1).map(|i| [0, i, i + 1]).collect();
        let is_sound = fan.iter().all(|&t| !polygon.is_folded(t));
        is_sound.then(|| fan.into_iter().map(|t| t.map(|i| corners[i])).collect())
    });
    let ears = (0..tries).filter_map(move |first| {
        let corners = turned(first);
        let polygon = Polygon::new(positions, &corners)?;
        let ears = clip_ears(&polygon, &mut Budget::for_corners(k)).ok()?;
        let is_sound = ears.iter().all(|&t| !polygon.is_folded(t));
        is_sound.then(|| ears.into_iter().map(|t| t.map(|i| corners[i])).collect())
    });
    fans.chain(ears)
}

/// The index of a corner that occurs more than once.
fn repeated_corner(corners: &[u32]) -> Option<usize> {
    if let [a, b, c, d] = corners {
        // Most polygons are quads.
        return if a == c || a == b || a == d {
            Some(0)
        } else if b == d || b == c {
            Some(1)
        } else {
            (c == d).then_some(2)
        };
    }
    let mut sorted: Vec<_> = corners.iter().zip(0..).collect();
    sorted.sort_unstable();
    let pair = sorted.windows(2).find(|pair| pair[0].0 == pair[1].0)?;
    Some(pair[0].1)
}

/// A polygon scaled to extent 1, with its unit normal.
struct Polygon {
    points: Vec<[f64; 3]>,
    normal: [f64; 3],
}

impl Polygon {
    /// `None` if a corner is missing or not finite, or if the polygon has no area.
    fn new(positions: &[[f64; 3]], corners: &[u32]) -> Option<Self> {
        let mut points = Vec::with_capacity(corners.len());
        for &corner in corners {
            points.push(*positions.get(corner as usize)?);
        }
        let origin = points[0];
        for p in &mut points {
            *p = sub(*p, origin);
        }
        let extent = points
            .as_flattened()
            .iter()
            .fold(0.0, |extent: f64, x| extent.max(x.abs()));
        // Multiplying by 1 / extent would overflow for the smallest extents.
        for x in points.as_flattened_mut() {
            *x /= extent;
        }
        let mut area = [0.0; 3];
        for pair in points.windows(2) {
            let c = cross(pair[0], pair[1]);
            area = [area[0] + c[0], area[1] + c[1], area[2] + c[2]];
        }
        let length = dot(area, area).sqrt();
        (length > FLAT && length.is_finite()).then(|| Self {
            points,
            normal: area.map(|x| x / length),
        })
    }

    /// Twice the signed area of a triangle of three corners, seen along the normal.
    fn turn(&self, [a, b, c]: [usize; 3]) -> f64 {
        let p = &self.points;
        dot(cross(sub(p[b], p[a]), sub(p[c], p[a])), self.normal)
    }

    /// Whether a triangle of three corners is folded over or flat, by the sine of its first angle:
    /// of a convex polygon with many corners, triangles are small but not flat.
    fn is_folded(&self, t: [usize; 3]) -> bool {
        let [a, b, c] = t.map(|i| self.points[i]);
        let [ab, ac] = [sub(b, a), sub(c, a)];
        self.turn(t) <= FLAT * (dot(ab, ab) * dot(ac, ac)).sqrt()
    }

    /// Whether corner `q` lies in triangle `t` or on its border, but is none of its corners.
    fn holds(&self, t: [usize; 3], q: usize) -> bool {
        let [a, b, c] = t;
        t.iter().all(|&i| self.points[i] != self.points[q])
            && [[a, b, q], [b, c, q], [c, a, q]]
                .into_iter()
                .all(|side| self.turn(side) >= -FLAT)
    }
}

/// Cuts off one ear after the other.
///
/// Clipping an ear changes only whether its two neighbours are ears. Another corner is kept from
/// being an ear by a reflex corner inside its triangle, and ears are convex.
fn clip_ears(polygon: &Polygon, budget: &mut Budget) -> Result<Vec<[usize; 3]>, TooComplex> {
    let n = polygon.points.len();
    let mut ring = CornerRing {
        next: (0..n).map(|i| (i + 1) % n).collect(),
        prev: (0..n).map(|i| (i + n - 1) % n).collect(),
        turns: vec![0.0; n],
        blockers: Vec::new(),
    };
    for i in 0..n {
        ring.turns[i] = polygon.turn(ring.ear(i));
    }
    // A corner never turns from convex to reflex, so only corners that are reflex now can block.
    ring.blockers = (0..n).filter(|&i| ring.turns[i] <= FLAT).collect();
    let is_ear: Result<Vec<bool>, _> = (0..n).map(|i| ring.is_ear(polygon, i, budget)).collect();
    let mut is_ear = is_ear?;

    let mut triangles = Vec::with_capacity(n - 2);
    let mut at = 1;
    for left in (4..=n).rev() {
        let mut steps = 0;
        while !is_ear[at] && steps < left {
            at = ring.next[at];
            steps += 1;
        }
        budget.take(steps)?;
        if !is_ear[at] {
            // The polygon is not simple. Cut off the corner with the largest triangle.
            budget.take(left)?;
            at = ring.sharpest(at);
        }
        let ear = ring.ear(at);
        triangles.push(ear);
        let [before, clipped, after] = ear;
        ring.next[before] = after;
        ring.prev[after] = before;
        is_ear[clipped] = false;
        ring.turns[clipped] = f64::INFINITY;
        for i in [before, after] {
            ring.turns[i] = polygon.turn(ring.ear(i));
        }
        for i in [before, after] {
            is_ear[i] = ring.is_ear(polygon, i, budget)?;
        }
        // Continuing behind the neighbour distributes the cuts instead of concentrating them at one
        // corner.
        at = ring.next[after];
    }
    triangles.push(ring.ear(at));
    Ok(triangles)
}

/// The remaining corners, in a circular list.
struct CornerRing {
    next: Vec<usize>,
    prev: Vec<usize>,
    /// Twice the signed area of each corner's triangle; infinite for removed corners.
    turns: Vec<f64>,
    /// Corners that were not convex at the start.
    blockers: Vec<usize>,
}

impl CornerRing {
    /// The triangle of corner `i` and its neighbours.
    fn ear(&self, i: usize) -> [usize; 3] {
        [self.prev[i], i, self.next[i]]
    }

    /// Whether corner `i` is an ear.
    fn is_ear(&self, polygon: &Polygon, i: usize, budget: &mut Budget) -> Result<bool, TooComplex> {
        let convex = self.turns[i] > FLAT;
        if !convex {
            return Ok(false);
        }
        let ear = self.ear(i);
        let blocks =
            |&q: &usize| self.turns[q] <= FLAT && !ear.contains(&q) && polygon.holds(ear, q);
        let first = self.blockers.iter().position(blocks);
        budget.take(first.unwrap_or(self.blockers.len()))?;
        Ok(first.is_none())
    }

    /// The corner with the largest triangle.
    fn sharpest(&self, start: usize) -> usize {
        let (mut best, mut at) = (start, self.next[start]);
        while at != start {
            if self.turns[at] > self.turns[best] {
                best = at;
            }
            at = self.next[at];
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use proptest::prelude::*;

    use super::*;

    /// [`super::triangulate`] without a limit.
    fn triangulate(positions: &[[f64; 3]], corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
        super::triangulate(positions, corners, triangles, &mut Budget(u64::MAX)).unwrap();
    }

    /// The triangles of a plane polygon, after checking that they tile it.
    fn cut(polygon: &[[f64; 2]]) -> Vec<[u32; 3]> {
        // On a slanted plane, so that no coordinate direction is special.
        let lift = |p: &[f64; 2]| [p[0] - p[1], p[0] + p[1], 3.0 + p[0] - 2.0 * p[1]];
        let positions: Vec<_> = polygon.iter().map(lift).collect();
        let corners: Vec<u32> = (0..polygon.len() as u32).collect();
        let mut triangles = Vec::new();
        triangulate(&positions, &corners, &mut triangles);
        assert_eq!(triangles.len(), polygon.len() - 2);

        let area = |ring: &[[f64; 2]]| {
            let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
            pairs.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
        };
        let areas = triangles
            .iter()
            .map(|t| area(&t.map(|i| polygon[i as usize])));
        let signs: Vec<bool> = areas.clone().map(|a| a > 0.0).collect();
        assert!(signs.iter().all(|&s| s), "folded: {triangles:?}");
        let (sum, whole) = (areas.sum::<f64>(), area(polygon));
        assert!((sum - whole).abs() < 1e-9 * whole, "{sum} of {whole}");
        triangles
    }

    /// The face `0 1 2 1` was cut into two apparently sound triangles, so its repeated corner was
    /// not reported.
    #[test]
    fn a_repeated_corner_stays_visible() {
        let positions = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        for corners in [
            &[0, 1, 2, 1][..],
            &[0, 1, 2, 2],
            &[0, 1, 2, 3, 1],
            &[3, 0, 1, 0, 2, 1],
        ] {
            let mut triangles = Vec::new();
            triangulate(&positions, corners, &mut triangles);
            assert_eq!(triangles.len(), corners.len() - 2);
            let repeats = |t: &[u32; 3]| t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
            assert!(triangles.iter().any(repeats), "{corners:?}: {triangles:?}");
        }
    }

    /// A fan takes the square of its corners in windows.
    #[test]
    fn corners_on_one_line_are_cut_in_halves() {
        for (direction, count) in [([1.0, 0.0, 0.0], 3000), ([1e-3, 0.2, -7.0], 1000)] {
            let at = |k: u32| direction.map(|x: f64| x * f64::from(k));
            let positions: Vec<_> = (0..count).map(at).collect();
            let corners: Vec<u32> = (0..count).collect();
            let mut triangles = Vec::new();
            triangulate(&positions, &corners, &mut triangles);
            assert_eq!(triangles.len(), corners.len() - 2);
            let mut degrees = vec![0; corners.len()];
            for v in triangles.as_flattened() {
                degrees[*v as usize] += 1;
            }
            assert!(degrees.iter().all(|&degree| (1..=25).contains(&degree)));
            let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
            let all: HashSet<[u32; 2]> = triangles.iter().flat_map(sides).collect();
            assert_eq!(all.len(), 3 * triangles.len());
            let alone = all.iter().filter(|&&[a, b]| !all.contains(&[b, a]));
            assert!(alone.into_iter().all(|&[a, b]| b == (a + 1) % count));
        }
        let mut quad = Vec::new();
        triangulate(
            &[[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]],
            &[0, 1, 2, 3],
            &mut quad,
        );
        assert_eq!(quad, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn convex_faces_become_fans() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert_eq!(cut(&square), [[0, 1, 2], [0, 2, 3]]);
        let pentagon: Vec<_> = (0..5)
            .map(|i| f64::from(i) * 1.2566)
            .map(|a| [a.cos(), a.sin()])
            .collect();
        assert_eq!(cut(&pentagon), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    }

    #[test]
    fn concave_quads_are_cut_at_the_reflex_corner() {
        let dart = [[0.0, 0.0], [4.0, 1.0], [0.0, 2.0], [1.0, 1.0]];
        for reflex in 0..4 {
            let mut corners = dart;
            corners.rotate_left((3 + 4 - reflex) % 4);
            assert_eq!(corners[reflex], [1.0, 1.0]);
            let shared = |t: &[u32; 3]| t.contains(&(reflex as u32));
            assert!(cut(&corners).iter().all(shared), "reflex corner {reflex}");
        }
    }

    #[test]
    fn concave_polygons_are_tiled() {
        let comb = [
            [0.0, 0.0],
            [7.0, 0.0],
            [7.0, 5.0],
            [6.0, 5.0],
            [6.0, 1.0],
            [4.0, 1.0],
            [4.0, 5.0],
            [3.0, 5.0],
            [3.0, 1.0],
            [1.0, 1.0],
            [1.0, 5.0],
            [0.0, 5.0],
        ];
        let star: Vec<_> = (0..24)
            .map(|i| (f64::from(i) * 0.2618, if i % 2 == 0 { 1.0 } else { 0.3 }))
            .map(|(a, r)| [r * a.cos(), r * a.sin()])
            .collect();
        for polygon in [&comb[..], &star[..]] {
            for start in 0..polygon.len() {
                let mut turned = polygon.to_vec();
                turned.rotate_left(start);
                cut(&turned);
            }
        }
    }

    proptest! {
        #[test]
        fn star_shaped_polygons_are_tiled(
            radii in prop::collection::vec(0.05..1.0, 4..40),
            turn in 0.0..6.0,
        ) {
            let step = std::f64::consts::TAU / radii.len() as f64;
            let angles = (0..radii.len()).map(|i| turn + step * i as f64);
            let polygon: Vec<_> = angles
                .zip(&radii)
                .map(|(a, r): (f64, &f64)| [r * a.cos(), r * a.sin()])
                .collect();
            cut(&polygon);
        }
    }

    #[test]
    fn corners_in_line_make_no_flat_triangle() {
        // A square with a corner amid each side, as where finer faces adjoin.
        let square = [
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [2.0, 2.0],
            [1.0, 2.0],
            [0.0, 2.0],
            [0.0, 1.0],
        ];
        for start in 0..8 {
            let mut turned = square;
            turned.rotate_left(start);
            cut(&turned);
        }
    }

    #[test]
    fn the_cut_does_not_depend_on_the_scale() {
        let dart = [[0.0, 0.0], [1.0, 1.0], [0.0, 2.0], [4.0, 1.0]];
        let cut = |scale: f64| {
            let positions = dart.map(|p| [p[0] * scale, p[1] * scale, 0.0]);
            let mut triangles = Vec::new();
            triangulate(&positions, &[0, 1, 2, 3], &mut triangles);
            triangles
        };
        for scale in [1e-300, 1e-9, 1e9, 1e300] {
            assert_eq!(cut(scale), cut(1.0), "{scale}");
        }
    }

    #[test]
    fn hopeless_polygons_are_still_cut() {
        let bowtie = [[0.0; 3], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.5, 0.0]];
        let nan = [[f64::NAN; 3]; 5];
        let huge = [
            [0.0; 3],
            [1e308; 3],
            [-1e308, 1e308, 0.0],
            [1e308, 0.0, 0.0],
        ];
        let point = [[1.0; 3]; 6];
        for positions in [&bowtie[..], &nan[..], &huge[..], &point[..], &[]] {
            for corners in [
                &[0, 1, 2, 3][..],
                &[3, 2, 1, 0, 4, 5],
                &[0, 0, 0, 0, 0],
                &[9],
            ] {
                let mut triangles = Vec::new();
                triangulate(positions, corners, &mut triangles);
                assert_eq!(triangles.len(), corners.len().saturating_sub(2));
            }
        }
    }
}
