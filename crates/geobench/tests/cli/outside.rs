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
const SCRIPTS: [(&str, &str); 6] = [
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
    let sleeps = "echo '{\"ready\": true}'\nread -r _; exec sleep 600\n";
    sandbox.write("sleeps.sh", sleeps);
    describe("sleeps", "");
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
        "run square.off --ext peers.toml --algo {algorithms} --repeat 3 --warmup 1 --timeout 60s -o r.json"
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
    // Under protocol 1 a claim cannot be checked.
    let time = &cell["time"];
    assert_eq!(time["claimed"], json!([0.25, 0.25, 0.25]));
    assert_eq!(time["samples"], time["claimed"]);
    assert_eq!(
        (&time["doubted"], &time["unconfirmed"]),
        (&json!(false), &json!(true))
    );
    assert_eq!(time["outside"].as_array().unwrap().len(), 3);
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
fn a_broken_outside_program_costs_its_own_row() {
    let sandbox = sandbox();
    let all: Vec<String> = SCRIPTS
        .iter()
        .map(|(name, _)| format!("ext:{name}"))
        .collect();
    let cells = run(&sandbox, &format!("vtp,{},mmp", all.join(",")), 1);
    for cell in [&cells[0], &cells[7]] {
        assert_eq!(cell["status"], "ok");
        assert_eq!(cell["time"]["samples"].as_array().unwrap().len(), 3);
    }
    let rows: Vec<String> = cells[1..7]
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

/// The limit is of a group of its own: no other program has to keep it.
#[test]
fn an_outside_program_that_does_not_answer_costs_its_own_row() {
    let sandbox = sandbox();
    let group = |name: &str, algorithm: &str| {
        format!("[[group]]\nname = '{name}'\nalgorithms = ['{algorithm}']\n")
    };
    let suite = format!(
        "models = ['square.off']\ncheck = 'none'\n{}{}timeout = '2s'\n{}",
        group("before", "vtp"),
        group("sleeps", "ext:sleeps"),
        group("after", "ext:honest")
    );
    sandbox.write("suite.toml", &suite);
    let run = "run --config suite.toml --ext peers.toml --repeat 3 --quiet -o r.json";
    let call = sandbox.call(run);
    assert_eq!(call.code, 1, "{}", call.stderr);
    let file = sandbox.json("r.json");
    let cells = file["cells"].as_array().unwrap();
    let statuses: Vec<&Value> = cells.iter().map(|cell| &cell["status"]).collect();
    assert_eq!(statuses, ["ok", "timeout", "ok"]);
    assert_eq!(cells[1]["time"]["samples"], json!([]));
    let message = cells[1]["message"].as_str().unwrap();
    assert!(
        message.starts_with("took longer than the 2s allowed ("),
        "{message}"
    );
}

#[test]
fn a_program_that_spoils_the_model_costs_its_own_row() {
    let sandbox = sandbox();
    let mut peers = sandbox.read("peers.toml");
    for (name, does) in [
        ("alters", "echo 'v 9 9 9' >> \"$1\""),
        ("removes", "rm -r \"$(dirname \"$1\")\""),
    ] {
        sandbox.write(&format!("{name}.sh"), &format!("{does}; exit 3"));
        let given = "'{model}', '{source}', '{output}'";
        let command = format!("command = ['sh', '{name}.sh', {given}]");
        let table = format!("[ext.{name}]\nprotocol = 'once'\n{command}\n");
        peers.push_str(&table);
    }
    sandbox.write("peers.toml", &peers);
    let call = sandbox.call(
        "run square.off --ext peers.toml --algo vtp,ext:alters,ext:removes,ext:honest --repeat 2 \
         --timeout 60s --quiet -o r.json",
    );
    assert_eq!(call.code, 1, "{}", call.stderr);
    let file = sandbox.json("r.json");
    let cells = file["cells"].as_array().unwrap();
    let status: Vec<&Value> = cells.iter().map(|cell| &cell["status"]).collect();
    assert_eq!(status, ["ok", "crashed", "crashed", "ok"]);
    // The number of vertices that the last program read.
    assert_eq!(sandbox.read("log").lines().nth(1), Some("4"));
}

/// A solver under protocol 2 in Python. Its options say how long it works and what it claims.
const VERSION_2: &str = r#"
import json, sys, time

def option(name, value):
    for word in sys.argv[1:]:
        if word.startswith(name + "="):
            return float(word.partition("=")[2])
    return value

work, late, share = option("work", 0.0), option("late", 0.0), option("share", 1.0)
kept = None
for line in sys.stdin:
    request, _, rest = line.rstrip("\n").partition(" ")
    answer = {}
    if request == "load":
        if option("early", 0.0):
            time.sleep(work)
            kept = True
    elif request == "solve":
        source = int(rest)
        start = time.perf_counter()
        if not kept:
            time.sleep(work) if work else None
        distances = [[0, 1, 2**0.5, 1], [1, 0, 1, 2**0.5], [2**0.5, 1, 0, 1], [1, 2**0.5, 1, 0]][source]
        seconds = time.perf_counter() - start
        answer["seconds"] = share * (work if kept else seconds)
        time.sleep(late) if late else None
        answer["counters"] = {"propagated": 7}
    elif request == "write":
        with open(rest, "w") as file:
            file.writelines(f"{v},{d!r}\n" for v, d in enumerate(distances))
    print(json.dumps(answer), flush=True)
"#;

/// Runs the programs of [`VERSION_2`] with these options on the square, twice; returns the cells
/// and what was shown.
fn run_version_2(options: &[(&str, &[&str])], code: i32, more: &str) -> (Vec<Value>, String) {
    let sandbox = Sandbox::with_square();
    sandbox.write("solver.py", VERSION_2);
    let mut tables = String::new();
    for (name, options) in options {
        let words: Vec<String> = options.iter().map(|word| format!(", '{word}'")).collect();
        let words = words.concat();
        let command = format!("command = ['python3', 'solver.py'{words}]");
        let table = format!("[ext.{name}]\nprotocol = 2\n{command}\n");
        tables.push_str(&table);
    }
    sandbox.write("peers.toml", &tables);
    let names: Vec<String> = options
        .iter()
        .map(|(name, _)| format!("ext:{name}"))
        .collect();
    let call = sandbox.call(&format!(
        "run square.off --ext peers.toml --algo mmp,{} --repeat 2 --timeout 5m -o r.json {more}",
        names.join(",")
    ));
    assert_eq!(call.code, code, "{}", call.stderr);
    let cells = sandbox.json("r.json")["cells"].as_array().unwrap().clone();
    (cells[1..].to_vec(), call.stdout)
}

/// For each run, the longer of the time that the program claims and that from outside.
fn slower_of_each_run(time: &Value) -> Value {
    let claimed = time["claimed"].as_array().unwrap();
    let outside = time["outside"].as_array().unwrap();
    let runs = claimed.iter().zip(outside);
    let seconds = runs.map(|(claimed, outside)| {
        let slower = claimed.as_f64() > outside.as_f64();
        if slower { claimed } else { outside }.clone()
    });
    seconds.collect()
}

/// The clock is fair to honest programs, also of microseconds, and finds the others. A machine on
/// which a ping takes a third of a second would hide these from it.
#[test]
fn a_claim_is_checked_under_protocol_2() {
    let (cells, shown) = run_version_2(
        &[
            ("fast", &[]),
            ("slow", &["work=0.03"]),
            ("liar", &["work=0.8", "share=0.1"]),
            ("late", &["late=0.8"]),
        ],
        0,
        "--source 1",
    );
    let [fast, slow, liar, late] = &cells[..] else {
        panic!("{cells:?}");
    };
    for cell in &cells {
        assert_eq!(cell["status"], "ok", "{cell}");
        assert_eq!(cell["counters"]["propagated"], 7);
        assert_eq!(cell["time"]["ping"].as_array().unwrap().len(), 2);
    }
    // How far pings and answers vary depends on what else the machine does, so that an honest claim
    // may be doubted here. Tests of the statistics have the rule.
    for honest in [fast, slow] {
        let time = &honest["time"];
        let used = if time["doubted"] == true {
            slower_of_each_run(time)
        } else {
            time["claimed"].clone()
        };
        assert_eq!(time["samples"], used, "{time}");
    }
    for other in [liar, late] {
        let time = &other["time"];
        assert_eq!(time["doubted"], true, "{time}");
        assert_eq!(time["samples"], slower_of_each_run(time));
        // The claims are far less. Slow pings take something from the time.
        assert!(time["median"].as_f64().unwrap() >= 0.4, "{time}");
    }
    for text in ["Time from outside (s)", "Time it claims (s)"] {
        assert!(shown.contains(text), "{shown}");
    }
    for name in ["liar", "late"] {
        let note = format!("! ext:{name}: the time that it claims is less than that from outside");
        assert!(shown.contains(&note), "{shown}");
    }
}

#[test]
fn a_claim_above_the_time_from_outside_is_an_error_of_the_program() {
    // It solves while it loads, and claims the time of that solve.
    let (cells, _) = run_version_2(
        &[
            ("early", &["early=1", "work=2"]),
            ("boast", &["work=0.5", "share=3"]),
        ],
        1,
        "",
    );
    for cell in cells {
        assert_eq!(cell["status"], "crashed");
        let message = cell["message"].as_str().unwrap();
        assert!(
            message.starts_with("broke the protocol: `seconds` is ")
                && message.contains(" s after the request"),
            "{message}"
        );
    }
}

#[test]
fn a_set_up_is_no_longer_than_the_time_there_was_for_it() {
    let sandbox = Sandbox::with_square();
    let distances = r"printf '0,0\n1,1\n2,1.4142135623730951\n3,1\n'";
    for (name, seconds, code) in [("boast", "1e6", 1), ("none", "0", 0)] {
        // Protocol 2 claims the set-up while it loads, protocol 1 with the solve.
        let two = format!(
            "while read -r request file; do\ncase $request in\n\
             load) echo '{{\"setup_seconds\": {seconds}}}' ;;\n\
             solve) echo '{{\"seconds\": 0}}' ;;\n\
             write) {distances} > \"$file\"; echo '{{}}' ;;\n\
             *) echo '{{}}' ;;\nesac\ndone\n"
        );
        let once = format!(
            "{distances} > \"$1\"; echo '{{\"seconds\": 0, \"setup_seconds\": {seconds}}}'\n"
        );
        sandbox.write("two.sh", &two);
        sandbox.write("once.sh", &once);
        sandbox.write(
            "peers.toml",
            "[ext.two]\nprotocol = 2\ncommand = ['sh', 'two.sh']\n\
             [ext.once]\nprotocol = 'once'\n\
             command = ['sh', 'once.sh', '{output}', '{model}', '{source}']\n",
        );
        let call = sandbox.call(
            "run square.off --ext peers.toml --algo mmp,ext:two,ext:once --repeat 1 --warmup 0 \
             --rows time,setup -o r.json",
        );
        assert_eq!(call.code, code, "{name}: {}", call.stderr);
        for cell in &sandbox.json("r.json")["cells"].as_array().unwrap()[1..] {
            if code == 0 {
                assert_eq!(cell["time"]["setup"], 0.0, "{cell}");
                let note = "set-up of outside programs: as they claim it";
                assert!(call.stdout.contains(note), "{}", call.stdout);
            } else {
                let message = cell["message"].as_str().unwrap();
                assert!(
                    message.starts_with("broke the protocol: `setup_seconds` is 1e6, but there"),
                    "{message}"
                );
            }
        }
    }
}

#[test]
fn claims_without_a_check_are_marked_in_every_output() {
    let sandbox = sandbox();
    let files = "-o r.json -o r.csv -o r.md -o r.tex -o r.bmf.json -o r.gab.json";
    let run = "run square.off --ext peers.toml --algo vtp,ext:once --repeat 6 --timeout 60s";
    let call = sandbox.call(&format!("{run} {files}"));
    assert_eq!(call.code, 0, "{}", call.stderr);
    sandbox.succeed("report r.json -o r.html");
    let cell = &sandbox.json("r.json")["cells"][1];
    assert_eq!(cell["time"]["unconfirmed"], true);
    for shown in [
        call.stdout.as_str(),
        &sandbox.read("r.md"),
        &sandbox.read("r.tex"),
        &sandbox.read("r.html"),
    ] {
        assert!(shown.contains("ext:once (claimed)"), "{shown}");
    }
    for file in ["r.bmf.json", "r.gab.json"] {
        let text = sandbox.read(file);
        assert!(
            text.contains("square, ext:once (claimed), source 0"),
            "{text}"
        );
    }
    let csv = sandbox.read("r.csv");
    let mut lines = csv.lines();
    let place = lines.next().unwrap().split(',');
    let place = place
        .clone()
        .position(|name| name == "time_unconfirmed")
        .unwrap();
    assert!(
        csv.lines().last().unwrap().split(',').nth(place).unwrap() == "true",
        "{csv}"
    );
    // Comparisons and histories.
    let call =
        sandbox.call("compare r.json r.json --fail-on time=5%,outside_time=5%,claimed_time=5%");
    assert_eq!(call.code, 0, "{}", call.stderr);
    assert!(
        call.stdout.contains("ext:once (claimed)"),
        "{}",
        call.stdout
    );
    let mut slower = sandbox.json("r.json");
    let time = &mut slower["cells"][1]["time"];
    time["claimed"] = json!([2.0, 2.0, 2.0, 2.0, 2.0, 2.0]);
    sandbox.write("slower.json", &slower.to_string());
    let call = sandbox.call("compare r.json slower.json --fail-on claimed_time=5%");
    assert_eq!(call.code, 1, "{}", call.stderr);
    let shown = call.stdout + &call.stderr;
    assert!(shown.contains("claimed_time +300"), "{shown}");
    sandbox.succeed("record r.json --into history --commit 0123456789abcdef --date 2025-01-01");
    let record = std::fs::read_dir(sandbox.path("history")).unwrap();
    let record = record
        .flatten()
        .find(|entry| entry.path().extension().is_some_and(|e| e == "json"));
    let text = std::fs::read_to_string(record.unwrap().path()).unwrap();
    assert!(text.contains("\"claimed\":true"), "{text}");
}

#[test]
fn an_error_in_an_answer_names_the_key() {
    let sandbox = Sandbox::with_square();
    sandbox.write(
        "typo.sh",
        "while read -r request; do echo '{\"sec\": 0.1}'; done",
    );
    sandbox.write(
        "typo.toml",
        "[ext.typo]\nprotocol = 2\ncommand = ['sh', 'typo.sh']\n[ext.unused]\nnonsense = 1\n",
    );
    let call = sandbox.call("run square.off --ext typo.toml --algo mmp,ext:typo --quiet -o r.json");
    assert_eq!(call.code, 1, "{}", call.stderr);
    assert_eq!(
        sandbox.json("r.json")["cells"][1]["message"],
        "broke the protocol: there is no key `sec` (did you mean `seconds`?); known are seconds, \
         setup_seconds, rss_peak_bytes, heap_peak_bytes, counters, refused, ready (starting)"
    );
    let call = sandbox.call("run square.off --ext typo.toml --algo ext:unused");
    assert_eq!(call.code, 2);
    assert!(
        call.stderr.contains("there is no key `nonsense` here"),
        "{}",
        call.stderr
    );
}

/// A line that waits before the request would be an answer in no time. The keys of `geobench`'s own
/// children would be measurements of an outside program.
#[test]
fn lines_without_a_request_and_keys_of_own_children_break_the_protocol() {
    let sandbox = Sandbox::with_square();
    for (name, line, problem) in [
        (
            "twice",
            r"{}\n{}\n",
            "printed without a request: \"{}\"; write one line for each request",
        ),
        (
            "own",
            r#"{"edge_excess": 5}\n"#,
            "broke the protocol: there is no key `edge_excess`",
        ),
    ] {
        let script = format!("while read -r request; do printf '{line}'; done");
        sandbox.write("answers.sh", &script);
        let table = format!("[ext.{name}]\nprotocol = 2\ncommand = ['sh', 'answers.sh']\n");
        sandbox.write("peers.toml", &table);
        let run =
            format!("run square.off --ext peers.toml --algo mmp,ext:{name} --quiet -o r.json");
        let call = sandbox.call(&run);
        assert_eq!(call.code, 1, "{}", call.stderr);
        let cells = &sandbox.json("r.json")["cells"];
        let message = cells[1]["message"].as_str().unwrap();
        assert!(message.starts_with(problem), "{message}");
    }
}

#[test]
fn a_program_that_leaves_a_descendant_behind_has_ended() {
    let sandbox = Sandbox::with_square();
    // The descendant keeps the standard output of the program open.
    let script = "while read -r request; do\ncase $request in\n\
        solve*) sleep 600 & exit 3 ;;\n*) echo '{}' ;;\nesac\ndone\n";
    sandbox.write("leaves.sh", script);
    let table = "[ext.leaves]\nprotocol = 2\ncommand = ['sh', 'leaves.sh']\n";
    sandbox.write("peers.toml", table);
    let run = "run square.off --ext peers.toml --algo mmp,ext:leaves --timeout 60s --quiet";
    let call = sandbox.call(&format!("{run} -o r.json"));
    assert_eq!(call.code, 1, "{}", call.stderr);
    assert_eq!(
        sandbox.json("r.json")["cells"][1]["message"],
        "ended with exit status 3 without an answer (solving)"
    );
}

#[test]
fn a_message_quotes_the_beginning_of_a_long_refusal() {
    let sandbox = Sandbox::with_square();
    let why = "x".repeat(3000);
    let script = format!("while read -r _; do echo '{{\"refused\": \"{why}\"}}'; done");
    sandbox.write("wordy.sh", &script);
    let table = "[ext.wordy]\nprotocol = 2\ncommand = ['sh', 'wordy.sh']\n";
    sandbox.write("peers.toml", table);
    let call =
        sandbox.call("run square.off --ext peers.toml --algo mmp,ext:wordy --quiet -o r.json");
    assert_eq!(call.code, 2, "{}", call.stderr);
    let message = &sandbox.json("r.json")["cells"][1]["message"];
    assert_eq!(
        *message,
        format!("ext:wordy refused: {}...", "x".repeat(400))
    );
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
    let run = "run square.off --ext plain.toml --repeat 2 --timeout 5m -o r.json --quiet --algo";
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
fn an_unknown_program_is_refused_before_the_run() {
    let sandbox = sandbox();
    for (arguments, complaint) in [
        (
            "run square.off --algo ext:honets --ext peers.toml",
            "there is no outside program `honets` (did you mean `ext:honest`?)",
        ),
        (
            "run square.off --algo ext:honest",
            "or of a file given with --ext; `geobench init` writes an example, scripts/peers",
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

/// Records name the version and the hashes of outside programs, and runs of different programs
/// under one name are not mixed.
#[test]
fn the_record_has_the_provenance_of_outside_programs() {
    let sandbox = sandbox();
    let table = "[ext.Honest]\ncommand = ['sh', 'honest.sh', '{model}', '{source}', '{output}']\n\
                 version = '1'\nsource = 'https://example.org at c0ffee'\ncompiler = 'sh'\n\
                 flags = '-e'\nfiles = ['lib.so', 'none.so']\n";
    sandbox.write("own.toml", table);
    sandbox.write("lib.so", "abc");
    let run = |more: &str| {
        sandbox.call(&format!(
            "run square.off --ext own.toml --algo mmp,ext:honest --repeat 1 {more}"
        ))
    };
    let first = run("--resume j.jsonl -o old.json -o old.md");
    assert_eq!(first.code, 0, "{}", first.stderr);
    let record = sandbox.json("old.json");
    let program = &record["sessions"][0]["programs"][0];
    let texts = ["name", "version", "source", "compiler", "flags"].map(|key| &program[key]);
    let source = "https://example.org at c0ffee";
    assert_eq!(texts, ["ext:honest", "1", source, "sh", "-e"]);
    let files = program["files"].as_array().unwrap();
    let paths: Vec<_> = files.iter().map(|file| &file["path"]).collect();
    assert_eq!(paths, ["sh", "honest.sh", "lib.so", "none.so"]);
    let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    assert_eq!(files[2]["sha256"], abc);
    assert!(files[0]["sha256"].is_string() && files[3]["sha256"].is_null());
    let markdown = sandbox.read("old.md");
    assert!(
        markdown.contains("- Program ext:honest: version 1; "),
        "{markdown}"
    );

    sandbox.write("lib.so", "abcd");
    let changed = "the file lib.so of ext:honest has changed";
    for more in ["--resume j.jsonl", "--add-to old.json"] {
        let refused = run(more);
        assert_eq!(refused.code, 2, "{more}");
        assert!(refused.stderr.contains(changed), "{}", refused.stderr);
    }
    assert_eq!(run("-o new.json").code, 0);
    let compared = sandbox.call("compare old.json new.json");
    assert_eq!(compared.code, 0, "{}", compared.stderr);
    let both = compared.stdout + &compared.stderr;
    assert!(both.contains(changed), "{both}");
    let joined = sandbox.call("merge old.json new.json -o joined.json");
    assert_eq!(joined.code, 0, "{}", joined.stderr);
    assert!(joined.stderr.contains(changed), "{}", joined.stderr);
    let sessions = &sandbox.json("joined.json")["sessions"];
    assert_eq!(sessions.as_array().unwrap().len(), 2);
    let square = sandbox.read("square.off");
    sandbox.write("copy.off", &square);
    for (part, lib) in [(1, "abc"), (2, "abcd")] {
        sandbox.write("lib.so", lib);
        let run = run(&format!("copy.off --shard {part}/2 -o part{part}.json"));
        assert_eq!(run.code, 0, "{}", run.stderr);
    }
    let merged = sandbox.call("merge part1.json part2.json -o whole.json");
    assert_eq!(merged.code, 2, "{}", merged.stdout);
    assert!(merged.stderr.contains(changed), "{}", merged.stderr);
}
