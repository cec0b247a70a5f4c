//! Bounds on geodesic distances that use no unfolding.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::scalar::RealNumber;
use crate::surface::{PreciseSurface, next, prev};

/// An upper bound: the lengths of shortest paths along edges; infinite where no path leads.
///
/// # Panics
///
/// If a source is not a vertex.
pub fn edge_graph_distances<S: RealNumber>(
    surface: &PreciseSurface<S>,
    sources: &[u32],
) -> Vec<f64> {
    crate::rounded(&edge_graph(surface, sources))
}

/// Dijkstra's algorithm on the edges, with a linear search for the nearest open vertex: quadratic
/// and simple.
pub(crate) fn edge_graph<S: RealNumber>(
    surface: &PreciseSurface<S>,
    sources: &[u32],
) -> Vec<Option<S>> {
    let mut best = vec![None; surface.vertex_count()];
    for &source in sources {
        best[source as usize] = Some(S::zero());
    }
    let mut done = vec![false; best.len()];
    loop {
        let open = (0..best.len()).filter(|&v| !done[v] && best[v].is_some());
        let Some(v) = open.reduce(|a, b| if best[b] < best[a] { b } else { a }) else {
            return best;
        };
        done[v] = true;
        for &side in &surface.leaving[v] {
            for (along, end) in [(side, next(side)), (prev(side), prev(side))] {
                let length = best[v].map(|start| start + surface.sides[along].length);
                let end = surface.sides[end].tail;
                if best[end].is_none() || length < best[end] {
                    best[end] = length;
                }
            }
        }
    }
}

/// A lower bound: the Euclidean distances from the nearest of `sources`.
///
/// # Panics
///
/// If a source is not a vertex, or there is none.
pub fn euclidean_distances(positions: &[[f64; 3]], sources: &[u32]) -> Vec<f64> {
    assert!(!sources.is_empty(), "a distance needs a source");
    let distance = |a: [f64; 3], b: [f64; 3]| {
        let [x, y, z] = [0, 1, 2].map(|i| a[i] - b[i]);
        x.hypot(y).hypot(z)
    };
    positions
        .iter()
        .map(|&p| {
            let from = |&s: &u32| distance(positions[s as usize], p);
            sources.iter().map(from).fold(f64::INFINITY, f64::min)
        })
        .collect()
}

/// An upper bound that converges to the distance: shortest paths over `points_per_edge` further
/// points on each edge, straight within each triangle.
///
/// The relative error is some 1 / `points_per_edge`², and greater across needles. Takes 3 · (3 ·
/// `points_per_edge`)² steps for each triangle.
///
/// # Panics
///
/// If a source is not a vertex.
pub fn steiner_distances(
    surface: &PreciseSurface<f64>,
    sources: &[u32],
    points_per_edge: usize,
) -> Vec<f64> {
    let graph = SteinerGraph::new(surface, points_per_edge);
    let mut best = vec![f64::INFINITY; surface.vertex_count() + graph.extra];
    let mut queue = BinaryHeap::new();
    for &source in sources {
        best[source as usize] = 0.0;
        queue.push(Reverse((0_u64, source as usize)));
    }
    while let Some(Reverse((key, node))) = queue.pop() {
        // Non-negative floats have the order of their bits.
        if key != best[node].to_bits() {
            continue;
        }
        for &triangle in &graph.triangles_of[node] {
            let nodes = &graph.nodes_of[triangle];
            let Some((_, here)) = nodes.iter().find(|(n, _)| *n == node) else {
                continue;
            };
            for &(other, there) in nodes {
                let length = best[node] + (here[0] - there[0]).hypot(here[1] - there[1]);
                if length < best[other] {
                    best[other] = length;
                    queue.push(Reverse((length.to_bits(), other)));
                }
            }
        }
    }
    best.truncate(surface.vertex_count());
    best
}

/// The points of each triangle, in the frame of its first side.
struct SteinerGraph {
    extra: usize,
    nodes_of: Vec<Vec<(usize, [f64; 2])>>,
    triangles_of: Vec<Vec<usize>>,
}

impl SteinerGraph {
    fn new(surface: &PreciseSurface<f64>, points: usize) -> Self {
        let vertices = surface.vertex_count();
        let mut first_point = vec![usize::MAX; surface.sides.len()];
        let mut backwards = vec![false; surface.sides.len()];
        let mut extra = 0;
        for side in 0..surface.sides.len() {
            let first = surface.beyond[side].iter().min_by_key(|beyond| beyond.side);
            if let Some(first) = first.filter(|first| first.side < side) {
                first_point[side] = first_point[first.side];
                backwards[side] = !first.turned;
            } else {
                first_point[side] = vertices + extra;
                extra += points;
            }
        }
        let mut nodes_of = Vec::new();
        let mut triangles_of = vec![Vec::new(); vertices + extra];
        for triangle in 0..surface.sides.len() / 3 {
            let base = surface.sides[3 * triangle];
            let corners = [[0.0, 0.0], [base.length, 0.0], base.apex];
            let mut nodes = Vec::new();
            for k in 0..3 {
                let side = 3 * triangle + k;
                nodes.push((surface.sides[side].tail, corners[k]));
                for i in 0..points {
                    let step = if backwards[side] { points - 1 - i } else { i };
                    let part = (step + 1) as f64 / (points + 1) as f64;
                    let [from, to] = [corners[k], corners[(k + 1) % 3]];
                    let at = [0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis]));
                    nodes.push((first_point[side] + i, at));
                }
            }
            for &(node, _) in &nodes {
                triangles_of[node].push(triangle);
            }
            nodes_of.push(nodes);
        }
        Self {
            extra,
            nodes_of,
            triangles_of,
        }
    }
}
