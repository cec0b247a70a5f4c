use super::*;
use crate::{MeshMeasures, SplitMix64};

/// A number from 0 to 1.
fn number(random: &mut SplitMix64) -> f64 {
    (random.next() >> 11) as f64 / (1_u64 << 53) as f64
}

/// A point of any kind in one of the first `faces` faces; one in three is close to a corner.
fn any_point(mesh: &Mesh, faces: usize, random: &mut SplitMix64) -> SurfacePoint {
    let face = FaceId::new(random.below(faces) as u32);
    let corners = mesh.face_vertices(face);
    let near = [1.0, 1e-4, 1e-9][random.below(3)];
    let k = random.below(3);
    if random.below(4) == 0 {
        let ends = [corners[k], corners[(k + 1) % 3]];
        return mesh.point_on_edge(ends, near * number(random)).unwrap();
    }
    let (u, v) = (number(random), number(random));
    let (u, v) = if u + v > 1.0 {
        (1.0 - u, 1.0 - v)
    } else {
        (u, v)
    };
    let mut weights = [near * u; 3];
    weights[(k + 1) % 3] = near * v;
    weights[k] = 1.0 - near * (u + v);
    mesh.point_in_face(face, weights).unwrap()
}

/// Checks that the half-edges around each vertex have the order of a mesh that is built anew.
fn check_rings(mesh: &Mesh) {
    for v in mesh.vertices() {
        let mut sorted = mesh.outgoing(v).to_vec();
        sorted.sort_unstable();
        let expected = crate::build::in_fans(&sorted, |h| mesh.twin(h));
        assert_eq!(mesh.outgoing(v), expected);
    }
}

/// Checks that an insertion made in place gives `refined` and can be undone.
fn check_undo(mesh: &Mesh, points: &[SurfacePoint], refined: &Refined) {
    let insertion = mesh.insertion(points).unwrap();
    let mut changed = mesh.clone();
    let undo = changed.splice(insertion.splice());
    assert_eq!(*changed.data, *refined.mesh.data);
    changed.splice(&undo);
    assert_eq!(*changed.data, *mesh.data);
}

/// Checks that `refined` has the same surface as `mesh`.
fn check(mesh: &Mesh, refined: &Refined) -> Result<(), String> {
    let fine = &refined.mesh;
    fine.sanity_check()?;
    check_rings(fine);
    let (coarse, finer) = (MeshMeasures::of(mesh), MeshMeasures::of(fine));
    let same = |what, a: usize, b: usize| {
        if a == b {
            Ok(())
        } else {
            Err(format!("{what}: {a} became {b}"))
        }
    };
    same("genus", coarse.genus, finer.genus)?;
    same("components", coarse.components, finer.components)?;
    same(
        "boundary loops",
        coarse.boundary_loops,
        finer.boundary_loops,
    )?;
    same("saddles", coarse.saddles, finer.saddles)?;
    for v in fine.vertices().skip(mesh.vertex_count()) {
        let mut sides = fine.outgoing(v).iter().flat_map(|h| [*h, h.prev()]);
        let is_on_junction = sides.any(|h| !fine.junction(h).is_empty());
        if fine.is_saddle(v) || fine.is_pinched(v) != is_on_junction {
            return Err(format!("{v:?} is not flat"));
        }
        let measured: f64 = fine
            .outgoing(v)
            .iter()
            .map(|&h| {
                let [x, y] = fine.apex(h);
                libm::atan2(y, x)
            })
            .sum();
        if (measured - fine.total_angle(v)).abs() > 1e-9 {
            return Err(format!("the angle at {v:?} is {measured}"));
        }
    }
    // Every face is the sum of its parts.
    let area = |mesh: &Mesh, face: FaceId| {
        let h = face.half_edge(0);
        mesh.length(h) * mesh.apex(h)[1]
    };
    let mut sums = vec![0.0; mesh.face_count()];
    for face in fine.faces() {
        sums[refined.parent(face).index()] += area(fine, face);
    }
    for (face, sum) in mesh.faces().zip(sums) {
        let whole = area(mesh, face);
        if (sum - whole).abs() > 1e-12 * whole {
            return Err(format!(
                "{face:?} of twice the area {whole} has parts of {sum}"
            ));
        }
    }
    // So is every edge of the boundary.
    let rim = |mesh: &Mesh| -> f64 {
        let open = mesh.half_edges().filter(|&h| mesh.twin(h).is_none());
        open.map(|h| mesh.length(h)).sum()
    };
    if (rim(mesh) - rim(fine)).abs() > 1e-12 * rim(mesh) {
        return Err("the boundary has another length".to_owned());
    }
    Ok(())
}

