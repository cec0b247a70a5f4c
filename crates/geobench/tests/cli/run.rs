//! `geobench run`.

use geobench_window::simd::Instructions;
use serde_json::{Value, json};

use crate::support::{SQUARE, Sandbox, UNUSABLE};

/// Every documented field of a result file, as a dotted path.
const FIELDS: &str = "
    schema tool.version tool.commit tool.rustc tool.profile tool.features
    host.cpu host.cores host.memory_bytes host.os host.kernel host.load_start host.simd
    command started finished
    models.0.name models.0.path models.0.sha256 models.0.vertices models.0.faces models.0.edges
    models.0.boundary_edges models.0.components models.0.genus models.0.saddles models.0.anisotropy
    cells.0.model cells.0.algorithm cells.0.source cells.0.threads cells.0.simd cells.0.status cells.0.message
    cells.0.time.samples cells.0.time.median cells.0.time.min cells.0.time.mad cells.0.time.ci95
    cells.0.counters.propagated cells.0.counters.parents cells.0.counters.children
    cells.0.counters.kept cells.0.counters.reinserted cells.0.counters.trimmed
    cells.0.counters.filtered cells.0.counters.peak_windows cells.0.counters.stored_windows
    cells.0.counters.window_bytes cells.0.counters.queue_pushes cells.0.counters.queue_peak
    cells.0.counters.iterations cells.0.counters.levels cells.0.counters.pseudo_sources
    cells.0.counters.prime cells.0.counters.secondary
    cells.0.memory.papers_bytes cells.0.memory.windows_peak_bytes cells.0.memory.heap_peak_bytes
    cells.0.memory.rss_peak_bytes
    cells.0.phases.propagation cells.0.phases.pruning cells.0.phases.management
    cells.0.phases.samples
    cells.0.check.reference cells.0.check.max_abs cells.0.check.max_rel cells.0.check.unreachable";

/// The value at a dotted path; `None` if there is no such field. A field can also be null.
fn at<'v>(value: &'v Value, path: &str) -> Option<&'v Value> {
    value.pointer(&format!("/{}", path.replace('.', "/")))
}

#[test]
fn prints_a_table_like_those_of_the_papers() {
    let sandbox = Sandbox::with_square();
    let table = sandbox.succeed("run square.off --algo mmp,ich --repeat 2");
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows[0], "square  (V: 4, F: 2)  source 0");
    for (row, label) in rows[2..].iter().zip([
        "mmp",
        "═",
        "Time (s)",
        "Window propagations",
        "Peak memory, papers' count (MB)",
        "Peak memory, measured (MB)",
    ]) {
        assert!(row.contains(label), "{row}");
    }
    assert!(rows[2].ends_with("mmp ┆ ich │") || rows[2].contains("ich"));
    assert!(table.contains("checked against mmp: largest relative difference 0"));
    assert!(table.contains("time: median of 2 runs"));
    assert!(
        !table.contains('\u{1b}'),
        "no colour where there is no terminal"
    );
}

#[test]
fn an_approximate_algorithm_that_comes_first_is_no_reference() {
    let sandbox = Sandbox::with_square();
    let table = sandbox.succeed("run gen:torus,faces=500 --algo dijkstra,ich --repeat 1");
    assert!(table.contains("checked against ich"), "{table}");
    let table = sandbox.succeed("run gen:torus,faces=500 --algo dijkstra --repeat 1");
    assert!(table.contains("checked against mmp-fast"), "{table}");
}

#[test]
fn colour_is_shown_on_demand() {
    let sandbox = Sandbox::with_square();
    assert!(
        sandbox
            .succeed("run square.off --color always")
            .contains("\u{1b}[")
    );
    let piped = sandbox
        .command("run square.off --color auto")
        .env("NO_COLOR", "1")
        .output();
    assert!(
        !String::from_utf8(piped.unwrap().stdout)
            .unwrap()
            .contains('\u{1b}')
    );
}

