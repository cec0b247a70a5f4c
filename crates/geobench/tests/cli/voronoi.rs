//! `geobench voronoi`.

use serde_json::json;

use crate::support::Sandbox;

#[test]
fn cells_of_a_square_share_it() {
    let sandbox = Sandbox::new();
    for algorithm in [
        "window-vtp",
        "window-vtp{rwr=off}",
        "lct11",
        "lct11{queue=buckets}",
        "xls14",
    ] {
        let run = format!("voronoi gen:grid,n=4 --source 0,24 --algo {algorithm} -o v.json");
        let said = sandbox.succeed(&run);
        assert!(
            said.starts_with("v.json: 2 cells (2 discs), 0 vertices"),
            "{said}"
        );
        let file = sandbox.json("v.json");
        assert_eq!(file["schema"], "geobench-voronoi/1");
        assert_eq!(file["sources"], json!([0, 24]));
        for (cell, other) in [(0, 1), (1, 0)] {
            let cell = &file["cells"][cell];
            assert!((cell["area"].as_f64().unwrap() - 8.0).abs() < 1e-12);
            assert_eq!(
                (&cell["neighbours"], &cell["disc"]),
                (&json!([other]), &json!(true))
            );
        }
        assert!(
            file["arcs"]
                .as_array()
                .unwrap()
                .iter()
                .all(|arc| arc["kind"] == "line")
        );
    }
}

#[test]
fn every_form_is_written() {
    let sandbox = Sandbox::new();
    let common = "voronoi gen:torus,faces=500 --source random:8 --quiet";
    sandbox.succeed(&format!("{common} -o v.obj --labels l.csv"));
    let lines = sandbox.read("v.obj");
    assert!(lines.lines().any(|line| line.starts_with("l 1 2")));
    let labels = sandbox.read("l.csv");
    assert!(labels.starts_with("vertex,label,distance\n"));
    sandbox.succeed(&format!("{common} -o v.vtk --labels l.npy"));
    assert!(sandbox.read("v.vtk").contains("DATASET UNSTRUCTURED_GRID"));
    sandbox.succeed(&format!("{common} -o v.svg"));
    let picture = sandbox.read("v.svg");
    assert!(picture.starts_with("<svg"));
    // Borders are drawn as long lines, not arc by arc.
    assert!((4..60).contains(&picture.matches("<polyline").count()));
    sandbox.succeed(&format!("{common} -o v.png"));
    let picture = std::fs::read(sandbox.path("v.png")).unwrap();
    assert!(picture.starts_with(b"\x89PNG"));
    // The coloured model can be loaded as a model and has the same area.
    sandbox.succeed(&format!("{common} -o v.ply"));
    sandbox.succeed("info v.ply");
}

/// The coloured model and the borders once had the same extension, so only one could be written.
#[test]
fn borders_are_written_beside_the_model_as_polylines() {
    let sandbox = Sandbox::new();
    let common = "voronoi gen:torus,faces=500 --source random:8 --quiet";
    sandbox.succeed(&format!("{common} -o v.ply --borders b.ply"));
    sandbox.succeed("info v.ply");
    let text = sandbox.read("b.ply");
    let (header, body) = text.split_once("end_header\n").unwrap();
    let count = |element: &str| -> usize {
        let found = header.lines().find_map(|line| line.strip_prefix(element));
        found.unwrap().trim().parse().unwrap()
    };
    let [vertices, edges] = ["element vertex", "element edge"].map(count);
    assert_eq!(body.lines().count(), vertices + edges);
    let numbers = body.lines().skip(vertices).flat_map(str::split_whitespace);
    assert!(
        numbers
            .map(|n| n.parse::<usize>().unwrap())
            .all(|n| n < vertices)
    );
    // The other formats hold the same points as the main file.
    sandbox.succeed(&format!("{common} -o v.obj --borders b.obj"));
    assert_eq!(sandbox.read("v.obj"), sandbox.read("b.obj"));
    let points = sandbox.read("b.obj");
    let points = points.lines().filter_map(|line| line.strip_prefix("v "));
    assert!(points.eq(body.lines().take(vertices)));
    sandbox.succeed(&format!("{common} -o v.json --borders b.vtk"));
    assert!(sandbox.read("b.vtk").contains("SCALARS left int 1"));
}

#[test]
fn the_dual_is_a_mesh_of_the_sources() {
    let sandbox = Sandbox::new();
    let run = "voronoi gen:sphere,subdiv=3 --source random:40 -o v.json --dual d.obj";
    let said = sandbox.succeed(run);
    assert!(said.contains("d.obj: 76 triangles, "), "{said}");
    sandbox.succeed(&run.replace("d.obj", "d.off"));
    assert!(sandbox.read("d.off").starts_with("OFF\n40 76 0\n"));
    assert_eq!(
        sandbox
            .read("d.obj")
            .lines()
            .filter(|line| line.starts_with("f "))
            .count(),
        76
    );
}

#[test]
fn a_dual_that_is_no_triangulation_does_not_lose_the_other_files() {
    let sandbox = Sandbox::new();
    let error = sandbox.refuse("voronoi gen:sphere,subdiv=1 --source 0 -o v.json --dual d.obj");
    assert!(error.contains("cell 0 is no disc"), "{error}");
    assert_eq!(sandbox.json("v.json")["cells"].as_array().unwrap().len(), 1);
    assert!(!sandbox.path("d.obj").exists());
}