/// Three sheets on a line of edges, one of them turned over, and a Möbius strip.
fn with_junctions() -> [Mesh; 2] {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for x in [0.0, 1.0, 2.0] {
        positions.extend([[x, 0.0, 0.0], [x, 1.0, 0.0], [x, -1.0, 0.0], [x, 0.0, 1.0]]);
    }
    for sheet in 1..4 {
        for i in [0, 4] {
            let [a, b, c, d] = [i, i + 4, i + sheet, i + 4 + sheet];
            triangles.extend([[a, b, c], [b, d, c]].map(|[p, q, r]| match sheet {
                3 => [q, p, r],
                _ => [p, q, r],
            }));
        }
    }
    let strip = [[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]];
    let of_strip = (0..5_u32).map(|i| [f64::from(i), f64::from(i * i), f64::from(i % 2)]);
    [
        Mesh::new(positions, triangles).unwrap(),
        Mesh::new(of_strip.collect(), strip.to_vec()).unwrap(),
    ]
}

#[test]
fn a_refined_mesh_has_the_same_junctions() {
    for mesh in with_junctions() {
        assert!(mesh.has_junctions());
        for seed in 0..200 {
            let mut random = SplitMix64::new(seed);
            let count = [1, 2, 5, 40][random.below(4)];
            let points: Vec<SurfacePoint> = (0..count)
                .map(|_| any_point(&mesh, mesh.face_count(), &mut random))
                .collect();
            let refined = mesh.with_points(&points).unwrap();
            check(&mesh, &refined).unwrap();
            check_undo(&mesh, &points, &refined);
            let length = |mesh: &Mesh| -> f64 {
                let sides = mesh.junction_sides();
                let edges = sides.filter(|&h| mesh.edge_of(h) == h);
                edges.map(|h| mesh.length(h)).sum()
            };
            let lengths = [&mesh, &refined.mesh].map(length);
            assert!((lengths[0] - lengths[1]).abs() < 1e-12 * lengths[0]);
            for h in refined.mesh.junction_sides() {
                let parents = refined
                    .mesh
                    .junction(h)
                    .iter()
                    .map(|h| refined.parent(h.face()));
                let count = refined.mesh.junction(h).len();
                assert_eq!(
                    parents.collect::<std::collections::BTreeSet<_>>().len(),
                    count
                );
            }
        }
    }
}

#[test]
fn a_refined_mesh_has_the_same_surface() {
    for spec in [
        "terrain,n=4,seed=4",
        "torus,faces=300,bump=0.2,seed=1",
        "anisotropic,faces=1000,g=8",
    ] {
        let mesh = Mesh::generate(spec).unwrap();
        for seed in 0..60 {
            let mut random = SplitMix64::new(seed);
            let faces = [1, 3, mesh.face_count()][random.below(3)];
            let count = [1, 2, 5, 40][random.below(4)];
            let points: Vec<SurfacePoint> = (0..count)
                .map(|_| any_point(&mesh, faces, &mut random))
                .collect();
            let refined = mesh.with_points(&points).unwrap();
            check(&mesh, &refined).unwrap_or_else(|e| panic!("{spec}, seed {seed}: {e}"));
            check_undo(&mesh, &points, &refined);
            for (point, vertex) in points.iter().zip(&refined.vertices) {
                let (a, b) = (
                    mesh.position_of(point).unwrap(),
                    refined.mesh.positions()[vertex.index()],
                );
                assert!(
                    (0..3).all(|i| (a[i] - b[i]).abs() < 1e-12),
                    "{spec}, seed {seed}"
                );
            }
        }
    }
}

