//! Mutation tests: damaged suites, result files, journals and files of distances. Any error or
//! result is accepted, but it must take little time. Files that can still be read are
//! passed to all code that shows or joins them.

#[path = "cli/support.rs"]
#[allow(dead_code, reason = "the tests of the command line use all of it")]
mod support;

#[path = "../../mesh/tests/io/damage.rs"]
mod damage;

#[path = "../../mesh/tests/processor_time/mod.rs"]
mod processor_time;

use std::fs;
use std::path::Path;
use std::time::Duration;

use damage::{Damage, damage, damages, fixed, mutations};
use geobench_harness::exec::expected::Expected;
use geobench_harness::exec::limits::DecompressionLimit;
use geobench_harness::plan::suite;
use geobench_harness::plan::suite::{ModelChoice, Settings, Suite, plans};
use geobench_harness::run::journal::{Journal, JournalHeader};
use geobench_harness::run::merge;
use geobench_harness::schema::result_file;
use geobench_harness::schema::{ModelRecord, ResultFile};
use geobench_report::history::{compare, pool};
use geobench_report::page::{self as report, Form, Input, Options, PictureChoice, Tables};
use geobench_report::table::{ComparisonFormat, Look, ResultFormat};
use processor_time::ProcessorTime;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use support::Sandbox;

/// The most processor time for a small file.
const LONGEST: Duration = Duration::from_secs(20);

/// The share of the cases that an ordinary test run executes.
const FEW: u32 = 300;

/// Reads damaged variants of `texts` with `read`, and checks that each takes a short time.
fn all_end(cases: u32, texts: &[String], read: impl Fn(usize, &[u8])) {
    let strategy = (0..texts.len(), prop::collection::vec(damages(), 1..5usize));
    let test = |(text, list): (usize, Vec<Damage>)| {
        let mut bytes = texts[text].clone().into_bytes();
        for d in &list {
            damage(&mut bytes, d);
        }
        let start = ProcessorTime::now();
        read(text, &bytes);
        prop_assert!(start.elapsed() < LONGEST, "took {:?}", start.elapsed());
        Ok(())
    };
    let done = TestRunner::new(fixed(cases)).run(&strategy, test);
    done.unwrap_or_else(|error| panic!("{error}"));
}

const SUITE: &str = r#"
repeat = 3
warmup = 1
source = "random:3,seed=1"
check = "mmp"
tolerance = 1e-9
seed = 1
threads = 2
timeout = "10m"
memory-limit = "8GiB"
max-decompressed = "1GiB"
rows = ["time", "propagated"]
ratios_to = "vtp"
wavefront = true

[[group]]
name = "widths"
shows = """
What a reader is to see."""
models = [
    "gen:torus,faces=20000,bump=0.1,seed=7",
    { path = "none.obj", optional = true },
    { real = ["horse"], path = "gen:knot,faces=9000" },
    { real = "cow", subdivide = 2, path = "gen:terrain,n=32" },
]
algorithms = ["vtp", "fwp-mmp{bucket=2}", { name = "fwp-mmp", kmax = 5000 }, "ext:a"]
full = { models = ["gen:sphere,subdiv=5"], source = [0, 17] }

[[group]]
name = "other"
models = ["gen:cube,n=2"]
algorithms = ["exact"]
source = 3

[ext.a]
command = ["./run", "{model}", "{source}", "{threads}", "{output}"]
protocol = "once"
approximate = true
"#;

fn suites(cases: u32) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("suite.toml");
    all_end(cases, &[SUITE.to_owned()], |_, bytes| {
        let text = String::from_utf8_lossy(bytes);
        if let Ok(suite) = Suite::parse(&path, &text)
            && let Ok(done) = plans(Some(&suite), &Settings::default(), &ModelChoice::default())
        {
            for mut plan in done.plans {
                let _ = plan.find_programs(&suite.programs);
                let model = ModelRecord {
                    vertices: Some(100),
                    ..ModelRecord::default()
                };
                let _ = plan.units_in(&model);
                let _ = (plan.runs(), plan.check_reference());
            }
        }
        if bytes.len().is_multiple_of(16) {
            fs::write(&path, bytes).unwrap();
            let _ = Suite::read(&path);
            let _ = suite::read_programs(&path);
        }
    });
}

/// Result files and a journal of small runs: one on two models with a failure, and a shard.
fn results() -> (Vec<String>, String) {
    let sandbox = Sandbox::with_square();
    sandbox.write("bad.off", support::UNUSABLE);
    let run = |arguments: &str| {
        let call = sandbox.call(&format!("run {arguments} --quiet"));
        assert!((0..3).contains(&call.code), "{}", call.stderr);
    };
    run(
        "square.off gen:cube,n=2 bad.off --algo mmp,vtp,test-panic --ratios-to vtp --wavefront \
         --source 0,2 --repeat 6 --resume j.jsonl -o whole.json",
    );
    run("square.off gen:cube,n=2 --algo vtp,ich --shard 1/1 -o part.json --repeat 2");
    let files = ["whole.json", "part.json"].map(|name| sandbox.read(name));
    (files.into(), sandbox.read("j.jsonl"))
}

