use crate::support::Sandbox;

/// Six runs of two algorithms, stored as `name`.
fn stored(sandbox: &Sandbox, name: &str) {
    sandbox.succeed(&format!(
        "run square.off gen:cube,n=3 --algo mmp,vtp -o {name} --quiet"
    ));
}

#[test]
fn a_run_is_no_worse_than_itself() {
    let sandbox = Sandbox::with_square();
    stored(&sandbox, "a.json");
    let shown = sandbox.succeed(
        "compare a.json a.json --fail-on time=0,propagated=0,heap_peak_bytes=0 -o c.json -o c.md -o c.txt",
    );
    assert!(shown.ends_with("none of 4 cells is worse\n"), "{shown}");
    assert_eq!(sandbox.read("c.txt"), shown);
    let json = sandbox.json("c.json");
    assert_eq!(json["schema"], "geobench-comparison/1");
    assert_eq!(json["cells"].as_array().unwrap().len(), 4);
    let markdown = sandbox.succeed("compare a.json a.json --format markdown");
    assert!(markdown.starts_with("### geobench: none of 4 cells is worse\n\n| Cell | Time |"));
    assert!(
        sandbox
            .read("c.md")
            .starts_with("### geobench: none of 4 cells is worse")
    );
}

#[test]
fn a_count_beyond_its_rule_is_status_1() {
    let sandbox = Sandbox::with_square();
    stored(&sandbox, "a.json");
    let mut changed = sandbox.json("a.json");
    let count = &mut changed["cells"][0]["counters"]["propagated"];
    *count = (count.as_u64().unwrap() + 1).into();
    sandbox.write("b.json", &changed.to_string());
    let without = sandbox.succeed("compare a.json b.json");
    assert!(
        without.contains("no rules, so that no figure is judged; times"),
        "{without}"
    );
    let outcome = sandbox.call("compare a.json b.json --fail-on propagated=0,time=10%");
    assert_eq!(outcome.code, 1);
    assert!(outcome.stdout.contains("1 of 4 cells is worse"));
    assert_eq!(outcome.stderr, "");
}

#[test]
fn missing_cells_are_status_1_under_the_rule_missing() {
    let sandbox = Sandbox::with_square();
    stored(&sandbox, "a.json");
    let mut part = sandbox.json("a.json");
    part["cells"].as_array_mut().unwrap().remove(0);
    sandbox.write("part.json", &part.to_string());
    let listed = sandbox.succeed("compare a.json part.json");
    assert!(
        listed.contains("only in the old file:\n  square, mmp"),
        "{listed}"
    );
    let outcome = sandbox.call("compare a.json part.json --fail-on missing=0");
    assert_eq!(outcome.code, 1);
    assert!(
        outcome
            .stdout
            .ends_with("none of 3 cells is worse; 1 of 4 cells is missing\n"),
        "{}",
        outcome.stdout
    );
    let markdown = sandbox.call("compare a.json part.json --fail-on missing=0 --format markdown");
    assert!(
        markdown
            .stdout
            .contains("\n- 1 of 4 cells is missing [missing=0]\n"),
        "{}",
        markdown.stdout
    );
}

/// A label may hide a parameter at its default. Cells are joined by name and all parameters.
#[test]
fn cells_with_another_queue_in_the_plan_are_other_cells() {
    let sandbox = Sandbox::with_square();
    stored(&sandbox, "a.json");
    let mut changed = sandbox.json("a.json");
    let parameters = &mut changed["plan"]["groups"][0]["algorithms"][0]["parameters"];
    assert_eq!(parameters["queue"], "heap");
    assert_eq!(parameters["crossing"], "single");
    parameters["queue"] = "calendar".into();
    sandbox.write("b.json", &changed.to_string());
    let listed = sandbox.succeed("compare a.json b.json");
    for line in [
        "only in the old file:\n  square, mmp,",
        "only in the new file:\n  square, mmp{queue=calendar},",
        "\nnone of 2 cells is worse\n",
    ] {
        assert!(listed.contains(line), "{line}: {listed}");
    }
    // A record of a version without these keys had calendar queues.
    let parameters = &mut changed["plan"]["groups"][0]["algorithms"][0]["parameters"];
    let parameters = parameters.as_object_mut().unwrap();
    parameters.remove("queue");
    parameters.remove("crossing");
    sandbox.write("old.json", &changed.to_string());
    let outcome = sandbox.call("compare b.json old.json --fail-on missing=0");
    assert_eq!(outcome.code, 0, "{}", outcome.stdout);
    assert!(
        outcome.stdout.contains("none of 4 cells is worse"),
        "{}",
        outcome.stdout
    );

    // Nor is a cell of one queue taken for that of another.
    sandbox.succeed("run square.off gen:cube,n=3 --algo mmp --add-to b.json --quiet");
    let cells = sandbox.json("b.json")["cells"].as_array().unwrap().clone();
    let mut labels: Vec<&str> = cells
        .iter()
        .map(|c| c["algorithm"].as_str().unwrap())
        .collect();
    labels.sort_unstable();
    labels.dedup();
    assert_eq!(labels, ["mmp", "mmp{queue=calendar}", "vtp"]);
    let recorded = sandbox.json("b.json")["algorithms"]
        .as_array()
        .unwrap()
        .len();
    assert_eq!(recorded, 3);
}

#[test]
fn files_that_do_not_compare_are_status_2_with_file_and_field() {
    let sandbox = Sandbox::with_square();
    stored(&sandbox, "a.json");
    sandbox.succeed("run gen:cube,n=2 --algo mmp -o other.json --quiet --repeat 1");
    assert!(
        sandbox
            .refuse("compare a.json other.json")
            .starts_with("a.json and other.json have no cell in common")
    );
    assert!(
        sandbox
            .refuse("compare a.json none.json")
            .starts_with("none.json: cannot be read: ")
    );
    let text = sandbox.read("a.json");
    sandbox.write("b.json", &text.replace("geobench/1", "geobench/9"));
    assert_eq!(
        sandbox.refuse("compare a.json b.json"),
        "b.json: `schema` is `geobench/9`, but this version of geobench reads `geobench/1`"
    );
    let mut bad = sandbox.json("a.json");
    bad["cells"][3]["time"]["samples"][1] = "soon".into();
    sandbox.write("b.json", &bad.to_string());
    let message = sandbox.refuse("compare b.json a.json");
    assert!(
        message.starts_with(
            "b.json: field `cells[3].time.samples[1]`: invalid type: string \"soon\", expected f64"
        ),
        "{message}"
    );
    // The text is cut between two fields. A cut within a number or a word would give another error.
    let (whole, _) = text.split_once("\"cells\"").expect("it has cells");
    sandbox.write("b.json", whole);
    assert!(
        sandbox
            .refuse("compare a.json b.json")
            .starts_with("b.json: not a result file: EOF while parsing")
    );
    let message = sandbox.refuse("compare a.json a.json --fail-on heap_peak=5%");
    assert!(
        message.contains("there is no rule `heap_peak`"),
        "{message}"
    );
    assert!(
        sandbox
            .refuse("compare a.json a.json -o c.csv")
            .ends_with("use .json, .md or .txt")
    );
}
