//! `--target` and `--radius` of `geobench run` and `verify`: runs end early, and only the requested
//! distances are compared.

use geobench_registry as registry;
use serde_json::{Value, json};

use crate::support::Sandbox;

const MODEL: &str = "gen:torus,faces=2000";
const ALGORITHMS: &str = "mmp,mmp-fast,ich,fwp-ch,vtp,vtp-fast,pch,dijkstra";

fn cells(sandbox: &Sandbox, file: &str) -> Vec<Value> {
    sandbox.json(file)["cells"].as_array().unwrap().clone()
}

#[test]
fn a_run_ends_early_and_its_counters_show_it() {
    let sandbox = Sandbox::new();
    let all = format!("run {MODEL} --algo {ALGORITHMS} --check mmp --repeat 1 --quiet");
    sandbox.succeed(&format!("{all} -o all.json"));
    sandbox.succeed(&format!("{all} --target 1,edge:0-1,0.5 -o near.json"));
    sandbox.succeed(&format!("{all} --radius 0.3 -o radius.json"));
    let vertices = sandbox.json("all.json")["models"][0]["vertices"].clone();
    let whole = cells(&sandbox, "all.json");
    for (file, goal, compared) in [
        ("near.json", "to 1,edge:0-1,0.5", Some(json!(2))),
        ("radius.json", "within 0.3", None),
    ] {
        for (cell, whole) in cells(&sandbox, file).iter().zip(&whole) {
            assert_eq!(cell["status"], "ok", "{cell}");
            assert_eq!(cell["goal"], goal);
            assert_eq!(whole["goal"], json!(null));
            assert_eq!(whole["check"]["compared"], vertices);
            let compared = compared.as_ref().unwrap_or(&cell["check"]["compared"]);
            assert_eq!(cell["check"]["compared"], *compared);
            let counter = |cell: &Value| {
                let counters = &cell["counters"];
                let found = [&counters["propagated"], &counters["queue_pushes"]];
                found.into_iter().find_map(Value::as_u64).unwrap()
            };
            assert!(5 * counter(cell) < counter(whole), "{cell}");
            let samples = cell["phases"]["samples"].as_u64();
            assert!(samples.is_some_and(|count| count > 0), "{cell}");
        }
    }
    let group = &sandbox.json("near.json")["plan"]["groups"][0];
    assert_eq!(group["targets"], "1,edge:0-1,0.5");
    let group = &sandbox.json("radius.json")["plan"]["groups"][0];
    assert_eq!(group["radius"], 0.3);
}

#[test]
fn vertices_beyond_the_radius_are_not_called_unreachable() {
    let table = |options: &str| {
        let sandbox = Sandbox::with_square();
        let run = format!("run square.off --algo vtp --repeat 1 --radius {options}");
        sandbox.succeed(&run)
    };
    let beyond = table("1.2");
    assert!(
        beyond.contains("beyond the radius or unreachable: 1"),
        "{beyond}"
    );
    assert!(!beyond.contains("unreachable vertices"), "{beyond}");
    assert!(!table("2").contains("unreachable"));
}

#[test]
fn results_of_other_targets_are_not_mixed() {
    let sandbox = Sandbox::with_square();
    let run = "run square.off --algo mmp,vtp --repeat 1 --quiet";
    sandbox.succeed(&format!("{run} --target 2 --resume j -o a.json"));
    sandbox.succeed(&format!("{run} --radius 0.5 -o b.json"));
    let refused = sandbox.refuse(&format!("{run} --target 1 --resume j"));
    assert!(refused.contains("belongs to another run"), "{refused}");
    assert!(refused.contains("targets"), "{refused}");
    let refused = sandbox.refuse(&format!("{run} --target 1 --add-to a.json"));
    assert!(
        refused.contains("its runs are to 2, and this one to 1"),
        "{refused}"
    );
    // Files with different goals are reported one after the other, in separate tables.
    let shown = sandbox.call("report a.json b.json -o r.html").stderr;
    let said = "its runs are within 0.5, and those of a.json to 2";
    assert!(shown.contains(said), "{shown}");
    let refused = sandbox.refuse("merge a.json b.json -o m.json");
    assert!(refused.contains(said), "{refused}");
    let refused = sandbox.refuse("pool a.json b.json -o p.json");
    assert!(
        refused.contains("not a round of the same benchmark"),
        "{refused}"
    );
    let refused = sandbox.refuse("compare a.json b.json");
    assert!(refused.contains("have no cell in common"), "{refused}");
}

