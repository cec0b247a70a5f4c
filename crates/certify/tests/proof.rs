//! The distances of `mmp` are proven; damaged ones are rejected.

use std::env;
use std::path::{Path, PathBuf};

use geobench_certify::{Bound, Claim, ClaimError, FailurePlace, PathPoint, WindowData};
use geobench_mesh::threads::Threads;
use geobench_mesh::{FaceId, HalfEdgeId, Mesh, TriangleSoup, VertexId};
use geobench_mmp::{Mmp, mmp, windows_of};
use geobench_oracle::nasty::Kind;
use geobench_oracle::{Geometry, zoo};
use geobench_window::Solver;

/// The windows of a solver that has run.
fn windows(mesh: &Mesh, solver: &Mmp) -> Vec<Vec<WindowData>> {
    let of = |h: HalfEdgeId| {
        windows_of(solver, h).map(|w| WindowData {
            interval: [w.b0, w.b1],
            image: [w.px, w.py],
            sigma: w.sigma,
        })
    };
    mesh.half_edges().map(|h| of(h).collect()).collect()
}

fn not_too_long(mesh: &Mesh, source: u32, distances: &[f64], windows: &[Vec<WindowData>]) -> Bound {
    let sources = [VertexId::new(source)];
    let claim = Claim::new(mesh, &sources, distances).unwrap();
    claim.not_too_long(|h| windows[h.index()].iter().copied())
}

fn solved(mesh: &Mesh, source: u32) -> (Vec<f64>, Vec<Vec<WindowData>>) {
    let mut solver = mmp(mesh);
    let distances = solver.distances_from(source).unwrap();
    let windows = windows(mesh, &solver);
    (distances, windows)
}

#[test]
fn threads_do_not_change_a_proof() {
    // So large that vertices, half-edges and faces are divided among threads.
    let mesh = Mesh::generate("terrain,n=145,seed=1").unwrap();
    let (distances, windows) = solved(&mesh, 0);
    let prove = || {
        let sources = [VertexId::new(0)];
        let claim = Claim::new(&mesh, &sources, &distances).unwrap();
        let edge = |v| Some(vec![PathPoint::Vertex(sources[0]), PathPoint::Vertex(v)]);
        (
            not_too_long(&mesh, 0, &distances, &windows),
            claim.not_too_short(edge),
        )
    };
    let alone = prove();
    assert!(alone.0.relative < 1e-9);
    // Only neighbours of the source have such a path.
    assert!(alone.1.failures.len() > mesh.vertex_count() - 20);
    assert_eq!(Threads::start(3).unwrap().run(prove), alone);
}

#[test]
fn fields_of_the_zoo_are_not_too_long() {
    let (mut proven, mut failed) = (0, Vec::new());
    for model in zoo::small() {
        let Geometry::Positions(positions) = model.geometry.clone() else {
            continue;
        };
        let soup = TriangleSoup::new(positions, model.triangles.clone());
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        for &source in &model.sources[..2] {
            let (distances, windows) = solved(&mesh, source);
            let bound = not_too_long(&mesh, source, &distances, &windows);
            let farthest = distances.iter().copied().filter(|d| d.is_finite());
            let farthest = farthest.fold(0.0, f64::max);
            let worst = bound.failures.first();
            // Solvers drop windows narrower than 1e-10 of an edge, and edges of thin faces are
            // long.
            let tolerance = if model.name.contains("stretched") {
                1e-8
            } else {
                1e-9
            };
            if bound.absolute > tolerance * farthest {
                failed.push(format!(
                    "{} from {source}: {:e} {worst:?}",
                    model.name, bound.absolute
                ));
            }
            proven += 1;
        }
    }
    assert!(
        failed.is_empty(),
        "{} of {proven}: {failed:#?}",
        failed.len()
    );
    assert!(proven > 50, "{proven}");
}

#[test]
fn fields_of_generated_models_are_not_too_long() {
    for spec in [
        "torus,faces=2000,bump=0.2,seed=3",
        "terrain,n=30,seed=2",
        "holes",
        "knot,faces=2000",
    ] {
        let mesh = Mesh::generate(spec).unwrap();
        let (distances, windows) = solved(&mesh, 17);
        let bound = not_too_long(&mesh, 17, &distances, &windows);
        let worst = bound.failures.first();
        assert!(
            bound.relative < 1e-10,
            "{spec}: {:e} {worst:?}",
            bound.relative
        );
        assert_eq!(worst, None, "{spec}");
    }
}

