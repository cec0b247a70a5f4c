//! The nasty meshes have the properties that they claim, and the oracle's searches agree on them.

use std::collections::BTreeMap;

use geobench_mesh::{Mesh, TriangleSoup, VertexId};
use geobench_oracle::nasty::{self, Kind, Nasty};
use geobench_oracle::{DoubleDouble, Model, Search, rounded, search};

/// The mesh with its faces oriented consistently; `None` if it is invalid.
fn usable(nasty: &Nasty) -> Option<Model> {
    let positions = nasty.model.positions()?.to_vec();
    let soup = TriangleSoup::new(positions.clone(), nasty.model.triangles.clone());
    let (mesh, _) = Mesh::from_soup(soup).ok()?;
    let faces = mesh
        .faces()
        .map(|f| mesh.face_vertices(f).map(VertexId::raw));
    let model = Model::new(&nasty.model.name, positions, faces.collect());
    Some(model.only_from(&nasty.model.sources))
}

#[test]
fn a_seed_always_makes_the_same_mesh() {
    for seed in 0..200 {
        let mesh = nasty::mesh(seed);
        assert_eq!(mesh.model, nasty::mesh(seed).model);
        assert_eq!(mesh.model, mesh.kind.mesh(seed).model);
        let count = mesh.model.vertex_count as u32;
        let name = &mesh.model.name;
        assert!(mesh.model.triangles.len() <= nasty::MOST_FACES, "{name}");
        assert!(!mesh.model.triangles.is_empty(), "{name}");
        assert!(
            mesh.model
                .triangles
                .as_flattened()
                .iter()
                .all(|&v| v < count),
            "{name}"
        );
        assert!(!mesh.model.sources.is_empty(), "{name}");
        assert!(mesh.model.sources.iter().all(|&v| v < count), "{name}");
    }
}

#[test]
fn most_meshes_of_each_kind_can_be_used() {
    let mut used: BTreeMap<Kind, u32> = BTreeMap::new();
    for seed in 0..40 * Kind::ALL.len() as u64 {
        let mesh = nasty::mesh(seed);
        *used.entry(mesh.kind).or_default() += u32::from(usable(&mesh).is_some());
    }
    assert_eq!(used.len(), Kind::ALL.len());
    assert!(used.values().all(|&count| count > 20), "{used:?}");
}

#[test]
fn every_search_finds_the_same_distances() {
    const MOST_BEAMS: u64 = 20_000;
    let pruned = Search::pruned(MOST_BEAMS);
    let exhaustive = Search {
        prune: false,
        ..pruned
    };
    let mut compared = 0;
    for seed in 0..500 {
        let Some(model) = usable(&nasty::mesh(seed)) else {
            continue;
        };
        let surface = model.surface::<DoubleDouble>();
        let Ok(found) = search(&surface, &model.sources, pruned) else {
            panic!("{}: the pruned search gave up", model.name);
        };
        let found = rounded(&found);
        let finite = found.iter().copied().filter(|d| d.is_finite());
        let slack = 1e-18 * finite.fold(0.0, f64::max);
        for plan in [pruned.from_everywhere(), exhaustive] {
            let Ok(other) = search(&surface, &model.sources, plan) else {
                continue;
            };
            compared += 1;
            for (v, (a, b)) in found.iter().zip(rounded(&other)).enumerate() {
                let same = *a == b || (a - b).abs() <= 1e-13 * b + slack;
                assert!(same, "{}, vertex {v}: {a:?}, by {plan:?} {b:?}", model.name);
            }
        }
    }
    assert!(compared > 700, "{compared}");
}
