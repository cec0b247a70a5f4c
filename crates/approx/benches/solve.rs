//! Whole solves of approximate algorithms on three generated models.

use criterion::{Criterion, criterion_group, criterion_main};
use geobench_approx::{Dijkstra, Fmm, Vsp, avtp, mmp_approx};
use geobench_benches::{named, whole_solves};

/// Relative error that is allowed.
const ERROR: f64 = 0.01;

fn solve(criterion: &mut Criterion) {
    whole_solves(criterion, |mesh| {
        vec![
            named("dijkstra", Dijkstra::new(mesh)),
            named("fmm", Fmm::new(mesh, true)),
            named("vsp", Vsp::new(mesh, 1)),
            named("mmp-approx", mmp_approx(mesh, ERROR)),
            named("avtp", avtp(mesh, ERROR)),
        ]
    });
}

criterion_group!(benches, solve);
criterion_main!(benches);
