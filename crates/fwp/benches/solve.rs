//! Whole solves on three generated models: the CH and MMP kinds under buckets and in the vertex
//! order of VTP, and FWP-MMP in batches.

use criterion::{Criterion, criterion_group, criterion_main};
use geobench_benches::{named, whole_solves};
use geobench_fwp::{BucketOptions, fwp_ch, fwp_mmp, fwp_mmp_batched, vtp_ch, vtp_mmp};

fn solve(criterion: &mut Criterion) {
    whole_solves(criterion, |mesh| {
        vec![
            named("fwp-ch", fwp_ch(mesh, BucketOptions::default())),
            named("vtp-ch", vtp_ch(mesh)),
            named("fwp-mmp", fwp_mmp(mesh, BucketOptions::default())),
            named(
                "fwp-mmp{turn=list}",
                fwp_mmp_batched(mesh, BucketOptions::default()),
            ),
            named("vtp-mmp", vtp_mmp(mesh)),
        ]
    });
}

criterion_group!(benches, solve);
criterion_main!(benches);
