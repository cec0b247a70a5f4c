//! Isolation: a cell that crashes, never ends or takes all memory affects only its own row. An
//! interrupted run keeps its finished cells.

use std::io::Read;
use std::process::{Child, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};

use crate::support::Sandbox;

/// Calls `geobench run` on the square with a failing algorithm, and returns the cells of its result
/// file.
fn run(sandbox: &Sandbox, arguments: &str) -> Vec<Value> {
    let call = sandbox.call(&format!("run square.off --repeat 2 -o r.json {arguments}"));
    assert_eq!(call.code, 1, "{arguments}: {}", call.stderr);
    sandbox.json("r.json")["cells"].as_array().unwrap().clone()
}

/// Runs `bad` between two algorithms that must not be affected, and returns the row of `bad`.
fn provoke(bad: &str, arguments: &str) -> (String, String) {
    let sandbox = Sandbox::with_square();
    let cells = run(&sandbox, &format!("--algo mmp,{bad},vtp {arguments}"));
    assert_eq!(cells.len(), 3);
    for cell in [&cells[0], &cells[2]] {
        assert_eq!(cell["status"], "ok", "{bad}: {cell}");
        assert_eq!(cell["time"]["samples"].as_array().unwrap().len(), 2);
        assert_eq!(cell["check"]["reference"], "mmp");
    }
    let cell = &cells[1];
    assert_eq!(cell["time"]["samples"], json!([]), "{bad}");
    let text = |key: &str| cell[key].as_str().unwrap().to_owned();
    (text("status"), text("message"))
}

#[test]
fn a_panic_costs_its_row() {
    let (status, message) = provoke("test-panic", "");
    assert_eq!(status, "crashed");
    assert!(
        message.starts_with("the algorithm panicked: no such luck (crates/registry/src/"),
        "{message}"
    );
}

#[test]
fn a_panic_costs_its_row_in_this_process_too() {
    let (status, message) = provoke("test-panic", "--isolate none");
    assert_eq!(status, "crashed");
    assert_eq!(message, "the algorithm panicked: no such luck");
}

#[test]
fn an_exit_fails_its_row_and_shows_the_end_of_stderr() {
    assert_eq!(
        provoke("test-exit", ""),
        (
            "crashed".to_owned(),
            "ended with exit status 3 without an answer, stderr: nothing to be done (warming up)"
                .to_owned()
        )
    );
}

#[test]
fn a_signal_fails_its_row_and_is_named() {
    for (bad, message) in [
        (
            "test-segv",
            "was killed by signal 11 (SIGSEGV) (warming up)",
        ),
        (
            "test-abort",
            "was killed by signal 6 (SIGABRT) (warming up)",
        ),
        (
            "test-kill{after=2}",
            "was killed by signal 9 (SIGKILL) (being timed)",
        ),
    ] {
        let found = provoke(bad, "");
        assert_eq!(found, ("crashed".to_owned(), message.to_owned()));
    }
}

#[test]
fn an_exhausted_stack_costs_its_row() {
    let (status, message) = provoke("test-overflow", "");
    assert_eq!(status, "crashed");
    assert!(
        message.starts_with("was killed by signal 6 (SIGABRT), stderr: "),
        "{message}"
    );
    assert!(message.contains("has overflowed its stack"), "{message}");
}

#[test]
fn garbage_on_the_pipe_costs_its_row() {
    assert_eq!(
        provoke("test-garbage", ""),
        (
            "crashed".to_owned(),
            "printed what is no answer: \"half way there\" (warming up)".to_owned()
        )
    );
}

#[test]
fn an_endless_loop_ends_as_timeout_without_its_other_runs() {
    let start = Instant::now();
    // The first timed run never ends; there would be a second one. No run of the others takes as
    // long, whatever else the machine does.
    let found = provoke("test-loop{after=1}", "--timeout 15s");
    assert_eq!(
        found,
        (
            "timeout".to_owned(),
            "took longer than the 15s allowed (being timed)".to_owned()
        )
    );
    assert!(start.elapsed() >= Duration::from_secs(15));
}

#[test]
fn a_cell_beyond_the_memory_limit_ends_as_out_of_memory() {
    let (status, message) = provoke("test-allocate", "--memory-limit 200MiB");
    assert_eq!(status, "out_of_memory");
    assert!(
        message.ends_with("more than the 200 MiB allowed (warming up)")
            || message.starts_with("memory allocation of 1048576 bytes failed"),
        "{message}"
    );
}

