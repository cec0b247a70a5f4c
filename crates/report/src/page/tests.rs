//! Tests of reports on mock results.

use std::path::PathBuf;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use geobench_harness::exec::limits::DecompressionLimit;
use geobench_harness::exec::mock::{MockBackend, crash_ich};
use geobench_harness::exec::model::ModelRef;
use geobench_harness::run::mock::{plan, result, run_mock};
use geobench_harness::schema::{GroupRecord, ResultFile, result_file};
use sha2::{Digest, Sha256};

use super::files::files;
use super::{BuiltReport, Form, Input, Options, PictureChoice, Tables, build, page};
use crate::table::tests::mixed_with;

/// A name of a model that needs escaping.
const NASTY: &str = "<b>&\"'";

fn mixed() -> ResultFile {
    mixed_with(NASTY)
}

fn options() -> Options {
    Options {
        ratio_to: None,
        picture: PictureChoice::None,
        decompressed: DecompressionLimit::default(),
        tables: Tables::OfSuite,
    }
}

fn report_on(result: ResultFile, options: &Options) -> BuiltReport {
    let path = PathBuf::from("some/run.json");
    build(&[Input::new(path, result)], options).unwrap()
}

/// The file of this name in one form, as text.
fn file(report: &BuiltReport, form: Form, name: &str) -> String {
    let all = files(report, form).unwrap();
    let names: Vec<&String> = all.iter().map(|(name, _)| name).collect();
    let found = all.iter().find(|(n, _)| n == name);
    let (_, contents) = found.unwrap_or_else(|| panic!("{name} is not among {names:?}"));
    String::from_utf8(contents.clone()).unwrap()
}

#[test]
fn the_table_as_csv_and_tex() {
    let report = report_on(mixed(), &options());
    insta::assert_snapshot!("table_csv", file(&report, Form::Csv, "g1-table.csv"));
    insta::assert_snapshot!("table_tex", file(&report, Form::Tex, "g1-table.tex"));
}

#[test]
fn the_numbers_behind_the_plots() {
    let report = report_on(mixed(), &options());
    insta::assert_snapshot!("ratio_csv", file(&report, Form::Csv, "g1-ratio.csv"));
    insta::assert_snapshot!("phases_csv", file(&report, Form::Csv, "g1-phases.csv"));
}

#[test]
fn plots_as_svg_and_in_latex() {
    let report = report_on(mixed(), &options());
    insta::assert_snapshot!("time_svg", file(&report, Form::Svg, "g1-time.svg"));
    insta::assert_snapshot!("phases_svg", file(&report, Form::Svg, "g1-phases.svg"));
    let drawing = file(&report, Form::Tex, "g1-time.svg");
    assert_eq!(drawing, file(&report, Form::Svg, "g1-time.svg"));
    let inclusion = file(&report, Form::Tex, "g1-time.tex");
    assert!(
        inclusion.ends_with("\n\\includesvg[width=\\linewidth]{g1-time}\n"),
        "{inclusion}"
    );
}

/// The contents of the script elements of a page, including those that hold data.
fn scripts(page: &str) -> Vec<&str> {
    let starts = page.split("<script").skip(1);
    let inside = |rest: &str| {
        let start = rest.find('>').map_or(0, |at| at + 1);
        start..rest.find("</script>").unwrap_or(rest.len())
    };
    starts.map(|rest| &rest[inside(rest)]).collect()
}

/// The page without the contents of its script elements.
fn markup(page: &str) -> String {
    scripts(page)
        .into_iter()
        .filter(|script| !script.is_empty())
        .fold(page.to_owned(), |page, script| page.replace(script, ""))
}

/// The page without styles, drawings, scripts and data, which other tests cover.
fn bare(page: &str) -> String {
    let mut text = page.to_owned();
    for (from, to) in [
        ("<style>", "</style>"),
        ("<svg", "</svg>"),
        ("<script type=\"application/json\">", "</script>"),
        ("<script>", "</script>"),
        ("'sha256-", "'\""),
        ("base64,", "\""),
    ] {
        let mut rest = text.as_str();
        let mut kept = String::new();
        while let Some(start) = rest.find(from) {
            let end = rest[start..].find(to).map_or(rest.len(), |e| start + e);
            kept += &rest[..start + from.len()];
            kept.push_str("...");
            rest = &rest[end..];
        }
        text = kept + rest;
    }
    text.replace(env!("CARGO_PKG_VERSION"), "VERSION")
}

