//! Welding, and what commands say about the models that they read.

use serde_json::Value;

use crate::support::Sandbox;

/// A unit square as two triangles that share no vertex. Vertex 3 lies at 0, and 4 at 2.
const SEAM: &str = "\
    v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 4 5 6\n";

const SQRT_2: f64 = std::f64::consts::SQRT_2;

fn with_seam() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("seam.obj", SEAM);
    // The copies are a millionth aside.
    sandbox.write(
        "close.obj",
        &SEAM.replacen("v 0 0 0\nv 1 1 0\nv 0 1", "v 0 1e-6 0\nv 1 1 0\nv 0 1", 1),
    );
    sandbox
}

fn distances(sandbox: &Sandbox, options: &str) -> Vec<Option<f64>> {
    sandbox.succeed(&format!("distance {options} -o d.json"));
    let field = sandbox.json("d.json");
    let list = field["distances"].as_array().unwrap();
    list.iter().map(Value::as_f64).collect()
}

#[test]
fn copies_have_the_distances_of_the_vertices_that_stand_for_them() {
    let sandbox = with_seam();
    let apart = distances(&sandbox, "seam.obj --source 1");
    assert_eq!(apart[3..], [None; 3]);
    let expected = [1.0, 0.0, 1.0, 1.0, 1.0, SQRT_2];
    let is_right = |found: Vec<Option<f64>>| {
        let mut pairs = found.iter().zip(expected);
        pairs.all(|(d, right)| d.is_some_and(|d| (d - right).abs() < 1e-12))
    };
    for algorithm in ["vtp-fast", "mmp", "ich", "pvtp", "svg"] {
        let options = format!("seam.obj --source 1 --weld --algo {algorithm}");
        assert!(is_right(distances(&sandbox, &options)), "{algorithm}");
    }
    // Of vertices at one distance the lowest is named.
    let said = sandbox.succeed("distance seam.obj --source 2 --weld -o d.csv");
    assert!(said.contains("the farthest is vertex 0 at"), "{said}");
    // Sources and targets may be copies.
    let from_copy = distances(&sandbox, "seam.obj --source 4 --weld");
    assert_eq!(from_copy, distances(&sandbox, "seam.obj --source 2 --weld"));
    let targets = "--target 3 --target edge:3-4,0.5 --target face:1,1,0,0";
    let found = distances(&sandbox, &format!("seam.obj --source 1 --weld {targets}"));
    assert_eq!(found.len(), 3);
    assert_eq!([found[0], found[2]], [Some(1.0); 2]);
    assert!((found[1].unwrap() - SQRT_2 / 2.0).abs() < 1e-12);
}

#[test]
fn a_tolerance_joins_vertices_that_are_close() {
    let sandbox = with_seam();
    let of = |weld: &str| distances(&sandbox, &format!("close.obj --source 1 {weld}"));
    assert_eq!(of("--weld")[5], of("--weld=1e-9")[5]);
    assert!(of("--weld=1e-9")[3].is_some_and(|d| d > 1.4));
    assert_eq!(of("--weld=1e-5")[3], Some(1.0));
    for wrong in ["--weld=2", "--weld=-1", "--weld=much"] {
        let said = sandbox.refuse(&format!("distance close.obj --source 1 {wrong} -o d.json"));
        assert!(said.contains("a fraction of the size"), "{said}");
    }
}

/// A value after a blank was taken for a model that does not exist.
#[test]
fn a_tolerance_after_a_blank_is_an_error() {
    let sandbox = with_seam();
    for command in [
        "distance close.obj --source 1 -o d.json --weld 1e-5",
        "info --weld 1e-5 close.obj",
        "run --color never --weld 1e-5 close.obj",
    ] {
        let said = sandbox.refuse(command);
        assert_eq!(
            said, "the value of --weld follows `=` without a blank: write --weld=1e-5",
            "{command}"
        );
    }
    // A model may follow, also one that is named by a number.
    sandbox.write("7", SEAM);
    sandbox.refuse("info --weld 8 seam.obj");
    sandbox.succeed("info --weld seam.obj");
    let said = sandbox.refuse("info --weld 7");
    assert!(!said.contains("blank"), "{said}");
}

#[test]
fn components_and_coincident_vertices_are_noted() {
    let sandbox = with_seam();
    let apart = sandbox.call("distance seam.obj --source 1 -o d.csv");
    for part in [
        "seam: 2 components that are not connected",
        "seam: 2 vertices lie at the place of another (and 0 within 1e-7 of the size; \
         welding would leave 1 component and 4 boundary edges); --weld does it",
        "source 1 is in a component of 3 of 6 vertices; 2 components",
    ] {
        assert!(apart.stderr.contains(part), "{}", apart.stderr);
    }
    let quiet = sandbox.call("distance seam.obj --source 1 -o d.csv --quiet");
    assert_eq!(quiet.stderr, "");
    let info = sandbox.succeed("info seam.obj");
    assert!(info.contains("--weld does it"), "{info}");
    let welded = sandbox.succeed("info seam.obj --weld");
    assert!(welded.contains("components           1"), "{welded}");
    assert!(
        welded.contains("2 vertices were welded to others"),
        "{welded}"
    );
}