#[test]
fn an_allocation_that_cannot_be_had_is_out_of_memory() {
    let petabyte = 1_u64 << 50;
    let (status, message) = provoke(&format!("test-allocate{{block={petabyte}}}"), "");
    assert_eq!(status, "out_of_memory");
    assert_eq!(
        message,
        format!("memory allocation of {petabyte} bytes failed (warming up)")
    );
}

#[test]
fn a_limit_that_is_exceeded_while_loading_is_the_status() {
    let sandbox = Sandbox::new();
    for (limit, status) in [
        ("--memory-limit 4MiB", "out_of_memory"),
        ("--timeout 1ms", "timeout"),
    ] {
        let run = format!("run gen:sphere,subdiv=6 --algo vtp {limit} --quiet -o r.json");
        assert_eq!(sandbox.call(&run).code, 1);
        let cell = &sandbox.json("r.json")["cells"][0];
        assert_eq!(cell["status"], status);
        let message = cell["message"].as_str().unwrap();
        assert!(message.starts_with("gen:sphere,subdiv=6"), "{message}");
        assert!(message.ends_with("(loading the model)"), "{message}");
    }
}

#[test]
fn a_reference_that_crashes_is_said_in_every_row() {
    let sandbox = Sandbox::with_square();
    let cells = run(&sandbox, "--algo test-abort,vtp");
    assert_eq!(cells[0]["status"], "crashed");
    assert_eq!(cells[1]["status"], "ok");
    assert_eq!(
        cells[1]["message"],
        "not checked: the reference test-abort failed: was killed by signal 6 (SIGABRT) (warming up)"
    );
}

#[test]
fn every_source_of_a_cell_has_a_process() {
    let sandbox = Sandbox::with_square();
    let cells = run(
        &sandbox,
        "--algo mmp,test-kill{after=2},test-kill{after=3} --source 0,1",
    );
    let statuses: Vec<&Value> = cells.iter().map(|cell| &cell["status"]).collect();
    // With one more to warm up there are three runs from each source, and six would be too many
    // for both.
    assert_eq!(statuses, ["ok", "crashed", "ok", "ok", "crashed", "ok"]);
}

#[test]
fn verify_goes_on_after_a_crash() {
    let sandbox = Sandbox::with_square();
    let call = sandbox.call("verify square.off --algo test-segv,vtp --source 0,1");
    let text = call.stdout;
    assert_eq!(call.code, 1, "{text}");
    assert_eq!(
        text.matches("test-segv: FAILED: was killed by signal 11 (SIGSEGV)")
            .count(),
        2
    );
    assert_eq!(text.matches("vtp: ok: agrees with mmp").count(), 2);
}

#[test]
fn limits_need_processes() {
    let sandbox = Sandbox::with_square();
    for option in ["--timeout 10s", "--memory-limit 1GiB"] {
        let message = sandbox.refuse(&format!("run square.off --isolate none {option}"));
        let (name, _) = option.split_once(' ').unwrap();
        assert_eq!(
            message,
            format!(
                "{name} needs --isolate process: nothing can end a run in this very process \
                 without ending all others"
            )
        );
    }
    let output = sandbox.call("run square.off --isolate none --timeout none --memory-limit none");
    assert_eq!(output.code, 0);
    assert!(!output.stderr.contains("limits"), "{}", output.stderr);
}

#[test]
fn limits_are_read_and_recorded() {
    let sandbox = Sandbox::with_square();
    sandbox.write(
        "suite.toml",
        "models = [\"square.off\"]\nalgorithms = [\"vtp\"]\ntimeout = \"90s\"\n\
         [[group]]\nname = \"a\"\n[[group]]\nname = \"b\"\ntimeout = \"none\"\nmemory-limit = \"1GiB\"\n",
    );
    sandbox.succeed("run --config suite.toml -o r.json");
    let result = sandbox.json("r.json");
    assert_eq!(result["isolation"], json!({"process": true, "cpus": null}));
    let limits = |result: &Value| {
        let groups = result["groups"].as_array().unwrap().iter();
        let both = groups.map(|g| json!([g["timeout"], g["memory_limit"]]));
        Value::Array(both.collect())
    };
    assert_eq!(limits(&result), json!([[90.0, null], [null, 1 << 30]]));

    sandbox.succeed("run --config suite.toml -o r.json --timeout 5m");
    assert_eq!(
        limits(&sandbox.json("r.json")),
        json!([[300.0, null], [300.0, 1 << 30]])
    );

    let output = sandbox.call("run --config suite.toml -o r.json --isolate none");
    assert_eq!(output.code, 0);
    assert!(
        output
            .stderr
            .contains("group `a`: without --isolate process nothing keeps its limits"),
        "{}",
        output.stderr
    );
    let result = sandbox.json("r.json");
    assert_eq!(result["isolation"]["process"], false);
    assert_eq!(limits(&result), json!([[null, null], [null, null]]));

    sandbox.write(
        "suite.toml",
        "timeout = \"soon\"\n[[group]]\nname = \"a\"\n",
    );
    assert_eq!(
        sandbox.refuse("run --config suite.toml"),
        "suite.toml, line 1: `timeout`: `soon` is not a time; give one such as 90s, 10m or 1h30m, or none"
    );
}

