//! Tests of the runner with a mock backend.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use geobench_registry as registry;

use crate::exec::mock::{MockBackend, crash_ich, spoil_vtp};
use crate::exec::{Listener, Pass, Step};
use crate::plan::sampling::Sampling;
use crate::plan::{Plan, Reference};
use crate::run::mock::{NullListener, plan, run_mock};
use crate::run::{Records, run};
use crate::schema::{Cell, PhaseSeconds, Precision, Status};

fn cell<'c>(cells: &'c [Cell], algorithm: &str) -> &'c Cell {
    cells.iter().find(|c| c.algorithm == algorithm).unwrap()
}

#[test]
fn runs_are_interleaved_and_the_reference_goes_first() {
    let mut plan = plan(&["horse"], "vtp,mmp", "0");
    plan.sampling = Sampling::Fixed(2);
    let backend = MockBackend::default();
    let records = run_mock(&plan, &backend);
    assert_eq!(
        backend.log(),
        [
            "warm mmp 0",
            "warm vtp 0",
            "time vtp 0",
            "time mmp 0",
            "time mmp 0",
            "time vtp 0",
            "clock vtp 0",
            "clock mmp 0",
            "count vtp 0",
            "count mmp 0",
        ]
    );
    assert_eq!(plan.runs(), backend.log().len());
    assert_eq!(cell(&records.cells, "vtp").time.places, [0, 1]);
    assert_eq!(cell(&records.cells, "mmp").time.places, [1, 0]);
}

/// The runs that a progress bar counts.
#[derive(Default)]
struct BarCounts {
    total: usize,
    done: usize,
}

impl Listener for BarCounts {
    fn step(&mut self, _: &Step<'_>) {
        self.done += 1;
        assert!(self.done <= self.total);
    }

    fn more(&mut self, runs: usize) {
        self.total += runs;
    }

    fn skipped(&mut self, runs: usize) {
        self.done += runs;
        assert!(self.done <= self.total);
    }
}

#[test]
fn progress_ends_at_its_total() {
    for (algorithms, warmup, sampling) in [
        ("vtp,mmp", 0, Sampling::Fixed(1)),
        ("vtp,mmp", 1, Sampling::Fixed(2)),
        ("vtp", 0, Sampling::Fixed(1)),
        ("vtp,ich", 0, Sampling::UntilPrecise(Precision::USUAL)),
    ] {
        let mut plan = plan(&["horse", "cow"], algorithms, "0,1");
        plan.reference = Reference::usual(&plan.algorithms);
        plan.warmup = warmup;
        plan.sampling = sampling;
        for counts in [false, true] {
            plan.counts = counts;
            let mut bar = BarCounts {
                total: plan.runs(),
                done: 0,
            };
            run(&plan, &MockBackend::default(), None, None, &mut bar, 1).unwrap();
            assert_eq!(bar.done, bar.total, "{algorithms}");
        }
    }
}

#[test]
fn without_a_number_each_cell_repeats_until_it_is_precise() {
    let mut plan = plan(&["horse"], "mmp,ich,vtp", "0");
    plan.sampling = Sampling::UntilPrecise(Precision::USUAL);
    // mmp: constant times; ich: between 50 and 150 % of the median; vtp: constant and short.
    let backend = MockBackend {
        time: Some(|name, nth| match name {
            "mmp" => 1.0,
            "ich" => 1.0 + ((nth % 7) as f64 - 3.0) / 6.0,
            _ => 0.001,
        }),
        ..MockBackend::default()
    };
    let records = run_mock(&plan, &backend);
    let time = |name| &cell(&records.cells, name).time;
    assert_eq!(time("mmp").samples.len(), 6);
    assert!(time("mmp").solves.is_empty() && !time("mmp").is_imprecise());
    // The maximum time of 20 s is reached before the maximum number of runs.
    let spent: f64 = time("ich").samples.iter().sum();
    assert!((20.0..22.0).contains(&spent) && time("ich").solves.is_empty());
    assert!(time("ich").is_imprecise());
    // The minimum time of 0.2 s, in batches of a twentieth of it.
    assert_eq!(time("vtp").solves, [10; 20]);
    assert_eq!(time("vtp").precision, Some(0.03));
    // Every cell has a run in each of the first rounds, so that samples form pairs.
    let timed = backend
        .log()
        .into_iter()
        .filter(|run| run.starts_with("time"));
    let first: Vec<String> = timed.take(15).collect();
    for round in first.chunks(3) {
        assert!(round[0] != round[1] && round[1] != round[2] && round[0] != round[2]);
    }
    assert_eq!(time("mmp").places.len(), 6);
    assert_eq!(time("vtp").places.len(), 20);
}

