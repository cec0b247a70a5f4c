//! Sites along the boundary of a surface.

use std::collections::HashSet;
use std::ops::Range;

use geobench_mesh::{HalfEdgeId, Mesh, PointError, SurfacePoint};

/// Greatest distance of the boundary from the straight lines between corners, as a fraction of the
/// spacing.
const DEVIATION: f64 = 0.25;

/// Least number of sites on a boundary loop.
const FEWEST: usize = 3;

/// Factor by which the spacing grows while there are too many sites.
const COARSER: f64 = 1.25;

/// Greatest number of times that the spacing grows. It starts so that every site has its share of
/// the boundary, and ends at the latest where no corner is left, at some four times the whole
/// boundary: enough for 10^18 sites.
const ROUNDS: usize = 200;

/// Points along every boundary loop, at most `spacing` apart, with all corners. If there are more
/// than `most`, the spacing grows; at least three points remain on each loop.
///
/// # Errors
///
/// If a point is not on the mesh, which is a defect of the program.
pub(super) fn points(
    mesh: &Mesh,
    spacing: f64,
    most: usize,
) -> Result<Vec<SurfacePoint>, PointError> {
    let loops = loops(mesh);
    let most = most.max(FEWEST * loops.len());
    // With less, there would be more sites, of a narrow strip as many as do not fit into memory.
    let boundary: f64 = loops.iter().flatten().map(|&h| mesh.length(h)).sum();
    let mut spacing = spacing.max(boundary / most as f64);
    let mut divided = divisions(mesh, &loops, spacing);
    for _ in 0..ROUNDS {
        if divided.iter().map(|(_, pieces)| pieces).sum::<usize>() <= most {
            break;
        }
        spacing *= COARSER;
        divided = divisions(mesh, &loops, spacing);
    }
    let mut points = Vec::new();
    for (chain, pieces) in divided {
        chain.divide(mesh, pieces, &mut points)?;
    }
    Ok(points)
}

/// The chains of all loops, each with the number of its pieces.
fn divisions(mesh: &Mesh, loops: &[Vec<HalfEdgeId>], spacing: f64) -> Vec<(BoundaryChain, usize)> {
    let of_loop = |around: &Vec<HalfEdgeId>| {
        let chains = chains(mesh, around.clone(), spacing);
        let count = chains.len();
        let divided = chains.into_iter().map(move |chain| {
            let pieces = chain.pieces(spacing, count);
            (chain, pieces)
        });
        divided.collect::<Vec<_>>()
    };
    loops.iter().flat_map(of_loop).collect()
}

/// The boundary loops, each as its half-edges in order.
fn loops(mesh: &Mesh) -> Vec<Vec<HalfEdgeId>> {
    let mut seen = HashSet::new();
    let mut loops = Vec::new();
    for start in mesh.half_edges().filter(|&h| mesh.twin(h).is_none()) {
        let mut around = Vec::new();
        let mut h = start;
        while seen.insert(h) {
            around.push(h);
            // The next boundary half-edge is found by turning around the head, across the faces of
            // its fan.
            h = h.next();
            while let Some(twin) = mesh.twin(h) {
                h = twin.next();
            }
        }
        if !around.is_empty() {
            loops.push(around);
        }
    }
    loops
}

/// A part of the boundary from one corner to the next, or a whole loop without corners.
struct BoundaryChain {
    edges: Vec<HalfEdgeId>,
    length: f64,
}

/// The chains of a loop, between its corners.
fn chains(mesh: &Mesh, mut around: Vec<HalfEdgeId>, spacing: f64) -> Vec<BoundaryChain> {
    let mut is_corner = corners(mesh, &around, spacing);
    if let Some(first) = is_corner.iter().position(|&is_corner| is_corner) {
        around.rotate_left(first);
        is_corner.rotate_left(first);
    }
    let mut chains: Vec<BoundaryChain> = Vec::new();
    for (h, is_corner) in around.into_iter().zip(is_corner) {
        let length = mesh.length(h);
        match chains.last_mut().filter(|_| !is_corner) {
            Some(chain) => {
                chain.edges.push(h);
                chain.length += length;
            }
            None => chains.push(BoundaryChain {
                edges: vec![h],
                length,
            }),
        }
    }
    chains
}

/// Whether each half-edge of a loop begins at a corner.
///
/// The straight lines between corners deviate from the loop by at most [`DEVIATION`] times the
/// spacing (U. Ramer, 1972; D. Douglas, T. Peucker, 1973). So roughness below that makes no
/// corners. There are at least three if there are three vertices. Takes O(n log n) time for n
/// half-edges, O(n²) in the worst case.
fn corners(mesh: &Mesh, around: &[HalfEdgeId], spacing: f64) -> Vec<bool> {
    let count = around.len();
    let position = |i: usize| mesh.positions()[mesh.tail(around[i % count]).index()];
    let farthest = |indices: Range<usize>, segment: [[f64; 3]; 2]| {
        let each = indices.map(|i| (distance_to_segment(position(i), segment), i));
        each.reduce(|most, next| if next.0 > most.0 { next } else { most })
    };
    let mut is_corner = vec![false; count];
    // The vertex farthest from the first one, the one farthest from that, and the one farthest from
    // the line between both.
    let from = |i: usize| farthest(i..i + count, [position(i); 2]).map_or(i, |(_, at)| at % count);
    let first = from(0);
    let second = from(first);
    let line = [first, second].map(position);
    let third = farthest(0..count, line).map_or(first, |(_, at)| at);
    let mut corners = [first, second, third];
    corners.sort_unstable();
    for corner in corners {
        is_corner[corner] = true;
    }
    let [a, b, c] = corners;
    let mut open = vec![(a, b), (b, c), (c, a + count)];
    while let Some((a, b)) = open.pop() {
        let segment = [position(a), position(b)];
        let found = farthest(a + 1..b, segment);
        if let Some((_, at)) = found.filter(|&(d, _)| d > DEVIATION * spacing) {
            is_corner[at % count] = true;
            open.extend([(a, at), (at, b)]);
        }
    }
    is_corner
}

