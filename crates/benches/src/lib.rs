//! Shared code of the benches of the solver crates: models, and timing of whole solves.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion};
use geobench_mesh::{Mesh, VertexId};
use geobench_window::Solver;

/// A smooth closed surface, a closed surface with many saddles, and a rough one with a boundary.
const MODELS: [&str; 3] = [
    "gen:sphere,subdiv=5",
    "gen:torus,faces=50000,bump=0.1,seed=7",
    "gen:terrain,n=150,seed=1",
];

/// Samples of one solver: too few for small differences, because some models take seconds.
const SAMPLES: usize = 10;

/// The name of a series of times, and the solver.
pub type Named = (String, Box<dyn Solver>);

/// Gives `solver` a name.
pub fn named(name: impl Into<String>, solver: impl Solver + 'static) -> Named {
    (name.into(), Box::new(solver))
}

/// Times whole solves from vertex 0 of three generated models, without set-up, for each of the
/// solvers that `set_up` makes for a mesh.
///
/// # Panics
///
/// If the generators no longer accept the specs of the models.
pub fn whole_solves(criterion: &mut Criterion, set_up: impl Fn(&Mesh) -> Vec<Named>) {
    for spec in MODELS {
        let mesh = mesh(spec);
        let mut group = criterion.benchmark_group(spec);
        group.sample_size(SAMPLES);
        let source = [VertexId::new(0)];
        for (name, mut solver) in set_up(&mesh) {
            group.bench_function(BenchmarkId::from_parameter(name), |b| {
                b.iter(|| black_box(solver.solve(&source)));
            });
        }
        group.finish();
    }
}

/// The mesh of a spec.
fn mesh(spec: &str) -> Mesh {
    Mesh::generate(spec).unwrap_or_else(|error| panic!("{spec}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_such_models() {
        for spec in MODELS {
            assert!(mesh(spec).face_count() > 10_000, "{spec}");
        }
    }
}