#[test]
fn points_of_one_place_share_a_vertex_and_old_vertices_stay() {
    let mesh = Mesh::generate("cube,n=2").unwrap();
    let face = FaceId::new(5);
    let inside = mesh.point_in_face(face, [0.25, 0.25, 0.5]).unwrap();
    let close = mesh
        .point_in_face(face, [0.25 + 1e-14, 0.25 - 1e-14, 0.5])
        .unwrap();
    let [a, b, _] = mesh.face_vertices(face);
    let edge = mesh.point_on_edge([a, b], 0.3).unwrap();
    let same = mesh.point_on_edge([b, a], 0.7).unwrap();
    let refined = mesh
        .with_points(&[inside, edge, close, a.into(), same, inside])
        .unwrap();
    let [first, second] = [0, 1].map(|k| VertexId::new(mesh.vertex_count() as u32 + k));
    assert_eq!(refined.vertices, [first, second, first, a, second, first]);
    assert_eq!(refined.mesh.vertex_count(), mesh.vertex_count() + 2);
    // Nothing to add: the very same mesh.
    let same = mesh.with_points(&[a.into(), b.into()]).unwrap();
    assert_eq!(same.mesh.face_count(), mesh.face_count());
    assert_eq!(same.vertices, [a, b]);
}

#[test]
fn a_median_cut_by_many_points_has_no_sliver() {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, 3.0_f64.sqrt() / 2.0, 0.0]];
    let mesh = Mesh::new(positions, vec![[0, 1, 2]]).unwrap();
    let face = FaceId::new(0);
    let on_median = |w: f64| mesh.point_in_face(face, [(1.0 - w) / 2.0, (1.0 - w) / 2.0, w]);
    let points: Vec<SurfacePoint> = (1..20)
        .map(|i| on_median(f64::from(i) / 20.0).unwrap())
        .collect();
    let refined = mesh.with_points(&points).unwrap();
    check(&mesh, &refined).unwrap();
    let slivers = |v| refined.mesh.is_beside_sliver(v);
    assert!(!refined.mesh.vertices().any(slivers));
}

#[test]
fn far_from_the_origin_lengths_are_those_of_the_face() {
    let shift = 1e9;
    let positions =
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[x, y]| [x + shift, y + shift, shift]);
    let mesh = Mesh::new(positions.to_vec(), vec![[0, 1, 2]]).unwrap();
    let point = mesh.point_in_face(FaceId::new(0), [0.8, 0.1, 0.1]).unwrap();
    let refined = mesh.with_points(&[point]).unwrap();
    let (_, length) = refined
        .mesh
        .neighbours(refined.vertices[0])
        .find(|(v, _)| v.raw() == 0)
        .unwrap();
    assert!((length / (0.1 * 2.0_f64.sqrt()) - 1.0).abs() < 1e-14);
}

#[test]
fn a_refined_mesh_can_be_refined() {
    let mesh = Mesh::generate("terrain,n=3,seed=2").unwrap();
    let mut random = SplitMix64::new(3);
    let mut fine = mesh.clone();
    for _ in 0..6 {
        let points: Vec<_> = (0..5)
            .map(|_| any_point(&fine, fine.face_count(), &mut random))
            .collect();
        let refined = fine.with_points(&points).unwrap();
        check(&fine, &refined).unwrap();
        check_undo(&fine, &points, &refined);
        fine = refined.mesh;
    }
    let area = |mesh: &Mesh| MeshMeasures::of(mesh).area;
    assert!((area(&mesh) / area(&fine) - 1.0).abs() < 1e-12);
}

#[test]
fn points_of_another_mesh_are_refused() {
    let large = Mesh::generate("cube,n=4").unwrap();
    let small = Mesh::generate("octahedron,subdiv=0").unwrap();
    let face = FaceId::new(large.face_count() as u32 - 1);
    let inside = large.point_in_face(face, [0.2, 0.3, 0.5]).unwrap();
    assert!(matches!(
        small.with_points(&[inside]),
        Err(PointError::NoSuchFace { .. })
    ));
    let vertex = small.with_points(&[90.into()]);
    assert!(matches!(vertex, Err(PointError::NoSuchVertex { .. })));
}

#[test]
fn a_motion_keeps_lengths_and_takes_both_points_along() {
    // A quarter turn and a shift.
    let motion = Motion::between([[1.0, 0.0], [3.0, 0.0]], [[5.0, 5.0], [5.0, 7.0]]);
    for (from, to) in [
        ([1.0, 0.0], [5.0, 5.0]),
        ([3.0, 0.0], [5.0, 7.0]),
        ([1.0, 4.0], [1.0, 5.0]),
    ] {
        assert_eq!(motion.of(from), to);
    }
}