/// The distance from `p` to the segment from `a` to `b`.
fn distance_to_segment(p: [f64; 3], [a, b]: [[f64; 3]; 2]) -> f64 {
    let minus = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (along, to_p) = (minus(b, a), minus(p, a));
    let square = dot(along, along);
    let t = if square > 0.0 {
        (dot(to_p, along) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let off = minus(to_p, along.map(|x| x * t));
    dot(off, off).sqrt()
}

impl BoundaryChain {
    /// The number of equal pieces into which the chain is divided. None is longer than `spacing`,
    /// and a loop of `chains` chains has at least [`FEWEST`] pieces.
    fn pieces(&self, spacing: f64, chains: usize) -> usize {
        #[expect(clippy::cast_sign_loss, reason = "lengths are positive")]
        let needed = (self.length / spacing - 1e-9).ceil().max(1.0) as usize;
        needed.max(FEWEST.div_ceil(chains))
    }

    /// Adds the points at which pieces begin.
    fn divide(
        &self,
        mesh: &Mesh,
        pieces: usize,
        points: &mut Vec<SurfacePoint>,
    ) -> Result<(), PointError> {
        let (mut before, mut next) = (0.0, 0);
        for &h in &self.edges {
            let length = mesh.length(h);
            while next < pieces {
                let along = self.length * (next as f64 / pieces as f64) - before;
                if along >= length * (1.0 - 1e-9) {
                    break;
                }
                let ends = [mesh.tail(h), mesh.head(h)];
                points.push(if along <= 1e-9 * length {
                    ends[0].into()
                } else {
                    mesh.point_on_edge(ends, along / length)?
                });
                next += 1;
            }
            before += length;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn the_sides_of_a_square_are_divided_evenly() {
        let mesh = Mesh::generate("grid,n=10").unwrap();
        let sites = points(&mesh, 3.0, 1000).unwrap();
        // Each side of length 10 in four pieces.
        assert_eq!(sites.len(), 16);
        let low = mesh.positions()[0];
        for site in &sites {
            let position = mesh.position_of(site).unwrap();
            let on = [0, 1].map(|k| (position[k] - low[k]) / 2.5);
            assert!(on.iter().all(|x| (x - x.round()).abs() < 1e-9), "{on:?}");
        }
        // Too many: only corners are left.
        assert_eq!(points(&mesh, 3.0, 4).unwrap().len(), 4);
        let closed = Mesh::generate("sphere,subdiv=1").unwrap();
        assert_eq!(points(&closed, 0.1, 1000).unwrap(), []);
    }

    /// Regression test: a spacing far below the boundary, as the area of a narrow strip asks for,
    /// took memory for every point.
    #[test]
    fn a_narrow_strip_gets_no_more_points_than_asked_for() {
        for width in [1e-3, 1e-30, 1e-57] {
            let corners = [
                [0.0; 3],
                [1.0, 0.0, 0.0],
                [1.0, width, 0.0],
                [0.0, width, 0.0],
            ];
            let Ok(mesh) = Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]) else {
                continue;
            };
            for spacing in [width.sqrt(), width, 0.0] {
                let sites = points(&mesh, spacing, 6).unwrap();
                assert!((3..=6).contains(&sites.len()), "{width:e}: {}", sites.len());
            }
        }
    }

    #[test]
    fn a_rough_boundary_has_few_corners() {
        let mesh = Mesh::generate("terrain,n=707,seed=1").unwrap();
        // Many single vertices look like corners.
        let turn = |h: &HalfEdgeId| (mesh.total_angle(mesh.tail(*h)) - PI).abs();
        let around = &loops(&mesh)[0];
        assert!(around.iter().filter(|h| turn(h) > PI / 4.0).count() > 150);
        let length: f64 = around.iter().map(|&h| mesh.length(h)).sum();
        let spacing = length / 100.0;
        let sites = points(&mesh, spacing, 1000).unwrap();
        assert!((100..200).contains(&sites.len()), "{}", sites.len());
        let position = |i: usize| mesh.position_of(&sites[i]).unwrap();
        for corner in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
            let is_corner = |i| (0..2).all(|k| (position(i)[k] - corner[k]).abs() < 1e-9);
            assert!((0..sites.len()).any(is_corner), "{corner:?}");
        }
    }

    #[test]
    fn every_loop_gets_three_points() {
        let mesh = Mesh::generate("holes,holes=2").unwrap();
        let count = loops(&mesh).len();
        assert_eq!(count, geobench_mesh::MeshMeasures::of(&mesh).boundary_loops);
        let sites = points(&mesh, f64::INFINITY, 1000).unwrap();
        assert!(sites.len() >= 3 * count, "{} on {count}", sites.len());
    }
}
