//! The suites of `bench-configs`: each can be planned, and a small one is run.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use geobench_harness::plan::suite::{ModelChoice, Settings, Suite, plans};

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
        let planned = plans(Some(&suite), &Settings::default(), &ModelChoice::default()).unwrap();
        assert!(!planned.plans.is_empty());
        let full = ModelChoice {
            full: true,
            library: None,
        };
        let in_full = plans(Some(&suite), &Settings::default(), &full).unwrap();
        assert_eq!(in_full.plans.len(), planned.plans.len());
        for group in &suite.groups {
            assert!(group.shows.is_some(), "{}: {}", path.display(), group.name);
            let ratios_to = group.settings.ratios_to.as_ref();
            let mut algorithms = group
                .settings
                .algorithms
                .algorithms
                .iter()
                .flat_map(|list| &list.0);
            assert!(
                ratios_to.is_none_or(|one| algorithms.any(|a| a.label() == one.label())),
                "{}: {}",
                path.display(),
                group.name
            );
        }
        for plan in &planned.plans {
            assert!(plan.runs() > 0);
        }
        for plan in planned.plans.iter().chain(&in_full.plans) {
            // Every machine has all that there is to run.
            for model in &plan.models {
                assert!(model.file_path().is_none(), "{}: {model:?}", path.display());
            }
        }
    }
}

/// Parameters that papers vary, by the number of the paper.
const OF_PAPERS: [(&str, &[&str]); 5] = [
    ("000", &["threshold=1e-6"]),
    ("001", &["threshold=1e-6"]),
    (
        "002",
        &[
            "threshold=",
            "queue=fifo",
            "k=",
            "bucket=",
            "t=",
            "build=ich",
            "build=fwp-mmp",
        ],
    ),
    ("003", &[]),
    ("004", &["queue=buckets", "rwr=off"]),
];

/// The second heap: no claim on the queue is judged by one kind of heap alone.
const SECOND_HEAP: &str = "queue=heap4";

/// In the suite of a paper, algorithms have their defaults, and scalar instructions, unless the
/// paper varies a parameter. Fast forms are in a group of their own.
#[test]
fn no_suite_of_a_paper_uses_a_parameter_that_its_paper_lacks() {
    let mut papers = 0;
    for path in suites() {
        let file = path.file_name().unwrap().to_str().unwrap();
        let Some(paper) = file.get(..3).filter(|paper| paper.parse::<u32>().is_ok()) else {
            continue;
        };
        papers += 1;
        let varied = OF_PAPERS.iter().find(|(of, _)| *of == paper);
        let varied = varied.map_or(&[][..], |(_, varied)| varied);
        let suite = Suite::read(&path).unwrap();
        let planned = plans(Some(&suite), &Settings::default(), &ModelChoice::default()).unwrap();
        for plan in planned.plans {
            let group = plan.group.name.unwrap_or_default();
            for one in &plan.algorithms {
                let label = one.label();
                let inner = label.split_once('{').map_or("", |(_, rest)| rest);
                let inner = inner.trim_end_matches('}');
                for setting in inner.split(',').filter(|setting| !setting.is_empty()) {
                    let is_second = label == format!("{}{{{SECOND_HEAP}}}", one.algorithm().name);
                    let is_of_paper =
                        is_second || varied.iter().any(|known| setting.starts_with(known));
                    assert!(is_of_paper, "{file}, {group}: {label}");
                }
                // The report's form has no threshold: one group counts what it would drop.
                assert!(
                    one.algorithm().name != "edge-based" || inner.is_empty() || group == "tiny",
                    "{file}, {group}: {label}"
                );
                // By default a fast form of ICH builds its graph.
                assert!(
                    one.algorithm().name != "svg" || inner.contains("build="),
                    "{file}, {group}: {label}"
                );
                assert!(
                    group == "fast forms" || !one.algorithm().fast,
                    "{file}, {group}: {label}"
                );
                let is_scalar = one.simd().as_deref() == Some("scalar");
                assert!(
                    is_scalar || one.algorithm().fast,
                    "{file}, {group}: {label}"
                );
            }
        }
    }
    assert!(papers >= 30, "{papers}");
}

