//! Sources and targets anywhere on the surface.

use serde_json::json;

use crate::support::Sandbox;

/// Half the diagonal of the square.
const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

fn numbers(value: &serde_json::Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|x| x.as_f64().unwrap()).collect()
}

fn close(found: &[f64], expected: &[f64]) -> bool {
    let mut pairs = found.iter().zip(expected);
    found.len() == expected.len() && pairs.all(|(a, b)| (a - b).abs() <= 1e-14)
}

#[test]
fn every_form_of_source_has_its_distances() {
    let sandbox = Sandbox::with_square();
    let centre = [HALF; 4];
    for (source, expected, note) in [
        ("1", [1.0, 0.0, 1.0, 2.0_f64.sqrt()], ""),
        ("first", [0.0, 1.0, 2.0_f64.sqrt(), 1.0], ""),
        ("edge:0-2,0.5", centre, ""),
        (
            "face:0,0.5,0,0.5",
            centre,
            "face:0,0.5,0,0.5 is edge:2-0,0.5",
        ),
        (
            "at:0.5,0.5,1",
            centre,
            "at:0.5,0.5,1 is 1 from the surface; its nearest point is edge:2-0,0.5",
        ),
        (
            "far:0.5,0.5,2",
            centre,
            "far:0.5,0.5,2 is 2 from the surface; its nearest point is edge:2-0,0.5",
        ),
        (
            "at:1,1,0",
            [2.0_f64.sqrt(), 1.0, 0.0, 1.0],
            "at:1,1,0 is on the surface, vertex 2",
        ),
        (
            "face:1,0.5,0.25,0.25",
            [
                0.5_f64.hypot(0.25),
                0.75_f64.hypot(0.5),
                0.75_f64.hypot(0.5),
                0.5_f64.hypot(0.25),
            ],
            "",
        ),
        ("all", [0.0; 4], ""),
        ("random:4,seed=9", [0.0; 4], ""),
    ] {
        let said = sandbox.call(&format!("distance square.off --source {source} -o d.json"));
        let field = sandbox.json("d.json");
        let found = numbers(&field["distances"]);
        assert!(close(&found, &expected), "{source}: {found:?}");
        assert!(said.stdout.starts_with("d.json: 4 vertices"), "{said:?}");
        let expected = match note {
            "" => String::new(),
            note => format!("geobench: note: {note}\n"),
        };
        assert_eq!((said.code, said.stderr), (0, expected), "{source}");
    }
    sandbox.succeed("distance square.off --source 1 --source edge:0-3,0.5 -o d.json");
    let field = sandbox.json("d.json");
    assert_eq!(field["sources"], json!([1, "edge:0-3,0.5"]));
    assert!(close(&numbers(&field["distances"]), &[0.5, 0.0, 1.0, 0.5]));
}

#[test]
fn a_position_farther_away_than_the_size_of_the_model_must_be_meant() {
    let sandbox = Sandbox::with_square();
    let far = "--source 0 --target at:0,0,9";
    for (command, options) in [
        ("distance", format!("{far} -o d.csv")),
        ("path", format!("{far} -o p.json")),
        (
            "isolines",
            "--source at:0,0,9 --every 0.1 -o i.json".to_owned(),
        ),
        ("voronoi", "--source 0,at:0,0,9 -o v.json".to_owned()),
        ("certify", "--source at:0,0,9".to_owned()),
        ("run", "--source at:0,0,9 --algo mmp --repeat 1".to_owned()),
        ("verify", format!("{far} --algo vtp")),
    ] {
        let call = format!("{command} square.off {options}");
        let said = sandbox.call(&call);
        assert_eq!(said.code, 2, "{call}: {said:?}");
        assert!(
            said.stderr
                .contains("at:0,0,9 is 9 from the surface, whose size is 1.414")
        );
        assert!(
            said.stderr
                .contains("; far:0,0,9 or the option --far accepts that"),
            "{said:?}"
        );
        let said = sandbox.call(&format!("{call} --far"));
        assert_eq!(said.code, 0, "{call}: {said:?}");
        // Targets of `verify` have no notes.
        if command != "verify" {
            assert!(
                said.stderr.contains("far:0,0,9 is 9 from the surface; its"),
                "{said:?}"
            );
        }
    }
}

