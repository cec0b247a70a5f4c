//! Proofs of distances from vertex 0, the run of `mmp` included.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use geodesics::{Certificate, Mesh};

fn certificate(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("certificate");
    group.sample_size(10);
    for spec in [
        "gen:sphere,subdiv=4",
        "gen:torus,faces=5000,bump=0.1,seed=7",
        "gen:terrain,n=40,seed=1",
    ] {
        let mesh = Mesh::generate(spec).expect("a spec");
        group.bench_function(spec, |b| b.iter(|| black_box(Certificate::of(&mesh, 0))));
    }
    group.finish();
}

criterion_group!(benches, certificate);
criterion_main!(benches);