#[test]
fn a_reference_that_is_not_measured_runs_once() {
    let mut plan = plan(&["horse"], "vtp", "0");
    plan.reference = Reference::Algorithm(registry::select_one("ich").unwrap());
    plan.warmup = 0;
    plan.sampling = Sampling::Fixed(1);
    let backend = MockBackend::default();
    let records = run_mock(&plan, &backend);
    assert_eq!(
        backend.log(),
        ["warm ich 0", "time vtp 0", "clock vtp 0", "count vtp 0"]
    );
    assert_eq!(records.cells.len(), 1);
    assert_eq!(records.cells[0].check.reference.as_deref(), Some("ich"));
}

#[test]
fn a_wrong_answer_is_a_failed_cell_and_never_a_time() {
    let backend = MockBackend {
        alter: Some(spoil_vtp),
        ..MockBackend::default()
    };
    let records = run_mock(&plan(&["horse"], "mmp,vtp", "0"), &backend);
    let wrong = cell(&records.cells, "vtp");
    assert_eq!(wrong.status, Status::Wrong);
    assert_eq!(wrong.time.median, None);
    assert!(wrong.time.samples.is_empty());
    assert_eq!(wrong.memory.papers_bytes, None);
    assert_eq!(wrong.check.max_abs, Some(0.25));
    assert_eq!(
        wrong.message.as_deref().unwrap(),
        "differs from mmp: vertex 2 is at 1.75 instead of 1.5 (difference 2.500e-1, relative 1.429e-1); \
         1 of 4 vertices differ by more than 1e-9 relative and rounding; 2 algorithms: 1 with the reference's answer, \
         1 with this one, no majority"
    );
    assert_eq!(cell(&records.cells, "mmp").status, Status::Ok);
    let vtp_runs = backend.log().iter().filter(|l| l.contains("vtp")).count();
    assert_eq!(
        vtp_runs, 2,
        "nothing more is asked of an algorithm that was wrong"
    );
}

#[test]
fn a_crash_costs_one_cell() {
    let backend = MockBackend {
        alter: Some(crash_ich),
        ..MockBackend::default()
    };
    let records = run_mock(&plan(&["horse", "cow"], "mmp,ich,vtp", "0"), &backend);
    let statuses: Vec<_> = records.cells.iter().map(|c| c.status.name()).collect();
    assert_eq!(statuses, ["ok", "crashed", "ok", "ok", "crashed", "ok"]);
    assert!(
        records.cells[1]
            .message
            .as_deref()
            .unwrap()
            .contains("index out of bounds")
    );
}

#[test]
fn cells_without_their_reference_are_unchecked() {
    let backend = MockBackend {
        alter: Some(|step, _| match step.algorithm.label() {
            "mmp" => Some(crate::exec::Failure {
                status: Status::Crashed,
                message: "boom".into(),
            }),
            _ => None,
        }),
        ..MockBackend::default()
    };
    let records = run_mock(&plan(&["horse"], "mmp,vtp", "0"), &backend);
    assert_eq!(records.cells[0].status, Status::Crashed);
    let unchecked = &records.cells[1];
    assert_eq!(unchecked.status, Status::Ok);
    assert_eq!(unchecked.check.reference, None);
    assert_eq!(
        unchecked.message.as_deref(),
        Some("not checked: the reference mmp failed: boom")
    );
}

#[test]
fn a_refused_model_has_its_cells_and_the_others_run() {
    let backend = MockBackend {
        refuse: vec!["broken"],
        ..MockBackend::default()
    };
    let records = run_mock(&plan(&["broken", "cow"], "mmp,vtp", "0"), &backend);
    let statuses: Vec<_> = records.cells.iter().map(|c| c.status.name()).collect();
    assert_eq!(statuses, ["refused", "refused", "ok", "ok"]);
    assert_eq!(records.models[0].vertices, None);
    assert_eq!(
        records.cells[0].message.as_deref(),
        Some("broken.obj: edge 3-7 has 3 faces")
    );
}

