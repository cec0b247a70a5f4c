//! Solvers that insert points in place find what solvers of a refined mesh find.

use geobench_mesh::{FaceId, Mesh, SplitMix64, SurfacePoint, Tolerance, TriangleSoup, VertexId};
use geobench_oracle::nasty;
use geobench_registry::{Selection, select};
use geobench_window::{Goal, Origin, Solver, at_points, precision};

/// A vertex, or a point on an edge or in a face; one in three is close to a corner.
fn any_point(mesh: &Mesh, random: &mut SplitMix64) -> Option<SurfacePoint> {
    let face = FaceId::new(random.below(mesh.face_count()) as u32);
    let corners = mesh.face_vertices(face);
    let k = random.below(3);
    let near = [1.0, 1.0, 1e-3][random.below(3)];
    match random.below(4) {
        0 => Some(corners[k].into()),
        1 => mesh
            .point_on_edge([corners[k], corners[(k + 1) % 3]], near * random.unit())
            .ok(),
        _ => {
            let (u, v) = (near * random.unit(), near * random.unit());
            let (u, v) = if u + v > 1.0 {
                (1.0 - u, 1.0 - v)
            } else {
                (u, v)
            };
            let mut weights = [u; 3];
            weights[(k + 1) % 3] = v;
            weights[k] = 1.0 - u - v;
            mesh.point_in_face(face, weights).ok()
        }
    }
}

/// Solves from the first `from` of `points`, for all vertices and for the other points alone.
fn solve(solver: &mut dyn Solver, vertices: &[VertexId], from: usize) -> Option<[Vec<f64>; 2]> {
    let (sources, targets) = vertices.split_at(from);
    let goal = Goal::targets(targets.iter().copied());
    let all = solver.solve(sources).ok()?.distances;
    let near = solver.solve_until(sources, &goal).ok()?.distances;
    let near = targets.iter().map(|v| near[v.index()]).collect();
    Some([all, near])
}

/// Compares `selection` in place with a new set-up, for several sets of points one after the other.
/// Returns whether it inserts points in place.
fn check(name: &str, selection: &Selection, mesh: &Mesh, random: &mut SplitMix64) -> bool {
    let mut solver = selection.build(mesh);
    let label = selection.label();
    let before = solver.solve(&[0.into()]).ok();
    for _ in 0..3 {
        let (from, to) = (1 + random.below(2), 1 + random.below(2));
        let points: Vec<_> = (0..from + to)
            .filter_map(|_| any_point(mesh, random))
            .collect();
        if points.len() < from + to {
            continue;
        }
        let insertion = mesh.insertion(&points).unwrap();
        let mut in_place = true;
        let anew = |mesh: &Mesh| {
            in_place = false;
            selection.build(mesh)
        };
        let found = at_points(&mut *solver, insertion, anew, |solver, refined| {
            solve(solver, &refined.vertices, from)
        });
        if !in_place {
            return false;
        }
        let refined = mesh.with_points(&points).unwrap();
        let mut anew = selection.build(&refined.mesh);
        let expected = solve(&mut *anew, &refined.vertices, from);
        assert_eq!(found.is_some(), expected.is_some(), "{name}, {label}");
        let (Some(found), Some(expected)) = (found, expected) else {
            continue;
        };
        if precision::doubt(&refined.mesh, &expected[0]).is_some() {
            continue;
        }
        let rule = Tolerance::on(&refined.mesh, &expected[0]);
        let wrong: Vec<usize> = rule.wrong(&found[0], &expected[0]).collect();
        assert!(
            wrong.is_empty(),
            "{name}, {label}, {points:?}: {wrong:?} {:?} {:?}",
            found[0],
            expected[0]
        );
        for (k, v) in refined.vertices[from..].iter().enumerate() {
            let [a, b] = [found[1][k], expected[0][v.index()]];
            assert!(
                rule.is_right(v.index(), a, b),
                "{name}, {label}: target {k}: {a} {b}"
            );
        }
        let after = solver.solve(&[0.into()]).ok();
        if selection.threads() > 1 {
            // The windows of several threads differ from run to run.
            let [before, after] = [&before, &after].map(|s| s.as_ref().unwrap().distances.clone());
            assert_eq!(
                Tolerance::on(mesh, &before).wrong(&after, &before).count(),
                0
            );
        } else {
            assert_eq!(after, before, "{name}, {label}: not undone");
        }
    }
    true
}

