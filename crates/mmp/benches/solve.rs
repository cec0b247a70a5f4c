//! Whole solves of `mmp` and `mmp-edge`, as their papers describe them, of `mmp-fast`, and of
//! `mmp-fast` with all windows stored, on three generated models.

use criterion::{Criterion, criterion_group, criterion_main};
use geobench_benches::{named, whole_solves};
use geobench_mmp::{Retention, mmp, mmp_edge, mmp_fast};

fn solve(criterion: &mut Criterion) {
    whole_solves(criterion, |mesh| {
        vec![
            named("mmp", mmp(mesh)),
            named("mmp-edge", mmp_edge(mesh)),
            named("mmp-fast", mmp_fast(mesh)),
            named(
                "mmp-fast{lists=keep}",
                mmp_fast(mesh).retaining(Retention::All),
            ),
        ]
    });
}

criterion_group!(benches, solve);
criterion_main!(benches);
