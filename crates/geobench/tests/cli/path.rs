//! `geobench path`.

use serde_json::json;

use crate::support::Sandbox;

/// A strip of four unit squares and, apart from it, a triangle.
const STRIP: &str = "OFF\n13 9 0\n0 0 0\n1 0 0\n2 0 0\n3 0 0\n4 0 0\n0 1 0\n1 1 0\n2 1 0\n3 1 0\n4 1 0\n\
    9 0 0\n10 0 0\n9 1 0\n3 0 1 6\n3 0 6 5\n3 1 2 7\n3 1 7 6\n3 2 3 8\n3 2 8 7\n3 3 4 9\n3 3 9 8\n\
    3 10 11 12\n";

#[test]
fn json_has_points_edges_and_lengths() {
    let sandbox = Sandbox::new();
    sandbox.write("strip.off", STRIP);
    let outcome = sandbox.call("path strip.off --source 5 --target 4 --target 10 -o p.json");
    // A target is unreachable.
    assert_eq!(outcome.code, 1);
    let said = outcome.stdout;
    assert!(
        said.starts_with("vertex 5 to 4: length 4.123105625617"),
        "{said}"
    );
    assert!(
        said.contains("edges crossed, 0 vertices passed\nvertex 10: unreachable\n"),
        "{said}"
    );
    let file = sandbox.json("p.json");
    assert_eq!(file["schema"], "geobench-path/1");
    assert_eq!(file["algorithm"], "vtp-fast");
    let path = &file["paths"][0];
    assert_eq!((&path["source"], &path["target"]), (&json!(5), &json!(4)));
    let points = path["points"].as_array().unwrap();
    let edges = path["edges"].as_array().unwrap();
    assert_eq!(points.len(), edges.len() + 2);
    assert_eq!(points[0]["position"], json!([0.0, 1.0, 0.0]));
    assert_eq!(points[0]["vertex"], 5);
    // All points lie on the straight line from (0, 1) to (4, 0).
    for point in points {
        let [x, y] = [0, 1].map(|k| point["position"][k].as_f64().unwrap());
        assert!((x + 4.0 * y - 4.0).abs() < 1e-12, "{point}");
        let sum: f64 = (0..3)
            .map(|k| point["barycentric"][k].as_f64().unwrap())
            .sum();
        assert!((sum - 1.0).abs() < 1e-15, "{point}");
    }
    for edge in edges {
        let t = edge[2].as_f64().unwrap();
        assert!((0.0..=1.0).contains(&t), "{edge}");
    }
    let unreached = &file["paths"][1];
    assert_eq!(
        (&unreached["length"], &unreached["points"]),
        (&json!(null), &json!([]))
    );
}

#[test]
fn paths_join_any_points_by_every_exact_algorithm() {
    let sandbox = Sandbox::new();
    sandbox.write("strip.off", STRIP);
    // From (0.25, 0.5) in face 1 to (3.5, 1) on an edge.
    let points = "--source face:1,0.25,0.25,0.5 --source edge:10-12,0.5 --target edge:8-9,0.5 \
        --target at:3.5,0.25,2 --target edge:11-12,0.5 --target face:1,0.25,0.25,0.5";
    let algorithms = sandbox.succeed("algos exact --format json");
    let algorithms: serde_json::Value = serde_json::from_str(&algorithms).unwrap();
    let names = algorithms
        .as_array()
        .unwrap()
        .iter()
        .map(|a| a["name"].as_str().unwrap());
    let mut count = 0;
    for name in names {
        let said = sandbox.call(&format!("path strip.off {points} --algo {name} -o p.json"));
        assert!(
            said.stderr
                .contains("at:3.5,0.25,2 is 2 from the surface; "),
            "{name}: {said:?}"
        );
        let paths = &sandbox.json("p.json")["paths"];
        for (i, target, ends, length) in [
            (
                0,
                "edge:8-9,0.5",
                [[0.25, 0.75], [3.5, 1.0]],
                3.25_f64.hypot(0.25),
            ),
            (
                1,
                "at:3.5,0.25,2",
                [[0.25, 0.75], [3.5, 0.25]],
                3.25_f64.hypot(0.5),
            ),
            (2, "edge:11-12,0.5", [[9.0, 0.5], [9.5, 0.5]], 0.5),
            (3, "face:1,0.25,0.25,0.5", [[0.25, 0.75], [0.25, 0.75]], 0.0),
        ] {
            let path = &paths[i];
            assert_eq!(path["target"], target, "{name}");
            let source = ["face:1,0.25,0.25,0.5", "edge:10-12,0.5"][usize::from(i == 2)];
            assert_eq!(path["source"], source, "{name}");
            let found = path["length"].as_f64().unwrap();
            assert!((found - length).abs() <= 1e-12 * length, "{name}: {path}");
            let points = path["points"].as_array().unwrap();
            for (point, end) in [(&points[0], ends[0]), (&points[points.len() - 1], ends[1])] {
                for k in 0..2 {
                    let x = point["position"][k].as_f64().unwrap();
                    assert!((x - end[k]).abs() < 1e-14, "{name}: {point} for {end:?}");
                }
                assert!(point["face"].as_u64().unwrap() < 9, "{name}: {point}");
                assert_eq!(point["vertex"], json!(null));
            }
            // All others on edges of the model.
            assert!(path["edges"].as_array().unwrap().len() + 2 >= points.len());
        }
        count += 1;
    }
    assert!(count > 15, "{count} exact algorithms");
}

