//! Models with edges of more than two faces, and models that cannot be oriented.

use serde_json::Value;

use crate::support::Sandbox;

/// Three squares on the edge from 1 to 2, cut along diagonals. The last one is wound against the
/// others.
const BOOK: &str = "\
    v 0 0 0\nv 0 0 1\nv 1 0 0\nv 1 0 1\nv -1 0 0\nv -1 0 1\nv 0 1 0\nv 0 1 1\n\
    f 1 3 4\nf 1 4 2\nf 1 5 6\nf 1 6 2\nf 1 7 8\nf 2 1 8\n";

/// A strip of five triangles, its ends joined with a half turn.
const MOEBIUS: &str = "\
    v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nv -1 0 1\n\
    f 1 2 3\nf 2 3 4\nf 3 4 5\nf 4 5 1\nf 5 1 2\n";

fn with_models() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("book.obj", BOOK);
    sandbox.write("moebius.obj", MOEBIUS);
    sandbox
}

#[test]
fn distances_and_paths_cross_edges_of_three_faces() {
    let sandbox = with_models();
    let outcome = sandbox.call("distance book.obj --source 2 -o d.json");
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    assert!(
        outcome.stderr.contains("1 edge has more than two faces"),
        "{}",
        outcome.stderr
    );
    let field = sandbox.json("d.json");
    assert_eq!(field["algorithm"], "mmp-fast");
    let found: Vec<f64> = (field["distances"].as_array().unwrap().iter())
        .map(|d| d.as_f64().unwrap())
        .collect();
    let [two, five] = [2.0_f64.sqrt(), 5.0_f64.sqrt()];
    let expected = [1.0, two, 0.0, 1.0, 2.0, five, 2.0, five];
    let agree = |(a, b): (&f64, f64)| (a - b).abs() < 1e-12;
    assert!(found.iter().zip(expected).all(agree), "{found:?}");
    // The paths to the far corners of both other sheets cross the common edge in its middle.
    sandbox.succeed("path book.obj --source 2 --target 5 --target 7 -o p.json");
    let paths = sandbox.json("p.json");
    for path in paths["paths"].as_array().unwrap() {
        assert!((path["length"].as_f64().unwrap() - five).abs() < 1e-12);
    }
    sandbox.succeed("certify book.obj --source 2");
    // A point of the common edge.
    sandbox.succeed("distance book.obj --source edge:0-1,0.5 -o e.json");
    let field = sandbox.json("e.json");
    let corner = field["distances"][7].as_f64().unwrap();
    assert!((corner - 1.25_f64.sqrt()).abs() < 1e-12, "{corner}");
}

#[test]
fn isolines_continue_on_each_sheet() {
    let sandbox = with_models();
    // A half circle on each of the three sheets, and its ends on the edge.
    sandbox.succeed("isolines book.obj --source edge:0-1,0.5 --levels 0.25 -o i.json");
    let lines = sandbox.json("i.json");
    let text = lines.to_string();
    let length = |line: &Value| line["length"].as_f64().unwrap();
    let all = lines["levels"][0]["loops"].as_array().expect(&text);
    assert_eq!(all.len(), 3, "{text}");
    let half = 0.25 * std::f64::consts::PI;
    assert!(
        all.iter().all(|line| (length(line) - half).abs() < 1e-12),
        "{text}"
    );
}

