//! Random surfaces for property tests.

use geobench_oracle::zoo::{self, Diagonal, Rectangle};
use geobench_oracle::{Model, Random};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};

/// Few cases, the same in every run.
pub(crate) fn config(cases: u32) -> Config {
    Config {
        cases,
        max_shrink_iters: 100,
        rng_seed: RngSeed::Fixed(20_170_701),
        failure_persistence: None,
        ..Config::default()
    }
}

/// A surface in space with up to about 100 vertices: closed or open, smooth or rough, with general
/// or integer coordinates, some with holes, flat faces or a pinched vertex.
pub(crate) fn surface() -> impl Strategy<Value = Model> {
    (base(), extra()).prop_map(|(model, extra)| match extra {
        Extra::None => model,
        Extra::FlatFaces(count) => zoo::with_flat_faces(model, count, 0.5),
        Extra::Pinch(at) => {
            let at = at % model.vertex_count as u32;
            zoo::pinched(&model, at, &zoo::disphenoid([1.0, 1.25, 1.5]), 0)
        }
    })
}

#[derive(Clone, Debug)]
enum Extra {
    None,
    FlatFaces(u32),
    Pinch(u32),
}

fn extra() -> impl Strategy<Value = Extra> {
    prop_oneof![
        3 => Just(Extra::None),
        1 => (1..12_u32).prop_map(Extra::FlatFaces),
        1 => (0..1000_u32).prop_map(Extra::Pinch),
    ]
}

fn base() -> impl Strategy<Value = Model> {
    let diagonal = prop::sample::select(vec![
        Diagonal::Rising,
        Diagonal::Falling,
        Diagonal::Alternating,
    ]);
    let flat =
        ([3..9_u32, 3..9_u32], diagonal, any::<bool>()).prop_map(|(size, diagonal, holed)| {
            let hole = Rectangle::new([1, 1], [2, 3]);
            let holes = if holed { vec![hole] } else { vec![] };
            zoo::plate(size, diagonal, &holes)
        });
    let rough = (flat.clone(), 0.0..2.0, any::<u64>()).prop_map(|(flat, height, seed)| {
        let mut random = Random::new(seed);
        flat.moved(&format!("heights to {height}, seed {seed}"), |[x, y, _]| {
            [x, y, random.between(0.0, height)]
        })
    });
    let whole = (flat, 1..5_u32, any::<u64>()).prop_map(|(flat, levels, seed)| {
        let mut random = Random::new(seed);
        flat.moved(&format!("{levels} levels, seed {seed}"), |[x, y, _]| {
            [x, y, f64::from(random.below(levels))]
        })
    });
    let ball = (0.0..0.4, any::<u64>()).prop_map(|(noise, seed)| {
        let mut random = Random::new(seed);
        zoo::icosphere(1).moved(&format!("noise {noise}, seed {seed}"), |p| {
            let radius = random.between(1.0 - noise, 1.0 + noise);
            p.map(|x| x * radius)
        })
    });
    let torus =
        ([5..10_u32, 4..8_u32], 1.5..5.0).prop_map(|(size, large)| zoo::torus(size, large, 1.0));
    let box_ = [1..4_u32, 1..4_u32, 1..4_u32].prop_map(|size| zoo::cuboid(size, Diagonal::Rising));
    prop_oneof![rough, whole, ball, torus, box_]
}

/// A surface and some of its vertices.
pub(crate) fn surface_and_vertices(count: usize) -> impl Strategy<Value = (Model, Vec<u32>)> {
    with_vertices(surface(), count)
}

/// The same without faces of area 0.
pub(crate) fn solid_surface_and_vertices(count: usize) -> impl Strategy<Value = (Model, Vec<u32>)> {
    with_vertices(base(), count)
}

fn with_vertices(
    surface: impl Strategy<Value = Model>,
    count: usize,
) -> impl Strategy<Value = (Model, Vec<u32>)> {
    let picks = prop::collection::vec(any::<prop::sample::Index>(), count);
    (surface, picks).prop_map(|(model, picks)| {
        let vertices = picks.iter().map(|i| i.index(model.vertex_count) as u32);
        let vertices = vertices.collect();
        (model, vertices)
    })
}