#[test]
fn a_distance_that_is_too_long_by_a_billionth_is_noticed() {
    let mesh = Mesh::generate("torus,faces=500,bump=0.2,seed=3").unwrap();
    let (distances, windows) = solved(&mesh, 0);
    for v in (1..distances.len()).step_by(17) {
        let mut wrong = distances.clone();
        wrong[v] *= 1.0 + 1e-9;
        let bound = not_too_long(&mesh, 0, &wrong, &windows);
        assert!(bound.absolute > 0.99e-9 * distances[v], "{v}: {bound:?}");
        assert!(!bound.failures.is_empty());
    }
}

/// The whole field, with its windows, of a mesh with one vertex elsewhere. The bounds include what
/// it is too long; paths prove what it is too short.
#[test]
fn a_field_of_a_mesh_with_one_vertex_moved_is_not_proven() {
    let mesh = Mesh::generate("torus,faces=500,bump=0.2,seed=3").unwrap();
    let (right, _) = solved(&mesh, 0);
    let corners = |f| mesh.face_vertices(f).map(VertexId::raw);
    let faces: Vec<[u32; 3]> = mesh.faces().map(corners).collect();
    let mut noticed = 0;
    for v in [0, 7, 60, 100, 200] {
        for factor in [1.0 + 1e-3, 1.0 - 1e-3, 1.0 + 1e-6] {
            let mut positions = mesh.positions().to_vec();
            positions[v] = positions[v].map(|x| factor * x);
            let moved = Mesh::new(positions, faces.clone()).unwrap();
            let (distances, windows) = solved(&moved, 0);
            let bound = not_too_long(&mesh, 0, &distances, &windows);
            for (error, (given, right)) in bound.errors.iter().zip(distances.iter().zip(&right)) {
                let too_long = given - right * (1.0 + 1e-14);
                assert!(*error >= too_long, "vertex {v} moved by {factor}");
            }
            let is_long = distances
                .iter()
                .zip(&right)
                .any(|(given, right)| given > &(right * (1.0 + 1e-8)));
            noticed += usize::from(is_long);
        }
    }
    assert!(noticed >= 5, "{noticed}");
}

#[test]
fn exchanged_infinite_and_missing_distances_are_not_proven() {
    let mesh = Mesh::generate("torus,faces=500,bump=0.2,seed=3").unwrap();
    let (right, windows) = solved(&mesh, 0);
    for [a, b] in [[7, 8], [60, 200], [100, 101]] {
        let mut wrong = right.clone();
        wrong.swap(a, b);
        let bound = not_too_long(&mesh, 0, &wrong, &windows);
        assert!(bound.relative > 1e-9, "{a} and {b}");
        wrong[a] = f64::INFINITY;
        let bound = not_too_long(&mesh, 0, &wrong, &windows);
        assert_eq!(bound.relative, f64::INFINITY, "{a}");
        wrong[a] = f64::NAN;
        let sources = [VertexId::new(0)];
        let refused = Claim::new(&mesh, &sources, &wrong).unwrap_err();
        assert_eq!(refused, ClaimError::NoDistance(VertexId::new(a as u32)));
    }
}

#[test]
fn a_field_that_is_too_long_by_a_billionth_is_noticed() {
    let mesh = Mesh::generate("terrain,n=16,seed=2").unwrap();
    let (mut distances, mut windows) = solved(&mesh, 5);
    // Leaves the source and its windows as they are: their distance and sigma are 0.
    for d in &mut distances {
        *d *= 1.0 + 1e-9;
    }
    for window in windows.iter_mut().flatten() {
        window.sigma *= 1.0 + 1e-9;
    }
    let bound = not_too_long(&mesh, 5, &distances, &windows);
    assert!(bound.relative > 0.9e-9, "{bound:?}");
    assert!(!bound.failures.is_empty());
}

