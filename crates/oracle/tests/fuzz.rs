//! The algorithms on random nasty meshes and on meshes that have broken them, as the example `fuzz`
//! judges them. It takes more seeds, makes failures smaller and saves them.

use std::io::{self, Write};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use case::{Case, Expected, Skip, Verdict};
use geobench_oracle::nasty;

#[path = "../examples/fuzz/case.rs"]
#[expect(dead_code, reason = "the example uses the rest")]
mod case;
#[path = "../examples/fuzz/judge.rs"]
mod judge;
#[path = "../examples/fuzz/slivers.rs"]
mod slivers;
#[path = "../examples/fuzz/variants.rs"]
#[expect(dead_code, reason = "the example uses the rest")]
mod variants;

/// Longer than all algorithms together take for a mesh.
const LIMIT: Duration = Duration::from_secs(60);

/// What all algorithms got wrong, or why the mesh is skipped. On a mesh with known distances none
/// of them may be in doubt.
fn failures(name: &str, case: &Case, known: Option<Expected>) -> Result<Vec<String>, Skip> {
    let mesh = judge::mesh(case)?;
    let may_doubt = known.is_none();
    let expected = match known {
        Some(expected) => expected,
        None => judge::expected(case, &mesh)?,
    };
    let work = case
        .bounded
        .then(|| judge::work_of_mmp(case, &mesh))
        .flatten();
    let mut failures = Vec::new();
    for algorithm in variants::selected("all", false).expect("the registry knows `all`") {
        let label = algorithm.label();
        match judge::judge(&algorithm, case, &mesh, &expected, work) {
            Verdict::Failed(failure) => failures.push(format!("{name}, {label}: {failure}")),
            Verdict::InDoubt if !may_doubt => failures.push(format!("{name}, {label}: in doubt")),
            Verdict::Right | Verdict::InDoubt | Verdict::LeftOut => {}
        }
    }
    Ok(failures)
}

/// Fails with all that any algorithm gets wrong, or with the first mesh on which one hangs. Returns
/// how many meshes were judged.
fn check(cases: Vec<(String, Case, Option<Expected>)>) -> usize {
    const SHOWN: usize = 60;
    let mut wrong = Vec::new();
    let mut judged = 0;
    for (name, case, known) in cases {
        let (sender, result) = channel();
        let label = name.clone();
        thread::spawn(move || sender.send(failures(&label, &case, known)));
        match result.recv_timeout(LIMIT) {
            Ok(Ok(failures)) => {
                judged += 1;
                wrong.extend(failures);
            }
            Ok(Err(Skip::MeshPanics)) => panic!("{name}: the mesh cannot be built"),
            Ok(Err(_)) => {}
            Err(RecvTimeoutError::Timeout) => panic!("{name}: some algorithm hangs"),
            Err(RecvTimeoutError::Disconnected) => panic!("{name}: the judge panicked"),
        }
    }
    let count = wrong.len();
    wrong.truncate(SHOWN);
    assert!(count == 0, "{count} wrong answers:\n{}", wrong.join("\n"));
    judged
}

#[test]
fn random_nasty_meshes_are_solved_right() {
    let case = |seed| {
        let mesh = nasty::mesh(seed);
        (mesh.model.name.clone(), mesh.into(), None)
    };
    assert!(check((0..75).map(case).collect()) > 50);
}

/// Seeds on which algorithms were wrong, or took far too many windows.
const SEEDS_THAT_FAILED: [u64; 14] = [
    1512, 10_848, 22_262, 27_012, 30_187, 37_162, 40_412, 43_054, 45_450, 62_504, 81_137, 83_209,
    89_894, 98_387,
];

#[test]
fn seeds_that_failed_once_are_solved_right() {
    let case = |seed| {
        let mesh = nasty::mesh(seed);
        (mesh.model.name.clone(), mesh.into(), None)
    };
    let judged = check(SEEDS_THAT_FAILED.into_iter().map(case).collect());
    assert_eq!(judged, SEEDS_THAT_FAILED.len());
}

#[test]
fn slivers_are_solved_right() {
    let Ok(slivers) = slivers::read() else {
        // Written past the capture of test output, which would hide it.
        let _ = writeln!(
            io::stderr(),
            "SKIPPED: {} is missing; set GEOBENCH_SHARED to the folder with slivers/",
            slivers::path().display()
        );
        return;
    };
    let case = |sliver: slivers::Sliver| {
        let case = Case {
            vertices: sliver.vertices,
            faces: sliver.faces,
            sources: sliver.source,
            bounded: true,
        };
        (sliver.name, case, Some(sliver.distances))
    };
    check(slivers.into_iter().map(case).collect());
}
