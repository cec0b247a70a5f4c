//! Paths through way points made locally shortest: closed forms, classes of homotopy, and all small
//! and many random surfaces, judged by the oracle.

mod judged;

use std::f64::consts::{PI, TAU};

use geobench_mesh::{Mesh, Refined, SplitMix64, SurfacePoint, VertexId};
use geobench_mmp::mmp_fast;
use geobench_oracle::nasty::{self, Kind};
use geobench_oracle::{judge_geodesic, zoo};
use geobench_paths::{Path, Paths};
use geobench_window::{Goal, precision};

use crate::judged::oracle_mesh::mesh_of;
use crate::judged::path::judged_points;
use crate::judged::{report, surface};

/// The shortest paths from each of `ways` to the next, as one path; `None` if one is unreachable or
/// its length is in doubt.
fn joined(mesh: &Mesh, ways: &[VertexId], closed: bool) -> Option<Path> {
    let mut solver = mmp_fast(mesh);
    let mut ways = ways.to_vec();
    ways.extend(closed.then(|| ways[0]));
    let pieces = ways.windows(2).map(|pair| {
        let goal = Goal::targets([pair[1]]);
        let paths = Paths::find(&mut solver, mesh, pair[0], &goal).unwrap();
        if precision::doubt(mesh, paths.distances()).is_some() {
            return None;
        }
        paths.to(pair[1]).unwrap()
    });
    let pieces: Option<Vec<Path>> = pieces.collect();
    pieces.map(Path::joined)
}

/// The path through `ways` of `mesh`, before and after.
fn through(mesh: &Mesh, ways: &[SurfacePoint], closed: bool) -> (Refined, Path, Path) {
    let refined = mesh.with_points(ways).unwrap();
    let path = joined(&refined.mesh, &refined.vertices, closed).unwrap();
    let shorter = path.shortened(&refined.mesh, closed).unwrap();
    let flaw = flaw(&refined.mesh, [&path, &shorter], closed);
    assert_eq!(flaw, None, "{ways:?}");
    (refined, path, shorter)
}

/// What is wrong with a path as a shorter form of another one.
fn flaw(mesh: &Mesh, [path, shorter]: [&Path; 2], closed: bool) -> Option<String> {
    if shorter.length > path.length * (1.0 + 1e-13) {
        return Some(format!("{} from {}", shorter.length, path.length));
    }
    if !closed {
        let ends = |path: &Path| {
            (
                path.points[0].vertex(),
                path.points.last().unwrap().vertex(),
            )
        };
        if ends(path) != ends(shorter) {
            return Some("its ends have moved".to_owned());
        }
    }
    let points = judged_points(shorter);
    let judged = judge_geodesic(&surface(mesh), &points, closed, shorter.length);
    judged.err().map(|flaw| flaw.to_string())
}

/// A vertex, a point of an edge or one in a face.
fn random_point(mesh: &Mesh, random: &mut SplitMix64) -> SurfacePoint {
    let face = (random.below(mesh.face_count()) as u32).into();
    let corners = mesh.face_vertices(face);
    let [a, b, c] = [0; 3].map(|_| random.unit() + 1e-3);
    match random.below(3) {
        0 => corners[0].into(),
        1 => mesh
            .point_on_edge([corners[0], corners[1]], a / 1.1)
            .unwrap(),
        _ => mesh
            .point_in_face(face, [a, b, c].map(|w| w / (a + b + c)))
            .unwrap(),
    }
}

#[test]
fn helices_around_a_cylinder_are_straight() {
    let cylinder = Mesh::generate("cylinder,slices=24,stacks=9,height=3").unwrap();
    let around = 48.0 * (PI / 24.0).sin();
    let at = |turn: f64, z: f64| {
        let [x, y] = [(TAU * turn).cos(), (TAU * turn).sin()];
        cylinder.nearest_point([x, y, z]).unwrap().0
    };
    let low = cylinder.bounding_box().unwrap()[0][2];
    // Once around, and half around again; the ends are on the middles of sides.
    let ways = [
        (0.0, 0.3),
        (0.3, 2.2),
        (0.6, 0.7),
        (0.9, 1.9),
        (1.2, 1.1),
        (1.5, 2.5),
    ];
    let half = 0.5 / 24.0;
    let ways: Vec<_> = ways
        .iter()
        .map(|&(turn, z)| at(turn + half, low + z))
        .collect();
    let (_, before, after) = through(&cylinder, &ways, false);
    let expected = (1.5 * around).hypot(2.2);
    assert!(
        (after.length - expected).abs() < 1e-11,
        "{} {expected}",
        after.length
    );
    assert!(before.length > expected + 0.5);
    // Closed: once around, at some height.
    let (_, _, ring) = through(&cylinder, &ways[..4], true);
    assert!((ring.length - around).abs() < 1e-11, "{}", ring.length);
}

