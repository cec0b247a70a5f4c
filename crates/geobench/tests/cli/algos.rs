//! `geobench algos`.

use crate::support::Sandbox;

#[test]
fn every_algorithm_is_listed() {
    let sandbox = Sandbox::new();
    let text = sandbox.succeed("algos");
    let json: serde_json::Value =
        serde_json::from_str(&sandbox.succeed("algos --format json")).unwrap();
    let names: Vec<&str> = json
        .as_array()
        .unwrap()
        .iter()
        .map(|a| a["name"].as_str().unwrap())
        .collect();
    for name in ["mmp", "ich", "vtp"] {
        assert!(names.contains(&name));
        assert!(text.contains(name));
    }
    for field in ["family", "paper", "exact", "summary", "complexity"] {
        assert!(!json[0][field].is_null(), "{field}");
    }
}