/// The exact algorithms, all of which insert points in place.
fn exact() -> Vec<Selection> {
    let all = select("exact").unwrap().into_iter();
    all.map(|selection| selection.with_threads(2)).collect()
}

#[test]
fn points_in_place_are_those_of_a_refined_mesh_on_nasty_meshes() {
    let all = exact();
    for seed in 0..60 {
        let model = nasty::mesh(seed).model;
        let Some(positions) = model.positions() else {
            continue;
        };
        let soup = TriangleSoup::new(positions.to_vec(), model.triangles.clone());
        let Ok((mesh, _)) = Mesh::from_soup(soup) else {
            continue;
        };
        if mesh.face_count() == 0 {
            continue;
        }
        for (i, selection) in all.iter().enumerate() {
            let mut random = SplitMix64::new(100 * seed + i as u64);
            let in_place = check(&format!("seed {seed}"), selection, &mesh, &mut random);
            assert!(in_place, "{}", selection.label());
        }
    }
}

#[test]
fn points_in_place_are_those_of_a_refined_mesh_on_surfaces() {
    let all = exact();
    for spec in [
        "terrain,n=10,seed=3",
        "torus,faces=400,bump=0.2,seed=5",
        "grid,n=6",
        "cube,n=3",
        "strip,n=40,aspect=30",
        "anisotropic,faces=1000,g=6",
    ] {
        let mesh = Mesh::generate(spec).unwrap();
        for (i, selection) in all.iter().enumerate() {
            let mut random = SplitMix64::new(i as u64);
            let in_place = check(spec, selection, &mesh, &mut random);
            assert!(in_place, "{}", selection.label());
        }
    }
}

#[test]
fn points_on_junctions_are_inserted_in_place() {
    // Three squares on the edge from 0 to 1.
    let mut positions = vec![[0.0; 3], [1.0, 0.0, 0.0]];
    let mut triangles = Vec::new();
    for [y, z] in [[1.0, 0.0], [-0.5, 0.9], [-0.6, -0.7]] {
        let first = positions.len() as u32;
        positions.extend([[0.0, y, z], [1.1, y, z]]);
        triangles.extend([[0, 1, first + 1], [0, first + 1, first]]);
    }
    let mesh = Mesh::new(positions, triangles).unwrap();
    assert!(mesh.has_junctions());
    let crossing = exact().into_iter().filter(Selection::crosses_junctions);
    let crossing: Vec<Selection> = crossing.collect();
    assert!(crossing.len() >= 14);
    for selection in &crossing {
        let mut random = SplitMix64::new(5);
        for round in 0..10 {
            assert!(check(
                &format!("round {round}"),
                selection,
                &mesh,
                &mut random
            ));
        }
    }
}

#[test]
fn paths_from_points_in_place_have_origins() {
    let mesh = Mesh::generate("sphere,subdiv=2").unwrap();
    let point = |face: u32| mesh.point_in_face(face.into(), [0.2, 0.3, 0.5]).unwrap();
    let points = [point(3), point(200)];
    for selection in exact() {
        let mut solver = selection.build(&mesh);
        let insertion = mesh.insertion(&points).unwrap();
        let origin = at_points(
            &mut *solver,
            insertion,
            |mesh| selection.build(mesh),
            |solver, refined| {
                let [from, to] = [0, 1].map(|i| refined.vertices[i]);
                let (_, origins) = solver.trace(&[from], &Goal::targets([to])).ok()?;
                Some(origins.of(&refined.mesh, to))
            },
        );
        assert_ne!(origin, Some(Origin::None), "{}", selection.label());
    }
}
