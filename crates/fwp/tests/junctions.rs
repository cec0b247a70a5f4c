//! MMP and CH under every discipline on edges with any number of faces and on surfaces of one side.

use geobench_fwp::{
    BucketOptions, LabelCorrectingOptions, fwp_ch, fwp_mmp, fwp_mmp_batched, lc_ch, lc_mmp,
    lc_mmp_batched, vtp_ch, vtp_mmp, vtp_mmp_batched,
};
use geobench_ich::{Pch, ch, ich, ich_fast, ich1};
use geobench_mesh::{Mesh, Tolerance, TriangleSoup, VertexId};
use geobench_mmp::{mmp, mmp_batched, mmp_edge, mmp_fast};
use geobench_oracle::nasty::{Kind, Nasty};
use geobench_oracle::{DoubleDouble, Model, Random, Search, Transform, rounded, search};
use geobench_window::{Counter, Solver, precision};

/// Seeds of each kind; more with the environment variable `SEEDS`.
const SEEDS: u64 = 40;

const MOST_BEAMS: u64 = 60_000;

fn solvers(mesh: &Mesh) -> Vec<(&'static str, Box<dyn Solver>)> {
    let buckets = BucketOptions::default();
    let correcting = LabelCorrectingOptions::default();
    vec![
        ("mmp", Box::new(mmp(mesh))),
        ("mmp-edge", Box::new(mmp_edge(mesh))),
        ("mmp-batched", Box::new(mmp_batched(mesh, 0.5))),
        ("mmp-fast", Box::new(mmp_fast(mesh))),
        ("fwp-mmp", Box::new(fwp_mmp(mesh, buckets))),
        ("fwp-mmp batched", Box::new(fwp_mmp_batched(mesh, buckets))),
        ("lc-mmp", Box::new(lc_mmp(mesh, correcting))),
        ("lc-mmp batched", Box::new(lc_mmp_batched(mesh, correcting))),
        ("vtp-mmp", Box::new(vtp_mmp(mesh))),
        ("vtp-mmp batched", Box::new(vtp_mmp_batched(mesh))),
        ("ch", Box::new(ch(mesh))),
        ("ich1", Box::new(ich1(mesh))),
        ("ich", Box::new(ich(mesh))),
        ("ich-fast", Box::new(ich_fast(mesh))),
        ("pch", Box::new(Pch::new(mesh, 2))),
        ("fwp-ch", Box::new(fwp_ch(mesh, buckets))),
        ("lc-ch", Box::new(lc_ch(mesh, correcting))),
        ("vtp-ch", Box::new(vtp_ch(mesh))),
    ]
}

fn sources(nasty: &Nasty) -> Vec<VertexId> {
    nasty.model.sources.iter().map(|&v| v.into()).collect()
}

/// The mesh and its distances by the oracle; `None` if the mesh is refused or the oracle gives up.
fn solved(nasty: &Nasty) -> Option<(Mesh, Vec<f64>)> {
    let positions = nasty.model.positions()?.to_vec();
    let soup = TriangleSoup::new(positions.clone(), nasty.model.triangles.clone());
    let (mesh, _) = Mesh::from_soup(soup).ok()?;
    mesh.sanity_check().unwrap();
    let faces = mesh
        .faces()
        .map(|f| mesh.face_vertices(f).map(VertexId::raw));
    let model = Model::new(&nasty.model.name, positions, faces.collect());
    let kept: Vec<u32> = sources(nasty)
        .iter()
        .map(|&v| mesh.kept_vertex(v).raw())
        .collect();
    let surface = model.surface::<DoubleDouble>();
    let found = search(&surface, &kept, Search::pruned(MOST_BEAMS)).ok()?;
    let mut found = rounded(&found);
    mesh.fill_copies(&mut found);
    Some((mesh, found))
}

