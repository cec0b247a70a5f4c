//! Whole solves of `vtp` and of `vtp-fast`, with every set of instructions that the processor has and without each
//! improvement, on three generated models.

use criterion::{Criterion, criterion_group, criterion_main};
use geobench_benches::{named, whole_solves};
use geobench_vtp::{FastOptions, Instructions, Vtp, VtpFast};

fn options() -> Vec<(String, FastOptions)> {
    let all = FastOptions::default();
    let programs = [
        Instructions::Scalar,
        Instructions::Avx2,
        Instructions::Avx512,
    ];
    let programs = programs.into_iter().filter(|i| i.is_available());
    let programs = programs.map(|instructions| {
        let options = FastOptions {
            instructions,
            ..all
        };
        (format!("fast-{instructions}"), options)
    });
    let switched = [
        ("fast-pairs-1", FastOptions { pairs: 1, ..all }),
        (
            "fast-all-around",
            FastOptions {
                shadow: false,
                ..all
            },
        ),
        (
            "fast-own-numbers",
            FastOptions {
                renumber: false,
                ..all
            },
        ),
    ];
    programs
        .chain(switched.map(|(name, options)| (name.to_owned(), options)))
        .collect()
}

fn solve(criterion: &mut Criterion) {
    whole_solves(criterion, |mesh| {
        let mut solvers = vec![named("vtp", Vtp::new(mesh))];
        let with = |(name, options)| named(name, VtpFast::with_options(mesh, options));
        solvers.extend(options().into_iter().map(with));
        solvers
    });
}

criterion_group!(benches, solve);
criterion_main!(benches);
