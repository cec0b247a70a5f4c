//! Whole solves on three generated models: windows of the CH and of the MMP kind from buckets, and
//! in the order of VTP.

use criterion::{Criterion, criterion_group, criterion_main};
use geobench_benches::{named, whole_solves};
use geobench_fwp::{BucketOptions, fwp_ch, fwp_mmp, fwp_mmp_by_window, vtp_ch, vtp_mmp};

fn solve(criterion: &mut Criterion) {
    whole_solves(criterion, |mesh| {
        vec![
            named("fwp-ch", fwp_ch(mesh, BucketOptions::default())),
            named("vtp-ch", vtp_ch(mesh)),
            named("fwp-mmp", fwp_mmp(mesh, BucketOptions::default())),
            named(
                "fwp-mmp-by-window",
                fwp_mmp_by_window(mesh, BucketOptions::default()),
            ),
            named("vtp-mmp", vtp_mmp(mesh)),
        ]
    });
}

criterion_group!(benches, solve);
criterion_main!(benches);
