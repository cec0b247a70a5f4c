//! `geobench run --shard` and `geobench merge`.

use serde_json::Value;

use crate::support::{Sandbox, UNUSABLE};

/// A suite with two groups, an unusable model, and fewer sources than shards in places, so that
/// some shards lack a group or model.
const SUITE: &str = r#"
algorithms = ["mmp", "vtp"]
repeat = 1
warmup = 0

[[group]]
name = "first"
models = ["gen:octahedron", "bad.off", "gen:cube,n=2"]
source = "random:3,seed=2"

[[group]]
name = "second"
models = ["gen:sphere,subdiv=1", "bad.off"]
source = [5, 1]
"#;

const RUN: &str = "run --config suite.toml --quiet --isolate none";

fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("suite.toml", SUITE);
    sandbox.write("bad.off", UNUSABLE);
    sandbox
}

/// Runs all `count` shards. Their files are `1.json`, `2.json` and so on.
fn run_parts(sandbox: &Sandbox, count: u32) -> String {
    let mut names = Vec::new();
    for index in 1..=count {
        let part = sandbox.call(&format!("{RUN} --shard {index}/{count} -o {index}.json"));
        assert!([0, 2].contains(&part.code), "{}", part.stderr);
        names.push(format!("{index}.json"));
    }
    names.reverse(); // The order of the files must not matter.
    names.join(" ")
}

/// The identity of a cell, and its fields that do not depend on time.
fn keys(result: &Value) -> Vec<String> {
    let cells = result["cells"].as_array().unwrap();
    let key = |c: &Value| {
        format!(
            "{} {} {} {} {} {} {}",
            c["group"],
            c["model"],
            c["source"],
            c["algorithm"],
            c["status"],
            c["counters"],
            c["check"]
        )
    };
    cells.iter().map(key).collect()
}

#[test]
fn the_parts_joined_are_the_whole() {
    let sandbox = sandbox();
    assert_eq!(sandbox.call(&format!("{RUN} -o whole.json")).code, 2);
    let whole = sandbox.json("whole.json");
    for count in [1, 2, 5, 13] {
        let parts = run_parts(&sandbox, count);
        let joined = sandbox.call(&format!("merge {parts} -o joined.json -o joined.csv"));
        assert_eq!(
            joined.code, 2,
            "as the whole: a model is refused: {}",
            joined.stderr
        );
        let joined = sandbox.json("joined.json");
        assert_eq!(keys(&joined), keys(&whole), "{count}");
        assert_eq!(joined["groups"], whole["groups"]);
        assert_eq!(joined["plan"], whole["plan"]);
        let names = |result: &Value| -> Vec<Value> {
            let models = result["models"].as_array().unwrap();
            models.iter().map(|m| m["name"].clone()).collect()
        };
        assert_eq!(names(&joined), names(&whole));
        let sessions = joined["sessions"].as_array().unwrap();
        assert_eq!(sessions.len(), count as usize);
        assert_eq!(sessions[0]["shard"]["index"], 1);
        for cell in joined["cells"].as_array().unwrap() {
            let shard = cell["shard"].as_u64().unwrap();
            assert!((1..=u64::from(count)).contains(&shard));
        }
    }
}