#[test]
fn algorithms_that_cannot_end_early_are_refused_by_name() {
    let sandbox = Sandbox::with_square();
    let refused = sandbox.refuse("run square.off --algo mmp,pvtp,heat --target 1");
    assert!(
        refused.contains("pvtp, heat cannot end early; leave out such algorithms, or leave"),
        "{refused}"
    );
    let refused = sandbox.refuse("run square.off --algo ext:x --radius 1");
    assert!(refused.contains("ext:x is an outside program, which is asked for all distances"));
    let refused = sandbox.refuse("verify square.off --algo window-vtp --radius 1");
    assert!(refused.contains("window-vtp cannot end early"), "{refused}");
    let shown = sandbox.succeed("verify square.off --target 2,edge:0-1,0.5");
    assert!(
        shown.starts_with("left out, because they cannot end early: "),
        "{shown}"
    );
    assert!(
        !shown.contains(" pvtp: ok") && shown.contains("vtp-fast: ok"),
        "{shown}"
    );
    sandbox.succeed("verify square.off --radius 1 --quiet");
    for algorithm in registry::select("all,certificate").unwrap() {
        let name = algorithm.label();
        let run = format!("run square.off --algo {name} --target 1 --repeat 1 --quiet");
        if algorithm.ends_early() {
            sandbox.succeed(&run);
        } else {
            let refused = sandbox.refuse(&run);
            assert!(
                refused.contains(&format!("{name} cannot end early")),
                "{refused}"
            );
        }
    }
}

#[test]
fn targets_are_read_from_files_and_suites_too() {
    let sandbox = Sandbox::with_square();
    sandbox.write("t.txt", "\u{feff}# two targets\n3\nface:0,0.2,0.3,0.5\n");
    sandbox.succeed("run square.off --algo mmp --targets t.txt --repeat 1 --quiet -o a.json");
    let goal = "to 3,face:0,0.2,0.3,0.5";
    assert_eq!(cells(&sandbox, "a.json")[0]["goal"], goal);
    sandbox.write(
        "suite.toml",
        "\u{feff}repeat = 1\nalgorithms = [\"vtp\"]\nmodels = [\"square.off\"]\n\n\
         [[group]]\nname = \"near\"\ntargets = \"t.txt\"\n\n\
         [[group]]\nname = \"both\"\ntarget = [2, \"edge:0-1,0.5\"]\nradius = 1\n",
    );
    sandbox.succeed("run --config suite.toml --quiet -o b.json");
    let goals: Vec<Value> = (cells(&sandbox, "b.json").iter())
        .map(|cell| cell["goal"].clone())
        .collect();
    assert_eq!(goals, [json!(goal), json!("to 2,edge:0-1,0.5 within 1")]);
    sandbox.write(
        "bad.toml",
        "[[group]]\nname = \"near\"\nmodels = [\"square.off\"]\nradius = -1\n",
    );
    let refused = sandbox.refuse("run --config bad.toml");
    assert!(
        refused.contains("`radius`: a number of 0 or more is expected"),
        "{refused}"
    );
    let refused = sandbox.call("run square.off --algo mmp --target 9 --quiet");
    assert_eq!(refused.code, 2);
    assert!(
        refused.stderr.contains("target vertex 9 does not exist"),
        "{}",
        refused.stderr
    );
}

#[test]
fn stored_distances_are_compared_at_the_targets() {
    let sandbox = Sandbox::with_square();
    sandbox.write("square.s0.csv", "0,0\n1,1\n2,9\n3,1\n");
    let run = "run square.off --algo mmp --check file --repeat 1 --quiet";
    sandbox.succeed(&format!("{run} --target 1,3 -o a.json"));
    let check = cells(&sandbox, "a.json")[0]["check"].clone();
    assert_eq!(check["compared"], 2);
    sandbox.succeed(&format!("{run} --radius 1.2"));
    let wrong = sandbox.call(&format!("{run} --target 3,2 -o b.json"));
    assert_eq!(wrong.code, 1);
    // A proof decides that the file is wrong.
    let cell = cells(&sandbox, "b.json")[0].clone();
    assert_eq!(cell["check"]["replaced"], "./square.s0.csv", "{cell}");
    assert_eq!(cell["check"]["proven"], true, "{cell}");
    let said = "the reference `./square.s0.csv` is proven wrong; proven right: mmp";
    assert!(wrong.stderr.contains(said), "{}", wrong.stderr);
    let proof = cell["check"]["proof"].as_str().unwrap();
    let vertex = "vertex 2 is at 9 instead of 1.41";
    assert!(proof.contains(vertex), "{proof}");
}
