//! Runs that end once all that is wanted is final.

use geobench_mesh::{Mesh, SplitMix64, VertexId};
use geobench_oracle::zoo;
use geobench_window::{Counter, Goal};

use crate::support::{Failures, Run, exact_algorithms, exact_runs, mesh_of};

/// Has `run` end early at some targets and radii, and compares with its own full runs.
fn check(run: &mut Run<'_>, sources: &[u32], seed: u64, failures: &mut Failures) {
    let full = run.distances(sources);
    let at = run.at(sources);
    let ids: Vec<VertexId> = sources.iter().copied().map(VertexId::new).collect();
    let mut random = SplitMix64::new(seed);
    let mut solve = |goal: &Goal, wanted: &dyn Fn(usize) -> bool, cut: f64| {
        let found = match run.solver().solve_until(&ids, goal) {
            Ok(solution) => solution.distances,
            Err(refused) => return failures.unless(false, || format!("{at}: {refused}")),
        };
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
fn what_is_final_is_what_the_full_run_finds() {
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
fn a_near_target_needs_few_windows() {
    let mut failures = Failures::default();
    let mesh = Mesh::generate("sphere,subdiv=4,noise=0.1,seed=3").unwrap();
    let source = [VertexId::new(0)];
    let near = Goal::targets(mesh.neighbours(source[0]).map(|(v, _)| v));
    for algorithm in exact_algorithms() {
        // These run to their ends.
        let name = algorithm.algorithm().name;
        if matches!(name, "ch" | "pvtp" | "window-vtp" | "lct11" | "xls14") {
            continue;
        }
        let mut run = Run::new(algorithm, "bumpy sphere", &mesh);
        let all = run.solver().count(&source).unwrap().1;
        let few = run.solver().count_until(&source, &near).unwrap().1;
        let [all, few] = [all, few].map(|counters| counters.get(Counter::Parents).unwrap());
        failures.unless(few < all / 20, || {
            format!("{}: {few} of {all} windows", run.at(&[0]))
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
