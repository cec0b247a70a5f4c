//! Cube and box: the surface of a block of cells, with shared vertices at edges and corners.

use super::keys::{Key, Kind, Params};
use super::plate::MAX_SIDE;
use crate::soup::TriangleSoup;

pub(super) const CUBE_KEYS: &[Key] = &[
    Key::whole("n", 20, [1, 5_000], "cells along each side"),
    Key::real("side", 1.0, [1e-9, 1e9], "length of a side"),
];

pub(super) const BOX_KEYS: &[Key] = &[
    Key::real("a", 3.0, [1e-9, 1e9], "side along x"),
    Key::real("b", 2.0, [1e-9, 1e9], "side along y"),
    Key::real("c", 1.0, [1e-9, 1e9], "side along z"),
    Key {
        name: "n",
        kind: Kind::All(&["nx", "ny", "nz"]),
        summary: "cells along every side",
    },
    Key::whole("nx", 30, [1, MAX_SIDE], "cells along x"),
    Key::whole("ny", 20, [1, MAX_SIDE], "cells along y"),
    Key::whole("nz", 10, [1, MAX_SIDE], "cells along z"),
];

pub(super) fn cube_faces(params: &Params<'_>) -> u64 {
    faces([params.whole("n"); 3])
}

pub(super) fn cube(params: &Params<'_>) -> TriangleSoup {
    block([params.real("side"); 3], [params.count("n"); 3])
}

pub(super) fn box_faces(params: &Params<'_>) -> u64 {
    faces(["nx", "ny", "nz"].map(|key| params.whole(key)))
}

pub(super) fn cuboid(params: &Params<'_>) -> TriangleSoup {
    block(
        ["a", "b", "c"].map(|key| params.real(key)),
        ["nx", "ny", "nz"].map(|key| params.count(key)),
    )
}

const fn faces([nx, ny, nz]: [u64; 3]) -> u64 {
    4 * (nx * ny + ny * nz + nz * nx)
}

/// The surface of a block with one corner at the origin and the opposite one at `sides`.
///
/// Vertices are numbered layer by layer in z and row by row in y. Vertex 0 is the origin, the last
/// one the opposite corner. Coordinates are integers where a side is as long as its number of
/// cells.
fn block(sides: [f64; 3], cells: [usize; 3]) -> TriangleSoup {
    let [nx, ny, nz] = cells;
    let mut positions = Vec::new();
    for z in 0..=nz {
        for y in 0..=ny {
            let inner = 0 < z && z < nz && 0 < y && y < ny;
            for x in (0..=nx).step_by(if inner { nx } else { 1 }) {
                let at = [x, y, z];
                positions.push([0, 1, 2].map(|k| sides[k] * at[k] as f64 / cells[k] as f64));
            }
        }
    }
    let mut triangles = Vec::with_capacity(faces(cells.map(|n| n as u64)) as usize);
    for normal in 0..3 {
        // The outward direction is u × v on the far side and v × u on the near side.
        let (u, v) = ((normal + 1) % 3, (normal + 2) % 3);
        for (offset, u, v) in [(0, v, u), (cells[normal], u, v)] {
            for i in 0..cells[v] {
                for j in 0..cells[u] {
                    let corner = |du, dv| {
                        let mut at = [0; 3];
                        at[normal] = offset;
                        at[u] = j + du;
                        at[v] = i + dv;
                        number(cells, at)
                    };
                    let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    triangles.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
    }
    TriangleSoup::new(positions, triangles)
}

/// Number of the vertex at a surface point of the lattice.
fn number([nx, ny, nz]: [usize; 3], [x, y, z]: [usize; 3]) -> u32 {
    let full_layer = (nx + 1) * (ny + 1);
    let rim = 2 * (nx + ny);
    let start = if z == 0 {
        0
    } else {
        full_layer + (z - 1) * rim
    };
    let within = if z == 0 || z == nz {
        y * (nx + 1) + x
    } else if y == 0 {
        x
    } else if y == ny {
        nx + 1 + 2 * (ny - 1) + x
    } else {
        // Rows between the first and the last have two vertices, x = 0 and x = nx.
        nx + 1 + 2 * (y - 1) + usize::from(x == nx)
    };
    (start + within) as u32
}
