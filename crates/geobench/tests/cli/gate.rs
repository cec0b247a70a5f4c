//! Tests the rules of `scripts/regression` on stored result files, without Valgrind. The files are
//! from a base commit, from one that differs only in comments, and from one with a short loop in a
//! kernel that adds about 1 % to the instructions.

use serde_json::Value;

use crate::support::{Outcome, Sandbox};

const BASE: &str = include_str!("../data/gate/base.json");
const COMMENTS: &str = include_str!("../data/gate/comments.json");
const SLOWER: &str = include_str!("../data/gate/slower.json");

/// The rules in the script.
fn rules() -> String {
    let script = include_str!("../../../../scripts/regression");
    let line = script.lines().find_map(|l| l.strip_prefix("rules='"));
    line.unwrap().trim_end_matches('\'').to_owned()
}

fn compared(new: &str, rules: &str) -> Outcome {
    let sandbox = Sandbox::new();
    sandbox.write("base.json", BASE);
    sandbox.write("new.json", new);
    let format = "--format markdown";
    sandbox.call(&format!(
        "compare base.json new.json --fail-on {rules} {format}"
    ))
}

/// The base result with a change.
fn changed(change: impl FnOnce(&mut Value)) -> String {
    let mut file = serde_json::from_str(BASE).unwrap();
    change(&mut file);
    file.to_string()
}

#[test]
fn comments_and_short_loops_pass_and_are_shown() {
    for new in [BASE, COMMENTS, SLOWER] {
        let outcome = compared(new, &rules());
        assert_eq!(outcome.code, 0, "{}{}", outcome.stdout, outcome.stderr);
        assert!(
            outcome
                .stdout
                .starts_with("### geobench: none of 4 cells is worse\n")
        );
        assert!(outcome.stdout.contains("times are compared pair by pair"));
    }
    assert!(compared(SLOWER, &rules()).stdout.contains("| +1.32 % |"));
    // The times of five runs have no interval, so that a rule on them could never be broken.
    let strict = compared(COMMENTS, &(rules() + ",time=10%"));
    assert_eq!(strict.code, 2, "{}", strict.stdout);
    assert!(
        strict
            .stderr
            .contains("the rule time=10% is judged in no cell")
    );
    // Without an outside program nothing is measured from outside.
    let outside = compared(COMMENTS, "outside_time=10%");
    assert_eq!(outside.code, 2, "{}", outside.stdout);
    assert!(
        outside
            .stderr
            .contains("the rule outside_time=10% is judged in no cell")
    );
}

#[test]
fn the_gate_catches_regressions() {
    let stricter = rules().replace("instructions=2%", "instructions=1%");
    let outcome = compared(SLOWER, &stricter);
    assert_eq!(outcome.code, 1);
    assert!(outcome.stdout.starts_with(
        "### geobench: 2 of 4 cells are worse\n\n- sphere,subdiv=3, vtp, source 0: instructions 5,568,113 -> 5,641,352 (+1.32 %) [instructions=1%]\n"
    ), "{}", outcome.stdout);

    let scaled = |value: &Value, percent: u64| Value::from(value.as_u64().unwrap() * percent / 100);
    for (what, new) in [
        (
            "instructions",
            changed(|f| {
                let cell = &mut f["cells"][1];
                cell["instructions"] = scaled(&cell["instructions"], 110);
            }),
        ),
        (
            "heap_peak_bytes",
            changed(|f| {
                let memory = &mut f["cells"][2]["memory"];
                memory["heap_peak_bytes"] = scaled(&memory["heap_peak_bytes"], 103);
            }),
        ),
        (
            "propagated",
            changed(|f| {
                let counters = &mut f["cells"][0]["counters"];
                counters["propagated"] = (counters["propagated"].as_u64().unwrap() - 1).into();
            }),
        ),
        (
            "was ok, is timeout",
            changed(|f| f["cells"][3]["status"] = "timeout".into()),
        ),
    ] {
        let outcome = compared(&new, &rules());
        assert_eq!(outcome.code, 1, "{what}: {}", outcome.stdout);
        assert!(
            outcome
                .stdout
                .starts_with("### geobench: 1 of 4 cells is worse\n")
        );
        assert!(outcome.stdout.contains(what), "{what}: {}", outcome.stdout);
    }
}

#[test]
fn a_commit_whose_instructions_are_missing_fails() {
    let without = changed(|file| {
        file["cells"][2]
            .as_object_mut()
            .unwrap()
            .remove("instructions");
    });
    let outcome = compared(&without, &rules());
    assert_eq!(outcome.code, 1);
    assert!(
        outcome
            .stdout
            .starts_with("### geobench: 1 of 4 cells is worse\n")
            && outcome.stdout.contains("-> none: missing in the new file"),
        "{}",
        outcome.stdout
    );
    let sandbox = Sandbox::new();
    sandbox.write("old.json", &without);
    sandbox.write("new.json", BASE);
    let arguments = format!("compare old.json new.json --fail-on {}", rules());
    let outcome = sandbox.call(&arguments);
    assert_eq!(outcome.code, 1);
    assert!(
        outcome
            .stdout
            .contains("missing in the old file [instructions=2%]")
            && outcome.stdout.contains(
                "`instructions` is missing in 1 of 4 cells: run both versions with --instructions, \
                 or leave the rule out"
            ),
        "{}",
        outcome.stdout
    );
    // The script does this if the old commit cannot count instructions at all.
    let rules = rules().replace("instructions=2%,", "");
    sandbox.succeed(&format!("compare old.json new.json --fail-on {rules}"));
}
