//! The given bound of the error, compared with exact distances.

mod support;

use geobench_approx::{avtp, mmp_approx};
use geobench_mesh::Mesh;
use geobench_window::{Counter, Goal, Solver};
use support::cases;

#[test]
fn no_error_exceeds_the_bound() {
    for case in cases() {
        for epsilon in [0.0, 1e-6, 1e-3, 0.01, 0.1, 1.0, 30.0] {
            let mut solver = mmp_approx(&case.mesh, epsilon);
            case.check(&mut solver, epsilon, &format!("mmp-approx {epsilon}"));
            let mut solver = avtp(&case.mesh, epsilon);
            case.check(&mut solver, epsilon, &format!("avtp {epsilon}"));
        }
    }
}

#[test]
fn larger_errors_take_fewer_windows() {
    let mesh = Mesh::generate("terrain,n=60,seed=3").unwrap();
    let windows = |epsilon| {
        let (_, counters) = mmp_approx(&mesh, epsilon).count(&[0.into()]).unwrap();
        counters.get(Counter::Propagated).unwrap()
    };
    let counts = [1e-4, 1e-2, 1.0].map(windows);
    assert!(counts[0] > counts[1] && counts[1] > counts[2], "{counts:?}");
}

#[test]
fn a_run_with_a_goal_gives_the_distances_of_a_whole_one() {
    let mesh = Mesh::generate("terrain,n=30,seed=3").unwrap();
    let mut solvers: [Box<dyn Solver>; 2] =
        [Box::new(mmp_approx(&mesh, 0.1)), Box::new(avtp(&mesh, 0.1))];
    for solver in &mut solvers {
        let all = solver.solve(&[0.into()]).unwrap().distances;
        for target in [5, 300, 900] {
            let goal = Goal::targets([target]);
            let found = solver.solve_until(&[0.into()], &goal).unwrap().distances;
            assert_eq!(found[target as usize], all[target as usize]);
            let finite = found.iter().zip(&all).filter(|(d, _)| d.is_finite());
            assert!(finite.into_iter().all(|(d, whole)| d == whole));
        }
    }
}