#[test]
fn writes_every_field_of_the_result_file() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("run square.off --source 2 -o r.json -o r.csv -o r.md -o r.tex");
    let result = sandbox.json("r.json");
    for path in FIELDS.split_whitespace() {
        assert!(at(&result, path).is_some(), "{path} is missing");
    }
    assert_eq!(result["schema"], "geobench/1");
    assert_eq!(result["command"][1], "run");
    let model = &result["models"][0];
    assert_eq!(model["name"], "square");
    assert_eq!(
        [
            &model["vertices"],
            &model["faces"],
            &model["edges"],
            &model["boundary_edges"]
        ],
        [&json!(4), &json!(2), &json!(5), &json!(4)]
    );
    assert_eq!(model["sha256"].as_str().unwrap().len(), 64);
    for cell in result["cells"].as_array().unwrap() {
        assert_eq!(cell["status"], "ok");
        assert_eq!(cell["source"], 2);
        let time = &cell["time"];
        let samples = time["samples"].as_array().unwrap().len();
        assert!((5..=100).contains(&samples), "{samples}");
        // A solve of less than 10 ms is timed in batches; on a busy machine it may take longer.
        assert!([0, samples].contains(&time["solves"].as_array().unwrap().len()));
        assert_eq!(time["precision"], 0.03);
        assert!(cell["time"]["median"].as_f64().unwrap() > 0.0);
        assert!(cell["memory"]["heap_peak_bytes"].as_u64().unwrap() >= 4 * 8);
        // The groups of the built-in suite have references of their own.
        let (reference, simd) = match cell["group"].as_str().unwrap() {
            "papers" => ("mmp", "scalar".to_owned()),
            _ if cell["algorithm"] == "vtp" => ("mmp-fast", "scalar".to_owned()),
            _ => ("mmp-fast", Instructions::detect().to_string()),
        };
        assert_eq!(cell["check"]["reference"], reference);
        assert_eq!(cell["simd"], simd);
    }

    let csv = sandbox.read("r.csv");
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    for path in FIELDS.split_whitespace() {
        if let Some(field) = path.strip_prefix("cells.0.") {
            assert!(
                header.contains(&field.replace('.', "_").as_str()),
                "{field}"
            );
        }
    }
    assert_eq!(lines.count(), result["cells"].as_array().unwrap().len());
    assert!(sandbox.read("r.md").contains("| Model | |"));
    assert!(sandbox.read("r.tex").contains("\\begin{tabular}"));
}

#[test]
fn a_few_samples_have_a_note_in_place_of_an_interval() {
    let sandbox = Sandbox::with_square();
    let text = sandbox.succeed("run square.off --repeat 2 --format json --algo mmp");
    let result: Value = serde_json::from_str(&text).unwrap();
    let time = &result["cells"][0]["time"];
    assert_eq!(time["ci95"], Value::Null);
    assert_eq!(
        time["note"],
        "no confidence interval from fewer than 6 samples"
    );
}

#[test]
fn several_sources_are_several_cells() {
    let sandbox = Sandbox::with_square();
    let csv = sandbox.succeed("run square.off --source 3,1 --algo mmp --format csv --quiet");
    let sources: Vec<&str> = csv
        .lines()
        .skip(1)
        .map(|l| l.split(',').nth(2).unwrap())
        .collect();
    assert_eq!(sources, ["3", "1"]);
    let random = "run square.off --source random:3,seed=4 --algo mmp --format csv";
    assert_eq!(sandbox.succeed(random).lines().count(), 4);
}

#[test]
fn a_directory_is_searched_and_names_stay_apart() {
    let sandbox = Sandbox::new();
    for name in ["m/b/x.off", "m/a/x.off", "m/c.off"] {
        sandbox.write(name, SQUARE);
    }
    sandbox.write("m/notes.txt", "no mesh");
    let csv = sandbox.succeed("run m gen:cube,n=1 --algo mmp --repeat 1 --format csv");
    let names: Vec<&str> = csv
        .lines()
        .skip(1)
        .map(|l| l.split("mmp").next().unwrap())
        .collect();
    assert_eq!(names, ["m/a/x.off,", "m/b/x.off,", "c,", "\"cube,n=1\","]);
}

