//! Geodesic Voronoi diagrams of 20 sources: the field with its windows, and the borders of cells.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use geobench_mesh::{Mesh, VertexId};
use geobench_voronoi::{Diagram, FieldSolver, WindowVtp};

const SOURCES: u32 = 20;

fn diagram(criterion: &mut Criterion) {
    for spec in ["gen:sphere,subdiv=5", "gen:terrain,n=100,seed=1"] {
        let mesh = Mesh::generate(spec).expect("a spec");
        let step = mesh.vertex_count() as u32 / SOURCES;
        let sources: Vec<VertexId> = (0..SOURCES).map(|i| VertexId::new(i * step)).collect();
        let mut solver = WindowVtp::new(&mesh);
        let mut group = criterion.benchmark_group(spec);
        group.sample_size(10);
        group.bench_function("field", |b| {
            b.iter(|| black_box(solver.field(&sources).is_ok()));
        });
        let field = solver.field(&sources).expect("sources");
        group.bench_function("borders", |b| {
            b.iter(|| black_box(Diagram::new(&field, sources.len())));
        });
        group.finish();
    }
}

criterion_group!(benches, diagram);
criterion_main!(benches);