#[test]
fn a_source_that_does_not_exist_is_refused() {
    let records = run_mock(&plan(&["cow"], "vtp", "2,4"), &MockBackend::default());
    assert_eq!(records.cells.len(), 2);
    assert!(records.cells.iter().all(|c| c.status == Status::Refused));
    assert_eq!(
        records.cells[0].message.as_deref(),
        Some("cow.obj: source vertex 4 does not exist: the model has 4 vertices, numbered from 0")
    );
}

#[test]
fn any_number_of_random_sources_is_refused_at_once() {
    let plan = plan(&["cow"], "mmp,vtp", "random:999999999999999");
    let records = run_mock(&plan, &MockBackend::default());
    assert_eq!(records.cells.len(), 2);
    assert!(
        records
            .cells
            .iter()
            .all(|c| c.status == Status::Refused && c.source.is_none())
    );
}

#[test]
fn figures_come_from_the_runs_that_are_meant_for_them() {
    let records = run_mock(&plan(&["cow"], "mmp,vtp", "0"), &MockBackend::default());
    let (mmp, vtp) = (&records.cells[0], &records.cells[1]);
    assert_eq!(mmp.time.samples.len(), 6);
    assert_eq!(mmp.time.setup, Some(0.125));
    assert_eq!(
        mmp.memory.papers_bytes,
        Some(80 * 1_000_003),
        "stored windows"
    );
    assert_eq!(
        vtp.memory.papers_bytes,
        Some(80 * 10),
        "windows alive at the peak"
    );
    assert_eq!(vtp.memory.windows_peak_bytes, Some(640));
    // Two quarters, one and a half of one of the mock profile, as shares of the median time.
    let median = vtp.time.median.unwrap();
    let pruning = vtp.phases.pruning.unwrap();
    assert!((pruning - median * 2.0 / 7.0).abs() < 1e-9 * median);
    assert_eq!(vtp.check.unreachable, Some(1));
}

#[test]
fn without_a_check_only_nan_is_wrong() {
    let mut plan = plan(&["cow"], "vtp", "0");
    plan.reference = Reference::None;
    let records = run_mock(&plan, &MockBackend::default());
    assert_eq!(records.cells[0].status, Status::Ok);
    assert_eq!(records.cells[0].check.reference, None);
    let backend = MockBackend {
        alter: Some(|_, observation| {
            observation.distances[1] = f64::NAN;
            None
        }),
        ..MockBackend::default()
    };
    assert_eq!(run_mock(&plan, &backend).cells[0].status, Status::Wrong);
}

/// Requests an interruption after this number of runs.
struct Impatient(usize);

impl Listener for Impatient {
    fn step(&mut self, _: &Step<'_>) {
        self.0 = self.0.saturating_sub(1);
    }

    fn interrupted(&self) -> bool {
        self.0 == 0
    }
}

#[test]
fn an_interrupted_run_returns_the_complete_cells() {
    let plan = plan(&["cow", "horse"], "mmp,ich,vtp", "0");
    let stopped_after = |runs| {
        let backend = MockBackend {
            alter: Some(crash_ich),
            ..MockBackend::default()
        };
        let mut listener = Impatient(runs);
        let records = run(&plan, &backend, None, None, &mut listener, 1).unwrap();
        assert_eq!(backend.log().len(), runs);
        let cells = records.cells.iter();
        let cells: Vec<String> = cells
            .map(|cell| format!("{} {} {}", cell.model, cell.algorithm, cell.status.name()))
            .collect();
        (records.models.len(), cells.join(", "))
    };
    let cow = "cow mmp ok, cow ich crashed, cow vtp ok";
    // Three warm-ups, one round of three runs, five rounds of two, two profiled and two counting
    // runs.
    let runs_of_cow = 3 + 3 + 5 * 2 + 2 + 2;
    for (runs, models, cells) in [
        (runs_of_cow, 1, cow.to_owned()),
        (runs_of_cow + 2, 1, cow.to_owned()),
        (runs_of_cow + 7, 2, format!("{cow}, horse ich crashed")),
        (
            2 * runs_of_cow - 1,
            2,
            format!("{cow}, horse mmp ok, horse ich crashed"),
        ),
        (3, 0, String::new()),
    ] {
        assert_eq!(stopped_after(runs), (models, cells), "{runs}");
    }
}