#[test]
fn algorithms_that_do_not_cross_them_are_refused() {
    let sandbox = with_models();
    for (model, why) in [
        ("book.obj", "edges with more than two faces: use mmp-fast"),
        (
            "moebius.obj",
            "a surface that cannot be oriented: use mmp-fast",
        ),
    ] {
        for algorithm in ["vtp", "vtp-fast", "heat", "svg"] {
            let command = format!("distance {model} --source 0 --algo {algorithm} -o d.csv");
            let error = sandbox.call(&command).stderr;
            assert!(error.contains(&format!("{algorithm}: {why}")), "{error}");
        }
        for command in ["voronoi --source 0,1", "remesh --sites 4"] {
            let (name, rest) = command.split_once(' ').unwrap();
            let error = sandbox
                .call(&format!("{name} {model} {rest} -o out.obj"))
                .stderr;
            assert!(error.contains("Voronoi diagrams and remeshing"), "{error}");
            assert!(
                error.contains("use the commands distance, path or isolines"),
                "{error}"
            );
            assert!(!error.contains("mmp-fast"), "{error}");
        }
        let text = sandbox.succeed(&format!("verify {model}"));
        assert!(text.contains("vtp: left out"), "{text}");
        assert!(
            text.contains("fwp-mmp: ok") && text.contains("ich: ok"),
            "{text}"
        );
        // The others are checked, also if the first one would be the reference of other models.
        for list in ["mmp,vtp", "vtp,mmp", "vtp-fast,vtp,ich,mmp"] {
            let outcome = sandbox.call(&format!("run {model} --algo {list} --repeat 1"));
            assert_eq!(outcome.code, 2, "{list}: {}", outcome.stderr);
            let named = format!("vtp: {why}");
            assert!(outcome.stderr.contains(&named), "{}", outcome.stderr);
            assert!(outcome.stdout.contains(&named), "{}", outcome.stdout);
            assert!(
                outcome.stdout.contains("checked against "),
                "{}",
                outcome.stdout
            );
            assert!(
                !outcome.stdout.contains("not checked"),
                "{}",
                outcome.stdout
            );
        }
        // A reference that is asked for stays.
        let outcome = sandbox.call(&format!(
            "run {model} --algo vtp,mmp --check vtp --repeat 1"
        ));
        assert_eq!(outcome.code, 1, "{}", outcome.stderr);
    }
}

/// The algorithms that have cells on a model of a result, and the notes of that model.
fn cells_and_notes(result: &Value, model: &str) -> (Vec<String>, String) {
    let of = |cell: &&Value| cell["model"] == model;
    let cells = result["cells"].as_array().unwrap().iter().filter(of);
    let mut models = result["models"].as_array().unwrap().iter();
    let record = models.find(|record| record["name"] == model).unwrap();
    let algorithms = cells.map(|cell| cell["algorithm"].as_str().unwrap().to_owned());
    (algorithms.collect(), record["notes"].to_string())
}

const LEFT_OUT: &str = "left out, because they cross no edges with more than two faces and no surface \
    that cannot be oriented: ";

#[test]
fn a_run_leaves_out_such_algorithms_unless_named() {
    let sandbox = with_models();
    sandbox.write(
        "flat.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n",
    );
    // Both default groups have algorithms that do not cross junctions.
    let models = "flat.obj book.obj moebius.obj";
    let outcome = sandbox.call(&format!("run {models} --repeat 1 -o r.json -o r.md"));
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    let result = sandbox.json("r.json");
    let flat = "mmp ich fwp-mmp fwp-ch vtp mmp-fast ich-fast vtp vtp-fast";
    let (algorithms, _) = cells_and_notes(&result, "flat");
    assert_eq!(algorithms.join(" "), flat);
    let [papers, fast] = ["vtp", "vtp, vtp-fast"];
    for model in ["book", "moebius"] {
        let (algorithms, notes) = cells_and_notes(&result, model);
        assert_eq!(
            algorithms.join(" "),
            "mmp ich fwp-mmp fwp-ch mmp-fast ich-fast"
        );
        for names in [papers, fast] {
            assert!(notes.contains(&format!("{LEFT_OUT}{names}\"")), "{notes}");
            let told = format!("{model}: {LEFT_OUT}{names}\n");
            assert!(outcome.stderr.contains(&told), "{}", outcome.stderr);
        }
    }
    let markdown = sandbox.read("r.md");
    for text in [&outcome.stdout, &markdown] {
        let count = |names: &str| text.matches(&format!("{LEFT_OUT}{names}")).count();
        // The first is the beginning of the second.
        assert_eq!([count(papers), count(fast)], [4, 2], "{text}");
    }
    // Every row marks the best of the algorithms that ran.
    assert!(!outcome.stdout.contains("refused"), "{}", outcome.stdout);
}