#[test]
fn distances_are_limited_to_targets_and_radius() {
    let sandbox = Sandbox::with_square();
    let said = sandbox.succeed(
        "distance square.off --source 1 --target 0 --target edge:0-3,0.5 \
         --target face:1,0.5,0.25,0.25 -o d.csv",
    );
    assert!(
        said.starts_with("d.csv: 3 targets, 0 unreachable, the farthest is edge:0-3,0.5 at 1.118")
    );
    let csv = sandbox.read("d.csv");
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[..2], ["target,distance", "0,1"]);
    assert!(lines[2].starts_with("\"edge:0-3,0.5\",1.118"), "{csv}");
    assert!(
        lines[3].starts_with("\"face:1,0.5,0.25,0.25\",0.9013"),
        "{csv}"
    );

    sandbox.write("t.txt", "# two\n3\n\nat:0.5,0.5,0\n");
    sandbox.succeed("distance square.off --source 1 --targets t.txt --target 2 -o d.json");
    let field = sandbox.json("d.json");
    assert_eq!(field["targets"], json!([2, 3, "at:0.5,0.5,0"]));
    assert_eq!(field["vertices"], 4);
    assert!(close(
        &numbers(&field["distances"]),
        &[1.0, 2.0_f64.sqrt(), HALF]
    ));

    sandbox.succeed("distance square.off --source 1 --radius 1.2 -o d.csv");
    assert_eq!(
        sandbox.read("d.csv"),
        "vertex,distance\n0,1\n1,0\n2,1\n3,inf\n"
    );
    sandbox.succeed("distance square.off --source 1 --radius 1.2 --target 3 -o d.json");
    let field = sandbox.json("d.json");
    assert_eq!(
        (&field["unreachable"], &field["radius"]),
        (&json!(1), &json!(1.2))
    );

    sandbox.succeed("distance square.off --source 1 --target 3 -o d.npy");
    let npy = std::fs::read(sandbox.path("d.npy")).unwrap();
    let last = f64::from_le_bytes(npy[npy.len() - 8..].try_into().unwrap());
    assert!(npy.len() == 128 + 8 && close(&[last], &[2.0_f64.sqrt()]));
}

#[test]
fn sources_come_from_files_in_every_command() {
    let sandbox = Sandbox::with_square();
    // As other systems write it, and as `distance` does.
    sandbox.write("s.txt", "\u{feff}1\r\n\r\n\"edge:0-3,0.5\" # an edge\r\n");
    sandbox.write("table.csv", "source,0,1\n1,1,0\n\"edge:0-3,0.5\",0.5,1.1\n");
    sandbox.succeed("distance square.off --source 1 --source edge:0-3,0.5 -o named.csv");
    for file in ["s.txt", "table.csv"] {
        sandbox.succeed(&format!("distance square.off --sources {file} -o read.csv"));
        assert_eq!(sandbox.read("read.csv"), sandbox.read("named.csv"));
    }
    let mut piped = sandbox.command("distance square.off --sources - -o read.csv");
    piped.write_stdin("1\nedge:0-3,0.5\n").assert().success();
    assert_eq!(sandbox.read("read.csv"), sandbox.read("named.csv"));
    for arguments in ["-", "square.off --targets -"] {
        let options = "--input-format off --sources - -o read.csv";
        let mut twice = sandbox.command(&format!("distance {arguments} {options}"));
        let said = twice.write_stdin("1\n").output().unwrap();
        let error = String::from_utf8(said.stderr).unwrap();
        let problem = "-: two arguments are standard input, which can be read once; name a file";
        assert!(
            said.status.code() == Some(2) && error.contains(problem),
            "{error}"
        );
    }

    sandbox.succeed("distance square.off --source 2 --sources s.txt --each --matrix -o m.csv");
    let rows: Vec<String> = (sandbox.read("m.csv").lines())
        .map(|line| line.split(',').next().unwrap().to_owned())
        .collect();
    assert_eq!(rows, ["source", "2", "1", "\"edge:0-3"]);

    sandbox.write("t.txt", "3\n0\n");
    sandbox.succeed("path square.off --sources s.txt --targets t.txt --target 2 -o p.json");
    let paths = sandbox.json("p.json")["paths"].clone();
    let ends = paths.as_array().unwrap().iter();
    let ends: Vec<_> = ends
        .map(|path| (&path["source"], &path["target"]))
        .collect();
    let edge = json!("edge:0-3,0.5");
    assert_eq!(
        ends,
        [
            (&json!(1), &json!(2)),
            (&edge, &json!(3)),
            (&edge, &json!(0))
        ]
    );

    for call in [
        "isolines square.off --every 0.4",
        "voronoi square.off",
        "run square.off --algo mmp --repeat 1 --quiet",
    ] {
        sandbox.succeed(&format!("{call} --source 1,edge:0-3,0.5 -o named.json"));
        sandbox.succeed(&format!("{call} --sources s.txt -o read.json"));
        let [named, read] = ["named.json", "read.json"].map(|file| {
            let json = sandbox.json(file);
            let sources: Vec<_> = json["cells"].as_array().into_iter().flatten().collect();
            let sources: Vec<_> = sources.iter().map(|cell| cell["source"].clone()).collect();
            (sources, json["sources"].clone(), json["levels"].clone())
        });
        assert_eq!(named, read, "{call}");
    }
    sandbox.write(
        "suite.toml",
        "[[group]]\nname = \"a\"\nmodels = [\"square.off\"]\nalgorithms = [\"mmp\"]\nsources = \"s.txt\"\nrepeat = 1\n",
    );
    sandbox.succeed("run --config suite.toml --quiet -o read.json");
    assert_eq!(sandbox.json("read.json")["cells"][1]["source"], edge);
    for command in ["certify", "verify --algo mmp"] {
        sandbox.succeed(&format!("{command} square.off --sources s.txt"));
    }

    sandbox.write("bad.txt", "0\nedge:1-3,0.5\n");
    sandbox.write("worse.txt", "0\n\nx\n");
    sandbox.write("none.txt", "# none\n");
    for (file, message) in [
        ("bad.txt", "bad.txt, line 2: edge:1-3,0.5: no edge joins"),
        ("worse.txt", "worse.txt, line 3: `x` is not a source"),
        (
            "none.txt",
            "none.txt: there is no source in it; write one in each line",
        ),
        ("gone.txt", "gone.txt: "),
    ] {
        let said = sandbox.call(&format!("distance square.off --sources {file} -o d.csv"));
        assert!(said.code == 2 && said.stderr.contains(message), "{said:?}");
    }
}