/// The cells without their times, which differ from run to run.
fn essence(cells: &[Cell]) -> Vec<Cell> {
    let timeless = |cell: &Cell| Cell {
        time: crate::schema::Time {
            samples: vec![0.0; cell.time.samples.len()],
            ..Default::default()
        },
        phases: PhaseSeconds::default(),
        ..cell.clone()
    };
    cells.iter().map(timeless).collect()
}

/// Executes `plan` with up to `jobs` concurrent cells.
fn run_jobs(plan: &Plan, backend: &MockBackend, jobs: usize) -> Records {
    run(plan, backend, None, None, &mut NullListener, jobs).unwrap()
}

#[test]
fn cells_at_the_same_time_have_the_results_of_one_after_the_other_in_the_same_order() {
    let mut plan = plan(
        &["cow", "broken", "horse", "spot"],
        "mmp,ich,vtp,fwp-mmp",
        "0,3,1",
    );
    for alter in [None, Some(crash_ich as _), Some(spoil_vtp as _)] {
        for reference in ["mmp", "ch"] {
            plan.reference = Reference::Algorithm(registry::select_one(reference).unwrap());
            let backend = || MockBackend {
                alter,
                refuse: vec!["broken"],
                ..MockBackend::default()
            };
            let (alone, together) = (backend(), backend());
            let expected = run_jobs(&plan, &alone, 1);
            let found = run_jobs(&plan, &together, 5);
            assert_eq!(essence(&found.cells), essence(&expected.cells));
            assert_eq!(found.models, expected.models);
            let sorted = |backend: &MockBackend| {
                let mut log = backend.log();
                log.sort();
                log
            };
            assert_eq!(sorted(&together), sorted(&alone), "the same runs");
            // Concurrent cells have no common rounds.
            assert!(found.cells.iter().all(|cell| cell.time.places.is_empty()));
        }
    }
}

#[test]
fn jobs_limit_the_cells_at_a_time_and_the_reference_is_first() {
    static RUNNING: AtomicUsize = AtomicUsize::new(0);
    static MOST: AtomicUsize = AtomicUsize::new(0);
    let plan = plan(&["cow"], "vtp,mmp,ich,fwp-mmp", "0");
    let backend = MockBackend {
        alter: Some(|step, _| {
            let running = RUNNING.fetch_add(1, Ordering::SeqCst) + 1;
            MOST.fetch_max(running, Ordering::SeqCst);
            // The others wait for the first run of the reference, and then for each other.
            let is_first = step.pass == Pass::Warmup && step.algorithm.label() == "mmp";
            let mut waits = if is_first { 0 } else { 60_000 };
            while waits > 0 && MOST.load(Ordering::SeqCst) < 3 {
                thread::sleep(Duration::from_millis(1));
                waits -= 1;
            }
            // A fourth one would come meanwhile.
            thread::sleep(Duration::from_millis(20));
            RUNNING.fetch_sub(1, Ordering::SeqCst);
            None
        }),
        ..MockBackend::default()
    };
    run_jobs(&plan, &backend, 3);
    assert_eq!(MOST.load(Ordering::SeqCst), 3);
    assert_eq!(backend.log()[0], "warm mmp 0");
}

#[test]
fn an_interruption_ends_the_cells_that_run_at_the_same_time() {
    let plan = plan(&["cow", "horse", "spot"], "mmp,ich,vtp", "0,1");
    for runs in [1, 5, 9, 40] {
        let backend = MockBackend::default();
        let mut listener = Impatient(runs);
        let records = run(&plan, &backend, None, None, &mut listener, 4).unwrap();
        // Runs in progress are finished.
        assert!((runs..runs + 4).contains(&backend.log().len()), "{runs}");
        assert!(records.cells.iter().all(|cell| cell.status == Status::Ok));
        assert!(records.cells.len() <= runs / 8, "{runs}");
    }
}