#[test]
fn every_command_reads_welded_models() {
    let sandbox = with_seam();
    let said = sandbox.succeed("verify seam.obj --weld --source 4 --algo vtp-fast,mmp,ich");
    assert!(said.contains("seam-weld: source 4: mmp: ok"), "{said}");
    let said = sandbox.succeed("certify seam.obj --weld --source 4");
    assert!(said.contains("seam-weld: certified"), "{said}");
    let said = sandbox.succeed("path seam.obj --weld --source 1 --target 5");
    assert!(said.contains("length 1.414"), "{said}");
    sandbox.succeed("isolines seam.obj --weld --source 4 --every 0.3 -o i.json");
    sandbox.succeed("voronoi seam.obj --weld --source 1,5 -o v.json --labels l.csv");
    let labels = sandbox.read("l.csv");
    let labels: Vec<&str> = labels.lines().skip(1).map(|line| &line[..3]).collect();
    assert_eq!(labels[3][2..], labels[0][2..]);
    assert_eq!(labels[4][2..], labels[2][2..]);
}

#[test]
fn results_with_another_weld_are_not_mixed() {
    let sandbox = with_seam();
    let run = |weld: &str, file: &str| {
        sandbox.succeed(&format!(
            "run seam.obj --algo mmp --repeat 1 {weld} -o {file}"
        ));
        sandbox.json(file)
    };
    let files = [
        run("", "a.json"),
        run("--weld", "b.json"),
        run("--weld=1e-5", "c.json"),
    ];
    let names = ["seam", "seam-weld", "seam-weld=1e-5"];
    for (file, name) in files.iter().zip(names) {
        assert_eq!(file["models"][0]["name"], name);
        assert_eq!(file["cells"][0]["model"], name);
        assert_eq!(
            file["plan"]["groups"][0]["models"][0]["weld"],
            file["models"][0]["weld"]
        );
    }
    assert_eq!(files[2]["models"][0]["weld"], 1e-5);
    let hash = |file: &Value| file["models"][0]["sha256"].clone();
    assert_ne!(hash(&files[0]), hash(&files[1]));
    assert_ne!(hash(&files[1]), hash(&files[2]));
    assert_eq!(sandbox.call("compare a.json b.json").code, 2);
}

#[test]
fn suites_have_a_key() {
    let sandbox = with_seam();
    for (value, name) in [
        ("true", "seam-weld"),
        ("1e-6", "seam-weld=1e-6"),
        ("false", "seam"),
    ] {
        let suite = format!(
            "[[group]]\nname = \"g\"\nmodels = [\"seam.obj\"]\nalgorithms = [\"mmp\"]\n\
             weld = {value}\nrepeat = 1\n"
        );
        sandbox.write("suite.toml", &suite);
        sandbox.succeed("run --config suite.toml -o r.json");
        assert_eq!(sandbox.json("r.json")["models"][0]["name"], name);
    }
    // A group overrides the weld of all groups.
    let suite = "weld = true\n[[group]]\nname = \"g\"\nmodels = [\"seam.obj\"]\n\
                 algorithms = [\"mmp\"]\nweld = false\nrepeat = 1\n";
    sandbox.write("suite.toml", suite);
    sandbox.succeed("run --config suite.toml -o r.json");
    assert_eq!(sandbox.json("r.json")["models"][0]["name"], "seam");
}

#[test]
fn faces_that_are_left_out_keep_their_numbers() {
    let sandbox = Sandbox::new();
    // Face 1 is a segment, and face 2 is face 0 once more.
    sandbox.write(
        "faces.off",
        "OFF\n4 4 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 1 1 2\n3 1 2 0\n3 0 2 3\n",
    );
    let said = sandbox.call("distance faces.off --source 0 -o d.csv");
    assert_eq!(said.code, 0, "{}", said.stderr);
    let note = "faces: 1 face has the same vertices as another and is left out; 1 face has several \
                corners at one vertex and is left out";
    assert!(said.stderr.contains(note), "{}", said.stderr);
    let of = |face: &str| distances(&sandbox, &format!("faces.off --source face:{face}"));
    assert_eq!(of("2,0.2,0.3,0.5"), of("0,0.5,0.2,0.3"));
    assert_eq!(of("3,0,0,1"), distances(&sandbox, "faces.off --source 3"));
    assert_eq!(
        of("1,0.25,0.25,0.5"),
        distances(&sandbox, "faces.off --source edge:1-2,0.5")
    );
    sandbox.succeed("path faces.off --source 3 --target face:3,0.2,0.2,0.6 -o p.json");
    let last = &sandbox.json("p.json")["paths"][0]["points"];
    assert_eq!(last.as_array().unwrap().last().unwrap()["face"], 3);
}

#[test]
fn an_edge_of_the_file_that_welding_has_shrunk_is_a_vertex() {
    let sandbox = with_seam();
    // Vertices 0 and 3 are a millionth apart and become one.
    let at_vertex = distances(&sandbox, "close.obj --weld=1e-5 --source 0");
    let on_edge = distances(&sandbox, "close.obj --weld=1e-5 --source edge:0-3,0.5");
    assert_eq!(at_vertex, on_edge);
    let outcome = sandbox.call("distance close.obj --source edge:0-3,0.5 -o d.csv");
    assert_eq!(outcome.code, 2);
    let message = "no edge joins the vertices 0 and 3";
    assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
}
