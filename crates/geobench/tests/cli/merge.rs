//! `geobench run --shard` and `geobench merge`.

use serde_json::Value;

use crate::support::{NON_MANIFOLD, Sandbox};

/// Two groups; a model that cannot be used; sources of which not all parts have some.
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
    sandbox.write("bad.off", NON_MANIFOLD);
    sandbox
}

/// Runs all `count` parts; their files are called 1.json and so on.
fn run_parts(sandbox: &Sandbox, count: u32) -> String {
    let mut names = Vec::new();
    for index in 1..=count {
        let part = sandbox.call(&format!("{RUN} --shard {index}/{count} -o {index}.json"));
        assert!([0, 2].contains(&part.code), "{}", part.stderr);
        names.push(format!("{index}.json"));
    }
    names.reverse(); // The order in which they are given is of no account.
    names.join(" ")
}

/// What says which cell it is, and what does not depend on the clock.
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
fn what_does_not_belong_together_is_not_joined() {
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

    // Interrupted after its first cells.
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
fn a_part_with_nothing_to_do_says_so() {
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