/// Writes `file` in every format, and joins and compares it with `other`.
fn use_all(file: &ResultFile, other: &ResultFile, thoroughly: bool) {
    use ResultFormat::{Csv, Json, Latex, Markdown, Table};
    for format in [Table, Markdown, Latex, Csv, Json] {
        let _ = format.render(file);
    }
    let rules = "time=10%,propagated=+0,heap_peak_bytes=5%,missing=0".parse();
    let rules = rules.unwrap();
    for (old, new) in [(file, other), (other, file)] {
        if let Ok(comparison) = compare::compare(("old", old), ("new", new), &rules) {
            use ComparisonFormat::{Json, Markdown, Table};
            for format in [Table, Markdown, Json] {
                let _ = format.render(&comparison, Look::default());
            }
        }
    }
    let named = |file: &ResultFile, name: &str| (name.to_owned(), file.clone());
    let _ = merge::merge(vec![named(file, "a")]);
    let _ = merge::merge(vec![named(other, "a"), named(file, "b")]);
    let _ = pool::pool(vec![named(other, "a"), named(file, "b")], None);
    if !thoroughly {
        return;
    }
    let options = Options {
        ratio_to: None,
        picture: PictureChoice::None,
        decompressed: DecompressionLimit::default(),
        tables: Tables::OfSuite,
    };
    let input = Input::new("r.json".into(), file.clone());
    if let Ok(report) = report::build(&[input], &options) {
        let _ = report::page(&report);
        let folder = tempfile::tempdir().unwrap();
        for form in [Form::Svg, Form::Csv, Form::Tex] {
            report::write_files(&report, form, folder.path(), &[]).unwrap();
        }
    }
}

fn result_files(cases: u32, texts: &[String]) {
    let whole: Vec<ResultFile> = texts
        .iter()
        .map(|text| result_file::parse(Path::new("r.json"), text).unwrap())
        .collect();
    all_end(cases, texts, |of, bytes| {
        let text = String::from_utf8_lossy(bytes);
        // A report takes as long as reading hundreds of files.
        if let Ok(file) = result_file::parse(Path::new("r.json"), &text)
            && bytes.len().is_multiple_of(4)
        {
            use_all(&file, &whole[of], bytes.len().is_multiple_of(32));
        }
    });
}

fn journals(cases: u32, result: &str, journal: &str) {
    let result = result_file::parse(Path::new("r.json"), result).unwrap();
    let header = JournalHeader::new(result.tool, result.plan.unwrap());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("j.jsonl");
    // The first line identifies a journal. The other lines are read only if it is intact.
    let (first, rest) = journal.split_once('\n').unwrap();
    let texts = [rest.to_owned(), journal.to_owned()];
    all_end(cases, &texts, |of, bytes| {
        let start = if of == 0 { &[first, "\n"][..] } else { &[] };
        let bytes = [start.concat().as_bytes(), bytes].concat();
        fs::write(&path, &bytes).unwrap();
        if let Err(error) = Journal::open(&path, &header, &result.sessions[0]) {
            assert!(!error.to_string().is_empty());
            assert!(fs::read(&path).unwrap() == bytes, "it is left as it was");
        }
    });
}

fn distances(cases: u32) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("d.csv");
    let text = "vertex,distance\n0,0\n1,1.5\r\n\n2, 1e-3\n3,inf\n".to_owned();
    all_end(cases, &[text], |_, bytes| {
        fs::write(&path, bytes).unwrap();
        let _ = Expected::File(path.clone()).find(Path::new("m.obj"), None, &0.into(), 4);
    });
}

#[test]
fn damaged_files_do_not_panic() {
    suites(FEW);
    distances(FEW);
    let (files, journal) = results();
    result_files(FEW, &files);
    journals(FEW / 10, &files[0], &journal);
}

#[test]
#[ignore = "takes ten minutes"]
fn many_damaged_suites_do_not_panic() {
    suites(mutations());
}

#[test]
#[ignore = "takes ten minutes"]
fn many_damaged_results_do_not_panic() {
    result_files(mutations(), &results().0);
}

#[test]
#[ignore = "takes ten minutes"]
fn many_damaged_journals_and_distances_do_not_panic() {
    let (files, journal) = results();
    journals(mutations() / 100, &files[0], &journal);
    distances(mutations());
}
