//! Algorithms that fail, for tests of how runs report failures. They exist only with the feature
//! `failing-algorithms`, which no release has, and are selected by name only.

use std::hint::black_box;
use std::process::{Command, Stdio};
use std::time::Duration;

use geobench_mesh::{Mesh, VertexId};
use geobench_mmp::mmp_fast;
use geobench_window::simd::Instructions;
use geobench_window::{Goal, Observer, Solution, SolveError, Solver};
use rustix::process::{Signal, getpid, kill_process};

use super::{Algorithm, Parameter, Values};

const AFTER: Parameter = Parameter::integer(
    "after",
    0,
    0..=1_000_000,
    "runs that each solver carries out well before",
);

const BLOCK: Parameter =
    Parameter::integer("block", 1 << 20, 1..=1 << 60, "bytes of each allocation");

const SHARE: Parameter = Parameter::real(
    "share",
    0.5,
    0.0..=1.0,
    "by what share of it a distance is too long",
);

const VERTEX: Parameter = Parameter::integer(
    "vertex",
    1,
    0..=1_000_000,
    "the vertex whose distance is too long; none if it does not exist",
);

const UNLESS: Parameter = Parameter::word(
    "unless",
    &["scalar", "never"],
    "the instructions with which Valgrind knows all of them",
);

pub(crate) const FAMILY: &[Algorithm] = &[
    algorithm("test-panic", &[AFTER], |mesh, values| {
        misbehave(mesh, values, || panic!("no such luck"))
    }),
    algorithm("test-loop", &[AFTER], |mesh, values| {
        misbehave(mesh, values, || {
            // A test waits for this name.
            #[cfg(target_os = "linux")]
            let _ = rustix::thread::set_name(c"test-loop");
            loop {
                // Endless, without taking a processor from other tests.
                std::thread::sleep(Duration::from_millis(1));
            }
        })
    }),
    algorithm("test-allocate", &[AFTER, BLOCK], |mesh, values| {
        let bytes = values.integer(&BLOCK) as usize;
        misbehave(mesh, values, move || {
            let mut blocks = Vec::new();
            loop {
                blocks.push(black_box(vec![1_u8; bytes]));
            }
        })
    }),
    algorithm("test-garbage", &[AFTER], |mesh, values| {
        misbehave(mesh, values, || println!("half way there"))
    }),
    algorithm("test-spawn", &[AFTER], |mesh, values| {
        misbehave(mesh, values, || {
            let mut sleep = Command::new("setsid");
            sleep.args(["--fork", "sleep", "600"]).stderr(Stdio::null());
            let _ = sleep.stdin(Stdio::null()).stdout(Stdio::null()).status();
        })
    }),
    algorithm("test-exit", &[AFTER], |mesh, values| {
        misbehave(mesh, values, || {
            eprintln!("nothing to be done");
            std::process::exit(3)
        })
    }),
    algorithm("test-segv", &[AFTER], |mesh, values| {
        misbehave(mesh, values, || kill(Signal::SEGV))
    }),
    algorithm("test-abort", &[AFTER], |mesh, values| {
        misbehave(mesh, values, || std::process::abort())
    }),
    algorithm("test-kill", &[AFTER], |mesh, values| {
        misbehave(mesh, values, || kill(Signal::KILL))
    }),
    algorithm("test-wrong", &[AFTER, SHARE, VERTEX], |mesh, values| {
        Box::new(Wrong {
            inner: Box::new(mmp_fast(mesh)),
            well: values.integer(&AFTER),
            factor: 1.0 + values.real(&SHARE),
            vertex: values.integer(&VERTEX) as usize,
        })
    }),
    algorithm("test-illegal", &[UNLESS], |mesh, values| {
        let is_known = match values.word(&UNLESS) {
            Some("scalar") => values.instructions() == Instructions::Scalar,
            _ => false,
        };
        misbehave(mesh, &Values::default(), move || {
            if is_under_valgrind() && !is_known {
                kill(Signal::ILL);
            }
        })
    }),
    algorithm("test-overflow", &[AFTER], |mesh, values| {
        misbehave(mesh, values, || {
            black_box(descend(0));
        })
    }),
];

const fn algorithm(
    name: &'static str,
    parameters: &'static [Parameter],
    build: fn(&Mesh, &Values) -> Box<dyn Solver>,
) -> Algorithm {
    Algorithm {
        name,
        family: "test-family",
        paper: "none",
        summary: "does what its name says",
        complexity: "none",
        keeps: "nothing",
        choose: "never",
        parameters,
        build,
        // Exact, so that the tolerance applies.
        ..Algorithm::EXACT
    }
}

/// Sends a signal to this process until it takes effect: the Rust runtime handles the first
/// `SIGSEGV` itself.
fn kill(signal: Signal) {
    loop {
        let _ = kill_process(getpid(), signal);
    }
}

/// Whether this process runs under Valgrind, which preloads a library of its own.
fn is_under_valgrind() -> bool {
    std::env::var("LD_PRELOAD").is_ok_and(|libraries| libraries.contains("vgpreload"))
}

/// Overflows the stack.
#[expect(unconditional_recursion, reason = "that is what it is for")]
fn descend(depth: u64) -> u64 {
    let frame = black_box([depth; 64]);
    descend(depth + 1) + black_box(frame)[7]
}

fn misbehave(mesh: &Mesh, values: &Values, deed: impl FnMut() + Send + 'static) -> Box<dyn Solver> {
    Box::new(Misbehaving {
        inner: Box::new(mmp_fast(mesh)),
        well: values.integer(&AFTER),
        profiled: false,
        deed,
    })
}

/// Solves by `inner`; after a number of successful runs it calls `deed` before each run.
struct Misbehaving<D> {
    inner: Box<dyn Solver>,
    /// Number of further runs that succeed.
    well: u64,
    /// Whether a profiled run has started. It consists of a varying number of solves, which count
    /// as one run.
    profiled: bool,
    deed: D,
}

impl<D: FnMut()> Misbehaving<D> {
    fn begin(&mut self) {
        match self.well.checked_sub(1) {
            Some(less) => self.well = less,
            None => (self.deed)(),
        }
    }
}

impl<D: FnMut() + Send> Solver for Misbehaving<D> {
    fn run(
        &mut self,
        sources: &[VertexId],
        goal: &Goal,
        observer: Observer<'_>,
    ) -> Result<Solution, SolveError> {
        let is_profile = matches!(observer, Observer::Phases(_));
        if !is_profile || !std::mem::replace(&mut self.profiled, true) {
            self.begin();
        }
        self.inner.run(sources, goal, observer)
    }
}

/// Solves by `inner`; after a number of correct answers it makes one distance wrong.
struct Wrong {
    inner: Box<dyn Solver>,
    /// Number of further correct answers.
    well: u64,
    factor: f64,
    vertex: usize,
}

impl Wrong {
    fn spoil(&mut self, solution: &mut Solution) {
        match self.well.checked_sub(1) {
            Some(less) => self.well = less,
            None => {
                if let Some(distance) = solution.distances.get_mut(self.vertex) {
                    *distance *= self.factor;
                }
            }
        }
    }
}

impl Solver for Wrong {
    fn run(
        &mut self,
        sources: &[VertexId],
        goal: &Goal,
        observer: Observer<'_>,
    ) -> Result<Solution, SolveError> {
        let mut solution = self.inner.run(sources, goal, observer)?;
        self.spoil(&mut solution);
        Ok(solution)
    }
}
