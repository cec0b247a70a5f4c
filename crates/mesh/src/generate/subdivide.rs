//! Midpoint subdivision.

use crate::edges::EdgeGroups;
use crate::soup::TriangleSoup;

/// Splits every triangle into four at the midpoints of its sides: the same surface, finer.
///
/// Old vertices keep their numbers and positions. One new vertex follows for each edge, in the
/// order of the edge's smaller and then larger vertex. Triangle `t` becomes triangles `4t` to `4t +
/// 3`: those at its three corners and the middle one, oriented as it was. `file_faces` gives their
/// face in the file. Boundaries, pinched vertices, several components and non-manifold edges are
/// allowed. A triangle that names a missing or repeated vertex is kept, for validation to report.
///
/// Takes O(n) time for n triangles.
///
/// # Panics
///
/// If the result would have more half-edges or vertices than 32 bits can number: above some 350
/// million triangles. [`Modifiers::apply`](super::Modifiers::apply) refuses long before that.
pub fn midpoint_subdivide(soup: &TriangleSoup) -> TriangleSoup {
    let mut fine = split(soup);
    // Repeats the order in which `split` numbers children and kept triangles.
    fine.file_faces = (0..soup.triangles.len() as u32)
        .flat_map(|t| {
            let children = if splits(soup, t as usize) { 4 } else { 1 };
            std::iter::repeat_n(soup.file_face(t), children)
        })
        .collect();
    fine
}

/// Whether the triangle has three different vertices that exist.
pub(super) fn splits(soup: &TriangleSoup, triangle: usize) -> bool {
    let [a, b, c] = soup.triangles[triangle];
    let exists = |v: u32| (v as usize) < soup.positions.len();
    a != b && b != c && c != a && exists(a) && exists(b) && exists(c)
}

/// [`midpoint_subdivide`] without `file_faces`.
pub(super) fn split(soup: &TriangleSoup) -> TriangleSoup {
    let old = soup.positions.len();
    let sound: Vec<u32> = (0..soup.triangles.len() as u32)
        .filter(|&t| splits(soup, t as usize))
        .collect();
    let corners: Vec<[u32; 3]> = sound.iter().map(|&t| soup.triangles[t as usize]).collect();
    assert!(
        u32::try_from(old as u64 + 12 * corners.len() as u64).is_ok(),
        "too many triangles to subdivide: {}",
        corners.len()
    );
    let mut positions = soup.positions.clone();
    let mut midpoints = vec![[0; 3]; corners.len()];
    for edge in EdgeGroups::new(old, &corners).iter() {
        let midpoint = positions.len() as u32;
        let (p, q) = (positions[edge.low as usize], positions[edge.high as usize]);
        positions.push([0, 1, 2].map(|k| f64::midpoint(p[k], q[k])));
        for h in edge.half_edges() {
            midpoints[h as usize / 3][h as usize % 3] = midpoint;
        }
    }
    let mut triangles = Vec::with_capacity(soup.triangles.len() + 3 * corners.len());
    let mut next_sound = 0;
    for (t, &[a, b, c]) in soup.triangles.iter().enumerate() {
        if sound.get(next_sound) == Some(&(t as u32)) {
            let [ab, bc, ca] = midpoints[next_sound];
            triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            next_sound += 1;
        } else {
            triangles.push([a, b, c]);
        }
    }
    TriangleSoup {
        notes: soup.notes.clone(),
        ..TriangleSoup::new(positions, triangles)
    }
}
