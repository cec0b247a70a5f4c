//! `geobench algos`.

use crate::support::Sandbox;

#[test]
fn every_algorithm_is_listed() {
    let sandbox = Sandbox::new();
    let text = sandbox.succeed("algos all");
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
    for field in [
        "family",
        "paper",
        "exact",
        "summary",
        "complexity",
        "keeps",
        "choose",
        "departs",
        "parameters",
    ] {
        assert!(!json[0][field].is_null(), "{field}");
        if let Some(fact) = json[0][field].as_str() {
            assert!(text.contains(fact), "{field}");
        }
    }
}

#[test]
fn the_overview_fits_a_terminal() {
    let sandbox = Sandbox::new();
    let text = sandbox.succeed("algos");
    assert!(
        text.lines().all(|line| line.chars().count() <= 80),
        "{text}"
    );
    assert!(text.lines().count() < 130, "{text}");
    let json: serde_json::Value =
        serde_json::from_str(&sandbox.succeed("algos --format json")).unwrap();
    for algorithm in json.as_array().unwrap() {
        let name = algorithm["name"].as_str().unwrap();
        let own = |line: &str| line.split_whitespace().next() == Some(name);
        assert!(text.lines().any(own), "{name}:\n{text}");
    }
    assert!(text.contains("Which one to take"));
}

#[test]
fn a_part_of_the_list_can_be_asked_for() {
    let sandbox = Sandbox::new();
    let text = sandbox.succeed("algos ich");
    assert!(text.contains("Xin, Wang 2009"));
    assert!(!text.contains("Mitchell"));
    assert!(sandbox.refuse("algos ihc").contains("did you mean `ich`?"));
    let outside = sandbox.refuse("algos vtp,ext:own");
    assert!(
        outside.starts_with("ext:own is an outside program"),
        "{outside}"
    );
}

#[test]
fn every_counter_is_defined() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("run square.off --repeat 1 --quiet -o r.json");
    let counters = sandbox.json("r.json")["cells"][0]["counters"].clone();
    let listed: serde_json::Value =
        serde_json::from_str(&sandbox.succeed("algos --counters --format json")).unwrap();
    let text = sandbox.succeed("algos --counters");
    for counter in listed.as_array().unwrap() {
        let name = counter["name"].as_str().unwrap();
        assert!(counters.get(name).is_some(), "{name}");
        assert!(text.contains(name), "{name}");
    }
    assert_eq!(
        listed.as_array().unwrap().len(),
        counters.as_object().unwrap().len()
    );
}
