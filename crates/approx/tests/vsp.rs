//! Virtual source propagation: errors, their sign, threads, and surfaces of every kind.

mod support;

use geobench_approx::{Dijkstra, Vsp};
use geobench_mesh::{FaceId, Mesh, TriangleSoup, VertexId};
use geobench_mmp::mmp_fast;
use geobench_window::{Counter, Solver};
use support::cases;

/// The mean and the largest relative error, both in percent, from `sources`.
fn errors(mesh: &Mesh, sources: &[u32]) -> [f64; 2] {
    let exact = mmp_fast(mesh).distances_from(sources).unwrap();
    let found = Vsp::new(mesh, 1).distances_from(sources).unwrap();
    let compared = found.iter().zip(&exact).filter(|(_, e)| **e > 0.0);
    let errors: Vec<f64> = compared
        .map(|(d, e)| {
            assert_eq!(d.is_finite(), e.is_finite());
            if d == e {
                0.0
            } else {
                (d - e).abs() / e * 100.0
            }
        })
        .collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    [mean, errors.into_iter().fold(0.0, f64::max)]
}

fn generated(spec: &str) -> Mesh {
    Mesh::generate(spec).unwrap()
}

#[test]
fn errors_are_some_tenths_of_a_percent() {
    for (spec, mean, largest) in [
        ("sphere,subdiv=5", 0.03, 0.2),
        ("grid,n=40", 0.001, 0.01),
        ("grid,n=40,jitter=0.24,seed=3", 0.02, 0.5),
        ("terrain,n=60,seed=3", 0.4, 4.0),
        ("torus,faces=10000,bump=0.2,seed=3", 0.3, 5.0),
        ("knot,faces=8000", 0.8, 6.0),
        ("holes", 0.3, 3.0),
        ("anisotropic,faces=4000,g=4", 1.0, 8.0),
    ] {
        let found = errors(&generated(spec), &[0]);
        assert!(found[0] < mean && found[1] < largest, "{spec}: {found:?}");
    }
}

#[test]
fn scans_have_the_published_error() {
    for name in ["spot.obj", "cow.off"] {
        let path = format!(
            "{}/../../../shared/models/{name}",
            env!("CARGO_MANIFEST_DIR")
        );
        let mesh = Mesh::read(path).unwrap();
        let found = errors(&mesh, &[0]);
        assert!(found[0] < 0.27 && found[1] < 5.0, "{name}: {found:?}");
    }
}

/// In a plane the straight line to a source is no longer than any path. Single precision may
/// shorten it.
#[test]
fn no_distance_is_too_short_on_a_flat_convex_surface() {
    for spec in [
        "grid,n=30",
        "grid,n=30,jitter=0.24,seed=3",
        "grid,nx=7,ny=60",
    ] {
        let mesh = generated(spec);
        let p = mesh.positions();
        for source in [0, p.len() as u32 / 2] {
            let found = Vsp::new(&mesh, 1).distances_from(source).unwrap();
            for (q, d) in p.iter().zip(found) {
                let s = p[source as usize];
                let exact = (q[0] - s[0]).hypot(q[1] - s[1]);
                assert!(d >= exact * (1.0 - 1e-5), "{spec}: {d} for {exact}");
            }
        }
    }
}

/// A source may go on where a saddle hides it, so distances can be too short there.
#[test]
fn distances_beside_saddles_can_be_too_short() {
    let mesh = generated("terrain,n=60,seed=3");
    let exact = mmp_fast(&mesh).distances_from(0).unwrap();
    let found = Vsp::new(&mesh, 1).distances_from(0).unwrap();
    assert!(found.iter().zip(exact).any(|(d, e)| *d < e * (1.0 - 1e-3)));
}

/// The squares of `n`^3 cubes: edges of up to four squares, and many equal distances.
fn cubes(n: u32) -> Mesh {
    let side = n + 1;
    let position = |v: u32| [v / side / side, v / side % side, v % side].map(f64::from);
    let positions = (0..side.pow(3)).map(position).collect();
    let mut triangles = Vec::new();
    for square in 0..3 * side * n * n {
        let (axis, c) = (square as usize % 3, square / 3 % side);
        let [a, b] = [square / 3 / side % n, square / 3 / side / n];
        let mut corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[da, db]| {
            let mut at = [0; 3];
            (at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]) = (c, a + da, b + db);
            (at[0] * side + at[1]) * side + at[2]
        });
        corners.rotate_left((a * a + 3 * b + 5 * c) as usize % 7 % 2);
        let [p, q, r, s] = corners;
        triangles.extend([[p, q, r], [p, r, s]]);
    }
    let soup = TriangleSoup::new(positions, triangles);
    Mesh::from_soup(soup).unwrap().0
}

/// Rounds of over 1024 candidates, which several threads share.
#[test]
fn the_number_of_threads_changes_nothing() {
    let meshes = [
        generated("terrain,n=150,seed=3"),
        generated("torus,faces=30000,bump=0.2,seed=3"),
        cubes(14),
    ];
    for mesh in meshes {
        // The lattice has enough candidates from one source, and more equal distances.
        let step = if mesh.has_junctions() { 4000 } else { 50 };
        let sources: Vec<VertexId> = mesh.vertices().step_by(step).collect();
        let one = Vsp::new(&mesh, 1).count(&sources).unwrap();
        assert!(one.1.get(Counter::QueuePeak).unwrap() > 2048);
        for threads in [2, 3] {
            let mut solver = Vsp::new(&mesh, threads);
            for _ in 0..2 {
                assert_eq!(solver.count(&sources).unwrap(), one);
            }
        }
    }
}