/// The numbers of suites and of claims in the paper are those of the files.
#[test]
fn the_paper_counts_suites_and_claims() {
    let is_of_paper = |path: &&PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap();
        name.starts_with(|first: char| first.is_ascii_digit())
    };
    let suites = suites().iter().filter(is_of_paper).count();
    let files = geobench_report::claims::known().unwrap();
    let claims: usize = files.iter().map(|file| file.claims().count()).sum();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../paper/paper.md");
    let paper = std::fs::read_to_string(path).unwrap();
    let paper: Vec<&str> = paper.split_whitespace().collect();
    let paper = paper.join(" ");
    for words in [format!("{suites} suites"), format!("{claims} claims")] {
        assert!(paper.contains(&words), "{words}");
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

/// The names of the models in the result file of a run.
fn models(directory: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(directory.join("r.json")).unwrap();
    let result: serde_json::Value = serde_json::from_str(&text).unwrap();
    let models = result["models"].as_array().unwrap().iter();
    models
        .map(|m| m["name"].as_str().unwrap().to_owned())
        .collect()
}

const SIZES: &str = r#"
repeat = 1
warmup = 0
algorithms = ["vtp"]

[full]
source = [0, 3]

[[group]]
name = "sizes"
models = [
    { real = ["Asian Dragon", "cube"], path = "gen:octahedron" },
    { real = "cube", subdivide = 2, path = "gen:octahedron,subdivide=2" },
    { real = "bunny", path = "gen:tetrahedron" },
]

[group.full]
models = ["gen:cube,n=4"]
"#;

#[test]
fn real_models_take_the_place_of_those_that_stand_for_them() {
    let (directory, output) = run(SIZES, "-o r.json --models .");
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(
        text.contains("--models: .: no mesh file in this directory"),
        "{text}"
    );

    let mut generate = Command::new(env!("CARGO_BIN_EXE_geobench"));
    let cube = directory.path().join("Cube.obj");
    let made = generate.args(["gen", "cube,n=2", "-o"]).arg(cube).output();
    assert!(made.unwrap().status.success());
    let again = Command::new(env!("CARGO_BIN_EXE_geobench"))
        .current_dir(directory.path())
        .args("run --config suite.toml -o r.json --models .".split_whitespace())
        .output()
        .unwrap();
    let text = String::from_utf8(again.stderr).unwrap();
    assert_eq!(again.status.code(), Some(0), "{text}");
    assert_eq!(
        models(directory.path()),
        ["Cube", "Cube-x16", "tetrahedron"]
    );
    let note = "group `sizes`: no model called bunny is in .; gen:tetrahedron stands for it";
    assert!(text.contains(note), "{text}");
}

#[test]
fn full_sizes_come_before_the_small_ones_and_after_options() {
    let (directory, output) = run(SIZES, "-o r.json --full");
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert_eq!(models(directory.path()), ["cube,n=4"]);
    let text = std::fs::read_to_string(directory.path().join("r.json")).unwrap();
    let result: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(result["cells"].as_array().unwrap().len(), 2);
    let (directory, output) = run(SIZES, "-o r.json --full --source 1 gen:octahedron");
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(models(directory.path()), ["octahedron"]);
}

#[test]
fn sizes_and_real_models_are_those_of_a_suite() {
    for arguments in ["--full", "--models ."] {
        let output = Command::new(env!("CARGO_BIN_EXE_geobench"))
            .arg("run")
            .args(arguments.split_whitespace())
            .output()
            .unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments}: {text}");
        assert!(text.contains("--config <SUITE.toml>"), "{text}");
    }
}