/// Whether a window is the shortest somewhere on its edge, by far more than the damage done to it.
fn matters(
    mesh: &Mesh,
    distances: &[f64],
    windows: &[Vec<WindowData>],
    h: usize,
    i: usize,
) -> bool {
    let id = HalfEdgeId::new(h as u32);
    let w = windows[h][i];
    let t = f64::midpoint(w.interval[0], w.interval[1]);
    let length = mesh.length(id);
    let at = |w: &WindowData, t: f64| w.sigma + (t - w.image[0]).hypot(w.image[1]);
    let [tail, head] = [mesh.tail(id), mesh.head(id)].map(|v| distances[v.index()]);
    let mut others = vec![tail + t, head + length - t];
    if let Some(twin) = mesh.twin(id) {
        let t = length - t;
        let there = windows[twin.index()].iter();
        others.extend(
            there
                .filter(|w| w.interval[0] <= t && t <= w.interval[1])
                .map(|w| at(w, t)),
        );
    }
    w.interval[1] - w.interval[0] > 1e-3 * length
        && others.into_iter().all(|d| d > at(&w, t) + 1e-3 * length)
}

#[test]
fn a_window_that_is_missing_or_too_long_is_found_again() {
    let mesh = Mesh::generate("torus,faces=500,bump=0.2,seed=3").unwrap();
    let (distances, windows) = solved(&mesh, 0);
    let mut damaged = 0;
    for h in (0..mesh.half_edge_count()).step_by(41) {
        for i in 0..windows[h].len() {
            if !matters(&mesh, &distances, &windows, h, i) {
                continue;
            }
            damaged += 1;
            let mut longer = windows.clone();
            longer[h][i].sigma *= 1.0 + 1e-9;
            let mut missing = windows.clone();
            missing[h].remove(i);
            for windows in [longer, missing] {
                let bound = not_too_long(&mesh, 0, &distances, &windows);
                assert!(bound.relative < 1e-11, "{h} {i}: {}", bound.relative);
                assert!(
                    bound.failures.is_empty(),
                    "{h} {i}: {:?}",
                    bound.failures[0]
                );
            }
        }
    }
    assert!(damaged > 10, "{damaged}");
}

/// The distances are the same from a vertex and from a point in a face, but an added vertex has
/// thin faces around it, and its windows lie elsewhere. A window that ended by less than a unit in
/// the last place beyond a corner failed the proof with 3.5e-5: the lengths of edges are rounded.
#[test]
fn a_window_that_ended_beyond_a_corner_failed_the_proof() {
    for (spec, faces) in [
        ("torus,faces=3000,bump=0.1,seed=7", vec![7]),
        (
            "torus,faces=500,bump=0.2,seed=3",
            (0..500).step_by(41).collect(),
        ),
        ("terrain,n=16,seed=2", (0..512).step_by(57).collect()),
        ("knot,faces=600", (0..600).step_by(67).collect()),
        ("sphere,subdiv=3", vec![0, 100, 1000]),
    ] {
        let mesh = Mesh::generate(spec).unwrap();
        for face in faces {
            for at in [[0.2, 0.3, 0.5], [1e-6, 0.4, 0.599_999], [0.01, 0.98, 0.01]] {
                let point = mesh.point_in_face(FaceId::new(face), at).unwrap();
                let refined = mesh.with_points(&[point]).unwrap();
                let source = refined.vertices[0].raw();
                let (distances, windows) = solved(&refined.mesh, source);
                let bound = not_too_long(&refined.mesh, source, &distances, &windows);
                let worst = bound.failures.first();
                let of = format!("{spec} from face {face} at {at:?}");
                assert!(
                    bound.relative < 1e-10,
                    "{of}: {:e} {worst:?}",
                    bound.relative
                );
            }
        }
    }
}

/// Gaps that windows of saddle vertices leave, dropped where they were narrower than the margin of
/// `mmp`, grow beyond what windows beside them are stretched over. The proofs failed with 4e-4.
#[test]
fn gaps_of_dropped_windows_failed_the_proof() {
    for name in ["min", "corner_min", "so101_min2"] {
        let shared = env::var_os("GEOBENCH_SHARED").map_or_else(
            || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
            PathBuf::from,
        );
        let path = shared.join(format!("cases/certify/certify_fails_{name}.obj"));
        if !path.is_file() {
            println!("without {}", path.display());
            continue;
        }
        let mesh = Mesh::read(&path).unwrap();
        let (distances, windows) = solved(&mesh, 0);
        let bound = not_too_long(&mesh, 0, &distances, &windows);
        assert!(bound.relative < 1e-12, "{name}: {}", bound.relative);
        assert_eq!(bound.failures, [], "{name}");
    }
}