#[test]
fn the_page() {
    let html = page(&report_on(mixed(), &options()));
    insta::assert_snapshot!("page", bare(&html));
}

#[test]
fn names_cannot_break_the_page() {
    let mut result = mixed();
    result.groups = vec![GroupRecord {
        shows: Some("<script>alert(1)</script> & more".into()),
        ..GroupRecord::default()
    }];
    result.command.push("</style><img src=x>".into());
    let html = page(&report_on(result, &options()));
    // The last script is that of the page, the only one whose hash the policy allows.
    let mut scripts = scripts(&html);
    assert!(!scripts.pop().unwrap().contains("alert"));
    for data in scripts {
        assert!(!data.contains('<'), "{data}");
    }
    let own = "<script type=\"application/json\">";
    let html = markup(&html).replace(own, "").replace("<script>", "");
    let (_, html) = html.split_once("<title>").unwrap();
    for raw in ["<script", "<img", "<b>&", "\"'"] {
        assert!(!html.contains(raw), "{raw}");
    }
    for escaped in [
        "&lt;b&gt;&amp;&quot;&#39;",
        "&lt;script&gt;alert(1)&lt;/script&gt; &amp; more",
    ] {
        assert!(html.contains(escaped), "{escaped}");
    }
}

#[test]
fn elements_are_balanced_and_identifiers_unique() {
    let html = markup(&page(&report_on(mixed(), &options())));
    let mut ids: Vec<&str> = html
        .split(" id=\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        .collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count, "an identifier stands there twice");
    for name in [
        "section", "table", "tbody", "tr", "figure", "svg", "g", "ul", "dl", "div", "p",
    ] {
        let opened =
            html.matches(&format!("<{name}>")).count() + html.matches(&format!("<{name} ")).count();
        let closed = html.matches(&format!("</{name}>")).count();
        assert_eq!(opened, closed, "{name}");
    }
    // All targets of links and patterns exist.
    for target in html
        .split("href=\"#")
        .skip(1)
        .chain(html.split("url(#").skip(1))
    {
        let id = target.split(['"', ')']).next().unwrap();
        assert!(ids.binary_search(&id).is_ok(), "{id}");
    }
}

#[test]
fn nothing_is_asked_of_the_network_and_one_script_runs() {
    let html = page(&report_on(mixed(), &options()));
    for word in [
        "http://",
        "https://",
        "@import",
        "javascript:",
        " onload",
        "fetch(",
        "XMLHttpRequest",
        "import(",
        "eval(",
        "innerHTML",
    ] {
        // Browsers do not request the SVG namespace, although it is a URL.
        let text = html.replace("http://www.w3.org/2000/svg", "");
        assert!(!text.contains(word), "{word}");
    }
    assert_eq!(html.matches("<script>").count(), 1);
    assert!(html.contains("default-src 'none'"));
    let script = scripts(&html).pop().unwrap();
    let hash = STANDARD.encode(Sha256::digest(script));
    assert!(html.contains(&format!("script-src 'sha256-{hash}'")));
    assert!(html.len() < 200_000, "{} bytes", html.len());
}

/// Filters select parts of plots by the same names as tables.
#[test]
fn parts_of_plots_name_their_models_and_algorithms() {
    let html = page(&report_on(mixed(), &options()));
    for part in [
        "<g data-model=\"horse\">",
        "<g data-model=\"&lt;b&gt;&amp;&quot;&#39;\">",
        "<g data-algorithm=\"vtp\">",
        "<title>horse, vtp: ",
    ] {
        assert!(html.contains(part), "{part}");
    }
}

#[test]
fn a_crash_is_seen_in_table_plot_and_remarks() {
    let backend = MockBackend {
        alter: Some(crash_ich),
        ..MockBackend::default()
    };
    let records = run_mock(&plan(&["horse"], "mmp,ich,vtp", "0"), &backend);
    let report = report_on(result(records), &options());
    let html = page(&report);
    assert!(html.contains("<td class=\"n failed\">crashed</td>"));
    assert!(html.contains(
        "<li class=\"failed\">horse: ich, source 0: crashed: the algorithm panicked: index out of bounds</li>"
    ));
    let svg = file(&report, Form::Svg, "g1-time.svg");
    assert!(svg.contains(">crashed</text>"), "{svg}");
    let csv = file(&report, Form::Csv, "g1-time.csv");
    assert!(csv.contains("horse,ich,,,,,crashed"), "{csv}");
}

#[test]
fn if_all_failed_there_is_a_page_all_the_same() {
    let backend = MockBackend {
        refuse: vec!["a", "b"],
        ..MockBackend::default()
    };
    let records = run_mock(&plan(&["a", "b"], "mmp,vtp", "0"), &backend);
    let report = report_on(result(records), &options());
    let html = page(&report);
    assert!(
        html.contains("0 of 4 cells ended well. The others: 4 refused."),
        "{}",
        bare(&html)
    );
    assert!(!html.contains("<figure"));
    for form in [Form::Svg, Form::Csv, Form::Tex] {
        files(&report, form).unwrap();
    }
}

#[test]
fn ratios_are_to_the_algorithm_that_was_asked_for() {
    let to = |name: &str| Options {
        ratio_to: Some(name.to_owned()),
        ..options()
    };
    let report = report_on(mixed(), &to("ich"));
    let csv = file(&report, Form::Csv, "g1-ratio.csv");
    assert!(
        csv.contains("horse,mmp,,") && !csv.contains("horse,ich,"),
        "{csv}"
    );
    let path = PathBuf::from("r.json");
    let inputs = [Input::new(path, mixed())];
    let error = build(&inputs, &to("fwp-ch")).unwrap_err().to_string();
    assert_eq!(
        error,
        "--ratio-to fwp-ch: no group has this algorithm; there are mmp, ich, vtp"
    );
}

/// Models that differ in size alone.
fn sizes() -> ResultFile {
    let mut plan = plan(&[], "mmp,vtp", "0");
    let sizes = [1, 2, 3, 4].map(|n| format!("gen:sphere,subdiv={n}"));
    plan.models = sizes
        .iter()
        .map(|spec| ModelRef::generated(spec).unwrap())
        .collect();
    let mut result = result(run_mock(&plan, &MockBackend::default()));
    for (i, model) in result.models.iter_mut().enumerate() {
        model.faces = Some(80 << (2 * i));
    }
    result
}

#[test]
fn models_that_differ_in_size_alone_make_lines() {
    let report = report_on(sizes(), &options());
    insta::assert_snapshot!(
        "scaling_csv",
        file(&report, Form::Csv, "g1-ratio-faces-0.csv")
    );
    insta::assert_snapshot!(
        "scaling_svg",
        file(&report, Form::Svg, "g1-time-faces-0.svg")
    );
}

/// Two exact algorithms and two approximate ones on one model, with these set-up times, solve times
/// and errors.
fn approximate() -> ResultFile {
    let records = run_mock(
        &plan(&["horse"], "mmp,vtp,heat,svg", "0"),
        &MockBackend::default(),
    );
    let mut result = result(records);
    for cell in &mut result.cells {
        let (setup, solve, error) = match cell.algorithm.as_str() {
            "mmp" => (0.0, 4.0, 0.0),
            "vtp" => (0.5, 1.0, 1e-15),
            "heat" => (3.0, 0.75, 0.04),
            _ => (100.0, 0.125, 0.01),
        };
        cell.time.setup = Some(setup);
        cell.time.median = Some(solve);
        cell.time.ci95 = None;
        cell.check.mean_rel = Some(error);
        cell.check.max_rel = Some(2.0 * error);
        cell.approximate = error > 1e-6;
    }
    result
}

#[test]
fn errors_beside_times_have_a_front() {
    let report = report_on(approximate(), &options());
    let csv = file(&report, Form::Csv, "g1-mean-error.csv");
    let front: Vec<&str> = csv.lines().filter(|l| l.contains("front")).collect();
    // `heat` is slower and less accurate than the graph; `mmp` is slower than `vtp` and as exact.
    assert_eq!(
        front,
        [
            "Time (s),horse: front,0.125,0.01,,,",
            "Time (s),horse: front,1,0.000001,,,"
        ]
    );
    let svg = file(&report, Form::Svg, "g1-error.svg");
    assert_eq!(svg.matches("class=\"front\"").count(), 1);
    let html = page(&report);
    assert!(
        html.contains("On the front: svg (approx.), vtp."),
        "{}",
        bare(&html)
    );
    // Without approximate algorithms, the plot shows rounding errors.
    let names: Vec<String> = files(&report_on(mixed(), &options()), Form::Svg)
        .unwrap()
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    assert!(
        !names.contains(&"g1-mean-error.svg".to_owned()),
        "{names:?}"
    );
}

#[test]
fn set_up_is_paid_once() {
    let report = report_on(approximate(), &options());
    let csv = file(&report, Form::Csv, "g1-sources-table.csv");
    let rows: Vec<&str> = csv.lines().skip(1).collect();
    // 3 + 0.75 k is less than 0.5 + k for k > 10, and 100 + k / 8 for k > 113.7.
    assert_eq!(
        rows,
        [
            "horse,mmp,0,4.00,4.00,400,40000,never",
            "horse,vtp,0.500,1.00,1.50,100,10000,",
            "horse,heat (approx.),3.00,0.750,3.75,78.0,7503,from 11 on",
            "horse,svg (approx.),100,0.125,100,112,1350,from 114 on",
        ]
    );
    let csv = file(&report, Form::Csv, "g1-sources-0.csv");
    assert!(csv.contains("Sources,heat meets vtp,10,10.5,"), "{csv}");
    let html = page(&report);
    let words = "heat from 11 sources on, svg from 114 sources on";
    assert!(html.contains(words), "{}", bare(&html));
}

#[test]
fn many_models_share_lanes() {
    let names: Vec<String> = (0..30).map(|i| format!("model {i}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let records = run_mock(&plan(&names, "mmp,ich,vtp", "0"), &MockBackend::default());
    let report = report_on(result(records), &options());
    let svg = file(&report, Form::Svg, "g1-time.svg");
    // A lane for each model, named once, and a legend that names each algorithm once.
    assert_eq!(svg.matches(">model 7</text>").count(), 1);
    assert_eq!(svg.matches(">ich</text>").count(), 1);
    assert_eq!(svg.matches("class=\"lane\"").count(), 30);
    let csv = file(&report, Form::Csv, "g1-time.csv");
    assert_eq!(csv.lines().count(), 1 + 30 * 3);
}

#[test]
fn charts_of_very_many_models_show_the_first() {
    let names: Vec<String> = (0..400).map(|i| format!("model {i}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let records = run_mock(&plan(&names, "mmp,vtp", "0"), &MockBackend::default());
    let report = report_on(result(records), &options());
    let svg = file(&report, Form::Svg, "g1-time.svg");
    assert_eq!(svg.matches("class=\"lane\"").count(), 300);
    assert!(svg.contains(">first 300 of 400 models; Time (s)</text>"));
    let svg = file(&report, Form::Svg, "g1-phases.svg");
    assert!(svg.contains(">first 150 of 400 models; Time, "));
    let csv = file(&report, Form::Csv, "g1-time.csv");
    assert_eq!(csv.lines().count(), 1 + 400 * 2);
}

#[test]
fn the_papers_ratios_stand_beside_ours() {
    let records = run_mock(
        &plan(&["horse"], "mmp,ich,vtp,fwp-ch", "0"),
        &MockBackend::default(),
    );
    let mut result = result(records);
    result.command = [
        "geobench",
        "run",
        "--config",
        "bench-configs/003-table-1.toml",
    ]
    .map(str::to_owned)
    .to_vec();
    // The models are those of the suite.
    result.groups.push(GroupRecord {
        shows: Some("text".into()),
        ..GroupRecord::default()
    });
    let report = report_on(result, &options());
    // The mock horse has as many faces as the paper's.
    insta::assert_snapshot!(
        "papers_csv",
        file(&report, Form::Csv, "g1-paper-1-table.csv")
    );
    let svg = file(&report, Form::Svg, "g1-paper-1-time.svg");
    assert!(svg.contains(", paper, Horse: 1.585</title>"), "{svg}");
}

#[test]
fn a_mean_of_ratios_is_compared_with_ours() {
    let records = run_mock(
        &plan(&["a", "b"], "mmp,ich,vtp", "0"),
        &MockBackend::default(),
    );
    let wanted = Options {
        tables: "000-table-2".parse().unwrap(),
        ..options()
    };
    let report = report_on(result(records), &wanted);
    let csv = file(&report, Form::Csv, "g1-paper-1-table.csv");
    assert!(csv.contains("Time,ich / vtp,6.21 \u{b1} 1.88,"), "{csv}");
    assert!(csv.contains("Time,mmp / vtp,6.11 \u{b1} 1.90,"), "{csv}");
    assert!(!csv.contains("fwp-ch"), "{csv}");
}

#[test]
fn several_results_are_apart() {
    let input = |name: &str| Input::new(PathBuf::from(name), mixed());
    let report = build(&[input("old.json"), input("new.json")], &options()).unwrap();
    let html = page(&report);
    for id in ["r1-result", "r2-result", "r1-g1-time", "r2-g1-time"] {
        assert!(html.contains(&format!(" id=\"{id}\"")), "{id}");
    }
}

#[test]
fn a_picture_is_of_the_model_that_was_measured() {
    let mut plan = plan(&[], "vtp", "0");
    plan.models = vec![ModelRef::generated("gen:sphere,subdiv=2").unwrap()];
    let mut result = result(run_mock(&plan, &MockBackend::default()));
    let wanted = Options {
        picture: "sphere,subdiv=2:5".parse().unwrap(),
        ..options()
    };
    let input = |result: &ResultFile| Input::new(PathBuf::from("r.json"), result.clone());
    // The mock model has a hash that no file has.
    let error = build(&[input(&result)], &wanted).unwrap_err().to_string();
    assert_eq!(
        error,
        "no picture of sphere,subdiv=2: gen:sphere,subdiv=2 is not what was measured, its hash differs"
    );
    let unasked = Options {
        picture: PictureChoice::Any,
        ..options()
    };
    assert!(!page(&report_on(result.clone(), &unasked)).contains("data:image/png"));

    let model = ModelRef::generated("gen:sphere,subdiv=2")
        .unwrap()
        .load(geobench_harness::exec::limits::DecompressionLimit::default())
        .unwrap();
    result.models[0].sha256 = model.record.sha256;
    for wanted in [&wanted, &unasked] {
        let report = report_on(result.clone(), wanted);
        assert_eq!(page(&report).matches("data:image/png").count(), 1);
        let tex = file(&report, Form::Tex, "result-picture-sphere-subdiv-2.tex");
        assert!(tex.contains("\\includegraphics"), "{tex}");
    }
    let beyond = Options {
        picture: "sphere,subdiv=2:99999".parse().unwrap(),
        ..options()
    };
    let error = build(&[input(&result)], &beyond).unwrap_err().to_string();
    assert!(
        error.ends_with("vertex 99999 does not exist or has no face"),
        "{error}"
    );
    let other = Options {
        picture: "cube".parse().unwrap(),
        ..options()
    };
    let error = build(&[input(&result)], &other).unwrap_err().to_string();
    assert_eq!(
        error,
        "--picture cube: the result has no such model; it has sphere,subdiv=2"
    );
}

/// `docs/report.sha256` has the hash of the page on a record, without the model's picture and the
/// line that names the version.
#[test]
fn the_picture_in_the_guide_is_of_this_page() {
    let top = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = std::fs::read_to_string(top.join("docs/report.sha256")).unwrap();
    let (known, name) = text.trim().split_once("  ").unwrap();
    let path = top.join("results").join(name);
    let input = Input::new(path.clone(), result_file::read(&path).unwrap());
    let html = page(&build(&[input], &options()).unwrap());
    let lines = html
        .split_inclusive('\n')
        .filter(|line| !line.contains("<footer>"));
    let digest = Sha256::digest(lines.collect::<String>());
    let digits = digest.iter().map(|byte| format!("{byte:02x}"));
    assert_eq!(
        digits.collect::<Vec<_>>().concat(),
        known,
        "the page has changed; run scripts/report-picture"
    );
}
