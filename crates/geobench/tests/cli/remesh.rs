//! `geobench remesh`.

use std::fmt::Write as _;

use crate::support::Sandbox;

#[test]
fn a_torus_gets_an_even_mesh_of_genus_1() {
    let sandbox = Sandbox::new();
    let said = sandbox.succeed(
        "remesh gen:torus,faces=3000 --sites 150 --lloyd 3 -o even.obj --picture even.svg",
    );
    assert!(
        said.starts_with("even.obj: 150 vertices, 300 faces in "),
        "{said}"
    );
    for row in [
        "vertices",
        "least angle",
        "angles below 30°",
        "mean aspect",
        "worst aspect",
        "Hausdorff distance ",
        "before to after: ",
        "after to before: ",
    ] {
        assert!(said.contains(row), "{row}: {said}");
    }
    let info = sandbox.succeed("info even.obj");
    assert!(info.contains("genus"), "{info}");
    let info = sandbox.succeed("info even.obj --format json");
    let info: serde_json::Value = serde_json::from_str(&info).unwrap();
    assert!(info.to_string().contains("\"genus\":1"), "{info}");
    let picture = sandbox.read("even.svg");
    assert!(picture.contains("viewBox=\"0 0 960 400\""), "two pictures");
}

#[test]
fn every_form_of_mesh_is_written_and_read() {
    let sandbox = Sandbox::new();
    for name in ["e.obj", "e.ply", "e.off", "e.stl", "e.off.gz"] {
        let run = format!("remesh gen:sphere,subdiv=3 --sites 40 --lloyd 0 --quiet -o {name}");
        assert_eq!(sandbox.succeed(&run), "");
        let info = sandbox.succeed(&format!("info {name} --format json"));
        assert!(info.replace(' ', "").contains("\"faces\":76"), "{info}");
    }
    let run = "remesh gen:sphere,subdiv=3 --sites 40 -o e.obj --quiet --picture e.png";
    sandbox.succeed(run);
    let picture = std::fs::read(sandbox.path("e.png")).unwrap();
    assert!(picture.starts_with(b"\x89PNG"));
    let mesh = sandbox.succeed("remesh gen:sphere,subdiv=3 --sites 40 -o - --output-format off");
    assert!(mesh.starts_with("OFF\n40 76 0\n"), "{mesh}");
}

#[test]
fn sites_are_added_where_there_are_too_few() {
    let sandbox = Sandbox::new();
    let said = sandbox.succeed("remesh gen:torus,faces=3000 --sites 3 -o e.obj");
    assert!(said.contains(" sites more than asked for"), "{said}");
}

#[test]
fn refused_meshes_leave_no_file() {
    let sandbox = Sandbox::new();
    for (arguments, part) in [
        (
            "gen:cube,n=1 --sites 9 -o e.obj",
            "from 1 to 8 are possible",
        ),
        ("gen:cube,n=1 --sites 0 -o e.obj", "--sites"),
        (
            "gen:cube,n=1 --sites -8 -o e.obj",
            "invalid value '-8' for '--sites <N>'",
        ),
        (
            "gen:cube,n=1 --sites 8 -o e.txt",
            "use .obj, .ply, .off or .stl",
        ),
        (
            "gen:cube,n=1 --sites 8 -o e.obj --picture e.jpg",
            ".svg or .png",
        ),
        ("gen:cube,n=1 -o e.obj", "--sites"),
        ("none.obj --sites 8 -o e.obj", "none.obj"),
    ] {
        let error = sandbox.refuse(&format!("remesh {arguments}"));
        assert!(error.contains(part), "{error}");
        assert!(!sandbox.path("e.obj").exists());
    }
}

/// Regression test: along a boundary of a strip without area, points were set in memory without
/// end.
#[test]
fn a_strip_without_area_is_refused_or_remeshed() {
    let sandbox = Sandbox::new();
    let mut strip = String::new();
    for y in ["0", "1e-57", "2e-57", "3e-57"] {
        for x in 0..4 {
            writeln!(strip, "v {x} {y} 0").unwrap();
        }
    }
    for y in 0..3 {
        for x in 1..4 {
            let a = 4 * y + x;
            let [b, c, d] = [a + 1, a + 4, a + 5];
            writeln!(strip, "f {a} {b} {d}\nf {a} {d} {c}").unwrap();
        }
    }
    sandbox.write("strip.obj", &strip);
    let outcome = sandbox.call("remesh strip.obj --sites 3 -o r.obj");
    let is_refused = outcome.stderr.contains("geobench: error: strip.obj: ");
    assert!(
        outcome.code == 0 || outcome.code == 2 && is_refused,
        "{}",
        outcome.stderr
    );
}