#[test]
fn sources_may_be_anywhere() {
    let sandbox = Sandbox::new();
    // Two in one face, one on an edge, one at a place of space; the cells share the square.
    let run = "voronoi gen:grid,n=4 --source face:0,0.2,0.3,0.5 --source face:0,0.6,0.2,0.2 \
        --source edge:12-13,0.5 --source at:3.9,3.1,0.7 -o v.json --labels l.csv";
    let said = sandbox.call(run);
    assert!(
        said.stderr
            .contains("at:3.9,3.1,0.7 is 0.7 from the surface"),
        "{said:?}"
    );
    let file = sandbox.json("v.json");
    assert_eq!(file["sources"][2], "edge:12-13,0.5");
    let cells = file["cells"].as_array().unwrap();
    let area: f64 = cells
        .iter()
        .map(|cell| cell["area"].as_f64().unwrap())
        .sum();
    assert!((area - 16.0).abs() < 1e-9, "{area}");
    // The labels are those of the model's vertices, and faces are its faces.
    assert_eq!(sandbox.read("l.csv").lines().count(), 1 + 25);
    for arc in file["arcs"].as_array().unwrap() {
        assert!(arc["face"].as_u64().unwrap() < 32, "{arc}");
    }
    for vertex in file["vertices"].as_array().unwrap() {
        let face = vertex["face"].as_u64().unwrap();
        let weights: Vec<f64> = serde_json::from_value(vertex["barycentric"].clone()).unwrap();
        let sum: f64 = weights.iter().sum();
        assert!(face < 32 && (sum - 1.0).abs() < 1e-12, "{vertex}");
        assert!(weights.iter().all(|&w| w > -1e-12), "{vertex}");
    }
}

#[test]
fn sources_at_one_place_have_one_cell() {
    let sandbox = Sandbox::new();
    let run = "voronoi gen:grid,n=4 --source 3 --source edge:3-4,0 --source 20 -o v.json";
    let said = sandbox.succeed(run);
    assert!(
        said.contains("source edge:3-4,0 is at the same place as 3: cell 1 is empty"),
        "{said}"
    );
    let file = sandbox.json("v.json");
    assert_eq!(file["cells"][1]["area"], json!(0.0));
}

#[test]
fn unusable_arguments_are_named() {
    let sandbox = Sandbox::new();
    for (arguments, part) in [
        ("--source 0 -o v.txt", "v.txt"),
        ("--source 999 -o v.json", "999"),
        ("-o v.json", "--source"),
        ("--source random:0 -o v.json", "at least one"),
        ("--source face:99,1,0,0 -o v.json", "99"),
        ("--source 0 --algo vtp -o v.json", "use window-vtp"),
        ("--source 0 -o v.json --dual d.txt", "d.txt"),
        ("--source 0 -o v.json --labels l.txt", "l.txt"),
        ("--source 0 -o v.json --borders b.stl", "b.stl"),
    ] {
        let error = sandbox.refuse(&format!("voronoi gen:cube,n=1 {arguments}"));
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn unreachable_vertices_have_no_label() {
    let sandbox = Sandbox::new();
    sandbox.write(
        "two.off",
        "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n5 0 0\n6 0 0\n5 1 0\n3 0 1 2\n3 3 4 5\n",
    );
    let said = sandbox.succeed("voronoi two.off --source 0,1 -o v.json --labels l.csv");
    assert!(
        said.contains("3 vertices are reached from no source"),
        "{said}"
    );
    assert!(sandbox.read("l.csv").contains("\n4,,inf\n"));
    let file = sandbox.json("v.json");
    let area = |cell: usize| file["cells"][cell]["area"].as_f64().unwrap();
    assert!((area(0) + area(1) - 0.5).abs() < 1e-12);
}

#[test]
fn a_run_times_the_diagram_apart_and_checks_labels() {
    let sandbox = Sandbox::new();
    let run = "run gen:torus,faces=500 --algo window-vtp,lct11,lct11{queue=buckets},xls14,mmp \
        --source random:5 --sources-together --repeat 2 -o r.json";
    let table = sandbox.succeed(run);
    for row in ["Stage 2, diagram (s)", "Window limit", "Peak windows"] {
        assert!(
            table.to_lowercase().contains(&row.to_lowercase()),
            "{row}: {table}"
        );
    }
    let file = sandbox.json("r.json");
    for cell in file["cells"].as_array().unwrap() {
        let makes_diagrams = cell["algorithm"] != "mmp";
        assert_eq!(cell["status"], "ok", "{cell}");
        assert_eq!(
            cell["time"]["extraction"].as_f64().is_some_and(|s| s > 0.0),
            makes_diagrams
        );
        let wrong = if makes_diagrams {
            json!(0)
        } else {
            json!(null)
        };
        assert_eq!(cell["check"]["wrong_labels"], wrong, "{cell}");
    }
    sandbox.succeed(&run.replace("r.json", "r.csv"));
    let csv = sandbox.read("r.csv");
    let header = csv.lines().next().unwrap();
    assert!(header.contains(",time_extraction,") && header.contains(",check_wrong_labels,"));
}
