//! Whole solves of `vtp` and of `vtp-fast`, with every set of instructions that the processor has and without each
//! improvement, on three generated models.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use geobench_mesh::generate::generate;
use geobench_mesh::{Mesh, VertexId};
use geobench_vtp::{FastOptions, Instructions, Vtp, VtpFast};
use geobench_window::Solver;

/// A smooth closed surface, one with many saddles, and one with a border and rough ground.
const MODELS: [&str; 3] = [
    "gen:sphere,subdiv=5",
    "gen:torus,faces=50000,bump=0.1,seed=7",
    "gen:terrain,n=150,seed=1",
];

fn options() -> Vec<(String, FastOptions)> {
    let all = FastOptions::default();
    let programs = [
        Instructions::Scalar,
        Instructions::Avx2,
        Instructions::Avx512,
    ];
    let programs = programs.into_iter().filter(|i| i.is_available());
    let programs = programs.map(|instructions| {
        let options = FastOptions {
            instructions,
            ..all
        };
        (format!("fast-{instructions}"), options)
    });
    let switched = [
        ("fast-pairs-1", FastOptions { pairs: 1, ..all }),
        (
            "fast-all-around",
            FastOptions {
                shadow: false,
                ..all
            },
        ),
        (
            "fast-own-numbers",
            FastOptions {
                renumber: false,
                ..all
            },
        ),
    ];
    programs
        .chain(switched.map(|(name, options)| (name.to_owned(), options)))
        .collect()
}

fn solve(criterion: &mut Criterion) {
    for spec in MODELS {
        let soup = spec.parse().map(|spec| generate(&spec));
        let Ok(Ok(soup)) = soup else {
            panic!("`{spec}` is not a generator");
        };
        let (mesh, _) = Mesh::from_soup(soup).unwrap_or_else(|error| panic!("{spec}: {error}"));
        let source = [VertexId::new(0)];
        let mut group = criterion.benchmark_group(spec);
        group.sample_size(10);
        let mut plain = Vtp::new(&mesh);
        group.bench_function("vtp", |b| b.iter(|| black_box(plain.solve(&source))));
        for (name, options) in options() {
            let mut solver = VtpFast::with_options(&mesh, options);
            group.bench_function(BenchmarkId::from_parameter(name), |b| {
                b.iter(|| black_box(solver.solve(&source)));
            });
        }
        group.finish();
    }
}

criterion_group!(benches, solve);
criterion_main!(benches);