#[test]
fn one_broken_model_does_not_lose_the_others() {
    let sandbox = Sandbox::new();
    sandbox.write("m/bad.off", UNUSABLE);
    sandbox.write("m/good.off", SQUARE);
    let outcome = sandbox.call("run m --algo mmp --quiet -o r.json");
    assert_eq!(outcome.code, 2);
    assert_eq!(outcome.stderr.lines().count(), 1);
    assert!(
        outcome.stderr.starts_with("geobench: error: m/bad.off: "),
        "{}",
        outcome.stderr
    );
    assert!(outcome.stdout.contains("bad  (refused)"));
    assert!(outcome.stdout.contains("good  (V: 4, F: 2)"));
    let result = sandbox.json("r.json");
    assert_eq!(result["cells"][0]["status"], "refused");
    assert_eq!(result["cells"][0]["time"]["median"], Value::Null);
    assert_eq!(result["cells"][1]["status"], "ok");
}

#[test]
fn a_wrong_answer_is_a_failure() {
    let sandbox = Sandbox::with_square();
    let outcome = sandbox.call("run square.off --algo test-wrong --check mmp --format csv");
    assert_eq!(outcome.code, 1);
    let said = "no majority among the 2 algorithms, either may be wrong: the reference `mmp`; \
                `test-wrong` differs from `mmp` by up to 3.333e-1 relative, at vertex 1; \
                proven right: mmp";
    assert!(outcome.stderr.contains(said), "{}", outcome.stderr);
    let row = outcome.stdout.lines().nth(1).unwrap();
    assert!(
        row.starts_with("square,test-wrong,0,,1,false,wrong,"),
        "{row}"
    );

    let table = sandbox.call("run square.off --algo test-wrong --check mmp");
    assert_eq!(table.code, 1);
    assert!(
        table
            .stdout
            .lines()
            .any(|l| l.contains("Time (s)") && l.contains("wrong"))
    );
}

#[test]
fn a_wrong_file_of_distances_is_a_failure_and_fails_no_cell() {
    let sandbox = Sandbox::with_square();
    // The distance of vertex 2 is the square root of 2.
    sandbox.write(
        "expected/square.s0.csv",
        "vertex,distance\n0,0\n1,1\n2,1.5\n3,1\n",
    );
    for check in ["file", "expected/square.s0.csv"] {
        let command = format!("run square.off --algo mmp --check {check} --format csv");
        let outcome = sandbox.call(&command);
        assert_eq!(outcome.code, 1);
        let said = "expected/square.s0.csv` is proven wrong; proven right: mmp";
        assert!(outcome.stderr.contains(said), "{}", outcome.stderr);
        let row = outcome.stdout.lines().nth(1).unwrap();
        assert!(row.starts_with("square,mmp,0,,1,false,ok,"), "{row}");
        assert!(row.contains("is wrong: differs from certificate: vertex 2 is at 1.5"));
    }
}

#[test]
fn stored_distances_are_a_reference() {
    let sandbox = Sandbox::with_square();
    sandbox.write("square.s0.csv", "0,0\n1,1\n3,1.0000000000001\n");
    let table = sandbox.succeed("run square.off --algo mmp --check file");
    assert!(
        table.contains("largest relative difference 1.0e-13"),
        "{table}"
    );
    let missing = sandbox.call("run square.off --algo mmp --check file --source 1 --quiet");
    assert_eq!(missing.code, 1, "what could not be checked has not passed");
    assert!(
        missing
            .stdout
            .contains("not checked: there is no square.s1.csv beside the model")
    );
    sandbox.succeed("run square.off --algo mmp --check none --source 1");
}