#[test]
fn distances_across_junctions_are_those_of_the_oracle() {
    let seeds = std::env::var("SEEDS").map_or(SEEDS, |n| n.parse().unwrap());
    let first = std::env::var("FIRST").map_or(0, |n| n.parse().unwrap());
    let mut wrong = Vec::new();
    for &kind in Kind::JOINED {
        let (mut with_junctions, mut plain) = (0, 0);
        for seed in first..first + seeds {
            let nasty = kind.mesh(seed);
            let Some((mesh, expected)) = solved(&nasty) else {
                continue;
            };
            *(if mesh.has_junctions() {
                &mut with_junctions
            } else {
                &mut plain
            }) += 1;
            let rule = Tolerance::on(&mesh, &expected);
            for (name, mut solver) in solvers(&mesh) {
                let found = solver.solve(&sources(&nasty)).unwrap().distances;
                let doubt = precision::doubt(&mesh, &found).map_or(0.0, |doubt| doubt.bound);
                let is_wrong = |v: &usize| {
                    let is_right = rule.is_right(*v, found[*v], expected[*v]);
                    !is_right && (found[*v] - expected[*v]).abs() > doubt
                };
                if let Some(v) = (0..found.len()).find(is_wrong) {
                    let text = format!(
                        "{name}: vertex {v}: {} instead of {}",
                        found[v], expected[v]
                    );
                    wrong.push(format!("{}: {text}", nasty.model.name));
                }
            }
        }
        println!("{kind}: {with_junctions} with junctions, {plain} without");
        assert!(with_junctions > seeds / 4, "{kind}");
    }
    assert!(wrong.is_empty(), "{}: {}", wrong.len(), wrong.join("\n"));
}

