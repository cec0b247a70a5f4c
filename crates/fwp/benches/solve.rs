//! Whole solves on three generated models: windows of the CH and of the MMP kind from buckets, and in the order of VTP.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use geobench_fwp::{BucketOptions, fwp_ch, fwp_mmp, vtp_ch, vtp_mmp};
use geobench_mesh::generate::generate;
use geobench_mesh::{Mesh, VertexId};
use geobench_window::Solver;

/// A smooth closed surface, one with many saddles, and one with a border and rough ground.
const MODELS: [&str; 3] = [
    "gen:sphere,subdiv=5",
    "gen:torus,faces=50000,bump=0.1,seed=7",
    "gen:terrain,n=150,seed=1",
];

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
        let mut solver = fwp_ch(&mesh, BucketOptions::default());
        group.bench_function("fwp-ch", |b| b.iter(|| black_box(solver.solve(&source))));
        let mut solver = vtp_ch(&mesh);
        group.bench_function("vtp-ch", |b| b.iter(|| black_box(solver.solve(&source))));
        let mut solver = fwp_mmp(&mesh, BucketOptions::default());
        group.bench_function("fwp-mmp", |b| b.iter(|| black_box(solver.solve(&source))));
        let mut solver = vtp_mmp(&mesh);
        group.bench_function("vtp-mmp", |b| b.iter(|| black_box(solver.solve(&source))));
        group.finish();
    }
}

criterion_group!(benches, solve);
criterion_main!(benches);
