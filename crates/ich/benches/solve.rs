//! Whole solves of `ich1` and `ich` on three generated models.

use criterion::{Criterion, criterion_group, criterion_main};
use geobench_benches::{named, whole_solves};
use geobench_ich::{ich, ich1};

fn solve(criterion: &mut Criterion) {
    whole_solves(criterion, |mesh| {
        vec![named("ich1", ich1(mesh)), named("ich", ich(mesh))]
    });
}

criterion_group!(benches, solve);
criterion_main!(benches);
