//! Triangulation of polygons with holes by ears, which makes long thin faces.

use std::cmp::Ordering;

type Point = [f64; 2];

/// Twice the area of a triangle; positive if it turns left.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Whether two segments cross between their ends.
fn cross([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Triangles between the first outline, which turns left, and the others, which turn right. The
/// corners are numbered outline by outline.
pub(super) fn triangulate(outlines: &[Vec<Point>]) -> Vec<[u32; 3]> {
    let points: Vec<Point> = outlines.iter().flatten().copied().collect();
    let mut numbers = 0..points.len();
    let mut holes: Vec<Vec<usize>> = outlines
        .iter()
        .map(|outline| numbers.by_ref().take(outline.len()).collect())
        .collect();
    let mut boundary = holes.remove(0);
    // Holes on the right first, so that bridges do not cross later holes.
    let right = |hole: &[usize]| hole.iter().map(|&v| points[v][0]).fold(f64::MIN, f64::max);
    holes.sort_by(|a, b| right(b).total_cmp(&right(a)));
    for hole in holes {
        boundary = bridged(&points, &boundary, &hole);
    }
    clip_ears(&points, boundary)
}

/// The boundary with a bridge to `hole`, around it and back.
fn bridged(points: &[Point], boundary: &[usize], hole: &[usize]) -> Vec<usize> {
    let by_x = |&i: &usize, &j: &usize| points[hole[i]][0].total_cmp(&points[hole[j]][0]);
    let start = (0..hole.len()).max_by(by_x).unwrap_or(0);
    let from = points[hole[start]];
    let mut places: Vec<usize> = (0..boundary.len()).collect();
    let away = |&place: &usize| distance(from, points[boundary[place]]);
    places.sort_by(|a, b| away(a).partial_cmp(&away(b)).unwrap_or(Ordering::Equal));
    let is_visible = |&place: &usize| {
        let bridge = [from, points[boundary[place]]];
        let sides = |ring: &[usize]| {
            (0..ring.len()).any(|i| {
                let side = [ring[i], ring[(i + 1) % ring.len()]].map(|v| points[v]);
                cross(bridge, side)
            })
        };
        !sides(boundary) && !sides(hole)
    };
    let at = places.iter().copied().find(is_visible).unwrap_or(0);
    let mut joined = boundary[..=at].to_vec();
    joined.extend((0..=hole.len()).map(|i| hole[(start + i) % hole.len()]));
    joined.extend(&boundary[at..]);
    joined
}

fn clip_ears(points: &[Point], mut boundary: Vec<usize>) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    let mut place = 0;
    let mut rejected = 0;
    while boundary.len() > 2 && rejected < boundary.len() {
        let count = boundary.len();
        let corners = [0, 1, 2].map(|i| boundary[(place + i) % count]);
        let [a, b, c] = corners.map(|v| points[v]);
        let is_inside = |&v: &usize| {
            let p = points[v];
            let at_corner = [a, b, c].contains(&p);
            !at_corner && turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0
        };
        if turn(a, b, c) > 0.0 && !boundary.iter().any(is_inside) {
            triangles.push(corners.map(|v| v as u32));
            boundary.remove((place + 1) % count);
            rejected = 0;
        } else {
            rejected += 1;
            place += 1;
        }
        place %= boundary.len();
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_cover_a_square_without_its_holes() {
        let square = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let hole = |x: f64| vec![[x, 1.0], [x, 2.0], [x + 1.0, 2.0], [x + 1.0, 1.0]];
        let outlines = [square, hole(0.5), hole(2.5)];
        let points: Vec<Point> = outlines.iter().flatten().copied().collect();
        let triangles = triangulate(&outlines);
        // n corners and h holes make n + 2h - 2 triangles.
        assert_eq!(triangles.len(), 14);
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| points[v as usize]);
            turn(a, b, c) / 2.0
        };
        assert_eq!(triangles.iter().map(area).sum::<f64>(), 14.0);
    }
}