#[test]
fn different_runs_on_one_machine_are_joined_and_differences_noted() {
    let sandbox = Sandbox::with_square();
    let run = "run square.off --quiet --isolate none --repeat 2";
    sandbox.succeed(&format!("{run} --algo mmp,vtp -o a.json"));
    sandbox.succeed(&format!("{run} --algo vtp,ich --warmup 2 -o b.json"));
    let call = sandbox.call("merge a.json b.json -o joined.json -o s.csv --csv samples");
    assert_eq!(call.code, 0, "{}", call.stderr);
    assert!(
        call.stderr
            .contains("1 of its cells are also in earlier files"),
        "{}",
        call.stderr
    );
    assert!(
        call.stderr
            .contains("`plan.warmup` is 2 in b.json and 1 in a.json"),
        "{}",
        call.stderr
    );
    let joined = sandbox.json("joined.json");
    let names: Vec<&str> = (joined["cells"].as_array().unwrap().iter())
        .map(|cell| cell["algorithm"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["mmp", "vtp", "ich"]);
    assert_eq!(joined["cells"][1], sandbox.json("a.json")["cells"][1]);
    let csv = sandbox.read("s.csv");
    assert_eq!(csv.lines().count(), 1 + 3 * 2);
    assert!(csv.starts_with(
        "model,algorithm,source,goal,threads,group,sample,place,solves,seconds,vertices,faces,edges,machine\n"
    ));

    sandbox.write(
        "square.off",
        &crate::support::SQUARE.replace("1 1 0", "1 1 1"),
    );
    sandbox.succeed(&format!("{run} --algo mmp -o c.json"));
    let refusal = sandbox.refuse("merge a.json c.json -o x.json");
    assert!(refusal.starts_with("c.json: its model square is not that of a.json: the SHA-256 is "));
}

#[test]
fn a_file_grows_by_algorithms_models_and_runs() {
    let sandbox = Sandbox::with_square();
    let run = "run square.off --quiet --repeat";
    sandbox.succeed(&format!("{run} 2 --algo mmp,vtp -o r.json"));
    let before = sandbox.json("r.json");
    sandbox.succeed(&format!(
        "{run} 2 --algo mmp,vtp,ich gen:cube,n=2 --add-to r.json"
    ));
    let more = sandbox.json("r.json");
    let key = |cell: &Value| format!("{} {}", cell["model"], cell["algorithm"]);
    let keys: Vec<String> = more["cells"].as_array().unwrap().iter().map(key).collect();
    assert_eq!(keys.len(), 6);
    assert_eq!(more["cells"][0], before["cells"][0]);
    assert_eq!(more["cells"][1], before["cells"][1]);
    assert_eq!(more["cells"][2]["check"]["reference"], "mmp");
    assert_eq!(more["sessions"].as_array().unwrap().len(), 2);

    sandbox.succeed(&format!("{run} 3 --algo vtp --add-to r.json"));
    let longer = sandbox.json("r.json");
    let samples = |file: &Value| {
        file["cells"][1]["time"]["samples"]
            .as_array()
            .unwrap()
            .clone()
    };
    assert_eq!(samples(&longer).len(), 3);
    assert_eq!(samples(&longer)[..2], samples(&before));
    assert_eq!(longer["cells"][0], before["cells"][0]);
    // All cells are already in the file.
    sandbox.succeed(&format!("{run} 3 --algo vtp --add-to r.json"));
    assert_eq!(sandbox.json("r.json")["cells"], longer["cells"]);

    let mut elsewhere = longer.clone();
    elsewhere["host"]["cores"] = 1000.into();
    sandbox.write("other.json", &elsewhere.to_string());
    let refusal = sandbox.refuse(&format!("{run} 3 --algo ich --add-to other.json"));
    assert!(
        refusal.starts_with("other.json: from another machine"),
        "{refusal}"
    );
    // A run that takes no new times, for example one that only counts instructions, is accepted
    // from another machine.
    sandbox.succeed(&format!("{run} 3 --algo vtp --add-to other.json"));
    let kept = sandbox.json("other.json");
    assert_eq!(kept["cells"], longer["cells"]);
    assert_eq!(kept["host"]["cores"], 1000);
    let refusal = sandbox.refuse(&format!("{run} 4 --algo vtp --add-to other.json"));
    assert!(
        refusal.starts_with("other.json: from another machine"),
        "{refusal}"
    );
}

#[test]
fn a_dash_is_standard_input_and_output() {
    let sandbox = Sandbox::with_square();
    let piped = |arguments: &str, input: &str| {
        let mut command = sandbox.command(arguments);
        let output = command.write_stdin(input.to_owned()).output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments}: {error}");
        String::from_utf8(output.stdout).unwrap()
    };
    let square = sandbox.read("square.off");
    let csv = piped(
        "distance - --input-format off --source 0 -o - --output-format csv",
        &square,
    );
    assert!(csv.starts_with("vertex,distance\n0,0\n1,1\n"), "{csv}");
    let run = "run - --input-format off --algo mmp --repeat 1 --quiet -o - --output-format json";
    let json = piped(run, &square);
    assert!(json.starts_with("{\n  \"schema\""), "{json}");
    // The name is the one that the user wrote, and not that of a temporary file.
    let result: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(result["models"][0]["path"], "-");
    let shown = piped("info - --input-format off", &square);
    assert!(shown.starts_with("stdin  (-)\n"), "{shown}");
    let mut broken = sandbox.command("distance - --input-format obj --source 0 -o d.csv");
    let error = String::from_utf8(broken.write_stdin("x").output().unwrap().stderr).unwrap();
    assert!(error.starts_with("geobench: error: -: "), "{error}");
    let mut broken = sandbox.command("run - --input-format obj --algo mmp --repeat 1 --quiet");
    let error = String::from_utf8(broken.write_stdin("x").output().unwrap().stderr).unwrap();
    assert!(error.starts_with("geobench: error: -: there"), "{error}");
    let merged = piped("merge - -o - --output-format csv", &json);
    assert!(merged.starts_with("model,algorithm,"), "{merged}");
    let model = piped("gen tetrahedron,subdiv=0 -o - --output-format obj", "");
    assert!(model.contains("\nf "), "{model}");
    let refusal = sandbox.refuse("info -");
    assert!(
        refusal.starts_with("-: --input-format says in which form"),
        "{refusal}"
    );
    // The ending of a file names its format, so that the options would have no effect.
    for (command, option) in [
        ("info square.off --input-format obj", "--input-format obj"),
        (
            "gen torus -o torus.ply --output-format obj",
            "--output-format obj",
        ),
        (
            "distance square.off --source 0 -o d.csv --output-format nonsense",
            "--output-format nonsense",
        ),
    ] {
        let refusal = sandbox.refuse(command);
        assert!(
            refusal.starts_with(&format!("{option}: no file is `-`")),
            "{refusal}"
        );
    }
    assert!(!sandbox.path("torus.ply").exists());
}

