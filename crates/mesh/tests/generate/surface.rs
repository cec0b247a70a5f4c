//! Measures a triangle soup from its definition, without the crate's own mesh.

use std::collections::HashSet;

use geobench_mesh::{Mesh, TriangleSoup};

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
    let mut joined: Vec<u32> = (0..soup.positions.len() as u32).collect();
    let (mut area, mut volume) = (0.0, 0.0);
    for t in &soup.triangles {
        for k in 0..3 {
            let (from, to) = (t[k], t[(k + 1) % 3]);
            assert!(
                directed.insert((from, to)),
                "{name}: edge {from}-{to} twice"
            );
            assert!(p(from) != p(to), "{name}: zero-length edge {from}-{to}");
            let (a, b) = (root(&mut joined, from), root(&mut joined, to));
            joined[a as usize] = b;
        }
        let [a, b, c] = t.map(p);
        let normal = cross(minus(b, a), minus(c, a));
        let twice_area = dot(normal, normal).sqrt();
        assert!(twice_area > 0.0, "{name}: triangle {t:?} has no area");
        area += twice_area / 2.0;
        volume += dot(a, normal) / 6.0;
    }
    let used: HashSet<u32> = soup.triangles.iter().flatten().copied().collect();
    assert_eq!(used.len(), soup.positions.len(), "{name}: unused vertices");
    let roots: HashSet<u32> = used.iter().map(|&v| root(&mut joined, v)).collect();
    assert_eq!(roots.len(), 1, "{name}: components");
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

fn root(joined: &mut [u32], mut v: u32) -> u32 {
    while joined[v as usize] != v {
        joined[v as usize] = joined[joined[v as usize] as usize];
        v = joined[v as usize];
    }
    v
}

pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(u: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ]
}

/// Asserts that `a` and `b` differ by at most `tolerance` of `b`.
#[track_caller]
pub(crate) fn assert_close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs(), "{a} is not {b}");
}
