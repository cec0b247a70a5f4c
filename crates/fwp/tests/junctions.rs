//! MMP under every discipline on edges with any number of faces and on surfaces of one side.

use geobench_fwp::{
    BucketOptions, LabelCorrectingOptions, fwp_mmp, fwp_mmp_batched, lc_mmp, lc_mmp_batched,
    vtp_mmp, vtp_mmp_batched,
};
use geobench_ich::ich;
use geobench_mesh::{Mesh, Tolerance, TriangleSoup, VertexId};
use geobench_mmp::{mmp, mmp_batched, mmp_edge, mmp_fast};
use geobench_oracle::nasty::{Kind, Nasty};
use geobench_oracle::{DoubleDouble, Model, Search, rounded, search};
use geobench_window::{SolveError, Solver, precision};

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
            let refused = ich(&mesh).solve(&sources(&nasty)).err();
            assert_eq!(refused, SolveError::at_junctions(&mesh));
        }
        println!("{kind}: {with_junctions} with junctions, {plain} without");
        assert!(with_junctions > seeds / 4, "{kind}");
    }
    assert!(wrong.is_empty(), "{}: {}", wrong.len(), wrong.join("\n"));
}
