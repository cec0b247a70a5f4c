//! The suites of `bench-configs`: every one can be planned, and a small one is run.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use geobench::suite::{Settings, Suite, plans};

/// The suites that come with the program.
fn suites() -> Vec<PathBuf> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../bench-configs");
    let entries = std::fs::read_dir(directory).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    paths.sort_unstable();
    assert!(paths.len() >= 10, "{paths:?}");
    paths
}

#[test]
fn every_suite_has_a_plan() {
    for path in suites() {
        let suite = match Suite::read(&path) {
            Ok(suite) => suite,
            Err(error) => panic!("{error}"),
        };
        let planned = plans(Some(&suite), &Settings::default()).unwrap();
        assert!(!planned.plans.is_empty());
        for group in &suite.groups {
            assert!(group.shows.is_some(), "{}: {}", path.display(), group.name);
            let ratios_to = group.settings.ratios_to.as_deref();
            let algorithms = group.settings.algorithms.as_deref().unwrap_or_default();
            assert!(
                ratios_to.is_none_or(|name| algorithms.iter().any(|a| a.label() == name)),
                "{}: {}",
                path.display(),
                group.name
            );
        }
        for plan in &planned.plans {
            assert!(plan.runs() > 0);
            // Whatever machine it is, something can be run.
            let generated = |m: &&geobench::model::ModelRef| m.file_path().is_none();
            let scans = plan.group.name.as_deref() == Some("scans");
            assert!(
                scans || plan.models.iter().any(|m| generated(&m)),
                "{}: {:?}",
                path.display(),
                plan.group.name
            );
        }
    }
}

/// Calls the program with `--config` and a suite file of this text.
fn run(suite: &str, arguments: &str) -> (tempfile::TempDir, Output) {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("suite.toml"), suite).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_geobench"))
        .current_dir(directory.path())
        .args("run --config suite.toml".split_whitespace())
        .args(arguments.split_whitespace())
        .output()
        .unwrap();
    (directory, output)
}

const TINY: &str = r#"
repeat = 1
warmup = 0
algorithms = ["mmp", { name = "vtp" }]
models = ["gen:cube,n=2"]

[[group]]
name = "first"
shows = "Two models."
models = ["gen:cube,n=2", "gen:sphere,subdiv=1", { path = "none.obj", optional = true }]
rows = ["parents", "time"]
ratios_to = "vtp"

[[group]]
name = "second"
source = [3, 1]

[[group]]
name = "third"
models = [{ path = "none.obj", optional = true }]
"#;

#[test]
fn a_suite_is_run_group_by_group() {
    let (directory, output) = run(TINY, "-o r.json -o r.csv -o r.md");
    let (out, err) = (
        String::from_utf8(output.stdout).unwrap(),
        String::from_utf8(output.stderr).unwrap(),
    );
    assert_eq!(output.status.code(), Some(0), "{err}");
    assert!(
        out.starts_with("first\nTwo models.\n\ncube,n=2  ("),
        "{out}"
    );
    assert!(out.contains("│ Parents "));
    assert!(out.contains("ratios to vtp  (mean / standard deviation over 2 models)"));
    assert!(out.contains("\nsecond\n\ncube,n=2  (V: 26, F: 48)  median of 2 sources\n"));
    assert!(err.contains("group `first`: the optional model none.obj is left out: no such file"));
    assert!(err.contains("group `third` is left out: none of its models is there"));

    let read = |name: &str| std::fs::read_to_string(directory.path().join(name)).unwrap();
    let result: serde_json::Value = serde_json::from_str(&read("r.json")).unwrap();
    assert_eq!(result["groups"].as_array().unwrap().len(), 2);
    assert_eq!(result["groups"][0]["rows"][0], "parents");
    assert_eq!(result["models"].as_array().unwrap().len(), 2);
    let cells = result["cells"].as_array().unwrap();
    let groups: Vec<&str> = cells.iter().map(|c| c["group"].as_str().unwrap()).collect();
    assert_eq!(groups, [["first"; 4], ["second"; 4]].concat());
    assert!(read("r.csv").lines().nth(1).unwrap().contains(",first,"));
    assert!(read("r.md").contains("## second\n\n| Model | | mmp | vtp |"));
}

