//! Where answers disagree, a proof decides which are right.

use std::path::{Path, PathBuf};
use std::{env, fs};

use serde_json::{Value, json};

use crate::support::{Outcome, Sandbox};

const TWO_ALIKE: &str = "test-wrong,test-wrong{share=0.50000000000001}";

/// The outcome of a run on the square, and its cells.
fn run(sandbox: &Sandbox, arguments: &str) -> (Outcome, Vec<Value>) {
    let outcome = sandbox.call(&format!(
        "run square.off --repeat 2 --warmup 0 -o r.json --quiet {arguments}"
    ));
    let cells = sandbox.json("r.json")["cells"].as_array().unwrap().clone();
    (outcome, cells)
}

/// Field of the check of each cell.
fn checks(cells: &[Value], field: &str) -> Value {
    cells
        .iter()
        .map(|cell| cell["check"][field].clone())
        .collect()
}

fn statuses(cells: &[Value]) -> Value {
    cells.iter().map(|cell| cell["status"].clone()).collect()
}

#[test]
fn the_majority_is_wrong() {
    let sandbox = Sandbox::with_square();
    let outcome = sandbox.call(&format!("verify square.off --algo {TWO_ALIKE}"));
    assert_eq!(outcome.code, 1);
    let said = &outcome.stdout;
    assert!(
        said.starts_with(
            "square: source 0: mmp-fast: ok: reference for 4 vertices, 0 unreachable\n"
        ),
        "{said}"
    );
    assert!(
        said.contains(
            "square: source 0: test-wrong: WRONG: differs from proven distances: vertex 1 is at \
             1.5 instead of 1 "
        ),
        "{said}"
    );
    assert!(
        said.contains("the reference `mmp-fast` is the odd one out"),
        "{said}"
    );
    assert!(
        said.ends_with("source 0: proven right: mmp-fast\n1 of 3 answers agree\n"),
        "{said}"
    );
    let (outcome, cells) = run(
        &sandbox,
        &format!("--algo mmp-fast,{TWO_ALIKE} --check mmp-fast"),
    );
    assert_eq!(outcome.code, 1);
    assert!(
        outcome.stderr.contains("; proven right: mmp-fast\n"),
        "{}",
        outcome.stderr
    );
    assert_eq!(statuses(&cells), json!(["ok", "wrong", "wrong"]));
    assert_eq!(checks(&cells, "proven"), json!([true, false, false]));
    assert_eq!(
        cells[1]["check"]["proof"],
        "certificate: the reference mmp-fast is right"
    );
    assert_eq!(checks(&cells, "replaced"), json!([null, null, null]));
}

#[test]
fn a_wrong_reference_is_the_failed_cell() {
    let sandbox = Sandbox::with_square();
    let wrong = "--algo mmp,test-wrong,ich --check test-wrong";
    for jobs in ["", "--jobs 2", "--isolate none"] {
        let (outcome, cells) = run(&sandbox, &format!("{wrong} {jobs}"));
        assert_eq!(outcome.code, 1, "{}", outcome.stderr);
        assert_eq!(statuses(&cells), json!(["ok", "wrong", "ok"]), "{jobs}");
        assert_eq!(checks(&cells, "proven"), json!([true, false, true]));
        assert_eq!(checks(&cells, "cluster"), json!([0, 1, 0]));
        let replaced = json!(["test-wrong", "test-wrong", "test-wrong"]);
        assert_eq!(checks(&cells, "replaced"), replaced);
        let reference = json!(["certificate", "certificate", "certificate"]);
        assert_eq!(checks(&cells, "reference"), reference);
        assert_eq!(cells[0]["time"]["samples"].as_array().unwrap().len(), 2);
        assert_eq!(cells[0]["check"]["max_rel"], 0.0);
        let message = cells[1]["message"].as_str().unwrap();
        assert!(
            message.starts_with("differs from certificate: vertex 1 is at 1.5 instead of 1 "),
            "{message}"
        );
        let said = "square, source 0: the reference `test-wrong` is proven wrong; ";
        assert!(outcome.stderr.contains(said), "{}", outcome.stderr);
        assert!(
            outcome.stderr.contains("; proven right: mmp, ich\n"),
            "{}",
            outcome.stderr
        );
    }
}

