//! Measures a triangle soup from its definition, without the crate's own mesh.

use std::collections::HashSet;

use geobench_mesh::vector::{cross, dot, norm, sub};
use geobench_mesh::{DisjointSets, Mesh, TriangleSoup};

/// Global facts about a soup that is an oriented manifold without isolated vertices.
pub(crate) struct Surface {
    /// V - E + F.
    pub(crate) euler: i64,
    /// Edges with a triangle on one side only.
    pub(crate) boundary_edges: usize,
    pub(crate) area: f64,
    /// Enclosed volume, positive if triangles face outwards; for closed surfaces.
    pub(crate) volume: f64,
}

/// Checks that `soup` is an oriented, connected manifold whose every vertex is used and whose
/// sides and areas are positive, and measures it.
pub(crate) fn measure(name: &str, soup: &TriangleSoup) -> Surface {
    let p = |v: u32| soup.positions[v as usize];
    let mut directed = HashSet::new();
    let mut parts = DisjointSets::new(soup.positions.len());
    let (mut area, mut volume) = (0.0, 0.0);
    for t in &soup.triangles {
        for k in 0..3 {
            let (from, to) = (t[k], t[(k + 1) % 3]);
            assert!(
                directed.insert((from, to)),
                "{name}: edge {from}-{to} twice"
            );
            assert!(p(from) != p(to), "{name}: zero-length edge {from}-{to}");
            parts.union(from, to);
        }
        let [a, b, c] = t.map(p);
        let normal = cross(sub(b, a), sub(c, a));
        let twice_area = norm(normal);
        assert!(twice_area > 0.0, "{name}: triangle {t:?} has no area");
        area += twice_area / 2.0;
        volume += dot(a, normal) / 6.0;
    }
    let used: HashSet<u32> = soup.triangles.iter().flatten().copied().collect();
    assert_eq!(used.len(), soup.positions.len(), "{name}: unused vertices");
    assert_eq!(parts.count(), 1, "{name}: components");
    assert!(soup.positions.as_flattened().iter().all(|x| x.is_finite()));
    let boundary_edges = directed
        .iter()
        .filter(|&&(a, b)| !directed.contains(&(b, a)))
        .count();
    let edges = usize::midpoint(directed.len(), boundary_edges);
    let (mesh, _) = Mesh::from_soup(soup.clone()).expect(name);
    for v in mesh.vertices() {
        assert!(!mesh.is_pinched(v), "{name}: vertex {v} joins several fans");
    }
    Surface {
        euler: count(soup.positions.len()) - count(edges) + count(soup.triangles.len()),
        boundary_edges,
        area,
        volume,
    }
}

fn count(n: usize) -> i64 {
    n.try_into().expect("small models")
}

/// Asserts that `a` and `b` differ by at most `tolerance` of `b`.
#[track_caller]
pub(crate) fn assert_close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs(), "{a} is not {b}");
}
