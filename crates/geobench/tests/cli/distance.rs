//! `geobench distance`.

use serde_json::json;

use crate::support::Sandbox;

/// A square of side 1 and, apart from it, a triangle; vertex 7 is in no face.
const TWO_PARTS: &str = "OFF\n8 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n5 0 0\n6 0 0\n5 1 0\n9 9 9\n\
    3 0 1 2\n3 0 2 3\n3 4 5 6\n";

#[test]
fn unreachable_is_inf_in_text_and_null_in_json() {
    let sandbox = Sandbox::new();
    sandbox.write("two.off", TWO_PARTS);
    let said = sandbox.succeed("distance two.off --source 0 -o d.csv");
    assert!(
        said.starts_with("d.csv: 8 vertices, 4 unreachable, the farthest is vertex 2 at 1.414")
    );
    let csv = sandbox.read("d.csv");
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[..3], ["vertex,distance", "0,0", "1,1"]);
    assert_eq!(lines[5..], ["4,inf", "5,inf", "6,inf", "7,inf"]);

    sandbox.succeed("distance two.off --source 0 --algo mmp -o d.json --quiet");
    let field = sandbox.json("d.json");
    assert_eq!(field["unreachable"], 4);
    assert_eq!(field["algorithm"], "mmp");
    assert_eq!(field["distances"][7], json!(null));
    assert_eq!(field["distances"][1], json!(1.0));
}

#[test]
fn several_sources_give_the_distance_from_the_nearest() {
    let sandbox = Sandbox::new();
    sandbox.write("two.off", TWO_PARTS);
    sandbox.succeed("distance two.off --source 1,3,4 -o d.json");
    let field = sandbox.json("d.json");
    assert_eq!(field["sources"], json!([1, 3, 4]));
    assert_eq!(
        field["distances"],
        json!([1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, null])
    );
}

#[test]
fn every_form_is_written_and_replaced() {
    let sandbox = Sandbox::with_square();
    for (file, start) in [
        ("d.npy", &b"\x93NUMPY\x01\x00"[..]),
        ("d.ply", b"ply\n"),
        ("d.vtk", b"# vtk DataFile Version 3.0\n"),
        ("d.vtp", b"<?xml version=\"1.0\"?>\n"),
        ("D.CSV", b"vertex,distance\n"),
    ] {
        std::fs::write(sandbox.path(file), "old").unwrap();
        assert_eq!(
            sandbox.succeed(&format!("distance square.off --source 1 --quiet -o {file}")),
            ""
        );
        assert!(
            std::fs::read(sandbox.path(file))
                .unwrap()
                .starts_with(start),
            "{file}"
        );
    }
    // A distance field is a model too.
    assert!(
        sandbox
            .succeed("info d.ply")
            .contains("vertices             4\n")
    );
}

/// With a source at either end of a long and thin face, all distances are far below the rounding of
/// its sides.
#[test]
fn distances_that_rounding_may_spoil_are_not_given_in_silence() {
    let sandbox = Sandbox::new();
    sandbox.write("long.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1e-8 0\n3 0 1 2\n");
    let warned = sandbox.call("distance long.off --source 0,1 --quiet -o d.csv");
    assert_eq!(warned.code, 0);
    assert_eq!(
        warned.stderr,
        "geobench: warning: long: 1 face is too long and thin for these distances (the first is \
         face 0): each may be off by up to 1.0e-12; split the long edges to be sure\n"
    );
    sandbox.write("wide.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1e-2 0\n3 0 1 2\n");
    let sure = sandbox.call("distance wide.off --source 0 --quiet -o d.csv");
    assert_eq!((sure.code, sure.stderr.as_str()), (0, ""));
}