#[test]
fn pairs_are_lines_of_a_file() {
    let sandbox = Sandbox::with_square();
    sandbox.write(
        "p.txt",
        "0 3\n1,3 # the other diagonal\n\n\"edge:0-3,0.5\",1\nface:1,0.5,0.25,0.25 1\n1,1\n",
    );
    let said = sandbox.succeed("distance square.off --pairs p.txt --threads 2 -o d.csv");
    assert!(
        said.starts_with("d.csv: 5 pairs, 0 unreachable, the farthest is vertex 1 to 3 at 1.414"),
        "{said}"
    );
    let csv = sandbox.read("d.csv");
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[..2], ["source,target,distance", "0,3,1"]);
    assert!(lines[2].starts_with("1,3,1.414"), "{csv}");
    assert!(lines[3].starts_with("\"edge:0-3,0.5\",1,1.118"), "{csv}");
    assert!(
        lines[4].starts_with("\"face:1,0.5,0.25,0.25\",1,0.901"),
        "{csv}"
    );
    assert_eq!(lines[5], "1,1,0");

    // What it writes it reads.
    sandbox.succeed("distance square.off --pairs d.csv --radius 1.2 -o again.json");
    let json = sandbox.json("again.json");
    assert_eq!(
        (&json["pairs"], &json["unreachable"]),
        (&json!(true), &json!(1))
    );
    assert_eq!(
        json["sources"],
        json!([0, 1, "edge:0-3,0.5", "face:1,0.5,0.25,0.25", 1])
    );
    assert_eq!(json["targets"], json!([3, 3, 1, 1, 1]));
    assert_eq!(
        (&json["distances"][0], &json["distances"][1]),
        (&json!(1.0), &json!(null))
    );
    sandbox.succeed("distance square.off --pairs d.csv -o d.npy");
    assert_eq!(
        std::fs::read(sandbox.path("d.npy")).unwrap().len(),
        128 + 5 * 8
    );

    sandbox.write("bad.txt", "0,1\n0,9\n");
    sandbox.write("three.txt", "0,1,2\n");
    for (arguments, message) in [
        ("--pairs bad.txt -o x.csv", "bad.txt, line 2: "),
        (
            "--pairs three.txt -o x.csv",
            "three.txt, line 1: a pair is two points",
        ),
        (
            "--pairs p.txt -o x.ply",
            "a mesh has distances of all vertices",
        ),
        ("--pairs p.txt --source 1 -o x.csv", "cannot be used with"),
        (
            "--pairs p.txt --targets p.txt -o x.csv",
            "cannot be used with",
        ),
        ("--pairs p.txt --each -o x.csv", "cannot be used with"),
        ("--pairs p.txt --matrix -o x.csv", "cannot be used with"),
        ("-o x.csv", "--source"),
    ] {
        let said = sandbox.call(&format!("distance square.off {arguments}"));
        assert!(said.code == 2 && said.stderr.contains(message), "{said:?}");
    }
}