#[test]
fn options_come_before_the_suite() {
    let (directory, output) = run(
        TINY,
        "gen:octahedron --algo ich --source 2 --repeat 2 --rows kept --check none -o r.json",
    );
    assert_eq!(output.status.code(), Some(0));
    let text = std::fs::read_to_string(directory.path().join("r.json")).unwrap();
    let result: serde_json::Value = serde_json::from_str(&text).unwrap();
    let cells = result["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 3);
    for cell in cells {
        assert_eq!(cell["model"], "octahedron");
        assert_eq!(cell["algorithm"], "ich");
        assert_eq!(cell["source"], 2);
        assert_eq!(cell["time"]["samples"].as_array().unwrap().len(), 2);
        assert!(cell["check"]["reference"].is_null());
    }
    assert_eq!(result["groups"][1]["rows"][0], "kept");
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    for (suite, message) in [
        (
            "",
            "suite.toml: there is no group; start one with [[group]]",
        ),
        (
            "repeat = 0",
            "suite.toml, line 1: `repeat`: a whole number from 1 to 1000000",
        ),
        ("repeat = \"a", "suite.toml, line 1: invalid basic string"),
        (
            "\nrepaet = 1",
            "suite.toml, line 2: there is no key `repaet` here, did you mean `repeat`?",
        ),
        ("[group]\nname = 'a'", "suite.toml, line 1: `group`: a list"),
        (
            "[[group]]\nname = 3",
            "suite.toml, line 2: `name`: a text in quotes",
        ),
        (
            "[[group]]\nrepeat = 3",
            "suite.toml, line 1: `group`: a group must have a `name`",
        ),
        (
            "[[group]]\nname = 'a'",
            "suite.toml: group `a` has no models",
        ),
        (
            "[[group]]\nname = 'a'\n[[group]]\nname = 'a'",
            "suite.toml, line 3: `group`: two are called `a`",
        ),
        (
            "[[group]]\nname = 'a'\nmodels = [\n  'gen:cube',\n  'none.obj',\n]",
            "suite.toml, line 5: `models`: none.obj: no such file or directory",
        ),
        (
            "[[group]]\nname = 'a'\nmodels = [{ paht = 'x' }]",
            "suite.toml, line 3: there is no key `paht` here, did you mean `path`?",
        ),
        (
            "models = ['gen:spere']\n[[group]]\nname = 'a'",
            "line 1: `models`: gen:spere: unknown",
        ),
        (
            "models = []",
            "suite.toml, line 1: `models`: the list is empty",
        ),
        (
            "algorithms = ['vtp',\n 'mpm']",
            "suite.toml, line 2: `algorithms`: there is no algorithm `mpm`, did you mean `mmp`?",
        ),
        (
            "algorithms = [{ name = 'mmp', kmaxx = 3 }]",
            "suite.toml, line 1: `algorithms`: algorithm `mmp`",
        ),
        (
            "algorithms = [{ k = 3 }]",
            "`algorithms`: an algorithm must have a `name`",
        ),
        (
            "source = -1",
            "suite.toml, line 1: `source`: `-1` is not a source",
        ),
        (
            "source = [1, 1]",
            "suite.toml, line 1: `source`: source vertex 1 is named twice",
        ),
        (
            "tolerance = 'x'",
            "`tolerance`: a tolerance is a number, 0 or more",
        ),
        (
            "check = 'mpm'",
            "`check`: there is no algorithm `mpm`, did you mean `mmp`?",
        ),
        (
            "rows = ['tme']",
            "`rows`: there is no row `tme`, did you mean `time`?",
        ),
        (
            "[[group]]\nname = 'a'\nmodels = [{ path = 'none.obj', optional = true }]",
            "there is nothing to run: ",
        ),
    ] {
        let (_directory, output) = run(suite, "--quiet");
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{suite}");
        assert_eq!(text.lines().count(), 1, "{text}");
        assert!(text.contains(message), "{suite}: {text}");
    }
    let mut missing = Command::new(env!("CARGO_BIN_EXE_geobench"));
    let output = missing.args(["run", "--config", "none.toml"]).output();
    assert_eq!(output.unwrap().status.code(), Some(2));
}
