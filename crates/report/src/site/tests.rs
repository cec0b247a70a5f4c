use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use geobench_harness::schema::{IsolationRecord, ProgramRecord, SessionRecord, Status};
use geobench_registry::Provenance;

use super::measured::{Measurement, standings};
use super::*;
use crate::table::tests::mixed_with;

/// The largest page, in bytes.
const LARGEST: usize = 500_000;

/// The values of an attribute in a page.
fn values<'p>(page: &'p str, attribute: &str) -> Vec<&'p str> {
    let start = format!(" {attribute}=\"");
    let parts = page.split(&start).skip(1);
    parts.map(|part| part.split('"').next().unwrap()).collect()
}

/// Checks that every page has a title of its own, is small, asks for nothing from the network, and
/// that all its links lead to something.
fn check(site: &StaticSite, records: &SiteRecords) {
    let names: HashSet<String> = site
        .pages()
        .map(|(name, _)| format!("{name}.html"))
        .collect();
    assert_eq!(names.len(), site.pages().count());
    let copies: HashSet<String> = records
        .results
        .iter()
        .map(records::SiteRecord::address)
        .collect();
    let mut titles = HashSet::new();
    for (name, page) in site.pages() {
        assert!(page.len() < LARGEST, "{name} has {} bytes", page.len());
        let title = page
            .split("<title>")
            .nth(1)
            .unwrap()
            .split('<')
            .next()
            .unwrap();
        assert!(
            !title.is_empty() && titles.insert(title.to_owned()),
            "{name}: {title}"
        );
        let (shown, _) = page.split_once("<script>").unwrap_or((page, ""));
        assert!(!shown.contains("NaN"), "{name}");
        assert!(values(page, "src").is_empty(), "{name}");
        let ids = values(page, "id");
        let distinct: HashSet<&&str> = ids.iter().collect();
        assert_eq!(distinct.len(), ids.len(), "{name}: ids are used twice");
        for link in values(page, "href") {
            let outside = link.starts_with("https://") || link.starts_with("data:");
            let is_known = link.strip_prefix('#').map_or_else(
                || outside || names.contains(link) || copies.contains(link),
                |id| ids.contains(&id),
            );
            assert!(is_known, "{name}: {link} leads nowhere");
        }
    }
}

