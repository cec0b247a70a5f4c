//! `geobench isolines`.

use std::f64::consts::PI;

use crate::support::Sandbox;

/// A square of side 4. Isolines around its centre are circles.
const SQUARE: &str = "OFF\n5 4 0\n0 0 0\n4 0 0\n4 4 0\n0 4 0\n1 2 0\n\
    3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n";

#[test]
fn json_has_arcs_of_circles() {
    let sandbox = Sandbox::new();
    sandbox.write("square.off", SQUARE);
    let said = sandbox.succeed("isolines square.off --source at:2,2,0 --levels 1.5,2.5 -o i.json");
    assert!(
        said.contains("\ni.json: 2 isolines, ") || said.starts_with("i.json: 2 isolines, "),
        "{said}"
    );
    assert!(
        said.contains("distance 1.5: 1 loop, 0 open lines, length 9.42477796076"),
        "{said}"
    );
    assert!(
        said.contains("distance 2.5: 0 loops, 4 open lines"),
        "{said}"
    );
    let file = sandbox.json("i.json");
    assert_eq!(file["schema"], "geobench-isolines/1");
    assert_eq!(file["sources"][0], "at:2,2,0");
    for (level, r) in [(0, 1.5), (1, 2.5)] {
        let level = &file["levels"][level];
        assert_eq!(level["distance"], r);
        let mut length = 0.0;
        for line in level["loops"].as_array().unwrap() {
            assert_eq!(line["closed"], r == 1.5);
            let arcs = line["arcs"].as_array().unwrap();
            let position = |arc: &serde_json::Value, end: &str| {
                [0, 1, 2].map(|k| arc[end][k].as_f64().unwrap())
            };
            for (arc, next) in arcs.iter().zip(&arcs[1..]) {
                let [to, from] = [position(arc, "to"), position(next, "from")];
                assert!((0..3).all(|k| (to[k] - from[k]).abs() < 1e-14), "{line}");
            }
            for arc in arcs {
                for end in ["from", "to"] {
                    let [x, y, z] = position(arc, end);
                    assert!(
                        ((x - 2.0).hypot(y - 2.0) - r).abs() < 1e-14 && z == 0.0,
                        "{arc}"
                    );
                }
                assert_eq!(
                    arc["radius"].as_f64().map(|x| (x - r).abs() < 1e-14),
                    Some(true)
                );
                assert!(arc["face"].as_u64().unwrap() < 4);
            }
            length += line["length"].as_f64().unwrap();
        }
        let expected = if r == 1.5 {
            2.0 * PI * r
        } else {
            4.0 * r * (PI / 2.0 - 2.0 * (2.0_f64 / r).acos())
        };
        assert!((length - expected).abs() < 1e-13, "{length} and {expected}");
    }
}

#[test]
fn lines_keep_the_tolerance() {
    let sandbox = Sandbox::new();
    sandbox.write("square.off", SQUARE);
    let mut counts = Vec::new();
    for tolerance in [0.1, 0.001] {
        let command = format!(
            "isolines square.off --source at:2,2,0 --every 1.5 --tolerance {tolerance} --quiet -o i.obj"
        );
        assert_eq!(sandbox.succeed(&command), "");
        let text = sandbox.read("i.obj");
        let vertices = text.lines().filter_map(|line| line.strip_prefix("v "));
        let points: Vec<Vec<f64>> = vertices
            .map(|line| line.split(' ').map(|x| x.parse().unwrap()).collect())
            .collect();
        counts.push(points.len());
        assert!(text.lines().filter(|line| line.starts_with("l ")).count() >= 1);
        for p in &points {
            let r = (p[0] - 2.0).hypot(p[1] - 2.0);
            assert!((r - 1.5).abs() < 1e-14, "{r}");
        }
    }
    // The chord of a circle of radius 1.5 that is 0.001 away spans 4.2 degrees.
    assert!(counts[0] < 30 && counts[1] > 85, "{counts:?}");
}

#[test]
fn every_form_is_written() {
    let sandbox = Sandbox::new();
    sandbox.write("square.off", SQUARE);
    for (file, start) in [
        ("i.ply", "ply\nformat ascii 1.0\n"),
        (
            "i.vtk",
            "# vtk DataFile Version 3.0\nisolines of the geodesic distance",
        ),
        (
            "i.OBJ",
            "# isolines of the geodesic distance, model square\n",
        ),
        ("i.vtp", "<?xml version"),
        ("i.svg", "<svg "),
    ] {
        let command = format!("isolines square.off --source 4 --source 1 --every 0.5 -o {file}");
        let said = sandbox.succeed(&command);
        assert!(said.starts_with(&format!("{file}: ")), "{said}");
        assert!(sandbox.read(file).starts_with(start), "{file}");
    }
    let picture = sandbox.read("i.svg");
    assert!(picture.contains("<polyline "));
    // The scale has the unit and the levels.
    for text in [">distance (model units)<", ">0.5<", ">1<"] {
        assert!(picture.contains(text), "{text}");
    }
    sandbox.succeed("isolines square.off --source 4 --every 0.5 -o i.png");
    assert!(sandbox.bytes("i.png").starts_with(b"\x89PNG"));
}

