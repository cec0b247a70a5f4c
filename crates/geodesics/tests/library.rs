//! The library as its users see it.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::{env, fs, io, thread};

use geodesics::solvers::*;
use geodesics::{Distances, Mesh, MeshError, SolveError, Solver, SurfacePoint, VertexId, VtpFast};

/// A unit square of two triangles, and a vertex that belongs to neither.
fn square() -> Mesh {
    let mut positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    positions.extend([[1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [5.0, 5.0, 5.0]]);
    Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

/// A small model with distances that independent programs agree on, beside the project or where
/// `GEOBENCH_SHARED` says.
fn suzanne() -> Option<(PathBuf, Vec<(usize, f64)>)> {
    let shared = env::var_os("GEOBENCH_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    let Ok(text) = fs::read_to_string(shared.join("expected/suzanne.s0.csv")) else {
        // Past the capture of test output, which would hide it.
        let _ = writeln!(io::stderr(), "SKIPPED: no {}", shared.display());
        return None;
    };
    let parse = |line: &str| {
        let (vertex, distance) = line.split_once(',')?;
        Some((vertex.parse().ok()?, distance.parse().ok()?))
    };
    let expected: Vec<_> = text.lines().skip(1).filter_map(parse).collect();
    assert!(!expected.is_empty());
    Some((shared.join("models/suzanne.obj"), expected))
}

#[test]
fn distances_are_those_of_independent_programs() {
    let Some((path, expected)) = suzanne() else {
        return;
    };
    let distances = Mesh::read(path).unwrap().distances_from(0).unwrap();
    for (vertex, e) in expected {
        let d = distances[vertex];
        assert!((d - e).abs() <= 1e-9 * e, "vertex {vertex}: {d} and {e}");
    }
}

#[test]
fn every_solver_can_be_stored_sent_and_asked_again() {
    let mesh = Mesh::generate("terrain,n=12,seed=3").unwrap();
    let expected = [0, 77].map(|source| mesh.distances_from(source).unwrap());
    let buckets = BucketOptions::default();
    let correcting = LabelCorrectingOptions::default();
    let solvers: Vec<Box<dyn Solver>> = vec![
        Box::new(mmp(&mesh)),
        Box::new(mmp_batched(&mesh, 1.0)),
        Box::new(mmp_fast(&mesh)),
        Box::new(mmp_edge(&mesh)),
        Box::new(ch(&mesh)),
        Box::new(ich1(&mesh)),
        Box::new(ich(&mesh)),
        Box::new(fwp_mmp(&mesh, buckets)),
        Box::new(fwp_ch(&mesh, buckets)),
        Box::new(lc_mmp(&mesh, correcting)),
        Box::new(lc_ch(&mesh, correcting)),
        Box::new(vtp_mmp(&mesh)),
        Box::new(vtp_ch(&mesh)),
        Box::new(Ftp::new(&mesh)),
        Box::new(Opftp::new(&mesh)),
        Box::new(Vtp::new(&mesh)),
        Box::new(Opvtp::new(&mesh)),
        Box::new(VtpExhaustive::new(&mesh)),
        Box::new(VtpTrimming::new(&mesh)),
        Box::new(VtpNoRule1::new(&mesh)),
        Box::new(VtpNoRules23::new(&mesh)),
        Box::new(EdgeBased::new(&mesh)),
        Box::new(VtpFast::new(&mesh)),
        Box::new(Pvtp::new(&mesh, 2)),
        Box::new(Pch::new(&mesh, 2)),
    ];
    drop(mesh);
    let ask = |mut solver: Box<dyn Solver>| {
        [0, 77].map(|source| solver.solve(&[VertexId::new(source)]).unwrap().distances)
    };
    let ask_all = move || solvers.into_iter().map(ask).collect::<Vec<_>>();
    let found = thread::spawn(ask_all).join().unwrap();
    for (i, found) in found.iter().enumerate() {
        for (d, e) in found.concat().iter().zip(expected.concat()) {
            assert!((d - e).abs() <= 1e-12 * e, "solver {i}: {d} and {e}");
        }
    }
}

#[test]
fn sources_are_a_number_an_id_or_several() {
    let mesh = square();
    let one = mesh.distances_from(0).unwrap();
    assert_eq!(mesh.distances_from(VertexId::new(0)), Ok(one));
    let two = mesh.distances_from([0, 2]).unwrap();
    assert_eq!(two[..4], [0.0, 1.0, 0.0, 1.0]);
    let ends: &[u32; 2] = &[0, 2];
    assert_eq!(mesh.distances_from(ends), Ok(two.clone()));
    assert_eq!(mesh.distances_from(&ends[..]), Ok(two.clone()));
    assert_eq!(mesh.distances_from(&vec![2, 0]), Ok(two.clone()));
    assert_eq!(mesh.distances_from([0, 2].map(VertexId::new)), Ok(two));
}

#[test]
fn points_on_edges_and_in_faces_are_sources() {
    let mesh = square();
    let centre = mesh.point_on_edge([0, 2].map(VertexId::new), 0.5).unwrap();
    let half = 0.5_f64.sqrt();
    for found in [
        mesh.distances_from(centre),
        mesh.distances_from([centre, centre]),
    ] {
        let found = found.unwrap();
        assert_eq!(found.len(), 5);
        assert!(found[..4].iter().all(|d| (d - half).abs() < 1e-15));
        assert_eq!(found[4], f64::INFINITY);
    }
    let mixed: [SurfacePoint; 2] = [centre, 1.into()];
    assert_eq!(mesh.distances_from(mixed).unwrap()[1], 0.0);
    let sphere = Mesh::generate("sphere,subdiv=2").unwrap();
    let far = sphere.point_in_face(99.into(), [0.2, 0.3, 0.5]).unwrap();
    assert_eq!(mesh.distances_from(far), Err(SolveError::NoSuchPoint));
}

#[test]
fn unreachable_vertices_are_infinitely_far() {
    let mesh = square();
    assert_eq!(mesh.distances_from(0).unwrap()[4], f64::INFINITY);
    let from_afar = mesh.distances_from(4).unwrap();
    assert_eq!(from_afar[4], 0.0);
    assert!(from_afar[..4].iter().all(|&d| d == f64::INFINITY));
}

#[test]
fn errors_name_the_vertex_or_source() {
    let mesh = square();
    assert_eq!(
        mesh.distances_from(5),
        Err(SolveError::NoSuchVertex {
            vertex: VertexId::new(5),
            vertices: 5
        })
    );
    let none: [u32; 0] = [];
    let refused = VtpFast::new(&mesh).distances_from(none);
    assert_eq!(refused, Err(SolveError::NoSource));

    let three_faces = vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]];
    let invalid = Mesh::new(vec![[0.0; 3], [1.0; 3]], three_faces).unwrap_err();
    assert!(invalid.report.is_fatal());

    assert!(matches!(Mesh::read("no.obj"), Err(MeshError::Read(_))));
    let generated = Mesh::generate("dodecahedron");
    assert!(matches!(generated, Err(MeshError::Generate(_))));

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.off");
    fs::write(&path, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n").unwrap();
    let error = Mesh::read(&path).unwrap_err();
    assert!(matches!(&error, MeshError::Invalid { .. }));
    let text = error.to_string();
    assert!(text.contains("bad.off") && text.contains('7'), "{text}");
}

#[test]
fn every_distance_that_is_wrong_by_a_billionth_is_noticed() {
    use geodesics::certify::{Claim, PathPoint, WindowData};
    use geodesics::paths::PathPlace;
    use geodesics::{Goal, Paths};

    let mesh = Mesh::generate("torus,faces=300,bump=0.2,seed=3").unwrap();
    let source = [VertexId::new(0)];
    let mut solver = geodesics::mmp::mmp(&mesh);
    let paths = Paths::find(&mut solver, &mesh, source, &Goal::everything()).unwrap();
    let point = |place| match place {
        PathPlace::Vertex(v) => PathPoint::Vertex(v),
        PathPlace::Edge { ends, t } => PathPoint::Edge(ends, t),
        PathPlace::Face => unreachable!("a path between vertices has no points in faces"),
    };
    let path = |v| {
        let path = paths.to(v).unwrap()?;
        Some(path.points.into_iter().map(|p| point(p.place)).collect())
    };
    let windows = |h| {
        geodesics::mmp::windows_of(&solver, h).map(|w| WindowData {
            interval: [w.b0, w.b1],
            image: w.source(),
            sigma: w.sigma,
        })
    };
    let right = paths.distances();
    let claim = Claim::new(&mesh, &source, right).unwrap();
    assert!(claim.not_too_long(windows).relative < 1e-12);
    assert!(claim.not_too_short(path).relative < 1e-12);
    for v in 1..right.len() {
        for change in [1e-9, -1e-9] {
            let mut wrong = right.to_vec();
            wrong[v] *= 1.0 + change;
            let claim = Claim::new(&mesh, &source, &wrong).unwrap();
            let bound = if change > 0.0 {
                claim.not_too_long(windows)
            } else {
                claim.not_too_short(path)
            };
            assert!(bound.relative > 0.99e-9, "{v} {change}: {bound:?}");
            assert!(!bound.failures.is_empty());
        }
    }
    // All of them.
    let wrong: Vec<f64> = right.iter().map(|d| d * (1.0 - 1e-9)).collect();
    let claim = Claim::new(&mesh, &source, &wrong).unwrap();
    assert!(claim.not_too_short(path).failures.len() == right.len() - 1);
}
