//! `geobench certify`.

use crate::support::Sandbox;

#[test]
fn a_field_is_proven() {
    let sandbox = Sandbox::new();
    let said = sandbox.succeed("certify gen:terrain,n=20,seed=1 --source 7");
    assert!(said.contains("certified to "), "{said}");
    assert!(said.contains("not too long by more than"), "{said}");
    let shared = sandbox.succeed("certify gen:terrain,n=20,seed=1 --source 7 --threads 2");
    assert_eq!(shared, said);
}

#[test]
fn the_certificate_as_json() {
    let sandbox = Sandbox::new();
    let said = sandbox.succeed("certify gen:torus,faces=500 --source 0 --source 9 --format json");
    let json: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(json["schema"], "geobench-certificate/1");
    assert_eq!(json["certified"], true);
    assert!(json["relative"].as_f64().unwrap() < 1e-10);
    assert!(json["absolute"].as_f64().unwrap() > 0.0);
    assert!(json["faces"].as_u64().unwrap() >= 500);
    assert_eq!(json["failures"].as_array().unwrap().len(), 0);
}

#[test]
fn a_distance_of_a_file_that_is_off_by_two_billionths_is_found() {
    let sandbox = Sandbox::new();
    sandbox.succeed("distance gen:torus,faces=500 --source 3 --quiet -o right.csv");
    sandbox.succeed("certify gen:torus,faces=500 --source 3 --distances right.csv");
    let text = sandbox.read("right.csv");
    let lines = text.lines().map(|line| match line.strip_prefix("100,") {
        Some(d) => format!("100,{}", d.parse::<f64>().unwrap() * (1.0 + 2e-9)),
        None => line.to_owned(),
    });
    sandbox.write("wrong.csv", &lines.collect::<Vec<_>>().join("\n"));
    let outcome = sandbox.call("certify gen:torus,faces=500 --source 3 --distances wrong.csv");
    assert_eq!(outcome.code, 1);
    assert!(outcome.stdout.contains("not certified"));
    assert!(outcome.stdout.contains("vertex 100: wrong by at least "));
}

#[test]
fn damaged_files_are_never_certified() {
    let sandbox = Sandbox::new();
    sandbox.succeed("distance gen:torus,faces=500 --source 3 --quiet -o right.csv");
    let text = sandbox.read("right.csv");
    let line = |v: &str| {
        text.lines()
            .find(|line| line.starts_with(&format!("{v},")))
            .unwrap()
    };
    let distance = |v: &str| line(v).split_once(',').unwrap().1;
    let with = |v: &str, d: &str| text.replace(line(v), &format!("{v},{d}"));
    let exchanged = with("7", distance("90")).replace(line("90"), &format!("90,{}", distance("7")));
    let call = "certify gen:torus,faces=500 --source 3 --distances";
    for (name, damaged) in [
        (
            "moved.csv",
            with(
                "100",
                &format!("{}1", distance("100")).replacen(['1', '2'], "3", 1),
            ),
        ),
        ("exchanged.csv", exchanged),
        ("infinite.csv", with("100", "inf")),
        ("zero.csv", with("100", "0")),
    ] {
        assert_ne!(damaged, text, "{name}");
        sandbox.write(name, &damaged);
        let outcome = sandbox.call(&format!("{call} {name}"));
        assert_eq!(outcome.code, 1, "{name}: {}", outcome.stdout);
        assert!(
            outcome
                .stdout
                .contains("not certified: distances are wrong"),
            "{name}"
        );
        let outcome = sandbox.call(&format!("{call} {name} --partial"));
        assert_eq!(outcome.code, 1, "{name}: {}", outcome.stdout);
    }
    sandbox.write("nan.csv", &with("100", "nan"));
    assert_ne!(sandbox.call(&format!("{call} nan.csv")).code, 0);
}

/// A file of one row was certified.
#[test]
fn files_without_all_vertices_are_certified_if_they_are_allowed() {
    let sandbox = Sandbox::new();
    sandbox.succeed("distance gen:grid,n=9 --source 0 --quiet -o right.csv");
    let text = sandbox.read("right.csv");
    let half: Vec<&str> = text.lines().take(51).collect();
    sandbox.write("half.csv", &half.join("\n"));
    sandbox.write("one.csv", "vertex,distance\n0,0\n");
    let call = "certify gen:grid,n=9 --source 0 --distances";
    for (name, share) in [
        ("half.csv", "50 of 100 vertices compared, 50"),
        ("one.csv", "1 of 100"),
    ] {
        let outcome = sandbox.call(&format!("{call} {name}"));
        assert_eq!(outcome.code, 1, "{}", outcome.stdout);
        assert!(
            outcome
                .stdout
                .contains("not certified: distances are missing")
        );
        assert!(outcome.stdout.contains(share), "{}", outcome.stdout);
        let said = sandbox.succeed(&format!("{call} {name} --partial"));
        assert!(
            said.contains("certified to ") && said.contains(share),
            "{said}"
        );
    }
    // Cut in the middle of a row.
    sandbox.write("cut.csv", &text[..text.len() - 12]);
    assert_eq!(sandbox.call(&format!("{call} cut.csv")).code, 1);
    let said = sandbox.succeed(&format!("{call} one.csv --partial --format json"));
    let json: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(
        (&json["compared"], &json["vertices"]),
        (&1.into(), &100.into())
    );
    assert_ne!(
        sandbox
            .call("certify gen:grid,n=9 --source 0 --partial")
            .code,
        0
    );
}

