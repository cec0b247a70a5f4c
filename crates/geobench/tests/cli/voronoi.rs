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
    assert!(sandbox.read("v.vtk").contains("DATASET POLYDATA"));
    sandbox.succeed(&format!("{common} -o v.svg"));
    let picture = sandbox.read("v.svg");
    assert!(picture.starts_with("<svg"));
    // Borders are drawn whole, not arc by arc.
    assert!((4..60).contains(&picture.matches("<polyline").count()));
    sandbox.succeed(&format!("{common} -o v.png"));
    let picture = std::fs::read(sandbox.path("v.png")).unwrap();
    assert!(picture.starts_with(b"\x89PNG"));
    // The coloured model is a model, of the same area.
    sandbox.succeed(&format!("{common} -o v.ply"));
    sandbox.succeed("info v.ply");
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
fn a_dual_that_is_no_triangulation_leaves_no_file() {
    let sandbox = Sandbox::new();
    let error = sandbox.refuse("voronoi gen:sphere,subdiv=1 --source 0 -o v.json --dual d.obj");
    assert!(error.contains("cell 0 is no disc"), "{error}");
    assert!(!sandbox.path("v.json").exists() && !sandbox.path("d.obj").exists());
}

#[test]
fn unusable_arguments_are_named() {
    let sandbox = Sandbox::new();
    for (arguments, part) in [
        ("--source 0 -o v.txt", "v.txt"),
        ("--source 999 -o v.json", "999"),
        ("--source 0 --algo vtp -o v.json", "use window-vtp"),
        ("--source 0 -o v.json --dual d.txt", "d.txt"),
        ("--source 0 -o v.json --labels l.txt", "l.txt"),
    ] {
        let error = sandbox.refuse(&format!("voronoi gen:cube,n=1 {arguments}"));
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn what_no_source_reaches_has_no_label() {
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