#[test]
fn incomplete_or_different_parts_are_not_joined() {
    let sandbox = sandbox();
    run_parts(&sandbox, 3);
    assert_eq!(
        sandbox.refuse("merge 1.json 3.json -o x.json"),
        "of 3 parts, 2 is missing; give the files of all parts"
    );
    assert_eq!(
        sandbox.refuse("merge 2.json -o x.json"),
        "of 3 parts, 1, 3 are missing; give the files of all parts"
    );
    assert_eq!(
        sandbox.refuse("merge 1.json 2.json 3.json 2.json -o x.json"),
        "2.json: holds part 2/3, as does 2.json; give each part once"
    );
    sandbox.call(&format!("{RUN} -o whole.json"));
    assert_eq!(
        sandbox.refuse("merge whole.json 2.json -o x.json"),
        "whole.json: not a part of a benchmark: it was made without --shard"
    );

    let refused = |from: &str, to: &str| {
        let text = sandbox.read("2.json");
        assert!(text.contains(from));
        sandbox.write("other.json", &text.replacen(from, to, 1));
        sandbox.refuse("merge 1.json other.json 3.json -o x.json")
    };
    let start = "other.json: not a part of the same benchmark as 1.json: ";
    assert_eq!(
        refused("\"version\": \"", "\"version\": \"9"),
        format!(
            "{start}`tool.version` is \"9{0}\" and not \"{0}\"",
            env!("CARGO_PKG_VERSION")
        )
    );
    assert_eq!(
        refused("\"repeat\": 1", "\"repeat\": 2"),
        format!("{start}`plan.groups[0].repeat` is 2 and not 1")
    );
    assert_eq!(
        refused("\"count\": 3", "\"count\": 4"),
        format!("{start}there are 4 parts and not 3")
    );
    assert!(
        refused("\"sha256\": \"", "\"sha256\": \"f00")
            .starts_with(&format!("{start}the SHA-256 of "))
    );
    assert!(
        refused("\"schema\": \"geobench/1\"", "\"schema\": \"geobench/0\"").contains("`schema`")
    );

    // The shard was interrupted after its first cells.
    let mut part = sandbox.json("2.json");
    part["cells"].as_array_mut().unwrap().truncate(2);
    sandbox.write("other.json", &part.to_string());
    let refusal = sandbox.refuse("merge 1.json other.json 3.json -o x.json");
    assert!(
        refusal.starts_with("other.json: has no cells of "),
        "{refusal}"
    );
    assert!(!sandbox.path("x.json").exists());
}

#[test]
fn parts_of_different_machines_are_joined_with_a_warning() {
    let sandbox = sandbox();
    run_parts(&sandbox, 2);
    let mut part = sandbox.json("2.json");
    part["sessions"][0]["host"]["cpu"] = "another".into();
    sandbox.write("2.json", &part.to_string());
    let joined = sandbox.call("merge 1.json 2.json -o joined.json");
    assert!(
        joined
            .stderr
            .contains("the parts ran on different machines"),
        "{}",
        joined.stderr
    );
    let sessions = &sandbox.json("joined.json")["sessions"];
    assert_eq!(sessions[1]["host"]["cpu"], "another");
    assert_ne!(sessions[0]["host"]["cpu"], "another");
}