#[test]
fn curves_and_borders_are_sources_of_mmp_alone() {
    let sandbox = Sandbox::with_square();
    // From the middle of the diagonal to the middle of a side, and back.
    sandbox.write(
        "c.txt",
        "edge:0-2,0.5\nedge:0-1,0.5 # there\nedge:0-2,0.5\n",
    );
    sandbox.write("side.txt", "0\n1\n");
    let distances = |arguments: &str| {
        sandbox.succeed(&format!(
            "distance square.off {arguments} -o d.json --quiet"
        ));
        let json = sandbox.json("d.json");
        assert_eq!(json["algorithm"], "mmp");
        numbers(&json["distances"])
    };
    assert!(close(&distances("--curve c.txt"), &[0.5, 0.5, HALF, HALF]));
    assert!(close(
        &distances("--curve side.txt --algo mmp"),
        &[0.0, 0.0, 1.0, 1.0]
    ));
    assert!(close(&distances("--borders"), &[0.0; 4]));
    let found = distances("--curve c.txt --curve side.txt --source 3");
    assert!(close(&found, &[0.0, 0.0, HALF, 0.0]));
    assert_eq!(
        sandbox.json("d.json")["sources"],
        json!([3, "curve:c.txt", "curve:side.txt"])
    );
    let said = sandbox.succeed("distance square.off --curve c.txt --radius 0.6 -o d.csv");
    assert!(said.contains("2 unreachable"), "{said}");

    sandbox.write("apart.txt", "1\n\n3\n");
    sandbox.write("bad.txt", "0\n9\n");
    sandbox.write("list.txt", "0,1\n");
    for (arguments, message) in [
        (
            "--curve c.txt --algo vtp",
            "sources of vtp are points; mmp starts from curves",
        ),
        ("--borders --algo mmp{queue=fifo}", "mmp starts from curves"),
        (
            "--curve apart.txt",
            "apart.txt, line 3: no face contains the points 0 and 1",
        ),
        (
            "--curve bad.txt",
            "bad.txt, line 2: 9: vertex 9 does not exist",
        ),
        (
            "--curve list.txt",
            "list.txt, line 1: a line of a curve has one point",
        ),
        ("--curve gone.txt", "gone.txt: "),
        ("--curve c.txt --target 1", "cannot be used with"),
        ("--borders --pairs c.txt", "cannot be used with"),
        ("--borders --matrix", "cannot be used with"),
        ("--curve c.txt --source 0 --matrix", "cannot be used with"),
    ] {
        let said = sandbox.call(&format!("distance square.off {arguments} -o x.csv"));
        assert!(said.code == 2 && said.stderr.contains(message), "{said:?}");
    }
    let said = sandbox.call("distance gen:sphere,subdiv=1 --borders -o x.csv");
    assert!(
        said.code == 2 && said.stderr.contains("two faces or more"),
        "{said:?}"
    );
}

#[test]
fn targets_are_the_same_with_every_algorithm_and_thread() {
    let sandbox = Sandbox::new();
    let command = "distance gen:torus,faces=2000,bump=0.2,seed=3 --source face:7,0.2,0.3,0.5 \
        --target far:9,9,9 --target random:5 --target edge:0-1,0.25 -o d.json --quiet --algo";
    sandbox.succeed(&format!("{command} mmp"));
    let expected = numbers(&sandbox.json("d.json")["distances"]);
    for algorithm in [
        "vtp-fast",
        "vtp",
        "ich",
        "fwp-mmp",
        "lc-ch",
        "pvtp --threads 2",
    ] {
        sandbox.succeed(&format!("{command} {algorithm}"));
        let found = numbers(&sandbox.json("d.json")["distances"]);
        assert!(close(&found, &expected), "{algorithm}: {found:?}");
    }
}

#[test]
fn a_matrix_has_a_row_for_each_source() {
    let sandbox = Sandbox::with_square();
    let said = sandbox.succeed(
        "distance square.off --source 0,edge:0-2,0.5 --each --matrix --threads 2 -o m.csv",
    );
    assert_eq!(said, "m.csv: 2 x 4 distances, 0 unreachable\n");
    let csv = sandbox.read("m.csv");
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[0], "source,0,1,2,3");
    assert!(lines[1].starts_with("0,0,1,1.414"), "{csv}");
    assert!(
        lines[2].starts_with("\"edge:0-2,0.5\",0.7071067811865"),
        "{csv}"
    );

    sandbox.succeed("distance square.off --source all --each --matrix --target 2 -o m.npy");
    let npy = std::fs::read(sandbox.path("m.npy")).unwrap();
    assert!(npy[10..].starts_with(b"{'descr': '<f8', 'fortran_order': False, 'shape': (4, 1), }"));
    let last: Vec<f64> = npy[npy.len() - 16..]
        .chunks(8)
        .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
        .collect();
    assert_eq!(last, [0.0, 1.0]);
}

