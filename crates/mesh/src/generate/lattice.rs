//! Connectivity of rings of vertices: tori, and surfaces of revolution with or without poles.

/// Triangles of a torus of `rings` rings of `per_ring` vertices each, ring after ring.
///
/// Ring `i` joins ring `i + 1` vertex by vertex. The last ring joins the first with an offset of
/// `shift` vertices. Triangles are counter-clockwise if the ring number increases to the right and
/// the vertex number upwards. Both counts must be at least 3.
pub(super) fn wrapped(rings: usize, per_ring: usize, shift: usize) -> Vec<[u32; 3]> {
    let mut triangles = Vec::with_capacity(2 * rings * per_ring);
    for i in 0..rings {
        let (next, shift) = if i + 1 == rings {
            (0, shift)
        } else {
            (i + 1, 0)
        };
        let vertex = |ring: usize, j: usize| (ring * per_ring + j % per_ring) as u32;
        for j in 0..per_ring {
            let (a, d) = (vertex(i, j), vertex(i, j + 1));
            let (b, c) = (vertex(next, j + shift), vertex(next, j + shift + 1));
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles
}

/// Triangles of `rings` rings of `slices` vertices stacked downwards. They face outwards if rings
/// are counter-clockwise seen from above.
///
/// Vertices are numbered: the top pole if there is one, the rings from above, the bottom pole if
/// there is one. A pole is joined to the whole ring next to it.
pub(super) fn stacked(slices: usize, rings: usize, top: bool, bottom: bool) -> Vec<[u32; 3]> {
    let vertex = |ring: usize, j: usize| (usize::from(top) + ring * slices + j % slices) as u32;
    let mut triangles =
        Vec::with_capacity(stacked_count(slices as u64, rings as u64, top, bottom) as usize);
    if top {
        triangles.extend((0..slices).map(|j| [0, vertex(0, j), vertex(0, j + 1)]));
    }
    for upper in 0..rings - 1 {
        for j in 0..slices {
            let (a, d) = (vertex(upper, j), vertex(upper, j + 1));
            let (b, c) = (vertex(upper + 1, j), vertex(upper + 1, j + 1));
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    if bottom {
        let pole = vertex(rings, 0);
        let last = rings - 1;
        triangles.extend((0..slices).map(|j| [pole, vertex(last, j + 1), vertex(last, j)]));
    }
    triangles
}

/// The number of triangles that [`stacked`] makes.
pub(super) const fn stacked_count(slices: u64, rings: u64, top: bool, bottom: bool) -> u64 {
    slices * (2 * (rings - 1) + top as u64 + bottom as u64)
}
