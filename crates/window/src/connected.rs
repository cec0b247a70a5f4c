//! Distances over edges, for vertices that no window has reached.
//!
//! A window is cut where it is no wider than rounding, and a vertex beside edges that are shorter
//! than the rounding of its distance can lose all windows: the tip of a cone whose faces shrink to
//! 1e-18 of its size, or the faces around a vertex that is 1e19 times as far away. An edge from a
//! vertex with a distance is a path all the same. So a vertex that is connected to a source always
//! gets a distance, and in the first case the right one: the edge that it is reached by is as short
//! as the rounding. Where faces are too long for the distances, [`doubt`](crate::precision::doubt)
//! says by how much they may be off.

use geobench_mesh::{Mesh, VertexId};

use crate::origins::Way;
use crate::probe::Probe;
use crate::queue::Heap;

/// Gives the vertices of infinite distance that edges connect to others their shortest way over
/// edges, if the run left no shorter path open. O(n) if there are none; else O(n log n) for n
/// vertices of this kind, and the edges of the lesser of the reached and the other vertices.
#[inline]
pub fn reach_over_edges<P: Probe>(mesh: &Mesh, distances: &mut [f64], probe: &mut P) {
    let missing = distances.iter().filter(|d| d.is_infinite()).count();
    if missing > 0 {
        reach_missing(mesh, distances, missing, probe);
    }
}

#[cold]
fn reach_missing<P: Probe>(mesh: &Mesh, distances: &mut [f64], missing: usize, probe: &mut P) {
    // Distances that are not below it are not final.
    let bound = probe.open_bound();
    let is_final = |d: f64| d.is_finite() && d < bound;
    // The reached vertices beside missing ones, found from the side that has fewer.
    let mut queue: Heap<VertexId> = Heap::default();
    if missing < distances.len() / 2 {
        for v in mesh
            .vertices()
            .filter(|v| distances[v.index()].is_infinite())
        {
            for (u, _) in mesh.neighbours(v) {
                let d = distances[u.index()];
                if is_final(d) {
                    queue.push(d, u);
                }
            }
        }
    } else {
        for v in mesh.vertices() {
            let d = distances[v.index()];
            let mut around = mesh.neighbours(v);
            if is_final(d) && around.any(|(u, _)| !is_final(distances[u.index()])) {
                queue.push(d, v);
            }
        }
    }
    // Distances that windows have found stay as they are.
    let mut found = vec![false; if queue.is_empty() { 0 } else { distances.len() }];
    while let Some((d, v)) = queue.pop() {
        if d > distances[v.index()] {
            continue;
        }
        for (u, length) in mesh.neighbours(v) {
            let known = &mut distances[u.index()];
            let is_missing = known.is_infinite() || found[u.index()];
            if is_missing && d + length < known.min(bound) {
                *known = d + length;
                found[u.index()] = true;
                queue.push(d + length, u);
                if P::TRACES {
                    reach_along_edge(mesh, v, u, probe);
                }
            }
        }
    }
}

/// Tells `probe` that the path to `to` arrives along the edge from `from`.
pub fn reach_along_edge<P: Probe>(mesh: &Mesh, from: VertexId, to: VertexId, probe: &mut P) {
    for &h in mesh.outgoing(to) {
        if mesh.head(h) == from {
            return probe.reach(to, h, Way::FromTail);
        }
        if mesh.tail(h.prev()) == from {
            return probe.reach(to, h, Way::FromHead);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Goal, Origin, Origins};

    const INFINITE: f64 = f64::INFINITY;

    #[test]
    fn missing_vertices_are_reached_over_edges() {
        // 3 x 3 vertices, numbered in rows.
        let mesh = Mesh::generate("grid,n=2").unwrap();
        let whole = |missing: &[usize]| {
            let mut distances: Vec<f64> = (0..9)
                .map(|v| f64::hypot(f64::from(v % 3), f64::from(v / 3)))
                .collect();
            for &v in missing {
                distances[v] = INFINITE;
            }
            distances
        };
        for missing in [&[][..], &[2], &[1, 2, 5], &[1, 2, 4, 5, 6, 7, 8]] {
            let mut distances = whole(missing);
            let mut origins = Origins::new(9, true);
            reach_over_edges(&mesh, &mut distances, &mut origins);
            let exact = whole(&[]);
            for v in 0..9 {
                let is_missing = missing.contains(&v);
                assert!(distances[v].is_finite() && distances[v] >= exact[v], "{v}");
                assert!(is_missing || distances[v] == exact[v], "{v}");
                let origin = origins.of(&mesh, VertexId::from(v as u32));
                assert_eq!(matches!(origin, Origin::Vertex(_)), is_missing, "{v}");
            }
        }
    }

    #[test]
    fn unconnected_and_unfinished_vertices_stay_infinite() {
        let mesh = Mesh::generate("grid,n=2").unwrap();
        let mut nothing = vec![INFINITE; 9];
        reach_over_edges(&mesh, &mut nothing, &mut ());
        assert!(nothing.iter().all(|d| d.is_infinite()));
        // A run that ended at 1.5 may have open paths to what is farther.
        let goal = Goal::everything().within(1.2);
        let run = |probe: &mut crate::goal::Until<'_, ()>| {
            probe.end(1.5);
            let mut distances = vec![INFINITE; 9];
            distances[0] = 0.0;
            reach_over_edges(&mesh, &mut distances, probe);
            crate::Solution::new(distances)
        };
        let (solution, ()) = goal.bound((), run);
        let finite = |v: usize| solution.distances[v].is_finite();
        assert!(finite(1) && finite(3) && !finite(2) && !finite(8));
    }
}
