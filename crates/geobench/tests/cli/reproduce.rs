//! `scripts/reproduce`, on small models.

use std::path::Path;
use std::process::Command;

use crate::support::{Outcome, Sandbox};

fn reproduce(sandbox: &Sandbox, arguments: &str) -> Outcome {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/reproduce");
    let output = Command::new("bash")
        .arg(script)
        .args(arguments.split_whitespace())
        .current_dir(sandbox.path(""))
        .env("GEOBENCH", assert_cmd::cargo::cargo_bin("geobench"))
        .output()
        .unwrap();
    Outcome {
        code: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

#[test]
fn each_suite_leaves_its_result_and_its_tables() {
    let sandbox = Sandbox::new();
    let models = "gen:octahedron gen:cube,n=2 gen:tetrahedron";
    let call = format!("kept --repeat 1 --warmup 0 {models} -- 000-figure-12 001-table-5.1");
    let outcome = reproduce(&sandbox, &call);
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    for suite in ["000-figure-12", "001-table-5.1"] {
        let result = sandbox.json(&format!("kept/{suite}.json"));
        assert!(result["cells"].as_array().unwrap().len() >= 6);
        assert!(
            sandbox
                .read(&format!("kept/{suite}.md"))
                .contains("octahedron")
        );
        assert!(!sandbox.path(&format!("kept/{suite}.journal")).exists());
    }
    // The last page has the verdicts that two suites of one run each allow.
    let claims = sandbox.read("kept/claims.md");
    assert!(claims.contains("there is no result of the suite 002-table-1"));
    assert!(claims.contains("| Rule 1 saves propagations: "));

    let before = sandbox.read("kept/000-figure-12.json");
    let again = reproduce(&sandbox, &call);
    assert_eq!(again.code, 0);
    assert!(again.stderr.contains("000-figure-12 is there already"));
    assert_eq!(sandbox.read("kept/000-figure-12.json"), before);
}

#[test]
fn a_paper_stands_for_its_suites() {
    let sandbox = Sandbox::new();
    let call = "kept --repeat 1 --warmup 0 gen:octahedron -- 003";
    let outcome = reproduce(&sandbox, call);
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    assert!(sandbox.path("kept/003-table-1.json").exists());
    let outcome = reproduce(&sandbox, "other -- 009");
    assert_eq!(outcome.code, 3, "{}", outcome.stderr);
    assert!(outcome.stderr.contains("there is no suite 009"));
}

#[test]
fn missing_suites_are_named_before_anything_runs() {
    let sandbox = Sandbox::new();
    let outcome = reproduce(&sandbox, "kept -- 000-figure-12 000-table-9");
    assert_eq!(outcome.code, 3);
    assert_eq!(
        outcome.stderr,
        "scripts/reproduce: there is no suite 000-table-9 in bench-configs\n"
    );
    assert!(!sandbox.path("kept").exists());
    assert_eq!(reproduce(&sandbox, "--full").code, 3);
}

/// A suite with a failure keeps its results. The exit status reports the failure.
#[test]
fn a_failed_cell_is_kept_and_reported() {
    let sandbox = Sandbox::new();
    sandbox.write("broken.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n");
    let call = "kept --repeat 1 --warmup 0 broken.off gen:octahedron -- 000-figure-12";
    let outcome = reproduce(&sandbox, call);
    assert_eq!(outcome.code, 2, "{}", outcome.stderr);
    let result = sandbox.json("kept/000-figure-12.json");
    let cells = result["cells"].as_array().unwrap();
    let with = |status: &str| cells.iter().filter(|c| c["status"] == status).count();
    assert!(with("refused") > 0 && with("ok") == 3);
}
