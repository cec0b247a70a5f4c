//! `geobench claims` on results of the papers' suites and on files of users.

use std::path::Path;

use crate::support::Sandbox;

/// A sandbox with `r.json`, the result of a suite on small models.
fn with_result() -> Sandbox {
    let sandbox = Sandbox::new();
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../bench-configs");
    let suite = std::fs::read_to_string(configs.join("000-figure-12.toml")).unwrap();
    std::fs::create_dir(sandbox.path("bench-configs")).unwrap();
    sandbox.write("bench-configs/000-figure-12.toml", &suite);
    sandbox.succeed(
        "run --config bench-configs/000-figure-12.toml gen:octahedron gen:cube,n=2 \
         --repeat 1 --warmup 0 -o r.json --quiet --format csv",
    );
    sandbox
}

/// A claim about the least distance from the reference, which always holds.
const EXACT: &str = r#"paper = "mine"
title = "Mine"
[[claim]]
id = "mine-propagations"
place = "Table 1"
quote = "some"
claim = "Something is propagated"
suite = "000-figure-12"
[[claim.test]]
of = ["vtp"]
figure = "propagated"
holds = "> 0"
"#;

#[test]
fn verdicts_are_a_page_and_data() {
    let sandbox = with_result();
    let page = sandbox.succeed("claims r.json");
    assert!(page.starts_with("# The papers' claims, one by one\n"));
    assert!(page.contains("| Rule 1 saves propagations: "));
    assert!(page.contains("there is no result of the suite 002-table-1"));
    assert_eq!(
        sandbox.succeed("claims r.json -o page.md --quiet"),
        "",
        "the page is in the file"
    );
    assert_eq!(sandbox.read("page.md"), page);

    sandbox.write("mine.toml", EXACT);
    sandbox.succeed("claims r.json --claims mine.toml -o mine.json --quiet");
    let json = sandbox.json("mine.json");
    assert_eq!(json.as_array().unwrap().len(), 1);
    assert_eq!(json[0]["id"], "mine-propagations");
    assert_eq!(json[0]["verdict"], "confirmed");
    let values = json[0]["values"].as_object().unwrap();
    assert_eq!(values.len(), 2);
    assert!(values["vtp, octahedron"]["value"].as_f64().unwrap() > 0.0);
    let text = sandbox.succeed("claims r.json --claims mine.toml --format text");
    assert!(text.contains("mine-propagations") && text.contains("confirmed"));
}

/// Verdicts do not affect the exit status; unusable files do.
#[test]
fn verdicts_do_not_change_the_exit_status() {
    let sandbox = with_result();
    sandbox.write("not.toml", &EXACT.replace("> 0", "< 0"));
    let table = sandbox.succeed("claims r.json --claims not.toml --format csv");
    assert!(table.contains(",not,"), "{table}");

    let error = sandbox.refuse("claims r.json --claims none.toml");
    assert!(error.starts_with("none.toml: "), "{error}");
    let error = sandbox.refuse("claims none.json");
    assert!(error.starts_with("none.json: "), "{error}");
    let error = sandbox.refuse("claims r.json r.json");
    assert!(
        error.contains("are both results of the suite 000-figure-12"),
        "{error}"
    );
    for (from, to, expected) in [
        ("[\"vtp\"]", "[\"vtp\"", "broken.toml, line 11: "),
        (
            "[\"vtp\"]",
            "[\"vpt\"]",
            "broken.toml, line 10: `of`: there is no algorithm `vpt`",
        ),
        ("> 0", "0", "broken.toml, line 12: `holds`: `0` is no range"),
    ] {
        sandbox.write("broken.toml", &EXACT.replace(from, to));
        let error = sandbox.refuse("claims r.json --claims broken.toml");
        assert!(error.starts_with(expected), "{error}");
    }
}
