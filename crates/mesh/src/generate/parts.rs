//! Cutting faces into equal parts.

use super::subdivide::splits;
use crate::edges::EdgeGroups;
use crate::soup::TriangleSoup;

/// Cuts every edge into `parts` equal parts, and every triangle into `parts`² triangles. The
/// surface stays the same. The resolutions lie between those of
/// [`midpoint_subdivide`](super::midpoint_subdivide).
///
/// Old vertices keep their numbers and positions. Those within edges follow, edge by edge in the
/// order of `midpoint_subdivide`, from the edge's smaller vertex to its larger one; then those
/// within triangles. The parts of a triangle are consecutive, have its orientation, and have its
/// file face in `file_faces`. A triangle that names a vertex twice, or a missing vertex, is kept
/// for validation to report.
///
/// Takes O(n parts^2) time for n triangles.
///
/// # Panics
///
/// If `parts` is 0, or the result would have more vertices than 32 bits can number.
/// [`Modifiers::apply`](super::Modifiers::apply) refuses long before that.
pub(crate) fn cut_into_parts(soup: &TriangleSoup, parts: u32) -> TriangleSoup {
    assert!(parts > 0, "an edge has at least one part");
    let old = soup.positions.len();
    let sound: Vec<u32> = (0..soup.triangles.len() as u32)
        .filter(|&t| splits(soup, t as usize))
        .collect();
    let corners: Vec<[u32; 3]> = sound.iter().map(|&t| soup.triangles[t as usize]).collect();
    let most = old as u64 + corners.len() as u64 * u64::from(parts + 2).pow(2);
    assert!(
        u32::try_from(most).is_ok(),
        "too many parts: {most} vertices"
    );
    let mut positions = soup.positions.clone();
    // For each side of each sound triangle, the first vertex within the edge, counted from its
    // smaller end.
    let mut firsts = vec![[0; 3]; corners.len()];
    for edge in EdgeGroups::new(old, &corners).iter() {
        let first = positions.len() as u32;
        let (p, q) = (positions[edge.low as usize], positions[edge.high as usize]);
        positions.extend((1..parts).map(|i| between(p, q, i, parts)));
        for h in edge.half_edges() {
            firsts[h as usize / 3][h as usize % 3] = first;
        }
    }
    let mut fine = TriangleSoup::new(positions, Vec::new());
    fine.notes.clone_from(&soup.notes);
    let mut next_sound = 0;
    for (t, &triangle) in soup.triangles.iter().enumerate() {
        let before = fine.triangles.len();
        if sound.get(next_sound) == Some(&(t as u32)) {
            cut(&mut fine, triangle, firsts[next_sound], parts);
            next_sound += 1;
        } else {
            fine.triangles.push(triangle);
        }
        let parts = fine.triangles.len() - before;
        let file_face = soup.file_face(t as u32);
        fine.file_faces
            .extend(std::iter::repeat_n(file_face, parts));
    }
    fine
}

/// The point after `i` of `n` equal steps from `p` to `q`.
fn between(p: [f64; 3], q: [f64; 3], i: u32, n: u32) -> [f64; 3] {
    let share = f64::from(i) / f64::from(n);
    [0, 1, 2].map(|k| p[k] + (q[k] - p[k]) * share)
}