#[test]
fn wavefronts_are_kept_where_a_suite_wants_them() {
    let suite = r#"
repeat = 1
warmup = 0
models = ["gen:sphere,subdiv=2"]
algorithms = ["fwp-mmp", "vtp"]
[[group]]
name = "with"
wavefront = true
[[group]]
name = "without"
"#;
    let (directory, output) = run(suite, "-o r.json");
    assert_eq!(output.status.code(), Some(0));
    let text = std::fs::read_to_string(directory.path().join("r.json")).unwrap();
    let result: serde_json::Value = serde_json::from_str(&text).unwrap();
    for cell in result["cells"].as_array().unwrap() {
        if cell["group"] == "without" {
            assert!(cell.get("wavefront").is_none());
            continue;
        }
        let samples = cell["wavefront"].as_array().unwrap();
        assert!((10..100).contains(&samples.len()), "{}", samples.len());
        let field = |name: &str| -> Vec<f64> {
            samples.iter().map(|s| s[name].as_f64().unwrap()).collect()
        };
        assert!(field("windows").into_iter().all(|n| n >= 1.0));
        assert!(field("deviation").into_iter().all(|d| d >= 0.0));
        // The radius of the sphere is 1, and no window goes round it more than once.
        assert!(field("distance").iter().all(|d| (0.0..6.3).contains(d)));
        assert!(field("parents").is_sorted());
        let has_rounds = cell["algorithm"] == "fwp-mmp";
        assert!(samples.iter().all(|s| s["k"].is_u64() == has_rounds));
    }
}

/// Invalid suites, and their error messages.
const WRONG: &[(&str, &str)] = &[
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
        "suite.toml, line 2: there is no key `repaet` here (did you mean `repeat`?); known are ext, group, full, models,",
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
        "suite.toml, line 3: there is no key `paht` here (did you mean `path`?); known are path, optional, real,",
    ),
    (
        "models = [{ path = 'gen:cube', subdivide = 1 }]",
        "suite.toml, line 1: `models`: `subdivide` is for a model that has `real`",
    ),
    (
        "models = [{ path = 'gen:cube', real = '' }]",
        "`real`: a name is empty",
    ),
    (
        "[full]\nshows = 'x'",
        "suite.toml, line 2: there is no key `shows` here",
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
        "suite.toml, line 2: `algorithms`: there is no algorithm `mpm` (did you mean `mmp`?)",
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
        "tolerance = 'x'",
        "`tolerance`: a number of 0 or more is expected",
    ),
    (
        "check = 'mpm'",
        "`check`: there is no algorithm `mpm` (did you mean `mmp`?)",
    ),
    (
        "rows = ['tme']",
        "`rows`: there is no row `tme` (did you mean `time`?)",
    ),
    (
        "[[group]]\nname = 'a'\nmodels = [{ path = 'none.obj', optional = true }]",
        "there is nothing to run: ",
    ),
];

/// Every key that a message lists is in the example of its page.
#[test]
fn every_key_is_described() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../bench-configs");
    for (suite, page) in [
        ("nothing = 1", "README.md"),
        ("[[group]]\nname = 'a'\nnothing = 1", "README.md"),
        (
            "[[group]]\nname = 'a'\nmodels = ['gen:cube']\nalgorithms = ['ext:a']\n[ext.a]\nnothing = 1",
            "PEERS.md",
        ),
    ] {
        let (_directory, output) = run(suite, "--quiet");
        let text = String::from_utf8(output.stderr).unwrap();
        let (_, keys) = text.trim_end().split_once("known are ").unwrap();
        let page = std::fs::read_to_string(top.join(page)).unwrap();
        for key in keys.split(", ") {
            let is_described = page.lines().any(|line| {
                let rest = line.strip_prefix(key);
                rest.is_some_and(|rest| rest.starts_with(" = "))
                    || line.trim_start_matches('[').starts_with(&format!("{key}]"))
                    || line.trim_start_matches('[').starts_with(&format!("{key}."))
                    || line.starts_with(&format!("[group.{key}]"))
            });
            assert!(is_described, "{key}");
        }
    }
}

#[test]
fn errors_name_file_and_line() {
    for (suite, message) in WRONG {
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
