use crate::support::{Sandbox, UNUSABLE};

/// A sandbox with a small result, `r.json`.
fn with_result() -> Sandbox {
    let sandbox = Sandbox::with_square();
    sandbox.succeed(
        "run square.off gen:sphere,subdiv=1 --algo mmp,vtp --repeat 1 --warmup 0 -o r.json --quiet --format csv",
    );
    sandbox
}

#[test]
fn a_page_holds_everything() {
    let sandbox = with_result();
    assert_eq!(sandbox.succeed("report r.json -o r.html"), "r.html\n");
    let page = sandbox.read("r.html");
    assert!(page.starts_with("<!DOCTYPE html>"));
    for part in [
        "<title>Exact geodesic distances: r</title>",
        "square",
        "Time as a multiple of vtp",
        "data:image/png;base64,",
        "download=\"r.json\"",
        "download=\"r.csv\"",
        "Processors in use",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn a_page_of_joined_files_names_them_and_how_they_differ() {
    let sandbox = with_result();
    sandbox.succeed(
        "run square.off --algo ich --check none --repeat 1 --warmup 0 --timeout 90s -o s.json --quiet --format csv",
    );
    sandbox.succeed("report r.json s.json -o r.html --quiet");
    let page = sandbox.read("r.html");
    for part in [
        "<title>Exact geodesic distances: r, s</title>",
        "`timeout` is 90.0 in s.json and ",
        "1 of 5 answers were not compared with a reference.",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn files_to_take_into_a_paper() {
    let sandbox = with_result();
    let told =
        sandbox.succeed("report r.json --format svg figures --format csv data --format tex data");
    assert!(told.contains(" files in figures\n"), "{told}");
    let svg = sandbox.read("figures/g1-time.svg");
    assert!(svg.starts_with("<?xml") && svg.trim_end().ends_with("</svg>"));
    assert!(
        sandbox
            .read("data/g1-time.csv")
            .starts_with("of,series,x,value,low,high,absent\nsquare,mmp,")
    );
    assert!(sandbox.read("data/g1-table.tex").contains("\\toprule"));
    sandbox.succeed("report r.json --format html page --quiet");
    assert!(sandbox.path("page/report.html").exists());
}

#[test]
fn the_picture_is_chosen() {
    let sandbox = with_result();
    sandbox.succeed("report r.json -o r.html --picture sphere,subdiv=1:7");
    let page = sandbox.read("r.html");
    assert!(page.contains("Distances on sphere,subdiv=1") && page.contains("From vertex 7 "));
    sandbox.succeed("report r.json -o r.html --picture none");
    assert!(!sandbox.read("r.html").contains("data:image/png"));
    let error = sandbox.refuse("report r.json -o r.html --picture cube");
    assert_eq!(
        error,
        "--picture cube: the result has no such model; it has square, sphere,subdiv=1"
    );
    // The model does not exist any more. There is no picture, which is an error only if one was
    // requested.
    sandbox.write("square.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    let error = sandbox.refuse("report r.json -o r.html --picture square");
    assert_eq!(
        error,
        "no picture of square: square.off is not what was measured, its hash differs"
    );
    sandbox.succeed("report r.json -o r.html");
    assert!(
        sandbox
            .read("r.html")
            .contains("Distances on sphere,subdiv=1")
    );
}

#[test]
fn unusable_results_are_refused() {
    let sandbox = with_result();
    assert!(
        sandbox
            .refuse("report no.json -o r.html")
            .starts_with("no.json: cannot be read: ")
    );
    assert!(
        sandbox
            .refuse("report square.off -o r.html")
            .starts_with("square.off: not a result file: ")
    );
    sandbox.write("other.json", "{\"schema\": \"geobench/9\"}");
    assert!(
        sandbox
            .refuse("report r.json other.json -o r.html")
            .contains("`schema` is `geobench/9`")
    );
    let mut empty = sandbox.json("r.json");
    empty["cells"] = serde_json::json!([]);
    sandbox.write("empty.json", &empty.to_string());
    assert_eq!(
        sandbox.refuse("report empty.json -o r.html"),
        "empty.json: it has no cells, so there is nothing to report"
    );
    assert!(sandbox.refuse("report r.json").contains("--output"));
    assert_eq!(
        sandbox.refuse("report r.json --format pdf here"),
        "--format pdf: use html, svg, csv or tex"
    );
    assert!(
        sandbox
            .refuse("report r.json -o no/such/r.html")
            .contains("its directory does not exist")
    );
    assert!(
        sandbox
            .refuse("report r.json --format svg square.off")
            .starts_with("square.off: cannot be made")
    );
    assert_eq!(
        sandbox.refuse("report r.json -o r.html --ratio-to ich"),
        "--ratio-to ich: no group has this algorithm; there are mmp, vtp"
    );
    assert!(
        sandbox
            .refuse("report r.json -o r.html --papers 000-table-9")
            .contains("known are 000-figure-12")
    );
    assert!(!sandbox.path("r.html").exists());
}

#[test]
fn a_result_in_which_all_failed_can_be_read() {
    let sandbox = Sandbox::new();
    sandbox.write("broken.off", UNUSABLE);
    let outcome = sandbox.call("run broken.off --algo mmp,vtp -o r.json --quiet");
    assert_eq!(outcome.code, 2);
    sandbox.succeed("report r.json -o r.html");
    let page = sandbox.read("r.html");
    assert!(page.contains("0 of 2 cells ended well. The others: 2 refused."));
    assert!(
        page.contains("<li class=\"failed\">broken: refused: "),
        "{page}"
    );
}

#[test]
fn pipes_and_devices_are_no_models_to_draw() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("run square.off --algo mmp --repeat 1 --quiet -o r.json");
    let pipe = sandbox.path("pipe.off");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    for path in ["pipe.off", "gen:file,path=pipe.off", "-"] {
        let mut file = sandbox.json("r.json");
        file["models"][0]["path"] = path.into();
        sandbox.write("other.json", &file.to_string());
        sandbox.succeed("report other.json -o page.html --quiet");
        let message = sandbox.refuse("report other.json -o page.html --picture square");
        assert!(message.contains("no picture of square"), "{message}");
    }
}

#[test]
fn a_long_name_of_a_model_makes_no_long_name_of_a_file() {
    let sandbox = Sandbox::new();
    let name = "m".repeat(245);
    sandbox.write(&format!("{name}.off"), crate::support::SQUARE);
    sandbox.succeed(&format!(
        "run {name}.off --algo mmp --repeat 1 --quiet -o r.json"
    ));
    sandbox.succeed("report r.json --format svg plots --quiet");
}
