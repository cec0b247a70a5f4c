use crate::support::Sandbox;

#[test]
fn rounds_become_one_file() {
    let sandbox = Sandbox::with_square();
    for round in 1..=6 {
        sandbox.succeed(&format!(
            "run square.off --algo mmp,vtp --repeat 1 --warmup 0 -o {round}.json --quiet"
        ));
    }
    sandbox.succeed(
        "pool 1.json 2.json 3.json 4.json 5.json 6.json --pairing turns -o all.json -o all.csv",
    );
    let all = sandbox.json("all.json");
    assert_eq!(all["pairing"], "turns");
    assert_eq!(all["cells"].as_array().unwrap().len(), 2);
    let time = &all["cells"][1]["time"];
    assert_eq!(time["samples"].as_array().unwrap().len(), 6);
    assert!(time["ci95"].is_array() && time["note"].is_null());
    let third = &sandbox.json("3.json")["cells"][1]["time"]["samples"][0];
    assert_eq!(&time["samples"][2], third);
    assert_eq!(sandbox.read("all.csv").lines().count(), 3);
}

#[test]
fn rounds_of_other_benchmarks_are_refused() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("run square.off --algo mmp,vtp --repeat 1 --warmup 0 -o a.json --quiet");
    sandbox.succeed("run square.off --algo mmp --repeat 1 --warmup 0 -o b.json --quiet");
    assert_eq!(
        sandbox.refuse("pool a.json b.json -o c.json"),
        "b.json: not a round of the same benchmark as a.json: it has another number of models or cells"
    );
    assert!(
        sandbox
            .refuse("pool a.json square.off -o c.json")
            .starts_with("square.off: not a result file: expected value")
    );
    assert!(!sandbox.path("c.json").exists());
}