#[test]
fn missing_files_and_sources_are_named() {
    let sandbox = Sandbox::new();
    let said = sandbox.refuse("certify gen:torus,faces=500 --source 0 --distances none.csv");
    assert!(said.contains("none.csv"), "{said}");
    let said = sandbox.refuse("certify gen:torus,faces=500 --source 9999");
    assert!(said.contains("9999"), "{said}");
}

#[test]
fn sources_may_be_points_of_edges_and_faces() {
    let sandbox = Sandbox::new();
    let said = sandbox.succeed("certify gen:torus,faces=500 --source edge:0-1,0.25");
    assert!(said.contains("certified to "), "{said}");
    let sources = "--source face:12,0.2,0.3,0.5 --source at:3,0,0";
    let said = sandbox.call(&format!("certify gen:torus,faces=500 {sources}"));
    assert!(said.stderr.contains(": at:3,0,0 is "), "{said:?}");
    assert!(said.stdout.contains("certified to "), "{said:?}");
    // A distance file holds only the vertices of the model.
    sandbox.succeed(&format!(
        "distance gen:torus,faces=500 {sources} --quiet -o d.csv"
    ));
    sandbox.succeed(&format!(
        "certify gen:torus,faces=500 {sources} --distances d.csv"
    ));
}

#[test]
fn runs_are_checked_with_proven_distances() {
    let sandbox = Sandbox::new();
    let run = "run gen:torus,faces=300 --algo vtp,ich --repeat 1 --quiet";
    sandbox.succeed(&format!("{run} --check certificate -o right.json"));
    let cells = &sandbox.json("right.json")["cells"];
    assert_eq!(cells[1]["check"]["reference"], "certificate");
    assert!(cells[1]["check"]["max_rel"].as_f64().unwrap() < 1e-12);
    // No certificate reaches this tolerance.
    let outcome = sandbox.call(&format!(
        "{run} --check certificate{{tolerance=1e-30}} -o unproven.json"
    ));
    assert_eq!(outcome.code, 1);
    let told = sandbox.json("unproven.json")["cells"][0]["message"].to_string();
    assert!(
        told.contains("not checked: the reference certificate"),
        "{told}"
    );
    assert!(told.contains("of a distance is not excluded"), "{told}");
}

#[test]
fn a_right_field_that_is_not_proven_is_not_called_wrong() {
    let sandbox = Sandbox::new();
    let call = "certify gen:anisotropic,g=8,faces=2000 --source 0 --tolerance 1e-15";
    let outcome = sandbox.call(call);
    assert_eq!(outcome.code, 1);
    assert!(
        outcome.stdout.contains("not certified: cannot be proven"),
        "{}",
        outcome.stdout
    );
    assert!(!outcome.stdout.contains("wrong"), "{}", outcome.stdout);
}

/// A finite distance of a vertex that no path reaches differed by infinity / infinity of it, which
/// counted as nothing.
#[test]
fn a_finite_distance_of_an_unreachable_vertex_was_certified() {
    let sandbox = Sandbox::new();
    sandbox.write(
        "apart.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\nf 4 5 6\n",
    );
    let certify = "certify apart.obj --source 0 --format json --distances";
    let right = "vertex,distance\n0,0\n1,1\n2,1\n3,inf\n4,inf\n5,inf\n";
    sandbox.write("right.csv", right);
    sandbox.succeed(&format!("{certify} right.csv"));
    sandbox.write("wrong.csv", &right.replace("4,inf", "4,5"));
    let outcome = sandbox.call(&format!("{certify} wrong.csv"));
    assert_eq!(outcome.code, 1, "{}", outcome.stdout);
    let json: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(json["certified"], false);
    assert_eq!(json["relative"], serde_json::Value::Null);
    assert_eq!(json["failures"][0]["vertex"], 4);
    assert_eq!(json["failures"][0]["wrong"], true);
    assert_eq!(json["failures"].as_array().unwrap().len(), 1);
}