#[test]
fn a_part_has_a_journal_of_its_own() {
    let sandbox = sandbox();
    sandbox.call(&format!("{RUN} --shard 1/2 --resume j.jsonl -o 1.json"));
    let refusal = sandbox.refuse(&format!("{RUN} --shard 2/2 --resume j.jsonl"));
    assert!(
        refusal.contains("`plan.shard.index` is 1 there and 2 now"),
        "{refusal}"
    );
    let before = sandbox.json("1.json");
    sandbox.call(&format!("{RUN} --shard 1/2 --resume j.jsonl -o 1.json"));
    assert_eq!(sandbox.json("1.json")["cells"], before["cells"]);
    assert!(
        sandbox
            .refuse("run gen:cube --shard 3/2")
            .contains("give I/N such as 2/3")
    );
}

#[test]
fn a_part_without_units_is_warned_of() {
    let sandbox = Sandbox::with_square();
    let run = "run square.off --algo vtp --repeat 1 --warmup 0 --shard";
    let warned = |part: &str| {
        let call = sandbox.call(&format!("{run} {part}"));
        assert_eq!(call.code, 0, "{}", call.stderr);
        call.stderr.contains("part 2/3 has nothing to do")
    };
    assert!(!warned("1/3"));
    assert!(warned("2/3"));
}

#[test]
fn a_model_that_one_part_cannot_load_fails_in_its_cells_alone() {
    let sandbox = Sandbox::new();
    let run =
        "run gen:sphere,subdiv=6 --algo vtp,ftp --source random:3 --repeat 1 --warmup 0 --quiet";
    for (index, limit) in [(1, ""), (2, "--memory-limit 4MiB"), (3, "")] {
        sandbox.call(&format!("{run} {limit} --shard {index}/3 -o {index}.json"));
    }
    // As if the machine had too little memory.
    let mut limited = sandbox.json("2.json");
    for group in limited["plan"]["groups"].as_array_mut().unwrap() {
        group["memory_limit"] = Value::Null;
    }
    sandbox.write("2.json", &limited.to_string());
    let merged = sandbox.call("merge 1.json 2.json 3.json -o r.json");
    // The status of the whole benchmark.
    assert_eq!(
        (merged.code, merged.stderr.as_str()),
        (
            1,
            "geobench: error: 2 of 6 cells failed or could not be checked\n"
        )
    );
    let result = sandbox.json("r.json");
    let cells = result["cells"].as_array().unwrap();
    let count = |status: &str| cells.iter().filter(|c| c["status"] == status).count();
    assert_eq!((count("ok"), count("out_of_memory")), (4, 2));
    assert!(result["models"][0]["sha256"].is_string());
}

#[test]
fn earlier_cells_stay_if_the_model_is_refused_now() {
    let sandbox = Sandbox::with_square();
    let run = "run square.off --quiet --repeat 2 --algo mmp --add-to r.json";
    sandbox.succeed("run square.off --quiet --repeat 2 --algo mmp -o r.json");
    let before = sandbox.json("r.json");
    // The square has no vertex 9.
    assert_eq!(sandbox.call(&format!("{run} --source 0,9")).code, 2);
    let cells = &sandbox.json("r.json")["cells"];
    assert_eq!(cells[0], before["cells"][0]);
    assert_eq!(
        (&cells[1]["source"], &cells[1]["status"]),
        (&9.into(), &"refused".into())
    );
}

#[test]
fn processes_that_add_to_one_file_lose_nothing() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("run square.off --algo dijkstra --repeat 1 --quiet -o all.json");
    std::thread::scope(|scope| {
        for algorithm in ["mmp", "ich", "vtp", "fwp-ch"] {
            let sandbox = &sandbox;
            scope.spawn(move || {
                sandbox.succeed(&format!(
                    "run square.off --algo {algorithm} --check none --repeat 2 --quiet --add-to all.json"
                ));
            });
        }
    });
    let all = sandbox.json("all.json");
    let cells = all["cells"].as_array().unwrap().iter();
    let mut names: Vec<&str> = cells.map(|c| c["algorithm"].as_str().unwrap()).collect();
    names.sort_unstable();
    assert_eq!(names, ["dijkstra", "fwp-ch", "ich", "mmp", "vtp"]);
}
