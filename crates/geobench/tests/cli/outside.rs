//! External programs (`ext:NAME`), simulated by shell scripts: requests, checks of answers, and the
//! handling of programs that report false times, crash or print other output.

use serde_json::{Value, json};

use crate::support::Sandbox;

/// A script that loads the model and answers each request with the correct distances of the square
/// from vertex 0.
const HONEST: &str = r#"
echo "$0 loads $1" >> log
grep -c '^v ' "$1" >> log
echo '{"ready": true}'
while read -r request; do
    echo "$request from $2" >> log
    printf 'vertex,distance\n0,0\n1,1\n2,1.4142135623730951\n3,1\n' > "$3"
    echo '{"seconds": 0.25, "counters": {"propagated": 7}, "rss_peak_bytes": 4096}'
done
"#;

/// Scripts that misbehave, with what they do on a request.
const SCRIPTS: [(&str, &str); 7] = [
    (
        "lies",
        r#"printf '0,0\n1,1\n2,1.5\n3,1\n' > "$3"; echo '{"seconds": 0.001}'"#,
    ),
    (
        "half",
        r#"printf '0,0\n1,1\n' > "$3"; echo '{"seconds": 0.001}'"#,
    ),
    ("silent", r#"echo '{"seconds": 0.001}'"#),
    ("talks", "echo 'half way there'"),
    ("dies", "echo 'no such luck' >&2; exit 3"),
    ("sleeps", "exec sleep 60"),
    ("refuses", r#"echo '{"refused": "too few faces"}'"#),
];

/// A sandbox with `square.off`, the scripts and a file `peers.toml` that describes them.
fn sandbox() -> Sandbox {
    let sandbox = Sandbox::with_square();
    let mut peers = String::new();
    let mut describe = |name: &str, more: &str| {
        let table = format!(
            "[ext.{name}]\ncommand = ['sh', '{name}.sh', '{{model}}', '{{source}}', '{{output}}']\n{more}\n"
        );
        peers.push_str(&table);
    };
    sandbox.write("honest.sh", HONEST);
    describe("honest", "");
    for (name, does) in SCRIPTS {
        let script =
            format!("echo '{{\"ready\": true}}'\nwhile read -r request; do\n{does}\ndone\n");
        sandbox.write(&format!("{name}.sh"), &script);
        describe(name, "");
    }
    let once = r#"printf '0,0\n1,1\n2,1.4142135623730951\n3,1\n' > "$3"; echo run >> log
        echo '{"seconds": 0.5}'"#;
    sandbox.write("once.sh", once);
    describe("once", "protocol = 'once'");
    sandbox.write(
        "roughly.sh",
        &format!(
            "echo '{{\"ready\": true}}'\nwhile read -r _; do {}\ndone\n",
            SCRIPTS[0].1
        ),
    );
    describe("roughly", "approximate = true");
    sandbox.write("peers.toml", &peers);
    sandbox
}

/// Runs `algorithms` on the square, checks the exit status `code`, and returns the cells.
fn run(sandbox: &Sandbox, algorithms: &str, code: i32) -> Vec<Value> {
    let call = sandbox.call(&format!(
        "run square.off --ext peers.toml --algo {algorithms} --repeat 3 --warmup 1 --timeout 2s -o r.json"
    ));
    assert_eq!(call.code, code, "{}", call.stderr);
    sandbox.json("r.json")["cells"].as_array().unwrap().clone()
}

#[test]
fn an_outside_program_is_one_process_that_is_asked_and_checked_like_any_algorithm() {
    let sandbox = sandbox();
    let cells = run(&sandbox, "vtp,ext:Honest", 0);
    let cell = &cells[1];
    assert_eq!(cell["algorithm"], "ext:honest");
    assert_eq!(cell["status"], "ok");
    // It claims more time than it took, so the time measured from outside is used.
    let time = &cell["time"];
    assert_eq!(time["claimed"], json!([0.25, 0.25, 0.25]));
    assert_eq!(time["doubted"], true);
    assert_eq!(time["samples"], time["outside"]);
    assert_eq!(time["samples"].as_array().unwrap().len(), 3);
    assert_eq!(cell["counters"]["propagated"], 7);
    assert_eq!(cell["counters"]["kept"], Value::Null);
    // The memory is measured, not claimed: a shell uses more than a page.
    assert!(cell["memory"]["rss_peak_bytes"].as_u64().unwrap() > 100_000);
    assert_eq!(cell["memory"]["heap_peak_bytes"], Value::Null);
    assert_eq!(cell["phases"]["propagation"], Value::Null);
    assert_eq!(cell["check"]["reference"], "vtp");
    assert!(cell["check"]["max_rel"].as_f64().unwrap() < 1e-12);
    // One process read the four vertices of an OBJ file and received four requests.
    let log = sandbox.read("log");
    let lines: Vec<&str> = log.lines().collect();
    assert!(
        lines[0].starts_with("honest.sh loads ") && lines[0].ends_with("model.obj"),
        "{log}"
    );
    assert_eq!(
        lines[1..],
        [
            "4",
            "solve from 0",
            "solve from 0",
            "solve from 0",
            "solve from 0"
        ]
    );
}

#[test]
fn a_program_that_is_called_once_for_each_run_needs_no_asking() {
    let sandbox = sandbox();
    let cells = run(&sandbox, "vtp,ext:once", 0);
    assert_eq!(cells[1]["time"]["claimed"], json!([0.5, 0.5, 0.5]));
    assert_eq!(sandbox.read("log"), "run\n".repeat(4));
}

#[test]
fn whatever_an_outside_program_does_costs_its_own_row() {
    let sandbox = sandbox();
    let all: Vec<String> = SCRIPTS
        .iter()
        .map(|(name, _)| format!("ext:{name}"))
        .collect();
    let cells = run(&sandbox, &format!("vtp,{},mmp", all.join(",")), 1);
    for cell in [&cells[0], &cells[8]] {
        assert_eq!(cell["status"], "ok");
        assert_eq!(cell["time"]["samples"].as_array().unwrap().len(), 3);
    }
    let rows: Vec<String> = cells[1..8]
        .iter()
        .map(|cell| {
            assert_eq!(cell["time"]["samples"], json!([]));
            format!(
                "{}: {}: {}",
                cell["algorithm"].as_str().unwrap(),
                cell["status"].as_str().unwrap(),
                cell["message"].as_str().unwrap()
            )
        })
        .collect();
    // The directory of the exchanged files has a different name each time.
    let rows = rows.join("\n");
    let rows: Vec<&str> = rows
        .split(' ')
        .map(|word| match word.split_once("geobench-") {
            Some(_) if word.ends_with(".csv:") => "FOLDER/silent.csv:",
            _ => word,
        })
        .collect();
    insta::assert_snapshot!(rows.join(" "));
}

/// A program that copies our answer and claims a time of 0 was once listed as the best.
#[test]
fn a_claim_that_cannot_be_is_shown_beside_the_time_from_outside() {
    let sandbox = sandbox();
    let fast = r#"printf '0,0\n1,1\n2,1.4142135623730951\n3,1\n' > "$3"
        sleep 0.05; echo '{"seconds": 1e-9}'"#;
    sandbox.write("fast.sh", fast);
    let modest = r#"sleep 0.02; printf '0,0\n1,1\n2,1.4142135623730951\n3,1\n' > "$3"
        echo '{"seconds": 0.02}'"#;
    sandbox.write("modest.sh", modest);
    let table = |name: &str| {
        format!(
            "[ext.{name}]\nprotocol = 'once'\n\
             command = ['sh', '{name}.sh', '{{model}}', '{{source}}', '{{output}}']\n"
        )
    };
    sandbox.write("two.toml", &(table("fast") + &table("modest")));
    let call = sandbox.call(
        "run square.off --ext two.toml --algo mmp,ext:fast,ext:modest --repeat 3 --timeout 20s -o r.json",
    );
    assert_eq!(call.code, 0, "{}", call.stderr);
    let file = sandbox.json("r.json");
    let fast = &file["cells"][1]["time"];
    assert_eq!(fast["doubted"], true);
    assert!(fast["median"].as_f64().unwrap() >= 0.05, "{fast}");
    let shown = &call.stdout;
    assert!(shown.contains("Time from outside (s)"), "{shown}");
    assert!(shown.contains("Time it claims (s)"), "{shown}");
    assert!(
        shown.contains(
            "! ext:fast: the time that it claims is more than that from outside, or less"
        ),
        "{shown}"
    );
    // On a slow machine, a shell may not start within a fraction of 0.2 s.
    let modest = &file["cells"][2]["time"];
    let outside = modest["outside"][0].as_f64().unwrap();
    assert!(outside >= 0.02, "{modest}");
    if outside < 0.19 {
        assert_eq!(
            (&modest["doubted"], &modest["samples"][0]),
            (&json!(false), &json!(0.02))
        );
    }
}

#[test]
fn a_command_is_timed_from_start_to_end_with_its_parameters() {
    let sandbox = Sandbox::with_square();
    let script = r#"[ "$(cat ready)" = yes ] || exit 1
        echo 'chatter that is no answer'
        sleep "$4"
        printf '0,0\n1,1\n2,1.4142135623730951\n3,1\n' > "$3""#;
    sandbox.write("plain.sh", script);
    sandbox.write(
        "plain.toml",
        "[ext.plain]\nprotocol = 'none'\nparameters = { time = [0.05, 0.01] }\n\
         command = ['sh', 'plain.sh', '{model}', '{source}', '{output}', '{time}']\n\
         prepare = ['sh', '-c', 'echo prepared {time} >> log; echo yes > ready']\n\
         cleanup = ['sh', '-c', 'echo cleaned >> log; rm ready']\n",
    );
    let run = "run square.off --ext plain.toml --repeat 2 --timeout 20s -o r.json --quiet --algo";
    sandbox.succeed(&format!("{run} mmp,ext:plain"));
    let file = sandbox.json("r.json");
    let cells = file["cells"].as_array().unwrap();
    let names: Vec<&str> = cells
        .iter()
        .map(|c| c["algorithm"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        ["mmp", "ext:plain{time=0.05}", "ext:plain{time=0.01}"]
    );
    for (cell, least) in cells[1..].iter().zip([0.05, 0.01]) {
        assert_eq!(cell["status"], "ok", "{cell}");
        let time = &cell["time"];
        assert!(time["median"].as_f64().unwrap() >= least, "{time}");
        assert_eq!(time["samples"], time["outside"]);
        assert_eq!(
            (&time["claimed"], &time["doubted"]),
            (&json!([]), &json!(false))
        );
    }
    // A warm-up and two runs for each combination, every one between `prepare` and `cleanup`.
    let log = sandbox.read("log");
    let lines: Vec<&str> = log.lines().collect();
    assert_eq!(lines.len(), 2 * 3 * 2);
    for pair in lines.chunks(2) {
        assert!(
            pair[0].starts_with("prepared 0.0") && pair[1] == "cleaned",
            "{log}"
        );
    }
    // A single combination.
    sandbox.succeed(&format!("{run} ext:plain{{time=0.01}} --check none"));
    assert_eq!(sandbox.json("r.json")["cells"].as_array().unwrap().len(), 1);

    let failing = sandbox
        .read("plain.toml")
        .replace("echo yes > ready", "exit 3");
    sandbox.write("plain.toml", &failing);
    let call = sandbox.call(&format!("{run} mmp,ext:plain{{time=0.01}}"));
    assert_eq!(call.code, 1, "{}", call.stderr);
    let message = &sandbox.json("r.json")["cells"][1]["message"];
    assert_eq!(
        message,
        "ended with exit status 3 without an answer (preparing)"
    );
}

#[test]
fn approximate_distances_are_compared_and_not_held_to_the_tolerance() {
    let sandbox = sandbox();
    let cells = run(&sandbox, "vtp,ext:roughly", 0);
    let cell = &cells[1];
    assert_eq!(cell["status"], "ok");
    assert_eq!(
        cell["message"],
        "approximate: compared, but not held to the tolerance"
    );
    let max_rel = cell["check"]["max_rel"].as_f64().unwrap();
    assert!((0.05..0.06).contains(&max_rel), "{max_rel}");
}

#[test]
fn a_remark_on_a_cell_that_went_well_is_a_warning_and_no_error() {
    let sandbox = sandbox();
    let run = "run square.off --ext peers.toml --algo vtp,ext:roughly --repeat 1 --warmup 0";
    let remarks = |more: &str| {
        let call = sandbox.call(&format!("{run} {more}"));
        assert_eq!(call.code, 0, "{}", call.stderr);
        let lines = call.stderr.lines().map(str::to_owned);
        // Remarks on the quality of the times depend on the machine. Progress is a note.
        let others = |line: &String| {
            let is_remark = line.contains("release build") || line.contains("times may");
            !is_remark && !line.contains("geobench: note: ")
        };
        lines.filter(others).collect::<Vec<_>>()
    };
    let remark = "geobench: warning: square: ext:roughly, source 0: approximate: compared, but not held to the tolerance";
    assert_eq!(remarks("--format csv"), [remark]);
    assert_eq!(remarks("--format csv --quiet"), [""; 0]);
    // The table has its own note, so there is no remark.
    assert_eq!(remarks("--format table"), [""; 0]);
}

#[test]
fn a_suite_describes_its_own_programs() {
    let sandbox = sandbox();
    let suite = format!(
        "{}\n[[group]]\nname = 'g'\nmodels = ['square.off']\nalgorithms = ['vtp', 'ext:honest']\n",
        sandbox.read("peers.toml")
    );
    sandbox.write("suite.toml", &suite);
    let call = sandbox.call("run --config suite.toml --repeat 1 --warmup 0 -o r.json");
    assert_eq!(call.code, 0, "{}", call.stderr);
    let cell = &sandbox.json("r.json")["cells"][1];
    assert_eq!(cell["time"]["claimed"], json!([0.25]));
    // A suite is also accepted as a file of programs.
    let call = sandbox.call("verify square.off --algo ext:honest --ext suite.toml");
    assert_eq!(call.code, 0, "{}", call.stderr);
}

#[test]
fn what_nobody_has_described_is_refused_before_anything_runs() {
    let sandbox = sandbox();
    for (arguments, complaint) in [
        (
            "run square.off --algo ext:honets --ext peers.toml",
            "there is no outside program `honets`, did you mean `ext:honest`?",
        ),
        (
            "run square.off --algo ext:honest",
            "describe it in a table [ext.honest] of the suite file, or of a file given with --ext\n",
        ),
        (
            "run square.off --algo ext:honest{k=1} --ext peers.toml",
            "there is no outside program `honest{k=1}`",
        ),
        (
            "run square.off --algo ext:",
            "an algorithm name is missing in `ext:`",
        ),
        (
            "distance square.off --source 0 --algo ext:honest -o d.csv",
            "ext:honest is an outside program: those take part in `run` and `verify`",
        ),
    ] {
        let call = sandbox.call(arguments);
        assert_eq!(call.code, 2, "{arguments}");
        assert!(call.stderr.contains(complaint), "{}", call.stderr);
    }
}
