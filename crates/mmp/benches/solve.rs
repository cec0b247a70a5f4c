//! Whole solves of `mmp`, by list and by window, storing the windows around the wavefront or all of
//! them, and of `mmp-edge`, on three generated models.

use criterion::{Criterion, criterion_group, criterion_main};
use geobench_benches::{named, whole_solves};
use geobench_mmp::{Keep, mmp, mmp_by_window, mmp_edge};

fn solve(criterion: &mut Criterion) {
    whole_solves(criterion, |mesh| {
        vec![
            named("mmp", mmp(mesh)),
            named("mmp-keep", mmp(mesh).keeping(Keep::All)),
            named("mmp-by-window", mmp_by_window(mesh)),
            named("mmp-edge", mmp_edge(mesh)),
        ]
    });
}

criterion_group!(benches, solve);
criterion_main!(benches);