#[test]
fn a_belt_around_a_box_stays_there() {
    let cube = Mesh::generate("cube,n=3,side=3").unwrap();
    let low = cube.bounding_box().unwrap()[0];
    let at = |x: f64, y: f64, z: f64| {
        let place = [low[0] + x, low[1] + y, low[2] + z];
        cube.nearest_point(place).unwrap().0
    };
    let ways = [
        at(1.2, 0.0, 1.0),
        at(3.0, 1.7, 1.6),
        at(1.4, 3.0, 1.3),
        at(0.0, 1.1, 1.9),
    ];
    let (_, before, after) = through(&cube, &ways, true);
    assert!((after.length - 12.0).abs() < 1e-12, "{}", after.length);
    assert!(before.length > 12.01);
    // Around one corner a loop contracts to a point.
    let ways = [at(0.2, 0.0, 0.3), at(0.0, 0.4, 0.2), at(0.3, 0.2, 0.0)];
    let (_, _, point) = through(&cube, &ways, true);
    assert_eq!((point.length, point.points.len()), (0.0, 1));
}

#[test]
fn loops_of_a_torus_stay_around_it() {
    // How often a path leads around the axis, and around the tube.
    let turns = |mesh: &Mesh, path: &Path| {
        let angles = path.polyline(mesh).into_iter().map(|[x, y, z]| {
            let out = x.hypot(y);
            [y.atan2(x), z.atan2(out - 1.0)]
        });
        let angles: Vec<[f64; 2]> = angles.collect();
        let turn = |k: usize| {
            let steps = angles.windows(2).map(|pair| {
                let step = pair[1][k] - pair[0][k];
                step - TAU * (step / TAU).round()
            });
            (steps.sum::<f64>() / TAU).round()
        };
        [turn(0), turn(1)]
    };
    let (mut seen, mut contracted) = (Vec::new(), 0);
    for spec in ["torus,faces=900", "torus,faces=900,bump=0.2,seed=3"] {
        let torus = Mesh::generate(spec).unwrap();
        let [low, high] = torus.bounding_box().unwrap();
        let size = high[0] - low[0];
        let mut random = SplitMix64::new(7);
        for i in 0..40 {
            let count = 3 + random.below(5);
            let ways: Vec<_> = (0..count)
                .map(|_| random_point(&torus, &mut random))
                .collect();
            let closed = i % 4 != 0;
            let (refined, before, after) = through(&torus, &ways, closed);
            if !closed {
                continue;
            }
            let class = turns(&refined.mesh, &before);
            assert_eq!(class, turns(&refined.mesh, &after), "{spec} {i}");
            assert!(class == [0.0; 2] || after.length > 0.2 * size, "{spec} {i}");
            contracted += usize::from(after.length == 0.0);
            seen.push(class);
        }
    }
    seen.sort_by(|a, b| a.partial_cmp(b).unwrap());
    seen.dedup();
    assert!(
        seen.len() > 4 && contracted > 4,
        "{seen:?}, {contracted} points"
    );
}

/// A square with a square hole in the middle.
fn frame() -> Mesh {
    let grid = Mesh::generate("grid,n=6").unwrap();
    let [low, _] = grid.bounding_box().unwrap();
    let positions = grid.positions().iter();
    let positions: Vec<_> = positions
        .map(|p| [p[0] - low[0], p[1] - low[1], 0.0])
        .collect();
    let is_kept = |corners: &[u32; 3]| {
        let middle = |k: usize| {
            corners
                .iter()
                .map(|&v| positions[v as usize][k])
                .sum::<f64>()
                / 3.0
        };
        ![0, 1].iter().all(|&k| (2.0..4.0).contains(&middle(k)))
    };
    let corners = |face| grid.face_vertices(face).map(VertexId::raw);
    let faces: Vec<_> = grid.faces().map(corners).filter(is_kept).collect();
    assert_eq!(faces.len(), 64);
    Mesh::new(positions, faces).unwrap()
}