#[test]
fn a_wrong_reference_without_a_cell_fails_the_run() {
    let sandbox = Sandbox::with_square();
    let (outcome, cells) = run(&sandbox, "--algo mmp,ich --check test-wrong");
    assert_eq!(outcome.code, 1);
    assert_eq!(statuses(&cells), json!(["ok", "ok"]));
    assert!(
        outcome.stderr.contains("a reference is proven wrong"),
        "{}",
        outcome.stderr
    );
    sandbox.write("square.s0.csv", "0,0\n2,1.4\n");
    let (outcome, cells) = run(&sandbox, "--algo mmp-fast,ich --check file");
    assert_eq!(outcome.code, 1);
    assert_eq!(statuses(&cells), json!(["ok", "ok"]));
    assert_eq!(cells[0]["check"]["replaced"], "./square.s0.csv");
}

#[test]
fn all_may_be_wrong() {
    let sandbox = Sandbox::with_square();
    let algorithms = "test-wrong,test-wrong{share=0.25}";
    let (outcome, cells) = run(&sandbox, &format!("--algo {algorithms} --check test-wrong"));
    assert_eq!(outcome.code, 1);
    assert_eq!(statuses(&cells), json!(["wrong", "wrong"]));
    assert_eq!(checks(&cells, "cluster"), json!([1, 2]));
    assert!(
        outcome
            .stderr
            .contains("no answer agrees with the proven distances"),
        "{}",
        outcome.stderr
    );
}

#[test]
fn answers_are_decided_if_the_reference_failed() {
    let sandbox = Sandbox::with_square();
    let (outcome, cells) = run(
        &sandbox,
        "--algo test-panic,test-wrong,mmp --check test-panic",
    );
    assert_eq!(outcome.code, 1);
    assert_eq!(statuses(&cells), json!(["crashed", "wrong", "ok"]));
    assert_eq!(checks(&cells, "proven"), json!([null, false, true]));
    assert_eq!(cells[2]["check"]["reference"], "certificate");
    assert_eq!(
        cells[2]["check"]["proof"],
        "certificate, since the reference failed"
    );
}

// No proof is exact, so with `--tolerance 0` there are bounds only.

#[test]
fn where_nothing_can_be_proven_bounds_refute() {
    let sandbox = Sandbox::with_square();
    let verify = "verify square.off --algo test-wrong,ich --tolerance 0";
    let outcome = sandbox.call(verify);
    let said = &outcome.stdout;
    assert_eq!(outcome.code, 1);
    assert!(said.contains("source 0: nothing is proven: "), "{said}");
    assert!(
        said.contains("test-wrong: WRONG: differs from proven bounds: vertex 1 is at 1.5 "),
        "{said}"
    );
    let left = "; proven wrong: test-wrong; not refuted, a single group: mmp-fast, ich\n";
    assert!(said.contains(left), "{said}");
    assert!(said.ends_with("2 of 3 answers agree\n"), "{said}");
    let (outcome, cells) = run(
        &sandbox,
        "--algo mmp-fast,test-wrong --check mmp-fast --tolerance 0",
    );
    assert_eq!(outcome.code, 1);
    assert_eq!(statuses(&cells), json!(["ok", "wrong"]));
    assert_eq!(checks(&cells, "proven"), json!([null, false]));
    let proof = cells[0]["check"]["proof"].as_str().unwrap();
    assert!(proof.starts_with("nothing is proven: "), "{proof}");
    assert!(outcome.stderr.contains(proof), "{}", outcome.stderr);
    let left = "; proven wrong: test-wrong; not refuted, a single group: mmp-fast\n";
    assert!(outcome.stderr.contains(left), "{}", outcome.stderr);
}

