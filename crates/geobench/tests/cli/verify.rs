//! `geobench verify`.

use crate::support::Sandbox;

#[test]
fn agreement_is_one_line_per_answer() {
    let sandbox = Sandbox::with_square();
    sandbox.write("square.s2.csv", "vertex,distance\n2,0\n1,1\n");
    let text = sandbox.succeed("verify square.off --algo mmp-fast,ich");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 5);
    assert_eq!(lines[0], "square: source 0: mmp-fast: ok (reference)");
    assert!(lines[1].starts_with("square: source 0: ich: ok: agrees with mmp-fast"));
    assert!(lines[2].starts_with("square: source 2: mmp-fast: ok: agrees with ./square.s2.csv"));
    assert_eq!(lines[4], "4 of 4 answers agree");
    assert_eq!(sandbox.succeed("verify square.off --quiet"), "");
}

#[test]
fn the_reference_runs_even_if_it_is_not_asked_for() {
    let text = Sandbox::with_square().succeed("verify square.off --algo ich");
    assert!(text.contains("mmp-fast: ok (reference)"));
}

#[test]
fn disagreement_fails_and_names_the_vertex() {
    let sandbox = Sandbox::with_square();
    sandbox.write("expected/square.s0.csv", "0,0\n1,1\n2,1.4\n3,inf\n");
    let outcome = sandbox.call("verify square.off --algo mmp-fast --quiet");
    assert_eq!(outcome.code, 1);
    assert!(
        outcome
            .stdout
            .contains("square: source 0: mmp-fast: WRONG: differs from ")
    );
    assert!(outcome.stdout.contains("vertex 3 is at 1 instead of inf"));
    assert!(outcome.stdout.contains("2 of 4 vertices differ"));
    assert!(outcome.stdout.ends_with("0 of 1 answers agree\n"));
}

#[test]
fn a_damaged_file_of_distances_is_named_with_its_line() {
    let sandbox = Sandbox::with_square();
    sandbox.write("square.s0.csv", "0,0\n1,one\n");
    let found = sandbox.refuse("verify square.off --algo mmp-fast --quiet");
    assert_eq!(found, "./square.s0.csv, line 2: `one` is not a distance");
}

#[test]
fn where_answers_disagree_a_proof_says_which_are_right() {
    let sandbox = Sandbox::with_square();
    sandbox.write("expected/square.s0.csv", "0,0\n1,1\n2,1.4\n3,1\n");
    let verify = "verify square.off --algo mmp-fast,ich --quiet";
    let said = sandbox.call(verify).stdout;
    assert!(
        said.contains("source 0: --certify proves which are right"),
        "{said}"
    );
    let outcome = sandbox.call(&format!("{verify} --certify"));
    assert_eq!(outcome.code, 1);
    let proven = "square: source 0: proven right: mmp-fast, ich\n";
    assert!(outcome.stdout.contains(proven), "{}", outcome.stdout);
}

#[test]
fn a_source_or_target_that_the_model_lacks_is_wrong_usage() {
    let sandbox = Sandbox::with_square();
    for wrong in ["--target 9", "--source edge:0-9,0.5"] {
        let outcome = sandbox.call(&format!("verify square.off --algo ich {wrong}"));
        assert_eq!(outcome.code, 2, "{wrong}: {}", outcome.stdout);
        assert!(!outcome.stdout.contains("WRONG"), "{}", outcome.stdout);
    }
}