#[test]
fn an_algorithm_alone_is_checked_by_another_that_has_no_row() {
    let sandbox = Sandbox::with_square();
    for (algorithm, reference) in [("ich", "mmp-fast"), ("mmp-fast", "ich-fast")] {
        let run = format!("run square.off --algo {algorithm} --repeat 1 -o r.json");
        let table = sandbox.succeed(&run);
        assert!(
            table.contains(&format!("checked against {reference}: ")),
            "{table}"
        );
        let cells = &sandbox.json("r.json")["cells"];
        assert_eq!(cells.as_array().unwrap().len(), 1);
        assert_eq!(cells[0]["check"]["reference"], reference);
    }
    let outcome = sandbox.call("run square.off --algo test-wrong --repeat 1");
    assert_eq!(outcome.code, 1, "{}", outcome.stderr);
    let table = sandbox.succeed("run square.off --algo ich --repeat 1 --check none");
    assert!(table.contains("not checked\n"), "{table}");
    let table = sandbox.succeed("run square.off --algo ich --repeat 1 --check ich");
    assert!(table.contains("not checked: ich is its own reference"));
    let table = sandbox.succeed("run square.off --algo ich --repeat 1 --check vtp");
    assert!(table.contains("checked against vtp"));
}

#[test]
fn without_a_model_the_built_in_suite_runs() {
    let sandbox = Sandbox::new();
    let csv = sandbox.succeed("run --algo ich --repeat 1 --warmup 0 --format csv");
    assert!(csv.lines().count() > 4);
    assert!(csv.lines().skip(1).all(|line| line.contains(",ok,")));
}

#[test]
fn a_reader_that_leaves_early_is_no_error() {
    use std::process::{Command, Stdio};
    let sandbox = Sandbox::with_square();
    let mut child = Command::new(env!("CARGO_BIN_EXE_geobench"))
        .args(["run", "square.off", "--quiet"])
        .current_dir(sandbox.path(""))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
    assert!(output.status.success());
}

/// The reader of a pipe ends when the first writer closes it, so a trial would be taken for the
/// whole.
#[cfg(unix)]
#[test]
fn a_pipe_gets_the_whole_output_at_once() {
    let sandbox = Sandbox::with_square();
    let made = std::process::Command::new("mkfifo")
        .arg(sandbox.path("p.csv"))
        .status();
    assert!(made.unwrap().success());
    let pipe = sandbox.path("p.csv");
    let reader = std::thread::spawn(move || std::fs::read_to_string(pipe).unwrap());
    sandbox.succeed("distance square.off --source 0 -o p.csv --quiet");
    assert!(reader.join().unwrap().starts_with("vertex,distance\n0,0\n"));
}

#[test]
fn the_reader_of_obj_files_can_be_the_library() {
    let sandbox = Sandbox::new();
    // The library refuses what is no number, also where no face uses it.
    sandbox.write(
        "m.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan(1) 0 0\nf 1 2 3\n",
    );
    sandbox.write(
        "suite.toml",
        "models = [\"m.obj\"]\nalgorithms = [\"mmp\"]\nreader = \"tobj\"\n[[group]]\nname = \"g\"\n",
    );
    let refusal = "tobj cannot read it";
    for isolate in ["process", "none"] {
        let run = format!("run m.obj --algo mmp --repeat 1 --isolate {isolate}");
        sandbox.succeed(&run);
        sandbox.succeed(&format!("{run} --reader direct"));
        for run in [
            format!("{run} --reader tobj"),
            format!("run --config suite.toml --repeat 1 --isolate {isolate}"),
        ] {
            let outcome = sandbox.call(&run);
            assert_eq!(outcome.code, 2, "{run}: {}", outcome.stderr);
            assert!(
                outcome.stderr.contains(refusal),
                "{run}: {}",
                outcome.stderr
            );
        }
    }
    let outcome = sandbox.call("run m.obj --reader fast");
    assert_eq!(outcome.code, 2);
    let message = "the readers of OBJ files are `direct` and `tobj`";
    assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
}
