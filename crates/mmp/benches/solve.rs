//! Whole solves of `mmp`, storing the windows around the wavefront or all of them, and of `mmp-edge`, on three
//! generated models.

use criterion::{Criterion, criterion_group, criterion_main};
use geobench_benches::{named, whole_solves};
use geobench_mmp::{Keep, mmp, mmp_by_list, mmp_edge};

fn solve(criterion: &mut Criterion) {
    whole_solves(criterion, |mesh| {
        let keeping = |policy: geobench_mmp::Trimming| policy.keeping(Keep::All);
        vec![
            named("mmp", mmp(mesh)),
            named("mmp-keep", mmp(mesh).map_policy(keeping)),
            named("mmp-by-list", mmp_by_list(mesh, 1.0)),
            named("mmp-edge", mmp_edge(mesh)),
        ]
    });
}

criterion_group!(benches, solve);
criterion_main!(benches);
