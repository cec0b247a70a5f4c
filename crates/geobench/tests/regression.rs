//! Fixed bugs, with tests named after them.

#[path = "cli/support.rs"]
#[allow(dead_code, reason = "the tests of the command line use the rest")]
mod support;

use std::io::Write;
use std::process::Command;

use flate2::Compression;
use flate2::write::GzEncoder;
use support::Sandbox;

/// An OBJ file of spaces in many gzip members, which decompresses to `mebibytes`.
fn bomb(sandbox: &Sandbox, name: &str, mebibytes: usize) {
    let mut member = GzEncoder::new(Vec::new(), Compression::best());
    member.write_all(&vec![b' '; 1 << 20]).unwrap();
    let bytes = member.finish().unwrap().repeat(mebibytes);
    std::fs::write(sandbox.path(name), bytes).unwrap();
}

#[test]
fn a_small_gzip_file_took_gigabytes() {
    let sandbox = Sandbox::new();
    bomb(&sandbox, "bomb.obj.gz", 3000);
    let message = "bomb.obj.gz: 3 MiB decompress to more than 301 MiB; if the file can be trusted, \
                   raise the limit with --max-decompressed SIZE";
    let program = assert_cmd::cargo::cargo_bin("geobench");
    for arguments in [
        "info bomb.obj.gz",
        "distance bomb.obj.gz --source 0 -o d.csv",
        "gen file,path=bomb.obj.gz -o m.obj",
        "run bomb.obj.gz --algo vtp",
        "run bomb.obj.gz --algo vtp --isolate none",
        "verify bomb.obj.gz --algo vtp",
    ] {
        // Without a bound on memory, the limits of the system would end the command and its
        // children.
        let output = Command::new("sh")
            .current_dir(sandbox.path(""))
            .args(["-c", "ulimit -v 1500000; exec \"$@\"", "sh"])
            .arg(&program)
            .args(arguments.split(' '))
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {stderr}");
        assert!(stderr.contains(message), "{arguments}: {stderr}");
    }
}

#[test]
fn a_large_count_in_a_gltf_file_named_no_option() {
    let sandbox = Sandbox::new();
    let accessor = "{\"componentType\":5126,\"count\":4000000000,\"type\":\"VEC3\"}";
    let file = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scenes\":[{{\"nodes\":[0]}}],\
         \"nodes\":[{{\"mesh\":0}}],\"accessors\":[{accessor}],\
         \"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}}}}]}}]}}"
    );
    sandbox.write("large.gltf", &file);
    let error = sandbox.call("info large.gltf").stderr;
    assert!(error.contains("large.gltf: accessor 0: "), "{error}");
    assert!(
        error.contains("raise the limit with --max-decompressed SIZE"),
        "{error}"
    );
}

#[test]
fn a_raised_limit_of_decompression_reaches_child_processes() {
    let sandbox = Sandbox::with_square();
    bomb(&sandbox, "blank.off.gz", 80);
    let mut end = GzEncoder::new(Vec::new(), Compression::best());
    end.write_all(b"\n").unwrap();
    end.write_all(sandbox.read("square.off").as_bytes())
        .unwrap();
    let mut bytes = std::fs::read(sandbox.path("blank.off.gz")).unwrap();
    bytes.extend(end.finish().unwrap());
    std::fs::write(sandbox.path("blank.off.gz"), bytes).unwrap();

    let run = "run blank.off.gz --algo vtp --repeat 1 --warmup 0 --resume j.jsonl -o r.json";
    let refused = sandbox.call(run);
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    std::fs::remove_file(sandbox.path("j.jsonl")).unwrap();
    sandbox.succeed(&format!("{run} --max-decompressed 100MiB"));
    let file = sandbox.json("r.json");
    assert_eq!(file["cells"][0]["status"], "ok");
    assert_eq!(file["plan"]["groups"][0]["max_decompressed"], 100_u64 << 20);
    // The limit is part of the identity of a run: a journal cannot be continued with another limit.
    let other = sandbox.call(&format!("{run} --max-decompressed 200MiB"));
    assert_eq!(other.code, 2, "{}", other.stderr);
    assert!(
        other.stderr.contains("max_decompressed"),
        "{}",
        other.stderr
    );
}

/// Distances of the square from vertex 0, written by a script.
const RIGHT: &str = r#"printf '0,0\n1,1\n2,1.4142135623730951\n3,1\n' > "$3""#;

