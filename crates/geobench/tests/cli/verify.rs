//! `geobench verify`.

use crate::support::Sandbox;

#[test]
fn agreement_is_one_line_per_answer() {
    let sandbox = Sandbox::with_square();
    sandbox.write("square.s2.csv", "vertex,distance\n2,0\n1,1\n");
    let text = sandbox.succeed("verify square.off --algo mmp-fast,ich");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 5);
    assert_eq!(
        lines[0],
        "square: source 0: mmp-fast: ok: reference for 4 vertices, 0 unreachable"
    );
    assert!(lines[1].starts_with("square: source 0: ich: ok: agrees with mmp-fast"));
    assert!(lines[2].starts_with("square: source 2: mmp-fast: ok: agrees with ./square.s2.csv"));
    assert_eq!(lines[4], "4 of 4 answers agree");
    assert_eq!(sandbox.succeed("verify square.off --quiet"), "");
    let one = sandbox.succeed("verify square.off --algo mmp-fast --target 3");
    assert!(
        one.contains(": ok: reference for 1 target, 0 unreachable\n"),
        "{one}"
    );
}

#[test]
fn the_reference_runs_even_if_it_is_not_asked_for() {
    let text = Sandbox::with_square().succeed("verify square.off --algo ich");
    assert!(text.contains("mmp-fast: ok: reference for "));
}

#[test]
fn disagreement_fails_and_names_the_vertex() {
    let sandbox = Sandbox::with_square();
    sandbox.write("expected/square.s0.csv", "0,0\n1,1\n2,1.4\n3,inf\n");
    let outcome = sandbox.call("verify square.off --algo mmp-fast --quiet");
    assert_eq!(outcome.code, 1);
    let wrong = "square: source 0: ./expected/square.s0.csv: WRONG: differs from proven distances: \
                 vertex 3 is at inf instead of 1";
    assert!(outcome.stdout.starts_with(wrong), "{}", outcome.stdout);
    assert!(outcome.stdout.contains("2 of 4 vertices differ"));
    assert!(
        outcome.stdout.ends_with("1 of 2 answers agree\n"),
        "{}",
        outcome.stdout
    );
}

#[test]
fn a_damaged_file_of_distances_is_named_with_its_line() {
    let sandbox = Sandbox::with_square();
    sandbox.write("square.s0.csv", "0,0\n1,one\n");
    let found = sandbox.refuse("verify square.off --algo mmp-fast --quiet");
    assert_eq!(found, "./square.s0.csv, line 2: `one` is not a distance");
}

#[test]
fn answers_in_doubt_are_named_and_counted_apart() {
    let sandbox = Sandbox::new();
    // The edges from vertex 2 are far longer than the distances.
    sandbox.write(
        "thin.off",
        "OFF\n4 2 0\n0 0 0\n1e-3 0 0\n0 1e3 0\n1e-3 1e3 0\n3 0 1 2\n3 1 3 2\n",
    );
    let outcome = sandbox.call("verify thin.off --algo ich --source 0 --radius 1");
    assert_eq!(outcome.code, 0, "{}", outcome.stdout);
    let doubt = "in doubt, each distance may be off by up to 1.0e-9";
    assert_eq!(
        outcome.stdout.matches(doubt).count(),
        2,
        "{}",
        outcome.stdout
    );
    assert!(
        outcome
            .stdout
            .ends_with("2 of 2 answers agree, 2 of them in doubt\n"),
        "{}",
        outcome.stdout
    );
    let off = "test-wrong{share=5e-7}";
    let outcome = sandbox.call(&format!(
        "verify thin.off --algo ich,{off} --source 0 --radius 1"
    ));
    assert_eq!(outcome.code, 1, "{}", outcome.stdout);
    let said = "test-wrong{share=5e-7}: IN DOUBT: ";
    assert!(outcome.stdout.contains(said), "{}", outcome.stdout);
    assert!(
        outcome
            .stdout
            .ends_with("2 of 3 answers agree, 2 of them in doubt; 1 in doubt differ\n"),
        "{}",
        outcome.stdout
    );
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
