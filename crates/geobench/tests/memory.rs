//! The peaks of memory that a child process reports for a cell belong to that cell only.

#![cfg(target_os = "linux")]

use std::hint::black_box;

use geobench_harness::exec::goal::GoalSpec;
use geobench_harness::exec::isolate::Isolated;
use geobench_harness::exec::limits::Limits;
use geobench_harness::exec::model::ModelRef;
use geobench_harness::exec::{Backend, Pass, Step};
use geobench_harness::measure::memory::Peaks;
use geobench_mesh::VertexId;
use geobench_registry as registry;

const MEGABYTE: u64 = 1 << 20;

fn isolated() -> Isolated {
    Isolated {
        limits: Limits::USUAL,
        program: Some(env!("CARGO_BIN_EXE_geobench").into()),
        ..Isolated::default()
    }
}

/// Executes these runs and returns the memory peaks of each.
fn runs(place: &Isolated, model: &str, list: &[(&str, Pass)]) -> Vec<Peaks> {
    let model = ModelRef::generated(model).unwrap();
    let mut session = place.open(&model).unwrap();
    let peaks = list.iter().map(|&(algorithm, pass)| {
        let step = Step {
            model: &model.name,
            algorithm: &registry::select_one(algorithm).unwrap(),
            source: &VertexId::new(0).into(),
            goal: &GoalSpec::default(),
            pass,
            solves: 1,
        };
        session.execute(&step).unwrap().peaks
    });
    peaks.collect()
}

fn measured(place: &Isolated) -> Peaks {
    runs(place, "gen:sphere,subdiv=4", &[("vtp", Pass::Profile)])[0]
}

#[test]
fn the_heap_of_a_run_is_the_same_each_time() {
    let model = "gen:anisotropic,faces=2000,g=4";
    let heap = |algorithm| runs(&isolated(), model, &[(algorithm, Pass::Profile)])[0].heap;
    for algorithm in ["vtp", "vtp-fast"] {
        let first = heap(algorithm);
        assert!(first.is_some());
        for _ in 0..3 {
            assert_eq!(heap(algorithm), first, "{algorithm}");
        }
    }
}

#[test]
fn a_parent_of_a_gigabyte_does_not_change_the_figures_of_a_child() {
    let alone = measured(&isolated());
    let gigabyte = black_box(vec![1_u8; 1024 * MEGABYTE as usize]);
    let beside = measured(&isolated());
    drop(gigabyte);
    assert_eq!(alone.heap, beside.heap);
    let (alone, beside) = (alone.rss.unwrap(), beside.rss.unwrap());
    assert!(alone < 200 * MEGABYTE, "{alone}");
    // How much of the program is resident depends on what else the system keeps in memory.
    assert!(alone.abs_diff(beside) < 100 * MEGABYTE, "{alone} {beside}");
}

#[test]
fn solvers_of_the_timed_runs_are_no_part_of_the_peak() {
    let model = "gen:torus,faces=20000,bump=0.1,seed=7";
    let fresh = runs(&isolated(), model, &[("mmp", Pass::Profile)])[0];
    let used = runs(
        &isolated(),
        model,
        &[("mmp", Pass::Time), ("mmp", Pass::Profile)],
    )[1];
    assert!(fresh.heap.is_some());
    assert_eq!(used.heap, fresh.heap);
}

/// Counting runs store levels in maps. These once made lists of windows look 50 % larger.
#[test]
fn memory_of_the_counters_is_not_counted() {
    let model = "gen:torus,faces=5000,bump=0.1,seed=7";
    let purposes = [
        ("vtp", Pass::Profile),
        ("vtp", Pass::Count),
        ("vtp", Pass::Profile),
    ];
    let peaks = runs(&isolated(), model, &purposes);
    assert_eq!(peaks[1], Peaks::default());
    assert_eq!(peaks[0].heap, peaks[2].heap);
}

/// Children of this thread.
fn children() -> usize {
    let list = std::fs::read_to_string("/proc/thread-self/children").unwrap();
    list.split_whitespace().count()
}

#[test]
fn where_all_hold_too_much_a_child_ends_after_its_run_and_comes_back_warm() {
    let model = ModelRef::generated("gen:sphere,subdiv=2").unwrap();
    for (budget, alive) in [(u64::MAX, [1, 2, 2, 2, 2]), (1, [1, 1, 1, 1, 1])] {
        let mut alive = alive.into_iter();
        let place = Isolated {
            budget: Some(budget),
            ..isolated()
        };
        let mut session = place.open(&model).unwrap();
        let vertices = session.model().vertices.unwrap() as usize;
        for (algorithm, pass) in [
            ("mmp", Pass::Warmup),
            ("vtp", Pass::Warmup),
            ("mmp", Pass::Time),
            ("vtp", Pass::Time),
            ("vtp", Pass::Count),
        ] {
            let step = Step {
                model: &model.name,
                algorithm: &registry::select_one(algorithm).unwrap(),
                source: &VertexId::new(0).into(),
                goal: &GoalSpec::default(),
                pass,
                solves: 1,
            };
            let observation = session.execute(&step).unwrap();
            assert_eq!(observation.distances.len(), vertices);
            assert_eq!(Some(children()), alive.next(), "{algorithm} {pass:?}");
            // A solver that is set up by a timed run has not been warmed up.
            let cold = observation.setup_seconds.is_some();
            assert_eq!(cold, pass == Pass::Warmup);
        }
        drop(session);
        assert_eq!(children(), 0);
    }
}