#[test]
fn a_path_stays_on_its_side_of_a_hole() {
    let frame = frame();
    let at = |x: f64, y: f64| frame.nearest_point([x, y, 0.0]).unwrap().0;
    // From left to right, above the hole and below it.
    for (y, corner) in [(5.5, 4.0), (0.5, 2.0)] {
        let ways = [at(0.5, 2.7), at(3.1, y), at(5.5, 2.7)];
        let (_, _, path) = through(&frame, &ways, false);
        let expected = 2.0 + 2.0 * 1.5_f64.hypot(corner - 2.7);
        assert!(
            (path.length - expected).abs() < 1e-12,
            "{} {expected}",
            path.length
        );
    }
    // Around the hole, a loop contracts to its border; beside it, to a point.
    let ways = [at(0.3, 0.4), at(5.3, 0.6), at(5.6, 5.1), at(0.4, 5.7)];
    let (_, _, ring) = through(&frame, &ways, true);
    assert!((ring.length - 8.0).abs() < 1e-12, "{}", ring.length);
    let ways = [at(0.3, 0.4), at(1.3, 0.6), at(1.1, 5.1)];
    let (_, _, point) = through(&frame, &ways, true);
    assert_eq!((point.length, point.points.len()), (0.0, 1));
}

#[test]
fn small_surfaces() {
    let mut failures = Vec::new();
    let mut random = SplitMix64::new(1);
    for model in zoo::small() {
        let mesh = mesh_of(&model).unwrap();
        let inspect = |ways: &[SurfacePoint]| inspect(&model.name, &mesh, ways);
        for count in [2, 3, 5] {
            let ways: Vec<_> = (0..count)
                .map(|_| random_point(&mesh, &mut random))
                .collect();
            failures.extend(inspect(&ways));
        }
    }
    report(&failures);
}

#[test]
fn random_surfaces() {
    let mut failures = Vec::new();
    let models = (0..150).map(|seed| nasty::mesh(seed).model);
    let joined = Kind::JOINED.iter();
    let joined = joined.flat_map(|kind| (0..10).map(|seed| kind.mesh(seed).model));
    for (seed, model) in models.chain(joined).enumerate() {
        let Ok(mesh) = mesh_of(&model) else {
            continue;
        };
        let mut random = SplitMix64::new(seed as u64);
        // Points in faces may be off their faces by the rounding of positions.
        let vertices = mesh.vertex_count();
        let ways = [0; 4].map(|_| VertexId::new(random.below(vertices) as u32).into());
        failures.extend(inspect(&model.name, &mesh, &ways));
    }
    report(&failures);
}

/// What is wrong with the path through `ways`, open and closed.
fn inspect(name: &str, mesh: &Mesh, ways: &[SurfacePoint]) -> Vec<String> {
    let refined = mesh.with_points(ways).unwrap();
    let flaws = [false, true].into_iter().filter_map(|closed| {
        let path = joined(&refined.mesh, &refined.vertices, closed)?;
        let Some(shorter) = path.shortened(&refined.mesh, closed) else {
            return Some(format!("{name}, from {ways:?}: none"));
        };
        let flaw = flaw(&refined.mesh, [&path, &shorter], closed)?;
        // On a surface of one side, a closed path may bend where it ends.
        let last = shorter.points.len() - 1;
        if closed
            && mesh.has_junctions()
            && flaw.starts_with(&format!("it is bent at point {last},"))
        {
            return None;
        }
        Some(format!("{name}, from {ways:?}, {closed}: {flaw}"))
    });
    flaws.collect()
}

#[test]
fn degenerate_paths() {
    let mesh = Mesh::generate("torus,faces=200").unwrap();
    let [a, b] = [3, 50].map(VertexId::new);
    let there = joined(&mesh, &[a, b], false).unwrap();
    let there_and_back = joined(&mesh, &[a, b, a], false).unwrap();
    for closed in [false, true] {
        // A single point, and a way there and back.
        for path in [
            joined(&mesh, &[a, a], false).unwrap(),
            there_and_back.clone(),
        ] {
            let path = path.shortened(&mesh, closed).unwrap();
            assert_eq!((path.length, path.points.len()), (0.0, 1));
            assert_eq!(path.points[0].vertex(), Some(a));
        }
    }
    // A shortest path stays as it is.
    let same = there.shortened(&mesh, false).unwrap();
    assert!((same.length - there.length).abs() < 1e-14 * there.length);
    assert_eq!(same.points.len(), there.points.len());
    // No closed path, one of another mesh, and one from inside a face.
    assert_eq!(there.shortened(&mesh, true), None);
    let grid = Mesh::generate("grid,n=2").unwrap();
    assert_eq!(there.shortened(&grid, false), None);
    let inside = mesh.point_in_face(0.into(), [0.2, 0.3, 0.5]).unwrap();
    let refined = mesh.with_points(&[inside, b.into()]).unwrap();
    let path = joined(&refined.mesh, &refined.vertices, false).unwrap();
    assert!(path.shortened(&refined.mesh, false).is_some());
    assert_eq!(path.of_original(&refined).shortened(&mesh, false), None);
    let empty = Path {
        length: 0.0,
        points: Vec::new(),
    };
    assert_eq!(empty.shortened(&mesh, true), None);
}