#[test]
fn rows_of_a_matrix_do_not_depend_on_threads() {
    let sandbox = Sandbox::new();
    let matrix = |threads: u32, file: &str| {
        sandbox.succeed(&format!(
            "distance gen:torus,faces=200 --source all --each --matrix --threads {threads} \
             --quiet -o {file}"
        ));
        sandbox.bytes(file)
    };
    for form in ["csv", "npy"] {
        let one = matrix(1, &format!("one.{form}"));
        assert!(one.len() > 1000);
        for threads in [2, 3] {
            assert_eq!(matrix(threads, &format!("several.{form}")), one);
        }
    }
}

#[test]
fn each_source_has_a_file_of_its_own() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("distance square.off --source 1,edge:0-2,0.5 --each -o d.csv");
    assert!(
        sandbox
            .read("d.s1.csv")
            .starts_with("vertex,distance\n0,1\n")
    );
    assert!(sandbox.read("d.sedge-0-2_0.5.csv").contains("0.7071"));
}

#[test]
fn invalid_points_are_named() {
    let sandbox = Sandbox::with_square();
    sandbox.write("bad.txt", "0\n\nedge:1-3,0.5\n");
    sandbox.write("worse.txt", "0\nx\n");
    sandbox.write("none.txt", "# none\n");
    for (arguments, message) in [
        ("--source x -o d.csv", "`x` is not a source: give"),
        ("--source 9 -o d.csv", "source vertex 9 does not exist"),
        (
            "--source edge:1-3,0.5 -o d.csv",
            "edge:1-3,0.5: no edge joins the vertices 1 and 3",
        ),
        (
            "--source edge:0-1,1.5 -o d.csv",
            "edge:0-1,1.5: 1.5 is not a place on an edge: give a number from 0 to 1",
        ),
        (
            "--source face:2,1,0,0 -o d.csv",
            "face:2,1,0,0: face 2 does not exist: the mesh has 2 faces, numbered from 0",
        ),
        (
            "--source face:0,0.5,0.7,0.1 -o d.csv",
            "the barycentric coordinates have the sum 1.3, not 1",
        ),
        (
            "--source face:0,-0.5,0.5,1 -o d.csv",
            "the barycentric coordinate -0.5 is not a number from 0 to 1",
        ),
        (
            "--source at:1,2,nan -o d.csv",
            "`at:1,2,nan` is not a source",
        ),
        (
            "--source 0 --target 7 -o d.csv",
            "target vertex 7 does not exist",
        ),
        (
            "--source 0 --target y -o d.csv",
            "`y` is not a target: give",
        ),
        (
            "--source 0 --targets bad.txt -o d.csv",
            "bad.txt, line 3: edge:1-3,0.5: no edge joins the vertices 1 and 3",
        ),
        (
            "--source 0 --targets worse.txt -o d.csv",
            "worse.txt, line 2: `x` is not a target",
        ),
        (
            "--source 0 --targets none.txt -o d.csv",
            "none.txt: there is no target in it; write one in each line",
        ),
        ("--source 0 --targets gone.txt -o d.csv", "gone.txt: "),
        (
            "--source 0 --radius -1 -o d.csv",
            "a number of 0 or more is expected",
        ),
        (
            "--source 0 --target 1 -o d.ply",
            "d.ply: a mesh has distances of all vertices",
        ),
        ("--source 0 --matrix -o d.csv", "--each"),
        ("--source 0 --each --matrix -o d.vtk", "d.vtk"),
    ] {
        let outcome = sandbox.call(&format!("distance square.off {arguments}"));
        assert_eq!(outcome.code, 2, "{arguments}: {}", outcome.stderr);
        assert!(
            outcome.stderr.contains(message),
            "{arguments}: {}",
            outcome.stderr
        );
    }
}

#[test]
fn run_takes_points_and_names_them_in_results() {
    let sandbox = Sandbox::with_square();
    for isolation in ["process", "none"] {
        let said = sandbox.succeed(&format!(
            "run square.off --source 1 --source edge:0-2,0.5,at:0,0,1 --algo mmp,vtp --repeat 1 \
             --isolate {isolation} --quiet -o r.json -o r.csv"
        ));
        let cells = sandbox.json("r.json")["cells"].clone();
        let sources: Vec<_> = cells
            .as_array()
            .unwrap()
            .iter()
            .map(|c| &c["source"])
            .collect();
        let expected = [json!(1), json!("edge:0-2,0.5"), json!("at:0,0,1")];
        let expected: Vec<_> = expected.iter().flat_map(|s| [s, s]).collect();
        assert_eq!(sources, expected, "{said}");
        for cell in cells.as_array().unwrap() {
            assert_eq!(cell["status"], "ok", "{cell}");
            assert_eq!(cell["check"]["reference"], "mmp", "{cell}");
            assert_eq!(cell["check"]["compared"], 4, "{cell}");
        }
        let note = "at:0,0,1 is 1 from the surface; its nearest point is vertex 0";
        assert_eq!(cells[4]["message"], note);
        assert!(sandbox.read("r.csv").contains("\"edge:0-2,0.5\""));
    }
}

