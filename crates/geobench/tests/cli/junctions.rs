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
fn what_does_not_cross_them_says_so() {
    let sandbox = with_models();
    for (model, why) in [
        ("book.obj", "edges with more than two faces: use mmp-fast"),
        (
            "moebius.obj",
            "a surface that cannot be oriented: use mmp-fast",
        ),
    ] {
        for algorithm in ["vtp", "ich", "heat", "svg"] {
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
        assert!(text.contains("fwp-mmp: ok"), "{text}");
        let outcome = sandbox.call(&format!("run {model} --algo mmp,vtp"));
        assert_eq!(outcome.code, 2, "{}", outcome.stderr);
        let named = format!("vtp: {why}");
        assert!(outcome.stderr.contains(&named), "{}", outcome.stderr);
        assert!(outcome.stdout.contains(&named), "{}", outcome.stdout);
    }
}
