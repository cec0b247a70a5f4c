//! Paths of every solver: on all small surfaces of the zoo, between points in faces and on edges,
//! and with ties.

mod judged;

use geobench_mesh::{FaceId, Mesh, SplitMix64, SurfacePoint, VertexId};
use geobench_mmp::mmp;
use geobench_oracle::zoo;
use geobench_paths::{PathPlace, Paths, TraceError};
use geobench_vtp::VtpFast;
use geobench_window::{Goal, Solver};

use crate::judged::oracle_mesh::mesh_of;
use crate::judged::{check, report, solvers};

#[test]
fn paths_are_straight_and_as_long_as_the_distances() {
    let mut failures = Vec::new();
    for model in zoo::small() {
        let mesh = mesh_of(&model).unwrap();
        check(&model.name, &mesh, &model.sources[..1], &mut failures);
        check(&model.name, &mesh, &model.sources, &mut failures);
    }
    report(&failures);
}

#[test]
fn a_run_for_one_target_traces_the_same_path() {
    let mesh = Mesh::generate("sphere,subdiv=3,noise=0.1,seed=3").unwrap();
    for (name, mut solver) in solvers(&mesh) {
        let all = Paths::find(solver.as_mut(), &mesh, 5, &Goal::everything()).unwrap();
        for target in [6, 77, 300] {
            let one = Paths::find(solver.as_mut(), &mesh, 5, &Goal::targets([target])).unwrap();
            let target = VertexId::new(target);
            assert_eq!(one.to(target), all.to(target), "{name} to {target}");
        }
    }
}

#[test]
fn distances_that_cannot_be_those_of_the_mesh_are_an_error() {
    let mesh = Mesh::generate("grid,n=2").unwrap();
    let distances = mmp(&mesh).solve(&[0.into()]).unwrap().distances;
    let found = |distances: &[f64]| Paths::of_distances(&mesh, distances.to_vec());
    let path = found(&distances).unwrap().to(8.into()).unwrap().unwrap();
    assert!((path.length - 8.0_f64.sqrt()).abs() < 1e-12);
    assert_eq!(
        found(&distances[..7]).map(drop),
        Err(TraceError::DistanceCount {
            distances: 7,
            vertices: 9
        })
    );
    for wrong in [f64::NAN, -1.0] {
        let mut distances = distances.clone();
        distances[4] = wrong;
        let error = TraceError::NoDistance(4.into());
        assert_eq!(found(&distances).map(drop), Err(error));
    }
}

#[test]
fn targets_that_do_not_exist_or_are_not_reached_have_no_path() {
    let apart = mesh_of(&zoo::with_isolated_vertices(&zoo::octahedron(), &[0])).unwrap();
    let mut solver = VtpFast::new(&apart);
    let paths = Paths::find(&mut solver, &apart, 3, &Goal::everything()).unwrap();
    let lonely = apart
        .vertices()
        .find(|&v| apart.outgoing(v).is_empty())
        .unwrap();
    assert_eq!(paths.to(lonely), Ok(None));
    let missing = VertexId::new(9999);
    assert!(matches!(
        paths.to(missing),
        Err(TraceError::NoSuchVertex { .. })
    ));
    let from_itself = Paths::find(&mut solver, &apart, lonely, &Goal::everything()).unwrap();
    let path = from_itself.to(lonely).unwrap().unwrap();
    assert_eq!((path.length, path.points.len()), (0.0, 1));
    assert_eq!(path.points[0].face, None);
}

