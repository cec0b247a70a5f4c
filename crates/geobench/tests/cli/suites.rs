//! `geobench suites`, `run --suite`, and the help.

use crate::support::Sandbox;

#[test]
fn a_suite_of_the_program_runs_on_other_models() {
    let sandbox = Sandbox::with_square();
    let list = sandbox.succeed("suites");
    let line = list.lines().find(|line| line.contains("000-section-6.2"));
    assert!(line.unwrap().contains("prime and secondary"), "{list}");
    sandbox.succeed("run --suite 000-section-6.2 square.off --quiet -o r.json");
    let result = sandbox.json("r.json");
    let groups = result["groups"].as_array().unwrap();
    assert!(groups.iter().all(|group| group["shows"].is_null()));
    assert_eq!(result["cells"][0]["model"], "square");
    let error = sandbox.refuse("run --suite 000-section-62");
    assert!(error.contains("`000-section-6.2`"), "{error}");
    let error = sandbox.refuse("run --suite quick --config quick.toml");
    assert!(error.contains("cannot be used with"), "{error}");
}

#[test]
fn a_suite_with_other_models_is_not_compared_with_its_paper() {
    let sandbox = Sandbox::with_square();
    let run = "run --suite 000-table-3 --repeat 1 --warmup 0 --quiet";
    sandbox.succeed(&format!("{run} square.off -o r.json"));
    sandbox.succeed("report r.json -o r.html");
    assert!(!sandbox.read("r.html").contains("Qin et al. 2016"));
    sandbox.succeed("report r.json -o r.html --papers 000-table-3");
    assert!(sandbox.read("r.html").contains("Qin et al. 2016"));
}

#[test]
fn help_has_groups_and_examples() {
    let sandbox = Sandbox::new();
    let help = sandbox.succeed("run --help");
    for heading in [
        "What runs:",
        "Sources and targets:",
        "Repetitions:",
        "Checks:",
        "Processes:",
        "Output:",
        "Parts and continuation:",
        "Examples:\n  geobench run ",
    ] {
        assert!(help.contains(heading), "{heading}: {help}");
    }
}