#[test]
fn of_several_sources_the_nearest_counts() {
    for spec in ["sphere,subdiv=4", "terrain,n=40,seed=3", "holes"] {
        let mesh = generated(spec);
        let found = errors(&mesh, &[0, 5, 77, 200]);
        assert!(found[0] < 0.5 && found[1] < 12.0, "{spec}: {found:?}");
        let all: Vec<u32> = mesh.vertices().map(VertexId::raw).collect();
        let none = Vsp::new(&mesh, 1).distances_from(&all).unwrap();
        assert!(none.iter().all(|d| *d == 0.0));
    }
}

#[test]
fn points_in_faces_and_on_edges_are_sources() {
    for spec in ["sphere,subdiv=4", "terrain,n=40,seed=3"] {
        let mesh = generated(spec);
        let face = FaceId::new(700);
        let [a, b, _] = mesh.face_vertices(face);
        let points = [
            mesh.point_in_face(face, [0.5, 0.3, 0.2]).unwrap(),
            mesh.point_on_edge([a, b], 1e-3).unwrap(),
        ];
        for point in points {
            let refined = mesh.with_points(&[point]).unwrap();
            let found = errors(&refined.mesh, &[refined.vertices[0].raw()]);
            assert!(found[0] < 0.5 && found[1] < 5.0, "{spec}: {found:?}");
        }
    }
}

#[test]
fn parts_without_a_source_are_infinitely_far() {
    let soup = |shift: f64| {
        let mesh = generated("sphere,subdiv=2");
        let positions = mesh.positions().iter().map(|p| [p[0] + shift, p[1], p[2]]);
        (positions.collect::<Vec<_>>(), mesh.to_soup().triangles)
    };
    let (mut positions, mut triangles) = soup(0.0);
    let (others, faces) = soup(5.0);
    let first = positions.len() as u32;
    positions.extend(others);
    positions.push([9.0; 3]);
    triangles.extend(faces.iter().map(|f| f.map(|v| v + first)));
    let (mesh, _) = Mesh::from_soup(TriangleSoup::new(positions, triangles)).unwrap();
    let found = Vsp::new(&mesh, 2).distances_from(3).unwrap();
    assert!(found[..first as usize].iter().all(|d| d.is_finite()));
    assert!(found[first as usize..].iter().all(|d| d.is_infinite()));
    let lone = Vsp::new(&mesh, 1).distances_from(2 * first).unwrap();
    assert!(lone[2 * first as usize] == 0.0 && lone[0].is_infinite());
}

/// Two flat squares that share a corner: paths go on through it.
#[test]
fn sources_start_anew_at_pinched_vertices() {
    let grid = generated("grid,n=20");
    let corner = (0..grid.vertex_count())
        .find(|&v| grid.positions()[v] == [20.0, 20.0, 0.0])
        .unwrap() as u32;
    let mut positions = grid.positions().to_vec();
    let triangles = grid.to_soup().triangles;
    let first = positions.len() as u32;
    positions.extend(
        grid.positions()
            .iter()
            .map(|p| [p[0] + 20.0, p[1] + 20.0, 0.0]),
    );
    let second = triangles
        .iter()
        .map(|f| f.map(|v| if v == 0 { corner } else { v + first }));
    let all = triangles.iter().copied().chain(second).collect();
    let mesh = Mesh::from_soup(TriangleSoup::new(positions, all))
        .unwrap()
        .0;
    assert!(mesh.is_pinched(corner.into()));
    let found = errors(&mesh, &[0]);
    assert!(found[0] < 0.01 && found[1] < 0.1, "{found:?}");
}

/// Three squares with a common side.
#[test]
fn sources_pass_edges_of_three_faces() {
    let n = 24;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for page in 0..3 {
        let (sin, cos) = (2.0 * f64::from(page)).sin_cos();
        for j in 0..=n {
            for i in 0..=n {
                let [x, r] = [i, j].map(f64::from);
                positions.push([x, r * cos, r * sin]);
            }
        }
        let at = |i: u32, j: u32| {
            let page = if j == 0 { 0 } else { page };
            (page * (n + 1) + j) * (n + 1) + i
        };
        for j in 0..n {
            for i in 0..n {
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    let soup = TriangleSoup::new(positions, triangles);
    let (mesh, _) = Mesh::from_soup(soup).unwrap();
    assert!(mesh.has_junctions());
    let found = errors(&mesh, &[10 * (n + 1) + 3]);
    assert!(found[0] < 0.05 && found[1] < 1.0, "{found:?}");
}

/// On slivers, needles and flat faces no distance is longer than along edges, and the work stays
/// linear.
#[test]
fn degenerate_faces_cost_neither_answers_nor_time() {
    for case in cases() {
        let (solution, counters) = Vsp::new(&case.mesh, 1).count(&case.sources).unwrap();
        let along_edges = Dijkstra::new(&case.mesh).solve(&case.sources).unwrap();
        let pairs = solution.distances.iter().zip(&along_edges.distances);
        for (v, (d, most)) in pairs.enumerate() {
            let case = &case.name;
            assert!(*d >= 0.0, "{case}: {v}: {d}");
            assert_eq!(d.is_finite(), most.is_finite(), "{case}: {v}");
            // Every edge on the way may leave its share to rounding.
            assert!(
                *d <= most * 1.01 || d == most,
                "{case}: {v}: {d} for {most}"
            );
        }
        let pushes = counters.get(Counter::QueuePushes).unwrap();
        let faces = case.mesh.face_count() as u64;
        assert!(pushes <= 8 * faces, "{}: {pushes} for {faces}", case.name);
    }
}
