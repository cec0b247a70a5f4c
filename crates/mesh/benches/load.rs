//! Loading of models: each format from memory to a `TriangleSoup`, and the half-edge mesh from
//! there.

use std::fs;
use std::hint::black_box;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use geobench_mesh::generate::{Spec, generate};
use geobench_mesh::io::{Format, read_bytes, write};
use geobench_mesh::{Mesh, TriangleSoup};

/// 20,480 faces: files of about a megabyte.
const MODEL: &str = "gen:sphere,subdiv=5";

fn model() -> TriangleSoup {
    let spec: Spec = MODEL.parse().expect("a spec");
    generate(&spec).expect("a model")
}

fn read(criterion: &mut Criterion) {
    let soup = model();
    let folder = tempfile::tempdir().expect("a folder");
    let mut group = criterion.benchmark_group("read");
    for extension in ["obj", "off", "ply", "stl", "obj.gz"] {
        let path = folder.path().join("model").with_extension(extension);
        write(&path, &soup).expect("a file");
        let bytes = fs::read(&path).expect("the file");
        let format = Format::from_path(&path).expect("a format");
        group.throughput(Throughput::Bytes(bytes.len() as u64));
        group.bench_function(BenchmarkId::from_parameter(extension), |b| {
            b.iter(|| black_box(read_bytes(&bytes, format, &path)));
        });
    }
    group.finish();
}

fn build(criterion: &mut Criterion) {
    let soup = model();
    criterion.bench_function("half-edges", |b| {
        b.iter_batched(
            || soup.clone(),
            |soup| black_box(Mesh::from_soup(soup)),
            BatchSize::LargeInput,
        );
    });
}

criterion_group!(benches, read, build);
criterion_main!(benches);