#[test]
fn names_with_commas_are_in_quotes() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("path square.off --source edge:0-1,0.5 --target edge:2-3,0.5 -o p.csv");
    let text = sandbox.read("p.csv");
    assert!(
        text.contains("\n0,\"edge:0-1,0.5\",\"edge:2-3,0.5\",0.5,0,0,,"),
        "{text}"
    );
}

#[test]
fn a_picture_shows_the_paths() {
    let sandbox = Sandbox::new();
    let command = "path gen:sphere,subdiv=2 --source 0 --target random:5";
    sandbox.succeed(&format!("{command} -o p.svg"));
    let svg = sandbox.read("p.svg");
    assert!(svg.starts_with("<svg ") && svg.contains("data:image/png;base64,"));
    assert!(svg.contains("<polyline ") && svg.contains("Shortest paths on sphere"));
    sandbox.succeed(&format!("{command} -o p.png"));
    assert!(sandbox.bytes("p.png").starts_with(b"\x89PNG"));
}

#[test]
fn every_form_is_written() {
    let sandbox = Sandbox::with_square();
    for (file, start, end) in [
        (
            "p.obj",
            "# shortest paths by mmp, model square\nv 1 0 0\n",
            "\nl 1 2\nl 2 3\n",
        ),
        ("p.ply", "ply\nformat ascii 1.0\n", "\n0 1\n1 2\n"),
        (
            "p.vtk",
            "# vtk DataFile Version 3.0\n",
            "\nSCALARS length double 1\nLOOKUP_TABLE default\n1.414213562373095\n1.414213562373095\n",
        ),
        ("p.vtp", "<?xml version=\"1.0\"?>\n", "</VTKFile>\n"),
        (
            "P.CSV",
            "path,source,target,x,y,z,vertex,face,u,v,w\n0,1,3,1,0,0,1,",
            "\n",
        ),
    ] {
        let command = format!("path square.off --source 1 --target 3 --algo mmp --quiet -o {file}");
        assert_eq!(sandbox.succeed(&command), "");
        let text = sandbox.read(file);
        assert!(
            text.starts_with(start) && text.ends_with(end),
            "{file}: {text}"
        );
    }
    let refused = sandbox.call("path square.off --source 1 --target 3 -o p.gif");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains(".json"), "{}", refused.stderr);
}

#[test]
fn all_targets_are_one_run() {
    let sandbox = Sandbox::new();
    let said = sandbox.succeed("path gen:sphere,subdiv=2 --source 0 --all-targets");
    assert!(said.starts_with("162 paths, 0 unreachable, "), "{said}");
    let distances = "distance gen:sphere,subdiv=2 --source 0 --quiet -o d.json";
    sandbox.succeed(distances);
    sandbox.succeed("path gen:sphere,subdiv=2 --source 0 --all-targets --quiet -o p.json");
    let (d, p) = (sandbox.json("d.json"), sandbox.json("p.json"));
    for v in 0..162 {
        let [d, l] = [&d["distances"][v], &p["paths"][v]["length"]].map(|x| x.as_f64().unwrap());
        assert!((d - l).abs() <= 1e-12 * d, "{v}: {d} and {l}");
    }
}

#[test]
fn wrong_input_is_named() {
    let sandbox = Sandbox::with_square();
    for (arguments, message) in [
        (
            "path square.off --source 1 --target 9",
            "vertex 9 does not exist: the model has 4 vertices",
        ),
        (
            "path square.off --source 9 --target 1",
            "vertex 9 does not exist: the model has 4 vertices",
        ),
        (
            "path square.off --source 1 --target face:9,1,0,0",
            "face:9,1,0,0: face 9 does not exist: the mesh has 2 faces",
        ),
        (
            "path square.off --source edge:1-3,0.5 --target 1",
            "edge:1-3,0.5: no edge joins the vertices 1 and 3",
        ),
        (
            "path square.off --source 1",
            "<--target <DST>|--targets <FILE>|--all-targets|--direction <X,Y,Z>>",
        ),
        ("path square.off --target 1", "--source <SRC>"),
        (
            "path square.off --source 1 --target 2 --all-targets",
            "cannot be used with",
        ),
        ("path none.off --source 1 --target 2", "none.off"),
        (
            "path square.off --source 1 --target 2 --algo heat",
            "heat: this algorithm traces no paths; choose an exact one that does, such as vtp-fast",
        ),
    ] {
        let outcome = sandbox.call(arguments);
        assert_eq!(outcome.code, 2, "{arguments}");
        assert!(
            outcome.stderr.contains(message),
            "{arguments}: {}",
            outcome.stderr
        );
    }
}