/// All vertices of these meshes lie on one line. Windows went around the foot of their source
/// without an end: each turn stored what rounding had added to the width of the foot, or what lay
/// behind rays along the edge.
#[test]
fn windows_end_on_sheets_without_area() {
    let rotated = |kind: Kind, seed| {
        let mut nasty = kind.mesh(seed);
        let changed = Transform::Rotate.apply(&nasty.model, &mut Random::new(seed));
        let sources = changed.sources(&nasty.model.sources);
        nasty.model = changed.model;
        nasty.model.sources = sources;
        nasty
    };
    let mut wrong = Vec::new();
    for nasty in [
        rotated(Kind::Rolled, 3651),
        Kind::Rolled.mesh(13830),
        Kind::CollinearFan.mesh(3326),
        Kind::CollinearFan.mesh(3754),
        Kind::Sewn.mesh(8486),
        Kind::Heap.mesh(22894),
    ] {
        let positions = nasty.model.positions().unwrap().to_vec();
        let soup = TriangleSoup::new(positions, nasty.model.triangles.clone());
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        let sources = sources(&nasty);
        // Some of the meshes are too hard for the oracle.
        let expected = mmp(&mesh).solve(&sources).unwrap().distances;
        let rule = Tolerance::on(&mesh, &expected);
        for (name, mut solver) in solvers(&mesh) {
            let (found, counters) = solver.count(&sources).unwrap();
            let windows = counters.get(Counter::Propagated).unwrap();
            let is_wrong = rule.wrong(&found.distances, &expected).next().is_some();
            if is_wrong || windows > 10_000 {
                wrong.push(format!("{}, {name}: {windows}", nasty.model.name));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Equal sheets sewn along two edges, lens after lens. Known by its lengths: more than two equal
/// sheets have no place in space.
fn lenses(count: u32, sheets: u32) -> Mesh {
    let place = |v: u32, low: u32| match v.checked_sub(low) {
        // The middle of a sheet.
        Some(side) => [1.1, f64::from(side) + 0.1, 0.5],
        None => [f64::from(v % 4 / 2) * 2.0, f64::from(v % 2), 0.0],
    };
    let (mut triangles, mut lengths) = (Vec::new(), Vec::new());
    let mut vertices = 2 * count + 2;
    for i in 0..count {
        for _ in 0..sheets {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| 2 * i + k);
            let (low, high) = (vertices, vertices + 1);
            vertices += 2;
            for face in [[a, low, high], [a, high, b], [low, c, d], [low, d, high]] {
                let at = face.map(|v| place(if v < low { v - 2 * i } else { v }, low));
                triangles.push(face);
                lengths.push([0, 1, 2].map(|k| {
                    let [x, y, z] = [0, 1, 2].map(|axis| at[(k + 1) % 3][axis] - at[k][axis]);
                    x.hypot(y).hypot(z)
                }));
            }
        }
    }
    let mesh = Mesh::from_lengths(vertices as usize, &triangles, &lengths);
    mesh.unwrap().0
}

#[test]
fn windows_in_a_row_of_lenses_are_as_many_as_the_lenses() {
    for sheets in [1, 2, 3] {
        let windows = |count: u32| -> Vec<u64> {
            let mesh = lenses(count, sheets);
            assert_eq!(mesh.has_junctions(), sheets > 1);
            let propagated = |(_, mut solver): (_, Box<dyn Solver>)| {
                let (_, counters) = solver.count(&[0.into()]).unwrap();
                counters.get(Counter::Propagated).unwrap()
            };
            solvers(&mesh).into_iter().map(propagated).collect()
        };
        let counts = [20, 40, 80].map(windows);
        let names = solvers(&lenses(1, sheets))
            .into_iter()
            .map(|(name, _)| name);
        for (i, name) in names.enumerate() {
            let [few, more, most] = [0, 1, 2].map(|k| counts[k][i]);
            println!("{name}: {few} {more} {most}");
            // The CH kinds take n² windows on a single sheet: it has no junctions that end them.
            let is_linear = match name {
                "ch" | "ich1" => false,
                _ => sheets > 1 || name.contains("mmp"),
            };
            let limit = if is_linear {
                more + 2 * (more - few) + few
            } else {
                5 * more
            };
            assert!(most < limit, "{name}: {few} {more} {most}");
        }
    }
}

/// The rule of one angle and one split drops the window that gives the last vertex its distance: it
/// infers a crossing on the surface from one in the plane, and the windows come over two sheets.
#[test]
fn windows_over_different_sheets_do_not_split_each_other() {
    // Sheets A and C below the x-axis, inclined to each other so that the source, in A, is 0.5 from
    // a vertex of C.
    let [a, b, apex, beyond] = [[-3.0, 0.0], [3.0, 0.0], [0.0, 1.0], [-2.41, 0.21]];
    let [s, m, n, p] = [[0.0, -1.4], [-0.02, -0.7], [0.02, -0.7], [0.01, -1.0]];
    let cos: f64 = (1.4 * 1.4 + 1.0 + 0.01 * 0.01 - 0.25) / (2.0 * 1.4);
    let sin = (1.0 - cos * cos).sqrt();
    let flat = |[x, y]: [f64; 2]| [x, y, 0.0];
    let raised = |[x, y]: [f64; 2]| [x, y * cos, y * sin];
    let positions = [
        flat(a),
        flat(b),
        flat(apex),
        flat(beyond),
        flat(s),
        flat(m),
        flat(n),
        raised(p),
        [1.0, -1.2, -2.0],
    ];
    let triangles = [
        [0, 1, 2],
        [0, 2, 3], // Above.
        [4, 6, 5],
        [5, 6, 1],
        [5, 1, 0], // A, with a channel from the source.
        [7, 1, 0], // C.
        [4, 7, 8],
    ];
    let mesh = Mesh::new(positions.to_vec(), triangles.to_vec()).unwrap();
    let [x, y] = [0, 1].map(|k| beyond[k] - p[k]);
    for (name, mut solver) in solvers(&mesh) {
        let d = solver.solve(&[4.into()]).unwrap().distances[3];
        assert!((d - (0.5 + f64::hypot(x, y))).abs() < 1e-12, "{name}: {d}");
    }
}