#[test]
fn failing_algorithms_are_not_listed() {
    let sandbox = Sandbox::with_square();
    for arguments in ["algos all", "algos exact", "algos all --format json"] {
        assert!(!sandbox.succeed(arguments).contains("test-"));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn cells_are_pinned_on_request() {
    let sandbox = Sandbox::with_square();
    let allowed = std::fs::read_to_string("/proc/self/status").unwrap();
    let allowed = allowed
        .lines()
        .find_map(|line| line.strip_prefix("Cpus_allowed_list:"))
        .unwrap()
        .trim();
    let first: usize = allowed.split([',', '-']).next().unwrap().parse().unwrap();
    for place in ["process", "none"] {
        sandbox.succeed(&format!(
            "run square.off --cpu {first} --isolate {place} -o r.json"
        ));
        assert_eq!(sandbox.json("r.json")["isolation"]["cpus"], json!([first]));
    }
    let message = sandbox.refuse("run square.off --cpu 1023");
    assert!(
        message.starts_with("--cpu: processor 1023 is not one of those that this process may use"),
        "{message}"
    );

    let mut looping = Looping::start(
        &sandbox,
        &format!("run square.off --algo test-loop --cpu {first}"),
    );
    let status = std::fs::read_to_string(format!("/proc/{}/status", looping.cell())).unwrap();
    assert!(
        status.contains(&format!("Cpus_allowed_list:\t{first}\n")),
        "{status}"
    );
    looping.kill();
}

/// A run of `geobench` that has reached an algorithm with an endless loop.
struct Looping(Child);

impl Looping {
    fn start(sandbox: &Sandbox, arguments: &str) -> Self {
        let child = std::process::Command::new(assert_cmd::cargo::cargo_bin!("geobench"))
            .args(arguments.split_whitespace())
            .current_dir(sandbox.path(""))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        Self(child)
    }

    /// Children of the process, oldest first.
    fn cells(&self) -> Vec<u32> {
        let id = self.0.id();
        let list = std::fs::read_to_string(format!("/proc/{id}/task/{id}/children"));
        let list = list.unwrap_or_default();
        list.split_whitespace()
            .map(|n| n.parse().unwrap())
            .collect()
    }

    /// Waits for the child process that loops, and returns it.
    fn cell(&self) -> u32 {
        let mut found = None;
        wait_until("a cell is at an endless loop", || {
            found = self.cells().into_iter().find(|cell| loops(*cell));
            found.is_some()
        });
        found.unwrap()
    }

    fn signal(&self, signal: Signal) {
        kill_process(Pid::from_child(&self.0), signal).unwrap();
    }

    /// Waits for the end of the run, and returns its exit status, standard output and standard
    /// error.
    fn end(mut self) -> (Option<i32>, String, String) {
        let (mut printed, mut complaints) = (String::new(), String::new());
        let stdout = self.0.stdout.as_mut().unwrap();
        stdout.read_to_string(&mut printed).unwrap();
        let stderr = self.0.stderr.as_mut().unwrap();
        stderr.read_to_string(&mut complaints).unwrap();
        (self.0.wait().unwrap().code(), printed, complaints)
    }

    fn kill(&mut self) {
        self.0.kill().unwrap();
        self.0.wait().unwrap();
    }
}

/// Whether a process exists and is not a zombie.
fn lives(process: u32) -> bool {
    std::fs::read_to_string(format!("/proc/{process}/stat"))
        .is_ok_and(|stat| !stat.rsplit_once(") ").unwrap().1.starts_with('Z'))
}

/// Whether a process has reached its endless loop.
fn loops(process: u32) -> bool {
    std::fs::read_to_string(format!("/proc/{process}/comm")).is_ok_and(|name| name == "test-loop\n")
}

/// Waits for a condition for at most ten minutes, on a machine however busy.
fn wait_until(what: &str, mut condition: impl FnMut() -> bool) {
    for _ in 0..60_000 {
        if condition() {
            return;
        }
        thread::sleep(Duration::from_millis(10));
    }
    panic!("it never comes about that {what}");
}

#[cfg(target_os = "linux")]
#[test]
fn no_cell_outlives_the_run() {
    let sandbox = Sandbox::with_square();
    let mut looping = Looping::start(&sandbox, "run square.off --algo mmp,vtp,test-loop");
    looping.cell();
    let cells = looping.cells();
    assert_eq!(cells.len(), 3, "one process for each algorithm");
    looping.kill();
    for cell in cells {
        wait_until("the cell ends with the run", || !lives(cell));
    }
    assert_eq!(looping.end().1, "");
}

/// Outputs are written at growing intervals. What a killed run had done since the last write is in
/// its store.
#[cfg(target_os = "linux")]
#[test]
fn a_killed_run_loses_no_model_that_has_ended() {
    let sandbox = Sandbox::new();
    let models: Vec<String> = (1..=12).map(|n| format!("\"gen:cube,n={n}\"")).collect();
    sandbox.write(
        "suite.toml",
        &format!(
            "repeat = 1\nwarmup = 0\n\
             [[group]]\nname = \"first\"\nalgorithms = [\"mmp\"]\nmodels = [{}]\n\
             [[group]]\nname = \"last\"\nalgorithms = [\"test-loop\"]\nmodels = [\"gen:cube\"]\n",
            models.join(", ")
        ),
    );
    let mut looping = Looping::start(&sandbox, "run --config suite.toml -o r.json");
    looping.cell();
    looping.kill();
    let cells = |file: &str| sandbox.json(file)["cells"].as_array().unwrap().len();
    assert!(cells("r.json") >= 9, "{}", cells("r.json"));
    sandbox.succeed("merge r.json -o all.json");
    assert_eq!(cells("all.json"), 12);
    sandbox.succeed("merge r.json.unfinished -o all.json");
    assert_eq!(cells("all.json"), 12);
    // A run that ends leaves none.
    sandbox.succeed("run gen:cube --algo mmp --repeat 1 -o r.json");
    assert_eq!(cells("r.json"), 1);
    assert!(!sandbox.path("r.json.unfinished").exists());
}

/// A run that adds to a file has a store, too, which the next one empties.
#[cfg(target_os = "linux")]
#[test]
fn a_killed_run_that_adds_loses_no_model_that_has_ended() {
    let sandbox = Sandbox::new();
    sandbox.succeed("run gen:tetrahedron,subdiv=1 --algo mmp --repeat 1 -o r.json");
    let models: Vec<String> = (1..=11).map(|n| format!("\"gen:cube,n={n}\"")).collect();
    sandbox.write(
        "suite.toml",
        &format!(
            "repeat = 1\nwarmup = 0\n\
             [[group]]\nname = \"first\"\nalgorithms = [\"mmp\"]\nmodels = [{}]\n\
             [[group]]\nname = \"last\"\nalgorithms = [\"test-loop\"]\nmodels = [\"gen:cube\"]\n",
            models.join(", ")
        ),
    );
    let mut looping = Looping::start(&sandbox, "run --config suite.toml --add-to r.json");
    looping.cell();
    let cells = |file: &str| sandbox.json(file)["cells"].as_array().unwrap().len();
    // While the run goes on, others add to the file and leave its store alone.
    sandbox.succeed("run gen:tetrahedron,subdiv=1 --algo vtp --repeat 1 --add-to r.json");
    assert!(sandbox.path("r.json.unfinished").exists());
    looping.kill();
    sandbox.succeed("merge r.json -o all.json");
    assert_eq!(cells("all.json"), 1 + 11 + 1);
    sandbox.succeed("run gen:tetrahedron,subdiv=1 --algo ich --repeat 1 --add-to r.json");
    assert_eq!(cells("r.json"), 1 + 11 + 2);
    assert!(!sandbox.path("r.json.unfinished").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn a_log_has_begin_and_end_of_models_and_signals() {
    let sandbox = Sandbox::with_square();
    let run = "run square.off --algo mmp --repeat 1 --warmup 0";
    let log = sandbox.call(run).stderr;
    assert!(log.contains("note: square: begins\n"), "{log}");
    assert!(log.contains(" s: 1 cell\n"), "{log}");
    let quiet = sandbox.call(&format!("{run} --no-progress")).stderr;
    assert!(!quiet.contains("begins"), "{quiet}");
    let looping = Looping::start(&sandbox, "run square.off --algo test-loop");
    looping.cell();
    looping.signal(Signal::INT);
    let (_, _, log) = looping.end();
    assert!(
        log.contains("stopping this run; again to stop at once"),
        "{log}"
    );
}

#[test]
fn a_cell_without_counts_has_timed_runs_only() {
    let sandbox = Sandbox::with_square();
    let run = "run square.off --algo mmp --repeat 2 --warmup 0 --check none --no-counts";
    sandbox.succeed(&format!("{run} -o r.json --resume j.jsonl"));
    let cell = &sandbox.json("r.json")["cells"][0];
    assert_eq!(cell["time"]["samples"].as_array().unwrap().len(), 2);
    assert!(cell["counters"]["propagated"].is_null());
    let journal = sandbox.read("j.jsonl");
    assert_eq!(journal.matches("\"purpose\"").count(), 2, "{journal}");
}

#[cfg(target_os = "linux")]
#[test]
fn an_interrupted_run_writes_the_complete_cells() {
    for signal in [Signal::INT, Signal::TERM] {
        let sandbox = Sandbox::with_square();
        sandbox.write(
            "suite.toml",
            "models = [\"square.off\"]\nrepeat = 2\ncheck = \"mmp\"\n\
             [[group]]\nname = \"first\"\nalgorithms = [\"mmp\", \"vtp\"]\n\
             [[group]]\nname = \"second\"\nalgorithms = [\"mmp\", \"test-exit\", \"test-loop\"]\n\
             [[group]]\nname = \"third\"\nalgorithms = [\"ich\"]\n",
        );
        let looping = Looping::start(&sandbox, "run --config suite.toml -o r.json");
        let cell = looping.cell();
        looping.signal(signal);
        let (code, printed, complaints) = looping.end();
        assert_eq!(code, Some(130), "{complaints}");
        assert!(!lives(cell));
        assert!(
            complaints.ends_with("geobench: error: interrupted: 3 of 6 cells are done\n"),
            "{complaints}"
        );
        assert!(
            printed.contains("vtp") && printed.contains("crashed"),
            "{printed}"
        );
        assert!(
            !printed.contains("test-loop") && !printed.contains("third"),
            "{printed}"
        );
        let result = sandbox.json("r.json");
        let cells = result["cells"].as_array().unwrap().iter();
        let cells: Vec<Value> = cells
            .map(|c| json!([c["group"], c["algorithm"], c["status"]]))
            .collect();
        assert_eq!(
            Value::Array(cells),
            json!([
                ["first", "mmp", "ok"],
                ["first", "vtp", "ok"],
                ["second", "test-exit", "crashed"]
            ])
        );
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_interrupted_at_its_first_cell_writes_empty_files() {
    let sandbox = Sandbox::with_square();
    let looping = Looping::start(
        &sandbox,
        "run square.off --algo test-loop -o r.json -o r.csv",
    );
    looping.cell();
    looping.signal(Signal::INT);
    let (code, _, complaints) = looping.end();
    assert_eq!(code, Some(130), "{complaints}");
    assert_eq!(sandbox.json("r.json")["cells"], json!([]));
    assert_eq!(sandbox.read("r.csv").lines().count(), 1);
}

#[cfg(target_os = "linux")]
#[test]
fn a_second_interrupt_ends_the_run_at_once() {
    let sandbox = Sandbox::with_square();
    // Without isolation, nothing can stop the loop, so the first interrupt has no effect.
    let looping = Looping::start(
        &sandbox,
        "run square.off --algo mmp,test-loop --isolate none --no-progress",
    );
    let id = looping.0.id();
    wait_until("the loop begins", || loops(id));
    looping.signal(Signal::INT);
    wait_until("the signal is taken in", || {
        let status = std::fs::read_to_string(format!("/proc/{id}/status")).unwrap();
        let pending = status.lines().find(|line| line.starts_with("ShdPnd:"));
        pending.unwrap().ends_with(&"0".repeat(16))
    });
    thread::sleep(Duration::from_millis(100));
    assert!(lives(id));
    looping.signal(Signal::INT);
    let (code, printed, _) = looping.end();
    assert_eq!((code, printed.as_str()), (Some(130), ""));
}

#[cfg(target_os = "linux")]
#[test]
fn verify_can_be_interrupted() {
    let sandbox = Sandbox::with_square();
    let looping = Looping::start(&sandbox, "verify square.off --algo vtp,test-loop,ich");
    looping.cell();
    looping.signal(Signal::INT);
    let (code, printed, complaints) = looping.end();
    assert_eq!(code, Some(130), "{complaints}");
    assert!(
        printed.contains("vtp: ok") && !printed.contains("test-loop"),
        "{printed}"
    );
    assert_eq!(
        complaints,
        "geobench: note: stopping this run; again to stop at once\ngeobench: error: interrupted\n"
    );
}