#[test]
fn bounds_refute_a_wrong_file_and_not_the_right_answers() {
    let sandbox = Sandbox::with_square();
    sandbox.write("square.s0.csv", "0,0\n2,1.4\n");
    let outcome = sandbox.call("verify square.off --algo ich --tolerance 0");
    let said = &outcome.stdout;
    assert_eq!(outcome.code, 1);
    assert!(said.contains("source 0: ich: ok: not refuted; "), "{said}");
    let of_file = "square.s0.csv: WRONG: differs from proven bounds: vertex 2 is at 1.4 ";
    assert!(said.contains(of_file), "{said}");
    let left = "square.s0.csv; not refuted, a single group: mmp-fast, ich\n";
    assert!(said.contains(left), "{said}");
    for jobs in ["", "--resume j.jsonl", "--resume j.jsonl", "--jobs 2"] {
        let (outcome, cells) = run(
            &sandbox,
            &format!("--algo mmp-fast,ich,test-wrong --check file --tolerance 0 {jobs}"),
        );
        assert_eq!(outcome.code, 1);
        assert_eq!(statuses(&cells), json!(["ok", "ok", "wrong"]), "{jobs}");
        assert_eq!(checks(&cells, "proven"), json!([null, null, false]));
        let replaced = json!(["./square.s0.csv", "./square.s0.csv", "./square.s0.csv"]);
        assert_eq!(checks(&cells, "replaced"), replaced);
        assert_eq!(cells[0]["check"]["reference"], "proven bounds");
        let left = "; proven wrong: test-wrong; not refuted, a single group: mmp-fast, ich\n";
        assert!(outcome.stderr.contains(left), "{}", outcome.stderr);
    }
}

/// A chain of thin faces, the last vertex at 4e-5. Its distances were proven to 5.7e-9 only, and
/// right answers were called wrong beside the file.
#[test]
fn a_wrong_file_of_a_chain_is_refuted() {
    let shared = env::var_os("GEOBENCH_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    let Ok(chain) = fs::read_to_string(shared.join("cases/exact/chain40.obj")) else {
        println!("without chain40.obj");
        return;
    };
    let sandbox = Sandbox::new();
    sandbox.write("chain.obj", &chain);
    sandbox.write("chain.s0.csv", "0,0\n440,4.1e-5\n");
    let outcome = sandbox.call("verify chain.obj --algo ich,vtp");
    let said = &outcome.stdout;
    assert_eq!(outcome.code, 1);
    assert!(said.contains("source 0: vtp: ok: proven right; "), "{said}");
    let decision = "source 0: proven right: mmp-fast, ich, vtp\n3 of 4 answers agree\n";
    assert!(said.ends_with(decision), "{said}");
}

#[test]
fn large_models_are_proven_only_on_request() {
    let sandbox = Sandbox::new();
    let verify = "verify gen:grid,n=160 --algo test-wrong --quiet";
    let said = sandbox.call(verify).stdout;
    let left = "nothing is proven: the model has 51200 faces; up to 50000 are proven unasked; \
                --certify proves which are right";
    assert!(said.contains(left), "{said}");
}

#[test]
fn a_proof_outlasts_an_interruption() {
    let sandbox = Sandbox::with_square();
    let arguments = "--algo test-wrong,mmp,ich --check test-wrong --resume j.jsonl";
    let (whole, expected) = run(&sandbox, arguments);
    assert_eq!(whole.code, 1);
    let journal = sandbox.read("j.jsonl");
    let lines: Vec<&str> = journal.split_inclusive('\n').collect();
    assert_eq!(journal.matches("\"decision\"").count(), 1);
    // From the first run on, which follows the header, the session and the model.
    for kept in 4..=lines.len() {
        sandbox.write("j.jsonl", &lines[..kept].concat());
        let (rest, cells) = run(&sandbox, arguments);
        assert_eq!(rest.code, 1, "{kept}");
        for field in [
            "reference",
            "proven",
            "proof",
            "replaced",
            "max_rel",
            "cluster",
        ] {
            assert_eq!(
                checks(&cells, field),
                checks(&expected, field),
                "{kept}: {field}"
            );
        }
        assert_eq!(statuses(&cells), statuses(&expected));
    }
}