#[test]
fn sources_together_are_one_run() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed(
        "run square.off --source 1,edge:0-2,0.5 --sources-together --algo mmp,vtp --repeat 1 \
         --quiet -o r.json",
    );
    let result = sandbox.json("r.json");
    let sources: Vec<_> = (0..3)
        .map(|i| result["cells"][i]["source"].clone())
        .collect();
    assert_eq!(
        sources,
        [
            json!("1,edge:0-2,0.5"),
            json!("1,edge:0-2,0.5"),
            json!(null)
        ]
    );
    assert_eq!(result["plan"]["groups"][0]["sources_together"], true);
    // A suite can also set it.
    sandbox.write(
        "suite.toml",
        "[[group]]\nname = \"g\"\nmodels = [\"square.off\"]\nalgorithms = [\"vtp\"]\n\
         source = [1, \"face:0,0.5,0.25,0.25\"]\nsources-together = true\nrepeat = 1\n",
    );
    sandbox.succeed("run --config suite.toml --quiet -o s.json");
    let cells = sandbox.json("s.json")["cells"].clone();
    assert_eq!(cells.as_array().unwrap().len(), 1);
    assert_eq!(cells[0]["source"], "1,face:0,0.5,0.25,0.25");
}

#[test]
fn a_journal_and_shards_know_points() {
    let sandbox = Sandbox::with_square();
    let command = "run square.off --source 3,edge:0-2,0.5 --algo mmp,vtp --repeat 2 --quiet";
    sandbox.succeed(&format!("{command} --resume j -o a.json"));
    let lines = sandbox.read("j").lines().count();
    sandbox.succeed(&format!("{command} --resume j -o b.json"));
    // Only the line of a session was added.
    assert_eq!(sandbox.read("j").lines().count(), lines + 1);
    assert_eq!(
        sandbox.json("a.json")["cells"],
        sandbox.json("b.json")["cells"]
    );
    // A nearby point is a different source, so its runs are not resumed.
    let other = "run square.off --source 3,edge:0-2,0.4 --algo mmp,vtp --repeat 2 --quiet";
    sandbox.succeed(&format!("{other} --resume j -o c.json"));
    assert!(sandbox.read("j").lines().count() > lines + 2);
    let cells = sandbox.json("c.json")["cells"].as_array().unwrap().clone();
    let nearby = cells.iter().filter(|cell| cell["source"] == "edge:0-2,0.4");
    assert_eq!(nearby.count(), 2);

    for source in [
        "all",
        "1,edge:0-2,0.5,face:0,0.5,0.25,0.25",
        "all --sources-together",
    ] {
        for part in ["1/2", "2/2"] {
            let name = &part[..1];
            sandbox.succeed(&format!(
                "run square.off gen:cube,n=1 --source {source} --algo mmp --repeat 1 --quiet \
                 --shard {part} -o p{name}.json"
            ));
        }
        sandbox.succeed("merge p1.json p2.json -o whole.json");
        let whole = sandbox.json("whole.json");
        let count = match source {
            "all" => 4 + 8,
            "all --sources-together" => 2,
            _ => 6,
        };
        assert_eq!(whole["cells"].as_array().unwrap().len(), count, "{source}");
    }
}

#[test]
fn verify_takes_points() {
    let sandbox = Sandbox::with_square();
    let said = sandbox.succeed(
        "verify square.off --source edge:0-2,0.5 --source face:0,0.5,0.25,0.25 --algo vtp,ich",
    );
    assert!(
        said.contains("square: source edge:0-2,0.5: vtp: ok: agrees with mmp"),
        "{said}"
    );
    assert!(
        said.contains("square: source face:0,0.5,0.25,0.25: ich: ok"),
        "{said}"
    );
    assert!(said.ends_with("6 of 6 answers agree\n"), "{said}");
}

#[test]
fn a_point_that_is_not_there_costs_its_cells() {
    let sandbox = Sandbox::with_square();
    for isolation in ["process", "none"] {
        let outcome = sandbox.call(&format!(
            "run square.off --source 1,edge:1-3,0.5 --algo mmp,vtp --repeat 1 --quiet \
             --isolate {isolation} -o r.json"
        ));
        assert_eq!(outcome.code, 2, "{}", outcome.stderr);
        let cells = sandbox.json("r.json")["cells"].clone();
        let status: Vec<_> = (0..4).map(|i| cells[i]["status"].clone()).collect();
        assert_eq!(
            status,
            ["ok", "ok", "refused", "refused"],
            "{}",
            outcome.stderr
        );
        let message = cells[2]["message"].as_str().unwrap();
        assert!(
            message.contains("edge:1-3,0.5: no edge joins the vertices 1 and 3"),
            "{message}"
        );
    }
}