#[test]
fn the_wavefront_of_a_run_lies_around_its_isoline() {
    let sandbox = Sandbox::new();
    let run = "isolines gen:sphere,subdiv=3 --source 0 --levels 1,2";
    let mut deviations = Vec::new();
    // First in, first out, or nearest first.
    for algorithm in ["ch", "ich", "vtp-fast"] {
        let said = sandbox.succeed(&format!("{run} --wavefront {algorithm} -o w.json"));
        assert!(
            said.contains(&format!("wavefront of {algorithm} at 1: ")),
            "{said}"
        );
        let file = &sandbox.json("w.json")["wavefront"];
        assert_eq!(file["algorithm"], algorithm);
        let fronts = file["fronts"].as_array().unwrap();
        assert_eq!(fronts.len(), 2);
        for front in fronts {
            let windows = front["windows"].as_array().unwrap();
            assert!(windows.len() > 50, "{algorithm}: {}", windows.len());
            for window in windows {
                // All lie between the chords and the sphere.
                let position = [0, 1, 2].map(|k| window["from"][k].as_f64().unwrap());
                let radius = position.iter().map(|x| x * x).sum::<f64>().sqrt();
                assert!((0.98..1.0 + 1e-12).contains(&radius), "{window}");
            }
        }
        deviations.push(fronts[0]["deviation"].as_f64().unwrap());
    }
    assert!(deviations[0] > 2.0 * deviations[1], "{deviations:?}");

    sandbox.succeed(&format!("{run} --wavefront ich -o w.vtk"));
    assert!(sandbox.read("w.vtk").contains("SCALARS is_window int 1"));
    sandbox.succeed(&format!("{run} -o plain.svg"));
    sandbox.succeed(&format!("{run} --wavefront ich -o w.svg"));
    let lines = |file| sandbox.read(file).matches("<polyline ").count();
    assert!(lines("w.svg") > lines("plain.svg") + 20);

    let said = sandbox.succeed(&format!("{run},9 --wavefront ich -o w.json"));
    assert!(
        said.ends_with("the wavefront does not come to 1 of the distances\n"),
        "{said}"
    );
    for (algorithm, message) in [
        ("dijkstra", "no windows that wait were seen"),
        ("ext:other", "outside program"),
    ] {
        let outcome = sandbox.call(&format!("{run} --wavefront {algorithm} -o w.json"));
        assert_eq!(outcome.code, 2);
        assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
    }
}

#[test]
fn a_view_turns_the_picture() {
    let sandbox = Sandbox::new();
    let draw = |view: &str| {
        let command = "isolines gen:box --source 0 --every 1 --quiet -o i.svg";
        sandbox.succeed(&format!("{command} {view}"));
        sandbox.read("i.svg")
    };
    let front = draw("--view 0,0");
    assert_ne!(front, draw(""));
    assert_ne!(front, draw("--view -30,20"));
    assert_eq!(front, draw("--view 360,0,y"));
    // The z-axis towards the viewer and y up, in both conventions.
    assert_eq!(front, draw("--view -90,90,z"));
    for (arguments, message) in [
        ("-o i.svg --view 1", "give AZIMUTH,ELEVATION"),
        ("-o i.json --view 1,2", "--view turns pictures"),
    ] {
        let outcome = sandbox.call(&format!(
            "isolines gen:box --source 0 --every 1 {arguments}"
        ));
        assert_eq!(outcome.code, 2, "{arguments}");
        assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
    }
}

#[test]
fn wrong_input_is_named() {
    let sandbox = Sandbox::new();
    sandbox.write("square.off", SQUARE);
    for (arguments, message) in [
        ("--every 1 -o i.json", "--source <SRC>"),
        ("--source 0 -o i.json", "--every"),
        (
            "--source 0 --every 1 --levels 2 -o i.json",
            "cannot be used with",
        ),
        ("--source 0 --every 0 -o i.json", "give a distance above 0"),
        (
            "--source 0 --levels 1,-2 -o i.json",
            "give a distance above 0",
        ),
        (
            "--source 0 --every 1e-9 -o i.json",
            "at most 10000 are made",
        ),
        ("--source 9 --every 1 -o i.json", "vertex 9 does not exist"),
        ("--source 0 --every 1", "--output <FILE>"),
        (
            "--source 0 --every 1 -o i.gif",
            ".json, .obj, .ply, .vtp, .vtk, .svg or .png",
        ),
    ] {
        let outcome = sandbox.call(&format!("isolines square.off {arguments}"));
        assert_eq!(outcome.code, 2, "{arguments}");
        assert!(
            outcome.stderr.contains(message),
            "{arguments}: {}",
            outcome.stderr
        );
    }
}

#[test]
fn a_level_given_twice_is_one_isoline() {
    let sandbox = Sandbox::new();
    sandbox.write("square.off", SQUARE);
    let said = sandbox.succeed("isolines square.off --source 0 --levels 1,1e-12,1.0,1 -o i.json");
    assert!(
        said.contains("\ndistance 1: ") && said.contains("\ndistance 1e-12: "),
        "{said}"
    );
    assert_eq!(
        said.lines()
            .filter(|line| line.starts_with("distance "))
            .count(),
        2
    );
    let levels = &sandbox.json("i.json")["levels"];
    assert_eq!(
        [&levels[0]["distance"], &levels[1]["distance"]],
        [1.0, 1e-12]
    );
    assert_eq!(levels.as_array().unwrap().len(), 2);
}