#[test]
fn paths_between_points_of_faces_and_edges_are_told_of_the_original() {
    let mesh = Mesh::generate("sphere,subdiv=2,noise=0.1,seed=3").unwrap();
    let mut random = SplitMix64::new(5);
    for _ in 0..50 {
        let mut point = || -> SurfacePoint {
            let face = mesh.faces().nth(random.below(mesh.face_count())).unwrap();
            let [a, b, c] = [random.unit(), random.unit(), random.unit()];
            let sum = a + b + c;
            if random.below(2) == 0 {
                return mesh
                    .point_in_face(face, [a / sum, b / sum, c / sum])
                    .unwrap();
            }
            let [from, to, _] = mesh.face_vertices(face);
            mesh.point_on_edge([from, to], a).unwrap()
        };
        let points = [point(), point()];
        let refined = mesh.with_points(&points).unwrap();
        let [from, to] = [refined.vertices[0], refined.vertices[1]];
        let mut solver = VtpFast::new(&refined.mesh);
        let paths = Paths::find(&mut solver, &refined.mesh, from, &Goal::targets([to])).unwrap();
        let path = paths.to(to).unwrap().unwrap().of_original(&refined);
        assert_eq!(path.length, paths.to(to).unwrap().unwrap().length);
        let line = path.polyline(&mesh);
        let ends = [line[0], line[line.len() - 1]];
        for (end, point) in ends.iter().zip(&points) {
            let expected = mesh.position_of(point).unwrap();
            assert!(
                (0..3).all(|k| (end[k] - expected[k]).abs() < 1e-14),
                "{end:?}"
            );
        }
        // Every point but the ends is on an edge or a vertex, and the line is as long as the path.
        let inner = &path.points[1..path.points.len() - 1];
        assert!(inner.iter().all(|point| point.place != PathPlace::Face));
        let steps = line.windows(2).map(|w| {
            let d: f64 = (0..3).map(|k| (w[0][k] - w[1][k]).powi(2)).sum();
            d.sqrt()
        });
        let length: f64 = steps.sum();
        assert!(
            (length - path.length).abs() <= 1e-12 * length,
            "{length}, {}",
            path.length
        );
    }
}

/// Surfaces on which many vertices have several shortest paths.
const TIES: [&str; 3] = ["grid,n=8", "cube,n=4", "octahedron,subdiv=2"];

#[test]
fn of_several_shortest_paths_it_is_always_the_same_one() {
    for spec in TIES {
        let mesh = Mesh::generate(spec).unwrap();
        let again = solvers(&mesh).into_iter();
        for ((name, mut solver), (_, mut other)) in solvers(&mesh).into_iter().zip(again) {
            let first = Paths::find(solver.as_mut(), &mesh, 0, &Goal::everything()).unwrap();
            // One solver has run before, from another source; the other one is new.
            solver.solve(&[VertexId::new(9)]).unwrap();
            for solver in [&mut solver, &mut other] {
                let paths = Paths::find(solver.as_mut(), &mesh, 0, &Goal::everything()).unwrap();
                for v in mesh.vertices() {
                    assert_eq!(paths.to(v), first.to(v), "{spec}, {name} to {v}");
                }
            }
        }
    }
}

#[test]
fn paths_between_points_with_ties_are_straight_and_always_the_same() {
    let mut failures = Vec::new();
    for spec in TIES {
        let mesh = Mesh::generate(spec).unwrap();
        let last = mesh.faces().last().unwrap();
        let [a, b, _] = mesh.face_vertices(last);
        let points = [
            mesh.point_in_face(FaceId::new(0), [0.25, 0.25, 0.5])
                .unwrap(),
            mesh.point_in_face(last, [1.0 / 3.0; 3]).unwrap(),
            mesh.point_on_edge([a, b], 0.5).unwrap(),
        ];
        let refined = mesh.with_points(&points).unwrap();
        let ends: Vec<u32> = refined.vertices.iter().map(|v| v.raw()).collect();
        check(spec, &refined.mesh, &ends[..1], &mut failures);
        for (name, mut solver) in solvers(&refined.mesh) {
            let mut find = || {
                let goal = Goal::targets(ends[1..].iter().copied());
                let paths = Paths::find(solver.as_mut(), &refined.mesh, ends[0], &goal).unwrap();
                let told = refined.vertices[1..].iter().map(|&v| {
                    let path = paths.to(v).unwrap().unwrap();
                    path.of_original(&refined)
                });
                told.collect::<Vec<_>>()
            };
            let first = find();
            assert_eq!(find(), first, "{spec}, {name}");
        }
    }
    report(&failures);
}
