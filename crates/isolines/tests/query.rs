//! Distances, gradients and paths at points of a field, beside solves on refined meshes.

use geobench_isolines::DistanceField;
use geobench_mesh::{FaceId, Mesh, SplitMix64, SurfacePoint, VertexId};
use geobench_mmp::mmp;
use geobench_oracle::nasty;
use geobench_vtp::VtpFast;
use geobench_window::Solver;

#[path = "../../oracle/tests/support/mesh.rs"]
mod oracle_mesh;

fn any_point(mesh: &Mesh, random: &mut SplitMix64) -> SurfacePoint {
    let face = FaceId::new(random.below(mesh.face_count()) as u32);
    let corners = mesh.face_vertices(face);
    match random.below(4) {
        0 => corners[1].into(),
        1 => mesh
            .point_on_edge([corners[0], corners[2]], random.unit())
            .unwrap(),
        _ => {
            let (u, v) = (0.5 * random.unit(), 0.5 * random.unit());
            mesh.point_in_face(face, [1.0 - u - v, u, v]).unwrap()
        }
    }
}

#[test]
fn a_field_knows_every_point_as_a_solve_on_the_split_mesh_does() {
    let mut random = SplitMix64::new(3);
    for spec in [
        "terrain,n=10,seed=3",
        "torus,faces=400,bump=0.2,seed=5",
        "cube,n=3",
        "grid,n=5",
    ] {
        let mesh = Mesh::generate(spec).unwrap();
        for sources in 1..=2 {
            let sources: Vec<_> = (0..sources)
                .map(|_| any_point(&mesh, &mut random))
                .collect();
            let field = DistanceField::new(&mesh, &sources).unwrap();
            for near in 0..30 {
                // Some targets in the faces of the sources.
                let target = if near < 6 {
                    let (face, _) = mesh.face_of(&sources[0]).unwrap();
                    let u = 0.8 * random.unit();
                    mesh.point_in_face(face, [0.9 - u, 0.1, u]).unwrap()
                } else {
                    any_point(&mesh, &mut random)
                };
                let points: Vec<_> = sources.iter().copied().chain([target]).collect();
                let refined = mesh.with_points(&points).unwrap();
                let (&to, from) = refined.vertices.split_last().unwrap();
                let solved = VtpFast::new(&refined.mesh).solve(from).unwrap();
                let expected = solved.distances[to.index()];
                let found = field.distance(&target).unwrap();
                assert!(
                    (found - expected).abs() <= 1e-12 * expected.max(1e-3),
                    "{spec}: {found} {expected}"
                );
                let path = field.path(&target).unwrap().unwrap();
                assert!(
                    (path.length - expected).abs() <= 1e-11 * expected.max(1e-3),
                    "{spec}"
                );
                if let Some(gradient) = field.gradient(&target).unwrap() {
                    let size: f64 = gradient.iter().map(|x| x * x).sum();
                    assert!((size - 1.0).abs() < 1e-9, "{spec}: {gradient:?}");
                    // The last piece of the path comes along the gradient.
                    let line = path.polyline(&mesh);
                    if let (None, [.., a, b]) = (target.vertex(), &line[..]) {
                        let step = [0, 1, 2].map(|k| b[k] - a[k]);
                        let along: f64 = (0..3).map(|k| step[k] * gradient[k]).sum();
                        let length = step.iter().map(|x| x * x).sum::<f64>().sqrt();
                        let in_face = matches!(target.place(), geobench_mesh::Place::Face(..));
                        assert!(
                            !in_face || length < 1e-9 || along > 0.999_999 * length,
                            "{spec}: {step:?} {gradient:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn every_vertex_but_a_source_has_a_gradient() {
    for spec in [
        "terrain,n=10,seed=3",
        "torus,faces=400,bump=0.2,seed=5",
        "grid,n=5",
    ] {
        let mesh = Mesh::generate(spec).unwrap();
        let inside = mesh.point_in_face(FaceId::new(7), [0.2, 0.3, 0.5]).unwrap();
        let field = DistanceField::new(&mesh, &[0.into(), inside]).unwrap();
        assert_eq!(field.gradient(&0.into()).unwrap(), None);
        for v in mesh.vertices().skip(1) {
            let gradient = field.gradient(&v.into()).unwrap();
            let gradient = gradient.unwrap_or_else(|| panic!("{spec}: {v:?}"));
            // The last piece of the path comes along it.
            let path = field.path(&v.into()).unwrap().unwrap();
            let line = path.polyline(&mesh);
            let [.., a, b] = &line[..] else {
                panic!("{spec}: {v:?} is no source");
            };
            let step = [0, 1, 2].map(|k| b[k] - a[k]);
            let along: f64 = (0..3).map(|k| step[k] * gradient[k]).sum();
            let length = step.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!(
                length < 1e-9 || along > 0.999_999 * length,
                "{spec}: {v:?}: {step:?} {gradient:?}"
            );
        }
    }
}

#[test]
fn points_that_do_not_exist_are_refused() {
    let [small, large] = ["grid,n=2", "grid,n=9"].map(|spec| Mesh::generate(spec).unwrap());
    let field = DistanceField::new(&small, &[0.into()]).unwrap();
    let point = large
        .point_in_face(FaceId::new(99), [0.2, 0.3, 0.5])
        .unwrap();
    assert!(field.distance(&point).is_err() && field.path(&point).is_err());
    assert!(field.gradient(&90.into()).is_err());
    assert_eq!(field.gradient(&0.into()).unwrap(), None);
}

/// Windows whose rays graze an edge, beside faces of no area, give their distances to no point in
/// front of them.
#[test]
fn a_field_knows_the_points_beside_flat_faces() {
    let mut random = SplitMix64::new(5);
    let seeds = [
        317, 329, 592, 642, 668, 838, 1239, 2155, 2910, 2992, 3338, 3801, 1164,
    ];
    for seed in seeds.into_iter().chain(0..120) {
        let Ok(mesh) = oracle_mesh::mesh_of(&nasty::mesh(seed).model) else {
            continue;
        };
        for _ in 0..3 {
            let source = VertexId::new(random.below(mesh.vertex_count()) as u32).into();
            let field = DistanceField::new(&mesh, &[source]).unwrap();
            let farthest = (field.distances().iter())
                .filter(|d| d.is_finite())
                .fold(mesh.longest_edge(), |a, &b| a.max(b));
            for _ in 0..8 {
                let target = any_point(&mesh, &mut random);
                let refined = mesh.with_points(&[source, target]).unwrap();
                let [from, to] = [0, 1].map(|k| refined.vertices[k]);
                let expected = mmp(&refined.mesh).solve(&[from]).unwrap().distances[to.index()];
                let found = field.distance(&target).unwrap();
                assert!(
                    (found - expected).abs() <= 1e-8 * farthest || found == expected,
                    "seed {seed}, {source:?} to {target:?}: {found:e}, but {expected:e}"
                );
            }
        }
    }
}