/// Adds the parts of a triangle, row by row from its corner `a`, and the vertices within it.
fn cut(fine: &mut TriangleSoup, [a, b, c]: [u32; 3], firsts: [u32; 3], parts: u32) {
    // The vertex after `i` steps from `from` to `to`.
    let on_side = |from: u32, to: u32, first: u32, i: u32| match i {
        0 => from,
        i if i == parts => to,
        i if from < to => first + i - 1,
        i => first + parts - i - 1,
    };
    let [ab, bc, ca] = firsts;
    let mut row = vec![a];
    for i in 1..=parts {
        let (left, right) = (on_side(a, b, ab, i), on_side(a, c, ca, i));
        let mut next = Vec::with_capacity(i as usize + 1);
        for j in 0..=i {
            next.push(if j == 0 {
                left
            } else if j == i {
                right
            } else if i == parts {
                on_side(b, c, bc, j)
            } else {
                let ends = [left, right].map(|v| fine.positions[v as usize]);
                fine.positions.push(between(ends[0], ends[1], j, i));
                fine.positions.len() as u32 - 1
            });
        }
        for j in 0..i as usize {
            if j > 0 {
                fine.triangles.push([row[j - 1], next[j], row[j]]);
            }
            fine.triangles.push([row[j], next[j], next[j + 1]]);
        }
        row = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Spec, generate, midpoint_subdivide};
    use crate::measure::MeshMeasures;
    use crate::mesh::Mesh;

    fn soup(spec: &str) -> TriangleSoup {
        generate(&spec.parse::<Spec>().unwrap()).unwrap()
    }

    fn area(soup: &TriangleSoup) -> f64 {
        let triangles = soup.triangles.iter();
        let sum = triangles.map(|t| {
            let [a, b, c] = t.map(|v| soup.positions[v as usize]);
            let (u, v) = (
                [0, 1, 2].map(|k| b[k] - a[k]),
                [0, 1, 2].map(|k| c[k] - a[k]),
            );
            let cross = [0, 1, 2].map(|k| {
                let (l, m) = ((k + 1) % 3, (k + 2) % 3);
                u[l] * v[m] - u[m] * v[l]
            });
            cross.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0
        });
        sum.sum()
    }

    #[test]
    fn parts_make_the_same_surface_of_a_sound_mesh() {
        let measure = |mesh: &Mesh| MeshMeasures::of(mesh);
        for model in ["gen:holes", "gen:sphere,subdiv=1", "gen:terrain,n=5,seed=1"] {
            let coarse = soup(model);
            let (before, _) = Mesh::from_soup(coarse.clone()).unwrap();
            for parts in 1..6 {
                let fine = cut_into_parts(&coarse, parts);
                assert_eq!(
                    fine.positions[..coarse.positions.len()],
                    coarse.positions[..]
                );
                let faces = coarse.triangles.len() * (parts * parts) as usize;
                assert_eq!(fine.triangles.len(), faces);
                assert!((area(&fine) / area(&coarse) - 1.0).abs() < 1e-12);
                let (mesh, _) = Mesh::from_soup(fine).unwrap();
                assert_eq!(
                    measure(&before).boundary_edges * parts as usize,
                    measure(&mesh).boundary_edges
                );
                assert_eq!(measure(&before).genus, measure(&mesh).genus);
            }
        }
    }

    #[test]
    fn one_part_changes_nothing_and_two_are_those_between_midpoints() {
        let coarse = soup("gen:cube,n=2");
        let one = cut_into_parts(&coarse, 1);
        assert_eq!(
            (&one.positions, &one.triangles),
            (&coarse.positions, &coarse.triangles)
        );
        let (two, halves) = (cut_into_parts(&coarse, 2), midpoint_subdivide(&coarse));
        assert_eq!(two.positions, halves.positions);
        let sorted = |soup: &TriangleSoup| {
            let mut triangles = soup.triangles.clone();
            for t in &mut triangles {
                let least = (0..3).min_by_key(|&k| t[k]).unwrap();
                t.rotate_left(least);
            }
            triangles.sort_unstable();
            triangles
        };
        assert_eq!(sorted(&two), sorted(&halves));
    }

    #[test]
    fn a_triangle_without_an_inside_is_kept() {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let broken = TriangleSoup::new(positions, vec![[0, 1, 1], [0, 1, 2], [0, 1, 7]]);
        let fine = cut_into_parts(&broken, 3);
        assert_eq!(fine.triangles.len(), 11);
        assert_eq!(
            (fine.triangles[0], fine.triangles[10]),
            ([0, 1, 1], [0, 1, 7])
        );
        assert_eq!(fine.file_face(9), 1);
    }
}
