//! Runs with goals, which end as soon as the requested distances are final.

use geobench_mesh::{Mesh, SplitMix64, VertexId};
use geobench_oracle::zoo;
use geobench_registry::select;
use geobench_window::{Counter, Counters, Goal, Observer, PhaseSampler};

use crate::support::{EXACT, Failures, Run, can_finish, exact_runs, mesh_of};

/// Runs `run` with several targets and radii, and compares with its full runs.
pub(crate) fn check(run: &mut Run<'_>, sources: &[u32], seed: u64, failures: &mut Failures) {
    let full = run.distances(sources);
    let (at, threads) = (run.at(sources), run.selection.threads());
    let ids: Vec<VertexId> = sources.iter().copied().map(VertexId::new).collect();
    let mut random = SplitMix64::new(seed);
    let mut sampler = PhaseSampler::start().unwrap();
    let mut solve = |goal: &Goal, wanted: &dyn Fn(usize) -> bool, cut: f64| {
        let found = match run.solver().solve_until(&ids, goal) {
            Ok(solution) => solution.distances,
            Err(refused) => return failures.unless(false, || format!("{at}: {refused}")),
        };
        let profiled = run.solver().run(&ids, goal, Observer::Phases(&mut sampler));
        // With several threads, the state at the end of a run varies.
        let same = profiled.is_ok_and(|again| again.distances == found || threads > 1);
        failures.unless(same, || format!("{at}, {goal:?}: other bits when observed"));
        for v in 0..full.len() {
            let expected = if full[v] > cut {
                f64::INFINITY
            } else {
                full[v]
            };
            let known = [found[v]];
            let same =
                run.may_give(&known, &[expected]) || (!wanted(v) && found[v] == f64::INFINITY);
            failures.unless(same, || {
                format!("{at}, {goal:?}: {} at {v} instead of {expected}", found[v])
            });
        }
    };
    let furthest = full
        .iter()
        .copied()
        .filter(|d| d.is_finite())
        .fold(0.0, f64::max);
    for _ in 0..2 {
        let targets: Vec<u32> = (0..=random.below(3))
            .map(|_| random.below(full.len()) as u32)
            .collect();
        let is_target = |v: usize| targets.contains(&(v as u32));
        solve(&Goal::targets(targets.clone()), &is_target, f64::INFINITY);
        let radius = furthest * random.below(100) as f64 / 100.0;
        solve(
            &Goal::everything().within(radius),
            &|v| full[v] <= radius,
            radius,
        );
        let both = Goal::targets(targets.clone()).within(radius);
        solve(&both, &|v| is_target(v) && full[v] <= radius, radius);
    }
    solve(&Goal::targets([0_u32; 0]), &|_| false, f64::INFINITY);
    solve(&Goal::everything(), &|_| true, f64::INFINITY);
    let again = run.distances(sources);
    failures.unless(run.may_give(&again, &full), || {
        format!("{at}: other bits after runs that ended early")
    });
}

#[test]
fn final_distances_are_those_of_the_full_run() {
    let mut failures = Failures::default();
    for (seed, model) in (0..).zip(zoo::small()) {
        let mesh = mesh_of(&model);
        for mut run in exact_runs(&model.name, &mesh) {
            check(&mut run, &model.sources[..1], seed, &mut failures);
            check(&mut run, &model.sources, !seed, &mut failures);
        }
    }
    failures.report();
}

#[test]
fn algorithms_that_end_early_take_few_windows_to_a_near_target() {
    let mut failures = Failures::default();
    let [small, large] =
        [3, 4].map(|n| Mesh::generate(&format!("sphere,subdiv={n},noise=0.1,seed=3")).unwrap());
    let source = [VertexId::new(0)];
    for algorithm in select(&format!("{EXACT},all,certificate")).unwrap() {
        let is_slow = !can_finish(algorithm.algorithm(), large.face_count(), 1e7);
        let mesh = if is_slow { &small } else { &large };
        let near = Goal::targets(mesh.neighbours(source[0]).map(|(v, _)| v));
        let ends_early = algorithm.ends_early();
        let mut run = Run::new(algorithm, "bumpy sphere", mesh);
        let (whole, all) = run.solver().count(&source).unwrap();
        let mut few = Counters::default();
        let observer = Observer::Counters(&mut few);
        let found = run.solver().run(&source, &near, observer).unwrap();
        // Dijkstra's algorithm and fast marching have no windows, and heat has no queue.
        let effort = |counters: &Counters| {
            let parents = counters.get(Counter::Parents);
            parents.or(counters.get(Counter::QueuePushes))
        };
        if let (Some(all), Some(few)) = (effort(&all), effort(&few)) {
            let is_early = few < all / 20;
            failures.unless(is_early == ends_early, || {
                format!("{}: {few} of {all} windows", run.at(&[0]))
            });
        }
        let reached = |d: &[f64]| d.iter().filter(|d| d.is_finite()).count();
        let is_cut = reached(&found.distances) < reached(&whole.distances);
        failures.unless(is_cut == ends_early, || {
            format!("{}: other distances are known, or are not", run.at(&[0]))
        });
    }
    failures.report();
}

#[test]
fn targets_that_do_not_exist_are_refused() {
    let mesh = Mesh::generate("cube,n=2").unwrap();
    for mut run in exact_runs("cube", &mesh) {
        let refused = run.solver().solve_until(&[0.into()], &Goal::targets([99]));
        let message = refused.unwrap_err().to_string();
        assert!(
            message.starts_with("target vertex 99 does not exist"),
            "{message}"
        );
    }
}