/// Two vertices of the border are almost one. Windows that leave through the edge between them were
/// scaled by the rounding of its ends, and the proofs failed with 3e-7 to 1e-4.
#[test]
fn windows_on_a_tiny_border_edge_failed_the_proof() {
    let [near, by] = [
        [4.183_929_189_131, 2.085_385_424_493, -0.173_372_839_244],
        [-1e-12, 2e-12, 2e-12],
    ];
    for scale in [0.3, 1.0, 10.0, 100.0, 1e3, 1e4] {
        let positions = vec![
            [4.040_973_998_461, 1.010_853_104_453, -0.055_246_919_49],
            [2.913_960_170_434, 2.024_753_156_523, 0.358_332_411_446],
            near,
            [3.077_214_119_591, 3.086_516_414_466, 0.196_214_534_182],
            [0, 1, 2].map(|k| near[k] + scale * by[k]),
        ];
        let mesh = Mesh::new(positions, vec![[0, 2, 1], [1, 2, 3], [2, 4, 3]]).unwrap();
        for source in [0, 1] {
            let (distances, windows) = solved(&mesh, source);
            let bound = not_too_long(&mesh, source, &distances, &windows);
            assert!(bound.relative < 1e-11, "{scale}: {}", bound.relative);
        }
    }
}

/// Thousands of windows of an edge are equal up to rounding. All pairs of them were compared,
/// between all places where two seemed to meet: no end in minutes.
#[test]
fn a_proof_of_a_sheet_without_area_ends() {
    let model = Kind::Heap.mesh(86947).model;
    let soup = TriangleSoup::new(model.positions().unwrap().to_vec(), model.triangles.clone());
    let (mesh, _) = Mesh::from_soup(soup).unwrap();
    let sources: Vec<VertexId> = model.sources.iter().copied().map(VertexId::new).collect();
    let mut solver = mmp(&mesh);
    let distances = solver.solve(&sources).unwrap().distances;
    let windows = windows(&mesh, &solver);
    let most = windows.iter().map(Vec::len).max();
    assert!(most > Some(500), "{most:?}");
    let claim = Claim::new(&mesh, &sources, &distances).unwrap();
    let bound = claim.not_too_long(|h| windows[h.index()].iter().copied());
    assert!(bound.pieces < 40_000, "{} pieces", bound.pieces);
}

#[test]
fn unreachable_vertices_are_infinite() {
    // Two triangles that share nothing.
    let positions = [
        [0.0, 0.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [5.0, 0.0],
        [6.0, 0.0],
        [5.0, 1.0],
    ];
    let positions = positions.map(|[x, y]| [x, y, 0.0]).to_vec();
    let mesh = Mesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let none = vec![Vec::new(); 6];
    let infinite = f64::INFINITY;
    let right = [0.0, 1.0, 1.0, infinite, infinite, infinite];
    assert!(not_too_long(&mesh, 0, &right, &none).absolute < 1e-13);
    let wrong = [0.0, 1.0, infinite, infinite, infinite, infinite];
    let bound = not_too_long(&mesh, 0, &wrong, &none);
    assert_eq!(bound.absolute, infinite);
    let failure = bound.failures[0];
    assert_eq!(failure.place, FailurePlace::Face(FaceId::new(0)));
    assert_eq!((failure.edge, failure.violation), (None, infinite));
}

#[test]
fn a_mesh_made_from_lengths_panicked() {
    let (mesh, _) = Mesh::from_lengths(3, &[[0, 1, 2]], &[[3.0, 4.0, 5.0]]).unwrap();
    let source = [VertexId::new(0)];
    let claim = Claim::new(&mesh, &source, &[0.0, 3.0, 5.0]);
    assert_eq!(claim.err(), Some(ClaimError::NoPositions));
}
