//! Small surfaces that the tests share.

#![allow(dead_code)] // No test program uses all of them.

use geobench_mesh::{Mesh, Report, TriangleSoup};

/// The mesh of `soup`, which must be usable and keep every promise of a mesh.
#[track_caller]
pub(crate) fn mesh_of(soup: TriangleSoup) -> (Mesh, Report) {
    let (mesh, report) = Mesh::from_soup(soup).expect("the soup is usable");
    mesh.sanity_check()
        .expect("the mesh keeps all its promises");
    (mesh, report)
}

/// Positions on a parabola in space, no three of them on a line, for tests of connectivity alone.
pub(crate) fn any_positions(count: u32) -> Vec<[f64; 3]> {
    (0..count)
        .map(f64::from)
        .map(|x| [x, x * x, x * x * x])
        .collect()
}

/// Triangles with [`any_positions`].
pub(crate) fn abstract_soup(vertex_count: u32, triangles: &[[u32; 3]]) -> TriangleSoup {
    TriangleSoup::new(any_positions(vertex_count), triangles.to_vec())
}

/// `columns` by `rows` unit squares in the plane, each cut into two triangles.
pub(crate) fn grid(columns: u32, rows: u32) -> TriangleSoup {
    let place = |x: u32, y: u32| y * (columns + 1) + x;
    let positions = (0..=rows)
        .flat_map(|y| (0..=columns).map(move |x| [f64::from(x), f64::from(y), 0.0]))
        .collect();
    let mut triangles = Vec::new();
    for y in 0..rows {
        for x in 0..columns {
            let [a, b] = [place(x, y), place(x + 1, y)];
            let [c, d] = [place(x, y + 1), place(x + 1, y + 1)];
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    TriangleSoup::new(positions, triangles)
}

/// A unit cube of 12 triangles. Vertex `x + 2y + 4z` lies at `(x, y, z)`.
pub(crate) fn cube() -> TriangleSoup {
    let positions = (0..8u32)
        .map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from))
        .collect();
    let squares = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = squares
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    TriangleSoup::new(positions, triangles)
}

/// The triangles of a tetrahedron on vertices `first..first + 4`, wound outwards.
pub(crate) fn tetrahedron([a, b, c, d]: [u32; 4]) -> [[u32; 3]; 4] {
    [[a, c, b], [a, b, d], [b, c, d], [c, a, d]]
}

/// A torus of `around` by `along` squares, each cut into two triangles; both at least 3.
pub(crate) fn torus(around: u32, along: u32) -> TriangleSoup {
    let angle = |i: u32, n: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
    let positions = (0..along)
        .flat_map(|j| {
            (0..around).map(move |i| {
                let (u, v) = (angle(i, around), angle(j, along));
                let radius = 3.0 + u.cos();
                [radius * v.cos(), radius * v.sin(), u.sin()]
            })
        })
        .collect();
    let place = |i: u32, j: u32| (j % along) * around + i % around;
    let mut triangles = Vec::new();
    for j in 0..along {
        for i in 0..around {
            let [a, b] = [place(i, j), place(i + 1, j)];
            let [c, d] = [place(i, j + 1), place(i + 1, j + 1)];
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    TriangleSoup::new(positions, triangles)
}

/// `count` triangles around vertex 0, the ring in the order of its angle `step`; closed or open.
/// The ring goes up and down so that the total angle may pass 2π.
pub(crate) fn fan(count: u32, closed: bool, heights: impl Fn(u32) -> f64) -> TriangleSoup {
    let ring = if closed { count } else { count + 1 };
    let mut positions = vec![[0.0; 3]];
    for i in 0..ring {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
        positions.push([angle.cos(), angle.sin(), heights(i)]);
    }
    let triangles = (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % ring]).collect();
    TriangleSoup::new(positions, triangles)
}