/// Describes external programs in `peers.toml`, each by name, protocol and script.
fn describe(sandbox: &Sandbox, programs: &[(&str, &str, String)]) {
    let tables = programs.iter().map(|(name, protocol, script)| {
        sandbox.write(&format!("{name}.sh"), script);
        format!(
            "[ext.{name}]\nprotocol = '{protocol}'\n\
             command = ['sh', '{name}.sh', '{{model}}', '{{source}}', '{{output}}']\n"
        )
    });
    sandbox.write("peers.toml", &tables.collect::<String>());
}

#[test]
fn an_answer_that_is_no_file_hung_the_run_or_gave_other_files_away() {
    let sandbox = Sandbox::with_square();
    sandbox.write("secret.txt", "the password\n");
    let places = [
        ("pipe", r#"mkfifo "$3""#),
        ("link", r#"ln -s "$PWD/secret.txt" "$3""#),
        ("endless", r#"ln -s /dev/zero "$3""#),
        ("directory", r#"mkdir "$3""#),
        ("large", r#"head -c 100000 /dev/zero > "$3""#),
    ];
    let script = |does: &&str| format!("{does}\necho '{{\"seconds\": 0.1}}'\n");
    let programs = places.map(|(name, does)| (name, "once", script(&does)));
    describe(&sandbox, &programs);
    let names = places.map(|(name, _)| format!("ext:{name}")).join(",");
    let call = sandbox.call(&format!(
        "run square.off --ext peers.toml --algo vtp,{names} --repeat 1 --timeout 60s -o r.json"
    ));
    assert_eq!(call.code, 1, "{}", call.stderr);
    for cell in &sandbox.json("r.json")["cells"].as_array().unwrap()[1..] {
        assert_eq!(cell["status"], "crashed", "{cell}");
        let message = cell["message"].as_str().unwrap();
        let problem = match cell["algorithm"].as_str() {
            Some("ext:large") => "it has more than 66048 bytes, too many for 4 vertices",
            _ => "it is no regular file; write the distances to a file of this name",
        };
        assert!(message.contains(problem), "{message}");
        assert!(!message.contains("password"), "{message}");
    }
}

/// Waits for at most five minutes until no program runs in the directory of the sandbox: on a busy
/// machine one that was killed takes a while to end. One that was not sleeps for ten minutes.
#[cfg(target_os = "linux")]
fn wait_until_none_runs_in(sandbox: &Sandbox, what: &str) {
    for _ in 0..30_000 {
        if running_in(sandbox).is_empty() {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    panic!("{what}: {:?}", running_in(sandbox));
}

/// Programs that run in the directory of the sandbox, but for this one.
#[cfg(target_os = "linux")]
fn running_in(sandbox: &Sandbox) -> Vec<String> {
    let place = std::fs::canonicalize(sandbox.path("")).unwrap();
    let processes = std::fs::read_dir("/proc").unwrap().flatten();
    processes
        .filter(|process| {
            std::fs::read_link(process.path().join("cwd")).is_ok_and(|cwd| cwd == place)
        })
        .filter_map(|process| std::fs::read_to_string(process.path().join("cmdline")).ok())
        .filter(|command| !command.is_empty())
        .collect()
}

#[cfg(target_os = "linux")]
#[test]
fn processes_of_an_outside_program_outlived_it() {
    let sandbox = Sandbox::with_square();
    let quiet = "< /dev/null > /dev/null 2>&1";
    let leaves = |name, start: &str| {
        let script = format!("{start}\n{RIGHT}\necho '{{\"seconds\": 0.1}}'\n");
        (name, "once", script)
    };
    describe(
        &sandbox,
        &[
            leaves("session", &format!("setsid sleep 600 {quiet} &")),
            leaves("orphan", &format!("setsid --fork sleep 600 {quiet}")),
            leaves("bare", &format!("env -i setsid --fork sleep 600 {quiet}")),
            leaves(
                "hidden",
                &format!("env -i setsid sh -c 'sleep 600; :' {quiet} &"),
            ),
            // Joins the process group of the program that measures.
            leaves(
                "joined",
                &format!(
                    "env -i perl -e 'setpgrp(0, shift); exec \"/bin/sleep\", 600' \
                     \"$(cut -d ' ' -f 5 /proc/$PPID/stat)\" {quiet} &"
                ),
            ),
            // Needs a process of its own as long as it lives, whatever else ends meanwhile.
            (
                "keeper",
                "session",
                format!(
                    "rm -f pid\nsetsid --fork sh -c 'echo $$ > pid; exec sleep 600' {quiet}\n\
                     while [ ! -s pid ]; do sleep 0.01; done\necho '{{\"ready\": true}}'\n\
                     while read -r _; do\n{RIGHT}\nkill -0 \"$(cat pid)\" || exit 7\n\
                     echo '{{\"seconds\": 0.1}}'\ndone\n"
                ),
            ),
        ],
    );
    let run = |algorithms: &str| {
        sandbox.succeed(&format!(
            "run square.off --ext peers.toml --algo vtp,{algorithms} --repeat 3 --warmup 1"
        ));
        wait_until_none_runs_in(&sandbox, algorithms);
    };
    for name in ["session", "orphan", "bare", "hidden", "joined", "keeper"] {
        run(&format!("ext:{name}"));
    }
    run("ext:keeper,ext:session,ext:orphan,ext:hidden,ext:joined,ext:bare");
}

#[cfg(target_os = "linux")]
#[test]
fn the_memory_of_a_daemon_without_environment_was_not_limited() {
    let sandbox = Sandbox::with_square();
    let large = "env -i setsid --fork perl -e '$x = \"a\" x 300_000_000; sleep 600'";
    let answer = format!("{RIGHT}\necho '{{\"seconds\": 0.1}}'");
    let script = format!("{large} < /dev/null > /dev/null 2>&1\nsleep 500\n{answer}\n");
    describe(&sandbox, &[("daemon", "once", script)]);
    let options = "--algo vtp,ext:daemon --repeat 1 --warmup 0 --memory-limit 100MB";
    let outcome = sandbox.call(&format!(
        "run square.off --ext peers.toml {options} -o r.json"
    ));
    assert_eq!(outcome.code, 1, "{}", outcome.stderr);
    let result = sandbox.json("r.json");
    let cells = result["cells"].as_array().unwrap();
    let daemon = cells.iter().find(|cell| cell["algorithm"] == "ext:daemon");
    assert_eq!(daemon.unwrap()["status"], "out_of_memory");
    wait_until_none_runs_in(&sandbox, "ext:daemon");
}

#[cfg(target_os = "linux")]
#[test]
fn the_daemon_of_one_program_failed_the_cells_of_others() {
    let sandbox = Sandbox::with_square();
    let large = "env -i setsid --fork perl -e '$x = \"a\" x 300_000_000; sleep 600'";
    let script =
        format!("{large} < /dev/null > /dev/null 2>&1\n{RIGHT}\necho '{{\"seconds\": 0.1}}'\n");
    let waits = format!(
        "echo '{{\"ready\": true}}'\nwhile read -r _; do\nsleep 0.3\n{RIGHT}\n\
         echo '{{\"seconds\": 0.1}}'\ndone\n"
    );
    describe(
        &sandbox,
        &[("daemon", "once", script), ("waits", "session", waits)],
    );
    for seed in 1..=3 {
        let options = "--algo vtp,ext:waits,ext:daemon --repeat 2 --warmup 0 --memory-limit 100MB";
        sandbox.call(&format!(
            "run square.off --ext peers.toml {options} --seed {seed} --quiet -o r.json"
        ));
        for cell in sandbox.json("r.json")["cells"].as_array().unwrap() {
            let is_own = cell["algorithm"] == "ext:daemon";
            assert!(is_own || cell["status"] == "ok", "seed {seed}: {cell}");
        }
        wait_until_none_runs_in(&sandbox, "ext:daemon");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn processes_of_a_child_outlived_it() {
    let sandbox = Sandbox::with_square();
    for algorithms in ["test-spawn", "test-spawn,vtp,test-spawn{after=2}"] {
        sandbox.succeed(&format!("run square.off --algo {algorithms} --repeat 2"));
        wait_until_none_runs_in(&sandbox, algorithms);
    }
}

#[test]
fn names_of_models_were_formulas_html_and_orders_to_the_terminal() {
    const NAME: &str = "=1+1<b>&|`x`\x1b[2J";
    let sandbox = Sandbox::new();
    sandbox.write(&format!("{NAME}.off"), support::SQUARE);
    let run = "run . --algo vtp --repeat 1 --warmup 0";
    let print = |format: &str| sandbox.succeed(&format!("{run} --format {format}"));
    sandbox.succeed(&format!("{run} -o r.json -o r.csv -o r.md -o r.tex"));

    assert_eq!(sandbox.json("r.json")["models"][0]["name"], NAME);
    let csv = sandbox.read("r.csv");
    assert!(csv.contains(&format!("\n'{NAME},vtp,0,")), "{csv}");
    assert_eq!(print("csv").lines().nth(1).unwrap().find("'=1+1"), Some(0));
    let escaped = "=1+1&lt;b>&amp;\\|\\`x\\`\\\\x1b[2J";
    let markdown = sandbox.read("r.md");
    assert!(
        markdown.contains(&format!("| {escaped} (V: 4")),
        "{markdown}"
    );
    assert!(
        markdown.contains(&format!("- \\{escaped}: source 0")),
        "{markdown}"
    );
    let latex = sandbox.read("r.tex");
    assert!(
        latex.contains("=1+1<b>\\&|`x`\\textbackslash{}x1b[2J &"),
        "{latex}"
    );
    let table = print("table");
    assert!(
        table.contains("=1+1<b>&|`x`\\x1b[2J  (V: 4, F: 2)"),
        "{table}"
    );
    let info = sandbox.succeed("info .");
    assert!(info.starts_with("=1+1<b>&|`x`\\x1b[2J  (./=1"), "{info}");
    let verified = sandbox.succeed("verify . --algo vtp");
    assert!(
        verified.contains("\\x1b[2J: source 0: vtp: ok"),
        "{verified}"
    );
    let page = sandbox.call("report r.json -o r.html --picture none");
    assert_eq!(page.code, 0, "{}", page.stderr);
    for text in [
        markdown,
        latex,
        table,
        info,
        verified,
        sandbox.read("r.html"),
    ] {
        assert!(!text.contains('\x1b'), "{text}");
    }
    sandbox.write("wrong\x1b[2J.off", "OFF\n");
    let call = sandbox.call("info wrong\x1b[2J.off");
    assert_eq!(call.code, 2);
    assert!(!call.stderr.contains('\x1b'), "{}", call.stderr);
}

/// The reference was trusted without a check. If it was wrong, all correct answers were reported as
/// wrong, and nothing pointed at the reference.
mod trusted_reference {
    use crate::support::{Outcome, Sandbox};

    fn verify(algorithms: &str) -> Outcome {
        let sandbox = Sandbox::with_square();
        sandbox.call(&format!("verify square.off --quiet --algo {algorithms}"))
    }

    /// The outcome of a run, and the cluster and message of each cell.
    fn run(arguments: &str) -> (Outcome, Vec<(Option<u64>, String)>) {
        let sandbox = Sandbox::with_square();
        let outcome = sandbox.call(&format!(
            "run square.off --repeat 1 --warmup 0 -o r.json -o r.csv --quiet {arguments}"
        ));
        let cells = sandbox.json("r.json")["cells"].as_array().unwrap().clone();
        assert!(sandbox.read("r.csv").contains("check_cluster"));
        let of_cell = |cell: &serde_json::Value| {
            let message = cell["message"].as_str().unwrap_or_default();
            (cell["check"]["cluster"].as_u64(), message.to_owned())
        };
        (outcome, cells.iter().map(of_cell).collect())
    }

    const TWO_ALIKE: &str = "test-wrong,test-wrong{share=0.50000000000001}";

    #[test]
    fn verify_did_not_say_that_the_reference_is_the_odd_one_out() {
        let outcome = verify(TWO_ALIKE);
        assert_eq!(outcome.code, 1);
        assert!(
            outcome.stdout.contains(
                "square: source 0: 2 of 3 algorithms agree with each other; the reference \
                 `mmp-fast` is the odd one out: it differs from them by up to 3.333e-1 relative, at vertex 1\n"
            ),
            "{}",
            outcome.stdout
        );
    }

    #[test]
    fn run_did_not_say_that_the_reference_is_the_odd_one_out() {
        // With this tolerance nothing is proven, so that the bounds of each vertex decide.
        let (outcome, cells) = run("--algo mmp,ich,test-wrong --check test-wrong --tolerance 0");
        assert_eq!(outcome.code, 1);
        for text in [
            "square, source 0: the reference `test-wrong` is proven wrong; ",
            "; proven wrong: test-wrong; not refuted, a single group: mmp, ich\n",
            "1 of 3 cells failed",
        ] {
            assert!(outcome.stderr.contains(text), "{}", outcome.stderr);
        }
        let wrong = &cells[2].1;
        assert!(wrong.contains("vertex 1 is at 1.5"), "{wrong}");
    }

    #[test]
    fn a_reference_that_has_no_cell_is_named_too() {
        let (outcome, _) = run("--algo mmp,ich --check test-wrong --tolerance 0");
        assert_eq!(outcome.code, 1);
        let text = "the reference `test-wrong` is proven wrong; ";
        assert!(outcome.stderr.contains(text), "{}", outcome.stderr);
    }

    #[test]
    fn a_file_that_all_algorithms_disagree_with_is_the_odd_one_out() {
        let sandbox = Sandbox::with_square();
        sandbox.write("square.s0.csv", "0,0\n1,1\n2,1.4\n3,1\n");
        let text =
            "`./square.s0.csv` differs from `mmp-fast` by up to 1.005e-2 relative, at vertex 2\n";
        let outcome = sandbox.call("verify square.off --quiet --algo ich");
        assert_eq!(outcome.code, 1);
        assert!(outcome.stdout.contains(text), "{}", outcome.stdout);
        let outcome = sandbox.call(
            "run square.off --repeat 1 --quiet --algo mmp-fast,ich --check file --tolerance 0",
        );
        assert_eq!(outcome.code, 1);
        assert!(
            outcome
                .stderr
                .contains("the reference `./square.s0.csv` is proven wrong; "),
            "{}",
            outcome.stderr
        );
    }

    #[test]
    fn one_that_is_wrong_is_named_and_the_majority_counted() {
        let text = "2 of 3 algorithms agree with each other, the reference `mmp-fast` among them; \
                    `test-wrong` differs from `mmp-fast` by up to 3.333e-1 relative, at vertex 1\n";
        let outcome = verify("mmp-fast,ich,test-wrong");
        assert_eq!(outcome.code, 1);
        assert!(outcome.stdout.contains(text), "{}", outcome.stdout);
        let (outcome, cells) = run("--algo mmp-fast,ich,test-wrong --check mmp-fast");
        assert_eq!(outcome.code, 1);
        assert!(
            outcome.stderr.contains(text.trim_end()),
            "{}",
            outcome.stderr
        );
        let clusters: Vec<_> = cells.iter().map(|(cluster, _)| *cluster).collect();
        assert_eq!(clusters, [Some(0), Some(0), Some(1)]);
        assert_eq!((&*cells[0].1, &*cells[1].1), ("", ""));
    }

    #[test]
    fn two_algorithms_have_no_majority() {
        let text = "no majority among the 2 algorithms, either may be wrong: the reference `mmp-fast`; \
                    `test-wrong` differs from `mmp-fast`";
        let outcome = verify("test-wrong");
        assert_eq!(outcome.code, 1);
        assert!(outcome.stdout.contains(text), "{}", outcome.stdout);
        let (outcome, cells) = run("--algo mmp-fast,test-wrong --check mmp-fast");
        assert_eq!(outcome.code, 1);
        assert!(outcome.stderr.contains(text), "{}", outcome.stderr);
        assert!(cells[0].1.starts_with(text));
        assert!(cells[1].1.ends_with(", no majority; proven wrong"));
    }

    #[test]
    fn agreement_is_quiet() {
        let outcome = verify("mmp,ich,vtp");
        assert_eq!((outcome.code, &*outcome.stdout), (0, ""));
        let (outcome, cells) = run("--algo mmp,ich,vtp --check mmp");
        assert_eq!((outcome.code, &*outcome.stderr), (0, ""));
        assert!(cells.iter().all(|cell| *cell == (Some(0), String::new())));
    }

    #[test]
    fn answers_from_before_an_interruption_are_compared_as_well() {
        let sandbox = Sandbox::with_square();
        let arguments = format!(
            "run square.off --repeat 2 --warmup 0 --algo mmp,{TWO_ALIKE},ich --check mmp --quiet \
             --format json --resume j.jsonl"
        );
        let whole = sandbox.call(&arguments);
        assert_eq!(whole.code, 1);
        let journal = sandbox.read("j.jsonl");
        let summary = |outcome: &Outcome| {
            let mut lines = outcome.stderr.lines();
            let line = lines.find(|line| line.contains("no majority among the 4 algorithms"));
            line.map(str::to_owned)
        };
        assert!(summary(&whole).is_some(), "{}", whole.stderr);
        let lines: Vec<&str> = journal.split_inclusive('\n').collect();
        // From the first run on, which follows the header, the session and the model.
        for kept in 4..=lines.len() {
            sandbox.write("j.jsonl", &lines[..kept].concat());
            let rest = sandbox.call(&arguments);
            assert_eq!(rest.code, 1, "{kept}");
            assert_eq!(summary(&rest), summary(&whole), "{kept}: {}", rest.stderr);
        }
    }
}

/// A solve with an instruction that Valgrind does not support, such as `vtp-fast` on `gen:holes`,
/// ended with SIGILL. Its instruction count was missing, and the gate ignored that. These tests
/// need Valgrind.
mod missing_instructions {
    use serde_json::Value;

    use crate::support::{Outcome, Sandbox};

    /// Counts the instructions of an algorithm on the square; standard error and the cell.
    fn count(sandbox: &Sandbox, algorithm: &str) -> (String, Value) {
        let call = sandbox.call(&format!(
            "run square.off --algo {algorithm} --check none --repeat 1 --warmup 0 \
             --instructions --quiet -o r.json"
        ));
        assert_eq!(call.code, 0, "{}", call.stderr);
        (call.stderr, sandbox.json("r.json")["cells"][0].clone())
    }

    #[test]
    fn instructions_unknown_to_valgrind_were_not_counted() {
        let sandbox = Sandbox::with_square();
        let (stderr, cell) = count(&sandbox, "test-illegal");
        assert_eq!(stderr, "");
        assert!(cell["instructions"].as_u64() > Some(0), "{cell}");
        assert_eq!(cell["instructions_simd"], "scalar");
        let (_, cell) = count(&sandbox, "vtp-fast{simd=scalar}");
        assert_eq!(cell["instructions_simd"], "scalar");
    }

    #[test]
    fn vtp_fast_on_a_surface_with_holes_was_not_counted() {
        let sandbox = Sandbox::new();
        sandbox.succeed(
            "run gen:holes --algo vtp-fast --check none --repeat 1 --warmup 0 --instructions \
             --quiet -o r.json",
        );
        let cell = &sandbox.json("r.json")["cells"][0];
        assert!(cell["instructions"].as_u64() > Some(1_000_000), "{cell}");
        assert!(cell["instructions_simd"].is_string());
    }

    #[test]
    fn a_solve_that_cannot_be_counted_passed_the_gate() {
        let sandbox = Sandbox::with_square();
        let (stderr, cell) = count(&sandbox, "test-illegal{unless=never}");
        assert_eq!(cell["instructions"], Value::Null);
        assert_eq!(
            stderr,
            "geobench: warning: square: test-illegal{unless=never}, source 0: instructions are not \
             counted: Valgrind does not know an instruction of the solve, not even with simd=scalar; \
             use a newer Valgrind\n"
        );
        let outcome: Outcome =
            sandbox.call("compare r.json r.json --fail-on propagated=0,instructions=2%");
        assert_eq!(outcome.code, 1, "{}", outcome.stdout);
        assert!(
            outcome.stdout.contains(
                "square, test-illegal{unless=never}, source 0: instructions none -> none: missing in \
                 both files [instructions=2%]"
            ),
            "{}",
            outcome.stdout
        );
    }
}

/// Calls the program with a standard output whose reader has ended, and returns the exit status.
fn without_a_reader(sandbox: &Sandbox, arguments: &str) -> Option<i32> {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("geobench"));
    let mut child = command
        .current_dir(sandbox.path(""))
        .args(arguments.split(' '))
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    child.wait().unwrap().code()
}

#[test]
fn a_reader_that_had_ended_ended_a_run_with_status_0() {
    let sandbox = Sandbox::with_square();
    let run = "run square.off gen:grid,n=3 --algo ich,vtp --repeat 1 -o r.json";
    assert_eq!(without_a_reader(&sandbox, run), Some(0));
    let result = sandbox.json("r.json");
    assert_eq!(result["cells"].as_array().unwrap().len(), 4);
    assert!(result["conditions"].is_object());
    // Stored distances that are wrong.
    sandbox.write("square.s0.csv", "vertex,distance\n0,0\n1,7\n");
    let verify = "verify square.off --algo ich,vtp";
    assert_eq!(without_a_reader(&sandbox, verify), Some(1));
}

#[test]
fn parts_with_a_source_in_two_forms_could_not_be_merged() {
    let sandbox = Sandbox::new();
    let run = "run gen:grid,n=3 --algo ich --repeat 1 --quiet --source first,0,5,random:16";
    for part in ["1/2", "2/2"] {
        let name = part.replace('/', "-");
        sandbox.succeed(&format!("{run} --shard {part} -o {name}.json"));
    }
    sandbox.succeed("merge 1-2.json 2-2.json -o all.json");
    // Every vertex once.
    assert_eq!(
        sandbox.json("all.json")["cells"].as_array().unwrap().len(),
        16
    );
}

#[test]
fn recording_a_file_again_doubled_its_samples() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("run square.off --algo ich --repeat 3 --quiet -o r.json");
    let record = "record r.json --commit 0123456789abcdef0123456789abcdef01234567 \
                  --date 2025-03-04 --into history";
    for _ in 0..2 {
        sandbox.succeed(record);
    }
    let files = std::fs::read_dir(sandbox.path("history")).unwrap();
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    let name = names
        .into_iter()
        .find(|name| !name.starts_with('.'))
        .unwrap();
    let samples = sandbox.json(&format!("history/{name}"))["cells"][0]["samples"].clone();
    assert_eq!(samples.as_array().unwrap().len(), 3);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let file = sandbox.path("history").join(name);
        let mode = std::fs::metadata(file).unwrap().permissions().mode();
        let plain = std::fs::metadata(sandbox.path("r.json"))
            .unwrap()
            .permissions()
            .mode();
        assert_eq!(mode, plain, "a history that only its owner can read");
    }
}

#[test]
fn notes_were_mixed_into_data_on_standard_output() {
    let sandbox = Sandbox::new();
    let model = "gen:torus,faces=500";
    for call in [
        format!("distance {model} --source at:3,0,0 -o - --output-format json"),
        format!("path {model} --source at:3,0,0 --target 5 -o - --output-format json"),
        format!("voronoi {model} --source at:3,0,0 --source 5 -o - --output-format json"),
    ] {
        let said = sandbox.succeed(&call);
        let parsed: Result<serde_json::Value, _> = serde_json::from_str(&said);
        assert!(parsed.is_ok(), "{call}: {said:.200}");
    }
    let said = sandbox.refuse(&format!(
        "distance {model} --source 0,1 --each -o - --output-format csv"
    ));
    assert!(
        said.starts_with("--each writes a file for each source"),
        "{said}"
    );
}

#[test]
fn answers_beyond_a_proven_bound_passed_in_verify() {
    let sandbox = Sandbox::with_square();
    // The distance of vertex 2 is wrong by more than the bound of `avtp`.
    sandbox.write("square.s0.csv", "vertex,distance\n0,0\n2,1.3\n");
    let outcome = sandbox.call("verify square.off --algo mmp-fast,avtp{eps=0.001}");
    assert_eq!(outcome.code, 1, "{}", outcome.stdout);
    let line = outcome.stdout.lines().find(|line| line.contains("avtp"));
    assert!(line.unwrap().contains("WRONG"), "{}", outcome.stdout);
}

#[test]
fn a_report_overwrote_its_result_file() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("run square.off --algo ich --repeat 1 --quiet -o r.json");
    let said = sandbox.refuse("report r.json -o r.json");
    assert_eq!(
        said,
        "r.json: the page is HTML; let the name end with .html"
    );
    assert!(sandbox.json("r.json")["cells"].is_array());
}

#[test]
fn one_file_for_two_outputs_lost_one() {
    let sandbox = Sandbox::new();
    let said = sandbox.refuse("voronoi gen:sphere --source random:9 -o v.obj --dual ./v.obj");
    assert!(said.ends_with("given twice as output"), "{said}");
    let said = sandbox.refuse("remesh gen:sphere --sites 99 -o v.obj --picture v.obj");
    assert!(said.contains("v.obj"), "{said}");
}