#[test]
fn a_named_algorithm_fails_also_beside_its_family() {
    let sandbox = with_models();
    let outcome = sandbox.call("run book.obj --algo mmp,vtp,vtp-family --repeat 1 -o r.json");
    assert_eq!(outcome.code, 2, "{}", outcome.stderr);
    let (algorithms, _) = cells_and_notes(&sandbox.json("r.json"), "book");
    assert_eq!(algorithms, ["mmp", "vtp", "vtp-mmp", "vtp-ch"]);
    let verified = sandbox.call("verify book.obj --algo mmp,vtp,vtp-family");
    assert_eq!(verified.code, 1);
    assert!(
        verified.stdout.contains("vtp: FAILED: vtp: edges"),
        "{}",
        verified.stdout
    );
    assert!(
        verified.stdout.contains("ftp: left out"),
        "{}",
        verified.stdout
    );
    // If nothing else would be left, the model is refused.
    let outcome = sandbox.call("run book.obj --algo voronoi-family --repeat 1");
    assert_eq!(outcome.code, 2, "{}", outcome.stderr);
    assert!(
        outcome
            .stderr
            .contains("which Voronoi diagrams and remeshing do not cross")
            && !outcome.stderr.contains("use mmp-fast"),
        "{}",
        outcome.stderr
    );
    // Another reference takes the place of one that is left out.
    let outcome = sandbox.call("run book.obj --algo vtp-family,mmp,all --repeat 1 -o r.json");
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    let result = sandbox.json("r.json");
    for cell in result["cells"].as_array().unwrap() {
        assert_eq!(cell["status"], "ok", "{cell}");
        assert!(cell["check"]["reference"].is_string(), "{cell}");
    }
    let outcome = sandbox.call("run book.obj --algo lc-mmp,vtp-family --target 5 --repeat 1");
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
}

#[test]
fn parts_and_continued_runs_leave_out_the_same() {
    let sandbox = with_models();
    let models = "gen:sphere,subdiv=1 book.obj moebius.obj --source 0,2";
    let run = format!(
        "run {models} --algo vtp,ich,mmp-family,fwp-ch,ftp,voronoi-family \
        --repeat 1 --check mmp"
    );
    let refused = |name: &str| {
        let outcome = sandbox.call(&format!("{run} {name}"));
        assert_eq!(outcome.code, 2, "{}", outcome.stderr);
        outcome
    };
    refused("-o whole.json");
    let keys = |file: &str| -> Vec<String> {
        let result = sandbox.json(file);
        let cells = result["cells"].as_array().unwrap().iter();
        cells
            .map(|c| {
                format!(
                    "{} {} {} {}",
                    c["model"], c["source"], c["algorithm"], c["status"]
                )
            })
            .collect()
    };
    let whole = keys("whole.json");
    assert!(whole.iter().any(|key| key.contains("lct11")), "{whole:?}");
    assert!(
        !whole
            .iter()
            .any(|key| key.contains("book") && key.contains("lct11")),
        "{whole:?}"
    );
    for part in 1..=3 {
        refused(&format!("--shard {part}/3 -o {part}.json"));
    }
    let merged = sandbox.call("merge 3.json 1.json 2.json -o merged.json");
    assert_eq!(merged.code, 2, "{}", merged.stderr);
    assert_eq!(keys("merged.json"), whole);
    let notes = |file: &str| cells_and_notes(&sandbox.json(file), "book").1;
    assert_eq!(notes("merged.json"), notes("whole.json"));
    refused("--resume j.jsonl -o first.json");
    let before = sandbox.read("j.jsonl").lines().count();
    refused("--resume j.jsonl -o second.json");
    // Only the new session is added.
    assert_eq!(sandbox.read("j.jsonl").lines().count(), before + 1);
    assert_eq!(keys("second.json"), whole);
    // What is named later gets its cells.
    sandbox.call("run book.obj --algo mmp,vtp-family --repeat 1 -o grown.json");
    let outcome = sandbox.call("run book.obj --algo ftp,mmp --repeat 1 --add-to grown.json");
    assert_eq!(outcome.code, 2, "{}", outcome.stderr);
    let (algorithms, _) = cells_and_notes(&sandbox.json("grown.json"), "book");
    assert_eq!(algorithms, ["mmp", "vtp-mmp", "vtp-ch", "ftp"]);
}