#[test]
fn records_of_several_programs_become_a_site() {
    let directory = tempfile::tempdir().unwrap();
    let mut result = mixed_with("a model");
    for (i, model) in result.models.iter_mut().enumerate() {
        model.sha256 = Some(format!("{i:064}"));
    }
    let model = result.models[0].clone();
    let mut outside = result.cells[0].clone();
    outside.algorithm = "ext:a<b>".to_owned();
    outside.status = Status::Wrong;
    outside.check.max_rel = Some(1e-3);
    outside.message = Some("differs <here>".to_owned());
    outside.check.proven = Some(false);
    result.cells.push(outside);
    result.sessions.push(SessionRecord {
        shard: None,
        host: result.host.clone(),
        command: Vec::new(),
        started: result.started.clone(),
        finished: None,
        tool: None,
        programs: vec![ProgramRecord {
            name: "ext:a<b>".to_owned(),
            provenance: Provenance {
                version: Some("1 <c>".to_owned()),
                flags: Some("-O3".to_owned()),
                ..Provenance::default()
            },
            files: Vec::new(),
        }],
    });
    let write = |name: &str, text: &str| {
        let path = directory.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    write("one.json", &serde_json::to_string(&result).unwrap());
    // Other records name a model differently, or have another model of its name.
    let mut models = result.models.iter();
    let place = models.position(|model| model.name != result.cells[0].model);
    let place = place.unwrap();
    let mut renamed = result.clone();
    for cell in &mut renamed.cells {
        if cell.model == result.models[place].name {
            "renamed".clone_into(&mut cell.model);
        }
    }
    "renamed".clone_into(&mut renamed.models[place].name);
    write("renamed.json", &serde_json::to_string(&renamed).unwrap());
    let mut changed = result.clone();
    changed.models[place].sha256 = Some("f".repeat(64));
    write("changed.json", &serde_json::to_string(&changed).unwrap());
    write("below/one.json", &serde_json::to_string(&result).unwrap());
    write("other.json", "{\"schema\": \"other/1\"}");
    let cpu = result.host.cpu.clone().unwrap_or_default();
    write(
        "machines.toml",
        &format!(
            "[[machine]]\nkey = \"box\"\ncpu = \"{cpu}\"\ncores = [{}]\nowner = \"me\"\nwords = \"mine\"\n",
            result.host.cores
        ),
    );
    let records = SiteRecords::read(&[directory.path().to_owned()]).unwrap();
    assert_eq!(records.notes.len(), 1);
    let corpus = Corpus {
        models: vec![crate::corpus::CorpusModel {
            name: "known".to_owned(),
            address: "gen:known".to_owned(),
            sha256: model.sha256.clone().unwrap(),
            licence: None,
            faces: model.faces.unwrap(),
            why: "to test".to_owned(),
        }],
    };
    let site = StaticSite::build(&records, &corpus, None).unwrap();
    check(&site, &records);
    let page = |name: &str| site.pages().find(|(known, _)| *known == name).unwrap().1;
    // Both records have the answer, the page has it once.
    assert_eq!(page("wrong").matches("differs &lt;here&gt;").count(), 1);
    assert!(page("program-ext-a-b").contains("Where it is wrong"));
    assert!(page("wrong").contains("proven in the run"));
    for fact in ["As it ran on", "1 &lt;c&gt;", "-O3"] {
        assert!(page("program-ext-a-b").contains(fact), "{fact}");
    }
    assert!(page("model-known").contains("to test"));
    assert!(page("records").contains("below/one"));
    assert!(!page("index").contains("trend.html"));
    let out = directory.path().join("site");
    site.write(&records, &out).unwrap();
    assert!(out.join("records/below-one.json").is_file() && out.join("index.html").is_file());
    let trend = "<html><header>\n</header>\n</html>".to_owned();
    let with_trend = StaticSite::build(&records, &corpus, Some(trend)).unwrap();
    let (_, index) = with_trend.pages().next().unwrap();
    assert!(index.contains("trend.html"));
}

#[test]
fn the_records_of_the_repository_become_a_site() {
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results");
    let records = SiteRecords::read(&[results]).unwrap();
    assert!(!records.certificates.is_empty() && !records.machines.is_empty());
    // Every machine is described.
    for record in &records.results {
        let key = records.machine(&record.result.host);
        assert!(
            records.machines.iter().any(|machine| machine.key == key),
            "{key}"
        );
    }
    // Without pictures, which take long: scripts/check-report looks at the pages with theirs.
    let mut corpus = Corpus::known().unwrap();
    corpus.models.retain(|model| !model.is_generated());
    let site = StaticSite::build(&records, &corpus, None).unwrap();
    check(&site, &records);
    // Long texts have wide columns on a phone.
    let (_, paper) = site.pages().find(|(name, _)| *name == "paper-000").unwrap();
    assert!(paper.contains("<td class=\"long\">"));
}

#[test]
fn ratios_of_records_without_the_base_are_linked() {
    let with = |algorithms: [(&str, f64); 2]| {
        let mut result = mixed_with("a model");
        let mut cell = result
            .cells
            .iter()
            .find(|c| c.status == Status::Ok)
            .unwrap()
            .clone();
        result.models.retain(|model| model.name == cell.model);
        result.cells.clear();
        for (name, seconds) in algorithms {
            cell.algorithm = name.to_owned();
            cell.approximate = name == "fmm";
            cell.simd = (name == "vtp").then(|| "avx512".to_owned());
            cell.time = geobench_harness::measure::statistics::time(vec![seconds; 6], Some(3.0));
            result.cells.push(cell.clone());
        }
        result
    };
    let record = |name: &str, result| records::SiteRecord {
        name: name.to_owned(),
        path: PathBuf::new(),
        result,
    };
    let records = SiteRecords {
        results: vec![
            record("a", with([("ich", 3.0), ("fmm", 1.5)])),
            record("b", with([("vtp", 2.0), ("ich", 4.0)])),
        ],
        ..SiteRecords::default()
    };
    let all = Measurement::all(&records);
    let found = standings(&all, |_| true);
    let of = |program: &str| found.iter().find(|one| one.program == program).unwrap();
    let ratio_of = |program: &str| (of(program).ratio, of(program).linked);
    assert_eq!(ratio_of("vtp"), (1.0, 0));
    assert_eq!(ratio_of("ich"), (2.0, 0));
    assert_eq!(ratio_of("fmm"), (1.0, 1));
    // The instructions of the base are named, and set-up is a multiple of its time.
    assert!(found.iter().all(|one| one.base_simd == ["avx512"]));
    assert_eq!(of("fmm").setup, Some(2.0));
    let page = StaticSite::build(&records, &Corpus { models: Vec::new() }, None).unwrap();
    let (_, page) = page
        .pages()
        .find(|(name, _)| *name == "program-ich")
        .unwrap();
    assert!(page.contains("2.00\u{a0}(avx512)"));

    // A ratio to an algorithm with other instructions is no link.
    let mut other = records.clone();
    for cell in &mut other.results[0].result.cells {
        cell.simd = Some("avx512".to_owned());
    }
    let all = Measurement::all(&other);
    assert!(
        standings(&all, |_| true)
            .iter()
            .all(|one| one.program != "fmm")
    );

    // Times of cells that ran at the same time do not count.
    let mut disturbed = records.clone();
    disturbed.results[1].result.isolation = Some(IsolationRecord {
        process: true,
        cpus: None,
        jobs: Some(2),
    });
    let all = Measurement::all(&disturbed);
    assert_eq!(all.len(), 4);
    assert!(standings(&all, |_| true).is_empty());
}

#[test]
fn distances_of_a_smooth_surface_are_no_errors() {
    let mut result = mixed_with("a model");
    result.cells.retain(|cell| cell.status == Status::Ok);
    for cell in &mut result.cells {
        cell.check.reference = Some("closed-form/sphere.csv".to_owned());
        cell.check.max_rel = Some(1e-3);
    }
    let records = SiteRecords {
        results: vec![records::SiteRecord {
            name: "a".to_owned(),
            path: PathBuf::new(),
            result,
        }],
        ..SiteRecords::default()
    };
    for one in Measurement::all(&records) {
        assert!(!one.is_wrong() && one.max_error().is_none());
    }
}

#[test]
fn a_directory_without_results_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let error = SiteRecords::read(&[directory.path().to_owned()]).unwrap_err();
    let start = format!("{}: no result file is there", directory.path().display());
    assert!(error.to_string().starts_with(&start), "{error}");
}
