//! Whole solves of `vtp` and of `vtp-fast`, with every set of instructions that the processor has
//! and without each improvement, and of `pvtp`, on three generated models.

use std::hint::black_box;
use std::sync::{Mutex, PoisonError};

use criterion::{Criterion, criterion_group, criterion_main};
use geobench_benches::{named, whole_solves};
use geobench_mesh::{Mesh, VertexId};
use geobench_vtp::{FastOptions, Pvtp, Vtp, VtpFast};
use geobench_window::simd::Instructions;
use geobench_window::{Goal, Observer, Solution, SolveError, Solver};
use rayon::{ThreadPool, ThreadPoolBuilder};

fn options() -> Vec<(String, FastOptions)> {
    let all = FastOptions::default();
    let programs = Instructions::ALL;
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
                spawn_wedge: false,
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

/// Two independent solves of `vtp-fast` at the same time. Their time is the least time of one solve
/// on two threads, doubled. On machines whose processors slow each other down, or that others use
/// as well, it shows what two threads can gain.
struct Twice {
    first: VtpFast,
    second: Mutex<VtpFast>,
    pool: ThreadPool,
}

impl Twice {
    fn new(mesh: &Mesh) -> Self {
        let pool = ThreadPoolBuilder::new().num_threads(1).build();
        Self {
            first: VtpFast::new(mesh),
            second: Mutex::new(VtpFast::new(mesh)),
            pool: pool.expect("the system starts a thread"),
        }
    }
}

impl Solver for Twice {
    fn run(
        &mut self,
        sources: &[VertexId],
        goal: &Goal,
        observer: Observer<'_>,
    ) -> Result<Solution, SolveError> {
        let (first, second) = (&mut self.first, &self.second);
        self.pool.in_place_scope(|scope| {
            scope.spawn_broadcast(|_, _| {
                let mut second = second.lock().unwrap_or_else(PoisonError::into_inner);
                black_box(second.solve(sources)).ok();
            });
            first.run(sources, goal, observer)
        })
    }
}

fn solve(criterion: &mut Criterion) {
    whole_solves(criterion, |mesh| {
        let mut solvers = vec![named("vtp", Vtp::new(mesh))];
        let with = |(name, options)| named(name, VtpFast::with_options(mesh, options));
        solvers.extend(options().into_iter().map(with));
        solvers.push(named("fast-twice-at-once", Twice::new(mesh)));
        solvers.extend([1, 2].map(|n| named(format!("pvtp-{n}"), Pvtp::new(mesh, n))));
        solvers
    });
}

criterion_group!(benches, solve);
criterion_main!(benches);
