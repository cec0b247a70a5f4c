//! `geobench run --resume`: a run that is killed at any moment loses no finished work.

use std::collections::{HashMap, HashSet};
use std::fs::{self, File};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

use geobench_mesh::SplitMix64;
use serde_json::{Value, json};

use crate::support::Sandbox;

/// A suite with two groups that share a model, several sources, and a reference that is not
/// measured.
const SUITE: &str = r#"
algorithms = ["mmp", "vtp", "ich"]
repeat = 4
seed = 5

[[group]]
name = "first"
models = ["gen:sphere,subdiv=3", "gen:torus,faces=2000", "gen:cube,n=6"]
source = "random:3"

[[group]]
name = "second"
models = ["gen:sphere,subdiv=3", "gen:terrain,n=20,seed=3"]
algorithms = ["vtp", "fwp-ch"]
check = "mmp"
source = [4, 7]
"#;

/// The number of runs in the suite. There are 9 sources with 3 algorithms and 4 sources with 2,
/// each with a warm-up, 4 timed runs and 2 other runs. The reference of the second group adds 4.
const RUNS: usize = (9 * 3 + 4 * 2) * 7 + 4;

fn start(sandbox: &Sandbox, arguments: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_geobench"))
        .current_dir(sandbox.path(""))
        .args(arguments.split_whitespace())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// The parts of a result that do not depend on time.
fn essence(result: &Value) -> Vec<Value> {
    let cells = result["cells"].as_array().unwrap();
    cells
        .iter()
        .map(|cell| {
            json!({
                "cell": [&cell["group"], &cell["model"], &cell["source"], &cell["algorithm"]],
                "status": [&cell["status"], &cell["message"]],
                "samples": cell["time"]["samples"].as_array().unwrap().len(),
                "places": cell["time"]["places"],
                "counters": cell["counters"],
                "papers": cell["memory"]["papers_bytes"],
                "check": cell["check"],
            })
        })
        .collect()
}

/// The complete lines of a journal.
fn whole_lines(sandbox: &Sandbox, name: &str) -> String {
    let text = fs::read(sandbox.path(name)).unwrap_or_default();
    let end = text.iter().rposition(|&byte| byte == b'\n');
    String::from_utf8(text[..end.map_or(0, |end| end + 1)].to_vec()).unwrap()
}

/// The number of processes that wrote to a journal.
fn sessions(journal: &str) -> usize {
    let lines = journal.lines();
    lines
        .filter(|line| line.starts_with("{\"session\":"))
        .count()
}

#[test]
fn killed_at_random_moments_a_run_loses_and_repeats_nothing() {
    kill_again_and_again("--isolate none", RUNS, 20);
}

#[test]
fn killed_with_its_children_a_run_loses_and_repeats_nothing() {
    let arguments = "gen:sphere,subdiv=2 --isolate process --source 3,1 --algo mmp,vtp";
    // Two groups on the one model, four cells each.
    kill_again_and_again(arguments, 4 * 7 + 4 * 7, 5);
}

#[test]
fn killed_with_several_cells_at_the_same_time_a_run_loses_and_repeats_nothing() {
    let arguments = "gen:sphere,subdiv=2 --jobs 3 --source 3,1 --algo mmp,vtp,ich";
    kill_again_and_again(arguments, 6 * 7 + 6 * 7, 5);
}

/// Runs the suite with these arguments, kills it at least this many times, and compares the result
/// with that of an uninterrupted run. The suite has `runs` distinct runs.
///
/// Where this process waits long for a processor, a run does much before it is killed. If it ends
/// after too few kills, all begins anew.
fn kill_again_and_again(arguments: &str, runs: usize, least: usize) {
    let sandbox = Sandbox::new();
    sandbox.write("suite.toml", SUITE);
    let run = format!("run {arguments} --config suite.toml --quiet");
    sandbox.succeed(&format!("{run} -o undisturbed.json"));

    let run = &format!("{run} --resume j.jsonl -o killed.json");
    let mut random = SplitMix64::new(1);
    let mut kills = 0;
    let mut known = String::new();
    loop {
        let mut child = start(&sandbox, run);
        // Kills happen after a random time or after a number of bytes in the journal. So some runs
        // are killed early and some make progress, independent of the speed of the machine.
        let wanted = known.len() as u64 + random.below(4000) as u64;
        let delay = Duration::from_micros(random.below(40_000) as u64);
        let early = random.below(3) == 0;
        let size = || fs::metadata(sandbox.path("j.jsonl")).map_or(0, |m| m.len());
        if early {
            thread::sleep(delay);
        }
        while !early && size() < wanted && child.try_wait().unwrap().is_none() {
            thread::sleep(Duration::from_micros(100));
        }
        child.kill().unwrap();
        let output = child.wait_with_output().unwrap();
        let text = whole_lines(&sandbox, "j.jsonl");
        assert!(text.starts_with(&known), "what was written stays");
        known = text;
        match output.status.code() {
            None => kills += 1,
            Some(code) => {
                let error = String::from_utf8(output.stderr).unwrap();
                assert_eq!(code, 0, "{error}");
                if kills >= least && sessions(&known) > 1 {
                    break;
                }
                fs::remove_file(sandbox.path("j.jsonl")).unwrap();
                known.clear();
            }
        }
    }

    let (whole, killed) = (
        sandbox.json("undisturbed.json"),
        sandbox.json("killed.json"),
    );
    assert_eq!(essence(&killed), essence(&whole));
    assert_eq!(whole["sessions"].as_array().unwrap().len(), 1);
    assert_eq!(
        killed["sessions"].as_array().unwrap().len(),
        sessions(&known)
    );
    assert_eq!(killed["plan"], whole["plan"]);

    // No finished run was repeated, except warm-ups before runs that were still to be timed.
    let mut seen = HashSet::new();
    let mut timed = HashMap::<String, usize>::new();
    for line in known.lines() {
        let line: Value = serde_json::from_str(line).unwrap();
        let id = &line["run"]["id"];
        if id.is_null() {
            continue;
        }
        let cell = json!([id["group"], id["model"], id["source"], id["algorithm"]]).to_string();
        let new = seen.insert(id.to_string());
        let timed = timed.entry(cell).or_default();
        match id["purpose"].as_str().unwrap() {
            "warm_up" => assert!(new || *timed < 4, "{id}"),
            "time" => {
                assert!(new, "{id}");
                *timed += 1;
            }
            _ => assert!(new, "{id}"),
        }
    }
    assert_eq!(seen.len(), runs);

    // Resumed again, with nothing left to do.
    sandbox.succeed(run);
    let again = sandbox.json("killed.json");
    assert_eq!(again["cells"], killed["cells"], "times included");
    assert_eq!(again["models"], killed["models"]);
    assert_eq!(
        sandbox.read("j.jsonl").lines().count(),
        known.lines().count() + 1
    );
}

#[test]
fn a_journal_of_another_model_or_of_other_options_is_refused() {
    let sandbox = Sandbox::with_square();
    let run = "run square.off --algo mmp --repeat 2 --quiet --resume j.jsonl";
    sandbox.succeed(run);
    let before = sandbox.read("j.jsonl");
    assert_eq!(
        sandbox.refuse(&format!("{run} --warmup 3")),
        "journal j.jsonl: belongs to another run: `plan.groups[0].warmup` is 1 there and 3 now; \
         repeat that run or name another file"
    );
    let moved = crate::support::SQUARE.replace("1 1 0", "1 1 1");
    sandbox.write("square.off", &moved);
    let refusal = sandbox.refuse(run);
    assert!(
        refusal.contains("`plan.groups[0].models[0].file_sha256` is \""),
        "{refusal}"
    );
    assert_eq!(sandbox.read("j.jsonl"), before);
}

#[test]
fn other_files_than_journals_are_refused_before_the_first_cell() {
    let sandbox = Sandbox::with_square();
    let run = "run square.off --algo mmp --quiet --resume";
    sandbox.write("notes.txt", "mine\n");
    assert!(
        sandbox
            .refuse(&format!("{run} notes.txt"))
            .contains("not a journal of geobench")
    );
    assert_eq!(sandbox.read("notes.txt"), "mine\n");
    assert!(
        sandbox
            .refuse(&format!("{run} /dev/full"))
            .contains("not a regular file")
    );
    assert!(
        sandbox
            .refuse(&format!("{run} ."))
            .contains("not a regular file")
    );
    let missing = sandbox.refuse(&format!("{run} no/such/j.jsonl"));
    assert!(
        missing.contains("journal no/such/j.jsonl: cannot be opened for writing"),
        "{missing}"
    );
    assert_eq!(
        sandbox.refuse(&format!("{run} r.json -o r.json")),
        "r.json: would replace a file that is read; name another output"
    );

    let file = File::create(sandbox.path("j.jsonl")).unwrap();
    file.lock().unwrap();
    assert_eq!(
        sandbox.refuse(&format!("{run} j.jsonl")),
        "journal j.jsonl: another process is writing it"
    );
    drop(file);
    sandbox.succeed(&format!("{run} j.jsonl"));
}

#[cfg(unix)]
#[test]
fn in_a_directory_that_is_read_only_nothing_is_begun() {
    use std::os::unix::fs::PermissionsExt;
    let sandbox = Sandbox::with_square();
    fs::create_dir(sandbox.path("ro")).unwrap();
    fs::set_permissions(sandbox.path("ro"), fs::Permissions::from_mode(0o555)).unwrap();
    // File permissions do not restrict root, but even root cannot create files in /proc.
    let directory = match File::create(sandbox.path("ro/probe")) {
        Ok(_) => "/proc/self".to_owned(),
        Err(_) => "ro".to_owned(),
    };
    for option in ["--resume", "-o"] {
        let refusal = sandbox.refuse(&format!(
            "run square.off --quiet {option} {directory}/j.json"
        ));
        assert!(refusal.contains("cannot be "), "{refusal}");
    }
}

/// Simulates a full disk by a limit on the size of files, in blocks of 512 bytes.
#[cfg(unix)]
#[test]
fn when_the_disk_is_full_nothing_that_was_done_is_lost() {
    let sandbox = Sandbox::with_square();
    let run = "run square.off --algo mmp,vtp --repeat 3 --quiet --resume j.jsonl -o r.json";
    let limited = |blocks: u32| {
        let program = env!("CARGO_BIN_EXE_geobench");
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec {program} {run}");
        let output = Command::new("sh")
            .current_dir(sandbox.path(""))
            .args(["-c", &script])
            .output()
            .unwrap();
        (
            output.status.code(),
            String::from_utf8(output.stderr).unwrap(),
        )
    };
    // The limit is too small for the first line.
    let (code, error) = limited(0);
    assert_eq!(code, Some(2), "{error}");
    assert!(
        error.contains("journal j.jsonl: cannot be written: "),
        "{error}"
    );
    assert!(!sandbox.path("j.jsonl").exists());

    // The limit allows some runs, but not all.
    let (code, error) = limited(10);
    assert_eq!(code, Some(2), "{error}");
    assert!(error.contains("it holds all runs up to here"), "{error}");
    let before = sandbox.read("j.jsonl");
    assert!(before.ends_with('\n') && before.contains("\"run\""));

    sandbox.succeed(run);
    assert!(sandbox.read("j.jsonl").starts_with(&before));
    assert_eq!(sandbox.json("r.json")["cells"].as_array().unwrap().len(), 2);
}

#[cfg(target_os = "linux")]
#[test]
fn results_that_cannot_be_written_in_the_end_are_saved_elsewhere() {
    let sandbox = Sandbox::with_square();
    std::os::unix::fs::symlink("/dev/full", sandbox.path("full.json")).unwrap();
    let mut command = sandbox.command("run square.off --algo mmp --repeat 1 --quiet -o full.json");
    let output = command.env("TMPDIR", sandbox.path("")).output().unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(
        error.starts_with("geobench: error: full.json: cannot be written: No space left"),
        "{error}"
    );
    let (_, saved) = error
        .trim_end()
        .split_once("; the results are in ")
        .unwrap();
    let saved: Value = serde_json::from_str(&fs::read_to_string(saved).unwrap()).unwrap();
    assert_eq!(saved["cells"][0]["status"], "ok");
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.contains("Time (s)"), "{table}");
}