#[test]
fn a_source_named_twice_is_one_source() {
    let sandbox = Sandbox::with_square();
    sandbox.write(
        "suite.toml",
        "[[group]]\nname = \"twice\"\nmodels = [\"square.off\"]\nalgorithms = [\"vtp\"]\n\
         source = [1, 3, 1]\nrepeat = 1\n",
    );
    for (command, twice) in [
        (
            "distance square.off",
            "--source 1 --source 3 --source 1 -o d.json",
        ),
        ("distance square.off --each", "--source 1,3,1 -o d.json"),
        ("path square.off --target 0", "--source 1,3,1 -o p.json"),
        (
            "isolines square.off --levels 0.5",
            "--source 1,3,1 -o i.json",
        ),
        ("voronoi square.off", "--source 1,3 --source 1 -o v.json"),
        ("certify square.off", "--source 1,3,1"),
        ("verify square.off --algo vtp", "--source 1 --source 3,1"),
        (
            "run square.off --algo vtp --repeat 1",
            "--source 1,3,1 -o r.json",
        ),
        ("run --config suite.toml", "-o r.json"),
    ] {
        let outcome = sandbox.call(&format!("{command} {twice}"));
        assert_eq!(outcome.code, 0, "{command}: {}", outcome.stderr);
        let note = ": source vertex 1 is named twice and counts once\n";
        assert_eq!(
            outcome.stderr.matches(note).count(),
            1,
            "{command}: {}",
            outcome.stderr
        );
    }
    assert_eq!(sandbox.json("v.json")["cells"].as_array().unwrap().len(), 2);
    assert_eq!(sandbox.json("r.json")["cells"].as_array().unwrap().len(), 2);
    let point = "face:1,0.5,0.25,0.25";
    let outcome = sandbox.call(&format!(
        "distance square.off --source {point},{point} -o d.json"
    ));
    let note = format!("geobench: note: source {point} is named twice and counts once\n");
    assert_eq!((outcome.code, outcome.stderr), (0, note));
}

#[test]
fn runs_start_in_the_largest_component() {
    let sandbox = Sandbox::new();
    // A triangle, an isolated vertex and a square.
    sandbox.write(
        "parts.off",
        "OFF 8 3 0\n9 0 0\n8 0 0\n9 1 0\n7 7 7\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n\
         3 0 1 2\n3 4 5 6\n3 4 6 7\n",
    );
    let said = sandbox.call("run parts.off --algo mmp,vtp --repeat 1 -o r.json");
    assert_eq!(said.code, 0, "{said:?}");
    let note = "source 4 is in the largest of 2 components, with 4 of 8 vertices";
    assert!(said.stdout.contains(note), "{said:?}");
    let result = sandbox.json("r.json");
    assert_eq!(result["plan"]["groups"][0]["sources"], "largest");
    assert_eq!(result["cells"][0]["source"], 4);
    let largest = json!({"first": 4, "vertices": 4});
    assert_eq!(result["models"][0]["largest_component"], largest);
    let said = sandbox.succeed("run parts.off --algo mmp,vtp --repeat 1 --source 0");
    assert!(!said.contains("the largest of"), "{said}");
    let note = "connected with the source: 3 of 8 vertices; 2 components";
    assert!(said.contains(note), "{said}");
    sandbox.succeed(
        "run parts.off --source 1,largest --sources-together --algo mmp --repeat 1 -o t.json",
    );
    assert_eq!(sandbox.json("t.json")["cells"][0]["source"], "1,4");
    // In one component it is vertex 0.
    sandbox.succeed("run gen:grid,n=2 --algo mmp --repeat 1 -o g.json");
    let result = sandbox.json("g.json");
    assert_eq!(result["cells"][0]["source"], 0);
    assert!(result["models"][0].get("largest_component").is_none());
    let said = sandbox.call("distance parts.off --source largest -o d.csv");
    let note = "source 4 is in a component of 4 of 8 vertices; 2 components";
    assert!(said.stderr.contains(note), "{said:?}");
    let said = sandbox.call("verify parts.off --source largest --algo vtp");
    let line = "parts: source 4: mmp-fast: ok: reference for 8 vertices, 4 unreachable";
    assert!(said.stdout.contains(line), "{said:?}");
    assert!(said.stderr.contains(note), "{said:?}");
    let said = sandbox.call("verify parts.off --source largest --algo vtp --radius 1");
    assert!(!said.stderr.contains("in a component"), "{said:?}");
    let said = sandbox.succeed("certify parts.off --source largest");
    assert!(
        said.contains("8 of 8 vertices compared, 100.000 %; 4 unreachable"),
        "{said}"
    );
    // Several sources, in one component, in all, or each for itself.
    for (arguments, note) in [
        (
            "0,2",
            "the sources are in 1 of 2 components, with 3 of 8 vertices",
        ),
        (
            "0,3",
            "the sources are in 1 of 2 components, with 4 of 8 vertices",
        ),
        (
            "face:0,0.25,0.25,0.5,0",
            "the sources are in 1 of 2 components, with 3 of 8 vertices",
        ),
        (
            "0,4,5 --each",
            "each source is in a component of 3 to 4 of 8 vertices; 2 components",
        ),
        (
            "0,1 --each",
            "each source is in a component of 3 of 8 vertices; 2 components",
        ),
    ] {
        let said = sandbox.call(&format!("distance parts.off --source {arguments} -o d.csv"));
        assert!(said.stderr.contains(note), "{arguments}: {said:?}");
    }
    let said = sandbox.call("distance parts.off --source 0,4 -o d.csv");
    assert!(!said.stderr.contains("source"), "{said:?}");
    let said = sandbox.succeed("run parts.off --source 0,4 --algo mmp --repeat 1");
    assert!(
        said.contains("unreachable vertices: 4 to 5, by source"),
        "{said}"
    );
    let said = sandbox.refuse("distance parts.off --source 0 --target largest -o d.csv");
    assert!(said.contains("`largest` is not a target"), "{said}");
}

