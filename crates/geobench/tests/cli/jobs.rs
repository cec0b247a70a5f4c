//! `geobench run --jobs`: several cells at the same time.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::support::Sandbox;

const RUN: &str = "run square.off gen:cube,n=3 gen:sphere,subdiv=2 --source 0,1 \
     --algo mmp,vtp,ich --repeat 2 --warmup 1";

/// The fields of all cells that do not depend on the machine.
fn essence(result: &Value) -> Vec<Value> {
    let cells = result["cells"].as_array().unwrap();
    cells
        .iter()
        .map(|cell| {
            json!({
                "cell": [&cell["model"], &cell["source"], &cell["algorithm"], &cell["status"]],
                "samples": cell["time"]["samples"].as_array().unwrap().len(),
                "counters": cell["counters"],
                "heap": cell["memory"]["heap_peak_bytes"],
                "check": cell["check"],
            })
        })
        .collect()
}

#[test]
fn all_but_the_times_is_as_with_one_job_and_the_times_are_marked() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed(&format!("{RUN} -o one.json"));
    let shown = sandbox.succeed(&format!("{RUN} --jobs 4 -o four.json -o four.md"));
    let (one, four) = (sandbox.json("one.json"), sandbox.json("four.json"));
    assert_eq!(essence(&four), essence(&one));
    assert_eq!(one["isolation"], json!({"process": true, "cpus": null}));
    assert_eq!(four["isolation"]["jobs"], 4);
    let mark = "4 cells ran at the same time";
    let warnings = four["conditions"]["warnings"].as_array().unwrap();
    assert!(warnings.contains(&mark.into()), "{warnings:?}");
    // A table has one part for each model, so the note appears once for each model.
    let table = sandbox.read("four.md");
    let marks = format!("the times are disturbed: {mark}");
    assert_eq!(table.matches(&marks).count(), 3, "{table}");
    assert!(
        shown.contains(&format!("disturbed, since {mark}")),
        "{shown}"
    );

    sandbox.succeed("report four.json -o four.html");
    assert!(sandbox.read("four.html").contains(mark));
    let compared = sandbox.call("compare one.json four.json");
    assert!(
        compared
            .stdout
            .contains(&format!("during the new runs {mark}")),
        "{}",
        compared.stdout
    );
}

#[test]
fn limits_hold_for_each_of_the_cells() {
    let sandbox = Sandbox::with_square();
    let start = Instant::now();
    let call = sandbox.call(
        "run square.off --algo mmp,test-loop,test-panic,test-segv,vtp --source 0,1,2 --repeat 1 \
         --timeout 15s --jobs 5 -o r.json",
    );
    assert_eq!(call.code, 1, "{}", call.stderr);
    let elapsed = start.elapsed();
    assert!(elapsed >= Duration::from_secs(15), "{elapsed:?}");
    let result = sandbox.json("r.json");
    let statuses: Vec<&str> = result["cells"]
        .as_array()
        .unwrap()
        .iter()
        .map(|cell| cell["status"].as_str().unwrap())
        .collect();
    assert_eq!(
        statuses,
        ["ok", "timeout", "crashed", "crashed", "ok"].repeat(3)
    );
}

#[test]
fn a_journal_of_another_number_of_jobs_is_refused() {
    let sandbox = Sandbox::with_square();
    let run = format!("{RUN} --quiet --resume j.jsonl");
    sandbox.succeed(&format!("{run} --jobs 3"));
    let lines = sandbox.read("j.jsonl").lines().count();
    sandbox.succeed(&format!("{run} --jobs 3"));
    assert_eq!(sandbox.read("j.jsonl").lines().count(), lines + 1);
    assert_eq!(
        sandbox.refuse(&run),
        "journal j.jsonl: belongs to another run: `plan.isolation.jobs` is 3 there and null now; \
         repeat that run or name another file"
    );
}
