//! Defects that were fixed, each as a test named after what went wrong.

#[path = "cli/support.rs"]
#[allow(dead_code, reason = "the tests of the command line use the rest")]
mod support;

/// The reference was trusted blindly: where it was wrong, all right answers were called wrong and
/// nothing pointed at the reference.
mod trusted_reference {
    use crate::support::{Outcome, Sandbox};

    /// Calls the program on the square with the algorithms at hand that misbehave.
    fn call(sandbox: &Sandbox, arguments: &str) -> Outcome {
        let output = sandbox
            .command(arguments)
            .env("GEOBENCH_TEST_ALGORITHMS", "1")
            .output()
            .unwrap();
        Outcome {
            code: output.status.code().unwrap(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    fn verify(algorithms: &str) -> Outcome {
        let sandbox = Sandbox::with_square();
        call(
            &sandbox,
            &format!("verify square.off --quiet --algo {algorithms}"),
        )
    }

    /// The outcome of a run, and cluster and message of each cell.
    fn run(arguments: &str) -> (Outcome, Vec<(Option<u64>, String)>) {
        let sandbox = Sandbox::with_square();
        let outcome = call(
            &sandbox,
            &format!("run square.off --repeat 1 --warmup 0 -o r.json -o r.csv --quiet {arguments}"),
        );
        let cells = sandbox.json("r.json")["cells"].as_array().unwrap().clone();
        assert!(sandbox.read("r.csv").contains("check_cluster"));
        let of_cell = |cell: &serde_json::Value| {
            let message = cell["message"].as_str().unwrap_or_default();
            (cell["check"]["cluster"].as_u64(), message.to_owned())
        };
        (outcome, cells.iter().map(of_cell).collect())
    }

    const TWO_ALIKE: &str = "test-wrong,test-wrong{share=0.50000000000001}";

    #[test]
    fn verify_did_not_say_that_the_reference_is_the_odd_one_out() {
        let outcome = verify(TWO_ALIKE);
        assert_eq!(outcome.code, 1);
        assert!(
            outcome.stdout.contains(
                "square: source 0: 2 of 3 algorithms agree with each other; the reference `mmp` \
                 is the odd one out: it differs from them by up to 3.333e-1 relative, at vertex 1\n"
            ),
            "{}",
            outcome.stdout
        );
    }

    #[test]
    fn run_did_not_say_that_the_reference_is_the_odd_one_out() {
        let (outcome, cells) = run("--algo mmp,ich,test-wrong --check test-wrong");
        assert_eq!(outcome.code, 1);
        let summary = "2 of 3 algorithms agree with each other; the reference `test-wrong` is the odd one \
             out: it differs from them by up to 3.333e-1 relative, at vertex 1";
        assert!(
            outcome
                .stderr
                .contains(&format!("error: square, source 0: {summary}\n")),
            "{}",
            outcome.stderr
        );
        let clusters: Vec<_> = cells.iter().map(|(cluster, _)| *cluster).collect();
        assert_eq!(clusters, [Some(1), Some(1), Some(0)]);
        for (_, message) in &cells[..2] {
            assert!(
                message.starts_with("differs from test-wrong: vertex 1 is at 1 instead of 1.5 ")
                    && message.ends_with(
                        "; 3 algorithms: 1 with the reference's answer, 2 with this one, the \
                         reference is the odd one out"
                    ),
                "{message}"
            );
        }
        assert_eq!(cells[2].1, summary);
    }

    #[test]
    fn a_reference_that_has_no_cell_is_named_too() {
        let (outcome, _) = run("--algo mmp,ich --check test-wrong");
        assert_eq!(outcome.code, 1);
        assert!(
            outcome
                .stderr
                .contains("the reference `test-wrong` is the odd one out"),
            "{}",
            outcome.stderr
        );
    }

    #[test]
    fn a_file_that_all_algorithms_disagree_with_is_the_odd_one_out() {
        let sandbox = Sandbox::with_square();
        sandbox.write("square.s0.csv", "0,0\n1,1\n2,1.4\n3,1\n");
        let text = "`./square.s0.csv` differs from `mmp` by up to 1.005e-2 relative, at vertex 2\n";
        let outcome = call(&sandbox, "verify square.off --quiet --algo ich");
        assert_eq!(outcome.code, 1);
        assert!(outcome.stdout.contains(text), "{}", outcome.stdout);
        let outcome = call(
            &sandbox,
            "run square.off --repeat 1 --quiet --algo mmp,ich --check file",
        );
        assert_eq!(outcome.code, 1);
        assert!(
            outcome.stderr.contains(
                "2 of 3 answers agree with each other; the reference `./square.s0.csv` is the \
                 odd one out"
            ),
            "{}",
            outcome.stderr
        );
    }

    #[test]
    fn one_that_is_wrong_is_named_and_the_majority_counted() {
        let text = "2 of 3 algorithms agree with each other, the reference `mmp` among them; \
                    `test-wrong` differs from `mmp` by up to 3.333e-1 relative, at vertex 1\n";
        let outcome = verify("mmp,ich,test-wrong");
        assert_eq!(outcome.code, 1);
        assert!(outcome.stdout.contains(text), "{}", outcome.stdout);
        let (outcome, cells) = run("--algo mmp,ich,test-wrong --check mmp");
        assert_eq!(outcome.code, 1);
        assert!(outcome.stderr.contains(text), "{}", outcome.stderr);
        let clusters: Vec<_> = cells.iter().map(|(cluster, _)| *cluster).collect();
        assert_eq!(clusters, [Some(0), Some(0), Some(1)]);
        assert_eq!((&*cells[0].1, &*cells[1].1), ("", ""));
    }

    #[test]
    fn two_algorithms_have_no_majority() {
        let text = "no majority among the 2 algorithms, either may be wrong: the reference `mmp`; \
                    `test-wrong` differs from `mmp`";
        let outcome = verify("test-wrong");
        assert_eq!(outcome.code, 1);
        assert!(outcome.stdout.contains(text), "{}", outcome.stdout);
        let (outcome, cells) = run("--algo mmp,test-wrong --check mmp");
        assert_eq!(outcome.code, 1);
        assert!(outcome.stderr.contains(text), "{}", outcome.stderr);
        assert!(cells[0].1.starts_with(text));
        assert!(cells[1].1.ends_with(", no majority"));
    }

    #[test]
    fn agreement_is_quiet() {
        let outcome = verify("mmp,ich,vtp");
        assert_eq!((outcome.code, &*outcome.stdout), (0, ""));
        let (outcome, cells) = run("--algo mmp,ich,vtp --check mmp");
        assert_eq!((outcome.code, &*outcome.stderr), (0, ""));
        assert!(cells.iter().all(|cell| *cell == (Some(0), String::new())));
    }

    #[test]
    fn answers_from_before_an_interruption_are_compared_as_well() {
        let sandbox = Sandbox::with_square();
        let arguments = format!(
            "run square.off --repeat 2 --warmup 0 --algo mmp,{TWO_ALIKE},ich --check mmp --quiet \
             --format json --resume j.jsonl"
        );
        let whole = call(&sandbox, &arguments);
        assert_eq!(whole.code, 1);
        let journal = sandbox.read("j.jsonl");
        let summary = |outcome: &Outcome| {
            let mut lines = outcome.stderr.lines();
            let line = lines.find(|line| line.contains("no majority among the 4 algorithms"));
            line.map(str::to_owned)
        };
        assert!(summary(&whole).is_some(), "{}", whole.stderr);
        let lines: Vec<&str> = journal.split_inclusive('\n').collect();
        // From the first run on, which follows the header, the session and the model.
        for kept in 4..=lines.len() {
            sandbox.write("j.jsonl", &lines[..kept].concat());
            let rest = call(&sandbox, &arguments);
            assert_eq!(rest.code, 1, "{kept}");
            assert_eq!(summary(&rest), summary(&whole), "{kept}: {}", rest.stderr);
        }
    }
}

/// A solve with an instruction that Valgrind does not know, as `vtp-fast` on `gen:holes`, ended with
/// SIGILL. Its instructions were missing, and the gate passed by them. These tests need Valgrind.
mod missing_instructions {
    use serde_json::Value;

    use crate::support::{Outcome, Sandbox};

    /// Counts the instructions of an algorithm on the square; standard error and the cell.
    fn count(sandbox: &Sandbox, algorithm: &str) -> (String, Value) {
        let output = sandbox
            .command(&format!(
                "run square.off --algo {algorithm} --check none --repeat 1 --warmup 0 \
                 --instructions --quiet -o r.json"
            ))
            .env("GEOBENCH_TEST_ALGORITHMS", "1")
            .output()
            .unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{stderr}");
        (stderr, sandbox.json("r.json")["cells"][0].clone())
    }

    #[test]
    fn what_valgrind_does_not_know_was_not_counted() {
        let sandbox = Sandbox::with_square();
        let (stderr, cell) = count(&sandbox, "test-illegal");
        assert_eq!(stderr, "");
        assert!(cell["instructions"].as_u64() > Some(0), "{cell}");
        assert_eq!(cell["instructions_simd"], "scalar");
        let (_, cell) = count(&sandbox, "vtp-fast{simd=scalar}");
        assert_eq!(cell["instructions_simd"], "scalar");
    }

    #[test]
    fn vtp_fast_on_a_surface_with_holes_was_not_counted() {
        let sandbox = Sandbox::new();
        sandbox.succeed(
            "run gen:holes --algo vtp-fast --check none --repeat 1 --warmup 0 --instructions \
             --quiet -o r.json",
        );
        let cell = &sandbox.json("r.json")["cells"][0];
        assert!(cell["instructions"].as_u64() > Some(1_000_000), "{cell}");
        assert!(cell["instructions_simd"].is_string());
    }

    #[test]
    fn a_solve_that_cannot_be_counted_passed_the_gate() {
        let sandbox = Sandbox::with_square();
        let (stderr, cell) = count(&sandbox, "test-illegal{unless=never}");
        assert_eq!(cell["instructions"], Value::Null);
        assert_eq!(
            stderr,
            "geobench: warning: square: test-illegal{unless=never}, source 0: instructions are not \
             counted: Valgrind does not know an instruction of the solve, not even with simd=scalar; \
             use a newer Valgrind\n"
        );
        let outcome: Outcome =
            sandbox.call("compare r.json r.json --fail-on propagated=0,instructions=2%");
        assert_eq!(outcome.code, 1, "{}", outcome.stdout);
        assert!(
            outcome.stdout.contains(
                "square, test-illegal{unless=never}, source 0: instructions none -> none: missing in \
                 both files [instructions=2%]"
            ),
            "{}",
            outcome.stdout
        );
    }
}