/// A unit square whose second face is wound against the first one, so that the mesh turns it over.
const TURNED: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 4 3\n";

#[test]
fn coordinates_in_faces_that_are_turned_over_are_those_of_the_file() {
    let sandbox = Sandbox::new();
    sandbox.write("turned.obj", TURNED);
    // 0.1 of (0, 0), 0.2 of (0, 1) and 0.7 of (1, 1).
    sandbox.succeed("distance turned.obj --source face:1,0.1,0.2,0.7 -o d.csv --quiet");
    let distances = sandbox.read("d.csv");
    let distances = distances
        .lines()
        .skip(1)
        .map(|line| line.split_once(',').unwrap().1);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0_f64]];
    for (found, [x, y]) in distances.zip(corners) {
        let right = (x - 0.7).hypot(y - 0.9);
        assert!(
            (found.parse::<f64>().unwrap() - right).abs() < 1e-12,
            "{found} for {right}"
        );
    }
    // What files say of points: each is where its triangle and coordinates in the file put it.
    let triangles = [[0, 1, 2], [0, 3, 2]];
    let is_there = |point: &serde_json::Value, face: &serde_json::Value| {
        let triangle: [usize; 3] = triangles[face.as_u64().unwrap() as usize];
        let weights = point["barycentric"].as_array().unwrap();
        for k in 0..2 {
            let weighted = triangle.iter().zip(weights);
            let place: f64 = weighted
                .map(|(&v, w)| corners[v][k] * w.as_f64().unwrap())
                .sum();
            assert!(
                (point["position"][k].as_f64().unwrap() - place).abs() < 1e-12,
                "{point}"
            );
        }
    };
    sandbox.succeed("path turned.obj --source 1 --target face:1,0.1,0.8,0.1 -o p.json --quiet");
    for point in sandbox.json("p.json")["paths"][0]["points"]
        .as_array()
        .unwrap()
    {
        is_there(point, &point["face"]);
    }
    sandbox.succeed("voronoi turned.obj --source 0 --source 2 --source 3 -o v.json --quiet");
    let diagram = sandbox.json("v.json");
    let vertices = diagram["vertices"].as_array().unwrap();
    assert!(!vertices.is_empty());
    for vertex in vertices {
        is_there(vertex, &vertex["face"]);
    }
    // The centre of an isoline is its source, in the plane of the triangle: from (0, 0) to (0, 1).
    sandbox
        .succeed("isolines turned.obj --source face:1,0.2,0.6,0.2 --levels 0.1 -o i.json --quiet");
    let isolines = sandbox.json("i.json");
    let arcs = isolines["levels"][0]["loops"][0]["arcs"]
        .as_array()
        .unwrap();
    let arc = arcs.iter().find(|arc| arc["face"] == 1).unwrap();
    for (k, right) in [0.8, 0.2].into_iter().enumerate() {
        assert!(
            (arc["centre"][k].as_f64().unwrap() - right).abs() < 1e-9,
            "{arc}"
        );
    }
}
