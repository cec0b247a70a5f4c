//! The nasty meshes have the properties that they claim, and the oracle's searches agree on them.

use std::collections::BTreeMap;

use geobench_mesh::{Mesh, TriangleSoup, VertexId};
use geobench_oracle::nasty::{self, Kind, Nasty};
use geobench_oracle::{DoubleDouble, Model, Search, rounded, search, steiner_distances};

/// The mesh with its faces oriented consistently; `None` if it is invalid.
fn usable(nasty: &Nasty) -> Option<Model> {
    let positions = nasty.model.positions()?.to_vec();
    let soup = TriangleSoup::new(positions.clone(), nasty.model.triangles.clone());
    let (mesh, _) = Mesh::from_soup(soup).ok()?;
    let faces = mesh
        .faces()
        .map(|f| mesh.face_vertices(f).map(VertexId::raw));
    let model = Model::new(&nasty.model.name, positions, faces.collect());
    let sources = nasty.model.sources.iter();
    let sources: Vec<u32> = sources.map(|&v| mesh.kept_vertex(v.into()).raw()).collect();
    Some(model.only_from(&sources))
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

/// Notes and tests name seeds of the general kinds.
#[test]
fn seeds_keep_their_meshes() {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64; // FNV-1a
    for seed in 0..1000 {
        let Model {
            name,
            triangles,
            sources,
            ..
        } = nasty::mesh(seed).model;
        for byte in format!("{name} {triangles:?} {sources:?}").bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    assert_eq!(hash, 0x6863_0674_7337_7e30);
}

#[test]
fn most_meshes_of_each_kind_can_be_used() {
    let mut used: BTreeMap<Kind, u32> = BTreeMap::new();
    for &kind in [Kind::GENERAL, Kind::BUILT].into_iter().flatten() {
        let usable = (0..40).filter(|&seed| usable(&kind.mesh(seed)).is_some());
        used.insert(kind, usable.count() as u32);
    }
    assert!(used.values().all(|&count| count > 20), "{used:?}");
}

/// Two bounds on either side: paths over points on edges, which know nothing of unfolding, and the
/// search with lines from every vertex.
#[test]
fn searches_across_edges_of_many_triangles_are_between_their_bounds() {
    let mut compared = 0;
    for &kind in Kind::JOINED {
        let plain = (0..200).map(|seed| kind.mesh(seed).model);
        let plain = plain.filter(|model| !model.name.contains(','));
        for model in plain.take(8) {
            let surface = model.surface::<f64>();
            let plan = Search::pruned(20_000);
            let found = search(&surface, &model.sources, plan);
            let everywhere = search(&surface, &model.sources, plan.from_everywhere());
            let (Ok(found), Ok(everywhere)) = (found, everywhere) else {
                continue;
            };
            let above = steiner_distances(&surface, &model.sources, 40);
            let (found, everywhere) = (rounded(&found), rounded(&everywhere));
            for (v, &d) in found.iter().enumerate() {
                let is_same = d == everywhere[v] || (d - everywhere[v]).abs() < 1e-12 * d;
                assert!(is_same, "{}: vertex {v}", model.name);
                let is_between =
                    d == above[v] || d < above[v] * (1.0 + 1e-12) && above[v] < 1.01 * d;
                assert!(is_between, "{}: vertex {v}: {d} {}", model.name, above[v]);
                compared += 1;
            }
        }
    }
    assert!(compared > 300, "{compared}");
}

#[test]
fn built_meshes_have_any_size() {
    for &kind in Kind::BUILT {
        let sizes = |mesh: &dyn Fn(u64) -> Nasty| -> [usize; 2] {
            let faces = (0..20).map(|seed| mesh(seed).model.triangles.len());
            let (least, most) = (faces.clone().min(), faces.max());
            [least.unwrap_or(0), most.unwrap_or(0)]
        };
        let [least, most] = sizes(&|seed| kind.mesh(seed));
        assert!(
            0 < least && least < 50 && 100 < most && most <= nasty::MOST_BUILT,
            "{kind}: {least}, {most}"
        );
        let [least, most] = sizes(&|seed| kind.large_mesh(seed));
        assert!(
            least < 2_000 && 5_000 < most && most <= nasty::MOST_LARGE,
            "{kind}: {least}, {most}"
        );
        assert_eq!(kind.large_mesh(3).model, kind.large_mesh(3).model);
    }
}

/// The first seeds of `chain` that nothing was changed of, with their distances in closed form.
#[test]
fn chains_are_as_long_as_their_x() {
    let mut compared = 0;
    for mesh in (0..100).map(|seed| Kind::Chain.mesh(seed)) {
        let positions = mesh.model.positions().unwrap_or_default();
        if mesh.model.name.contains(',') || mesh.model.sources != [0] {
            continue;
        }
        let surface = mesh.model.surface::<DoubleDouble>();
        let found = search(&surface, &[0], Search::pruned(20_000)).unwrap();
        // Vertices on the axis.
        for (place, d) in positions.iter().zip(rounded(&found)) {
            if place[1..] == [0.0; 2] {
                assert!(
                    (d - place[0]).abs() <= 1e-15 * d,
                    "{}: {d:?}, {place:?}",
                    mesh.model.name
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 100, "{compared}");
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