#[test]
fn straightest_lines_go_on_at_vertices_and_end_at_the_border() {
    let sandbox = Sandbox::with_square();
    // From a corner of the square through the middle of the diagonal, and beyond the border.
    let said = sandbox.succeed(
        "path square.off --source face:0,0.2,0.6,0.2 --direction -1,0.5,3 --length 0.25 -o p.json",
    );
    let json = sandbox.json("p.json");
    assert_eq!(json["algorithm"], "straightest");
    let path = &json["paths"][0];
    assert_eq!(path["length"], 0.25);
    let points = path["points"].as_array().unwrap();
    let at = |i: usize, k: usize| points[i]["position"][k].as_f64().unwrap();
    let last = points.len() - 1;
    let way = [0, 1].map(|k| at(last, k) - at(0, k));
    assert!((way[0] + 0.25 * 0.8_f64.sqrt()).abs() < 1e-12, "{way:?}");
    assert!((way[1] - 0.25 * 0.2_f64.sqrt()).abs() < 1e-12, "{way:?}");
    assert!(said.contains("face:0,0.2,0.6,0.2 to "), "{said}");

    let said = sandbox.call("path square.off --source 1 --direction=-1,1,0 --length 9");
    assert_eq!(said.code, 0, "{said:?}");
    assert!(
        said.stderr
            .contains("the line from vertex 1 ends at the border after 1.414"),
        "{said:?}"
    );
    assert!(
        said.stdout.starts_with("vertex 1 to 3: length 1.414"),
        "{said:?}"
    );

    for (arguments, message) in [
        ("--source 1 --direction 1,0,0", "--length"),
        ("--source 1 --length 2", "--direction"),
        ("--source 1 --length 2 --target 3", "--length"),
        ("--source 1 --direction 1,0 --length 2", "three numbers"),
        (
            "--source 1 --direction 0,0,1 --length 2",
            "does not point along the surface",
        ),
        (
            "--source 1 --direction 1,0,0 --length 2 --target 3",
            "cannot be used with",
        ),
    ] {
        let said = sandbox.call(&format!("path square.off {arguments}"));
        assert!(said.code == 2 && said.stderr.contains(message), "{said:?}");
    }
}

#[test]
fn a_path_through_targets_can_be_shortened() {
    let sandbox = Sandbox::new();
    sandbox.write("strip.off", STRIP);
    let length = |options: &str| {
        sandbox.succeed(&format!("path strip.off {options} --through -o p.json"));
        let file = sandbox.json("p.json");
        assert_eq!(file["paths"].as_array().unwrap().len(), 1);
        let (method, path) = (file["algorithm"].clone(), file["paths"][0].clone());
        (
            method,
            path["length"].as_f64().unwrap(),
            path["target"].clone(),
        )
    };
    // Along three sides of a square, around all four, and straight.
    let corners = "--source 0 --target 1 --target 6 --target 5";
    assert_eq!(length(corners), (json!("vtp-fast"), 3.0, json!(5)));
    let closed = format!("{corners} --closed");
    assert_eq!(length(&closed), (json!("vtp-fast"), 4.0, json!(0)));
    let shorter = length(&format!("{corners} --shorten"));
    assert_eq!(shorter, (json!("locally shortest"), 1.0, json!(5)));
    let ways = "--source 5 --target face:1,0.25,0.25,0.5 --target 3 --target 4 --shorten";
    let (_, found, target) = length(ways);
    assert!((found - 17.0_f64.sqrt()).abs() < 1e-12 && target == json!(4));
    let outcome = sandbox.call(&format!("path strip.off {closed} --shorten --through"));
    assert_eq!(outcome.code, 0);
    assert!(
        outcome.stderr.contains("the path contracts to a point"),
        "{outcome:?}"
    );
    // A target out of reach, two sources, and options that have no meaning alone.
    for (options, code, says) in [
        // The first way point that is out of reach is named.
        (
            "--source 0 --target 11,1 --through",
            1,
            "vertex 11: unreachable",
        ),
        (
            "--source 0 --target 1,11,3 --through --closed",
            1,
            "vertex 11: unreachable",
        ),
        (
            "--source 0,1 --target 5 --through",
            2,
            "--through: a path starts at one source, not at 2",
        ),
        ("--source 0 --all-targets --through", 2, "--target"),
        ("--source 0 --target 5 --shorten", 2, "--through"),
    ] {
        let outcome = sandbox.call(&format!("path strip.off {options}"));
        assert_eq!(outcome.code, code, "{outcome:?}");
        let said = if code == 1 {
            &outcome.stdout
        } else {
            &outcome.stderr
        };
        assert!(said.contains(says), "{outcome:?}");
    }
}
