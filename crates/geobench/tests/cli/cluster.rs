//! `geobench cluster`. `scripts/check-cluster` tests it with a real Slurm.

use std::process::Command;

use crate::support::Sandbox;

const START: &str = "cluster --shards 3 -o runs --no-submit --partition fast";
const RUN: &str = "gen:octahedron gen:cube,n=2 --algo vtp,mmp --source random:2 --repeat 1 --quiet";

/// Runs a job script as Slurm would.
fn start(sandbox: &Sandbox, script: &str, part: u32) {
    let mut command = Command::new("bash");
    command
        .arg(sandbox.path(script))
        .env("SLURM_ARRAY_TASK_ID", part.to_string())
        .env("SLURMD_NODENAME", "n7");
    let output = command.output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{script}: {text}");
}

#[test]
fn scripts_of_all_parts_make_the_whole_result() {
    let sandbox = Sandbox::new();
    sandbox.succeed(&format!("{START} --exclusive -- {RUN} --timeout 90s"));
    let script = sandbox.read("runs/part.sh");
    // The time follows from the sizes of the models, not from the limit of a run.
    for option in ["array=1-3", "partition=fast", "exclusive", "time=16"] {
        let line = format!("#SBATCH --{option}\n");
        assert!(script.contains(&line), "{line}: {script}");
    }
    for part in 1..=3 {
        start(&sandbox, "runs/part.sh", part);
    }
    start(&sandbox, "runs/merge.sh", 0);
    let status = sandbox.succeed("cluster -o runs --status");
    assert!(
        status.starts_with("3 of 3 parts done, 0 waiting or running, 0 failed\n"),
        "{status}"
    );
    let result = sandbox.json("runs/result.json");
    assert_eq!(result["cells"].as_array().unwrap().len(), 8);
    assert_eq!(result["sessions"][0]["host"]["node"], "n7");
    let resumed = sandbox.succeed("cluster -o runs --resume");
    assert!(resumed.starts_with("all parts are done: "), "{resumed}");
}

#[test]
fn a_part_goes_on_from_the_journal_of_its_node() {
    let sandbox = Sandbox::new();
    sandbox.succeed(&format!("{START} -- {RUN}"));
    start(&sandbox, "runs/part.sh", 2);
    let journal = sandbox.read("runs/journals/2.n7.jsonl");
    std::fs::remove_file(sandbox.path("runs/parts/2.json")).unwrap();
    start(&sandbox, "runs/part.sh", 2);
    let again = sandbox.read("runs/journals/2.n7.jsonl");
    let runs = |text: &str| {
        text.lines()
            .filter(|line| line.contains("\"purpose\""))
            .count()
    };
    assert!(runs(&journal) > 0, "{journal}");
    assert_eq!(runs(&again), runs(&journal), "{again}");
}

#[test]
fn wrong_usage_is_an_error() {
    let sandbox = Sandbox::new();
    for (arguments, problem) in [
        (format!("cluster -o runs -- {RUN}"), "--shards is missing"),
        (
            format!("cluster --shards 5 -o runs -- {RUN}"),
            "--shards 5: the plan has 4 pairs of model and source",
        ),
        (
            format!("{START} -- {RUN} -o r.json"),
            "--output: each part has one of its own; leave it out",
        ),
        (
            format!("{START} -- {RUN} --bad"),
            "the options of `run`: unexpected argument '--bad'",
        ),
        (
            "cluster -o runs --status".to_owned(),
            "part.sh: cannot be read",
        ),
    ] {
        let outcome = sandbox.call(&arguments);
        assert_eq!(outcome.code, 2, "{arguments}: {}", outcome.stderr);
        assert!(
            outcome.stderr.contains(problem),
            "{arguments}: {}",
            outcome.stderr
        );
        assert!(!sandbox.path("runs").exists(), "{arguments}");
    }
    sandbox.succeed(&format!("{START} -- {RUN}"));
    let twice = sandbox.call(&format!("{START} -- {RUN}"));
    assert!(
        twice.stderr.contains("has a benchmark already"),
        "{}",
        twice.stderr
    );
}
