//! The files of claims, and the page that is made of them.

use geobench_harness::plan;
use geobench_registry::Selection;

use super::*;
use crate::claims::cases::is_same;

#[test]
fn mistakes_in_files_are_named_with_their_line() {
    let line = HEAD.lines().count() + 2;
    let refused = |test: &str| read(test).unwrap_err().to_string();
    let at = |offset: usize| format!("c.toml, line {}: ", line + offset);
    for (test, expected) in [
        (
            "of = [\"vtp\"]\nhold = \"> 1\"",
            at(1) + "there is no key `hold` here (did you mean `holds`?)",
        ),
        (
            "of = [\"vpt\"]\nholds = \"> 1\"",
            at(0) + "`of`: there is no algorithm `vpt`",
        ),
        (
            "of = [\"vtp\"]\nholds = \"more\"",
            at(1) + "`holds`: `more` is no range; write `> 1`",
        ),
        (
            "of = [\"vtp\"]\nholds = \"2 to 1\"",
            at(1) + "`holds`: `2 to 1` is no range",
        ),
        (
            "of = [\"vtp\"]\nfigure = \"tme\"\nholds = \"> 1\"",
            at(1) + "`figure`: there is no row `tme`",
        ),
        (
            "of = [\"vtp\"]\nelse = [\"x\"]\nholds = \"> 1\"",
            at(1) + "`else`: there is no row `x`",
        ),
        (
            "of = []\nholds = \"> 1\"",
            at(0).replace(&line.to_string(), &(line - 1).to_string()) + "`of`: at least one",
        ),
        (
            "of = [\"vtp\"]",
            at(0).replace(&line.to_string(), &(line - 1).to_string())
                + "`holds`: a test has `holds` or `ends`",
        ),
        (
            "of = [\"vtp\"]\nholds = \"> 1\"\npaper = \"x\"",
            at(2) + "`paper`: there is no paper table `x`",
        ),
        (
            "of = [\"pvtp\"]\nto = \"vtp\"\nholds = \"> 1\"\npaper = \"000-table-1\"",
            at(3) + "`paper`: the table has no number of pvtp",
        ),
        (
            "of = [\"vtp\"]\nbest = \"k\"\nholds = \"> 1\"",
            at(1) + "`best`: vtp has no number for the parameter `k`",
        ),
        (
            "of = [\"vtp\"]\nshow = \"exponent\"\nholds = \"> 1\"",
            at(0).replace(&line.to_string(), &(line - 1).to_string()) + "`show`: only a growth",
        ),
        (
            "of = [\"vtp\"]\nover = \"size\"\nholds = \"> 1\"",
            at(1) + "`over`: unknown variant `size`",
        ),
        (
            "of = [\"vtp\"]\nsimd = \"avx2\"\nholds = \"> 1\"",
            at(1) + "`simd`: unknown variant `avx2`",
        ),
        (
            "of = [{ figure = \"time\" }]\nholds = \"> 1\"",
            at(0) + "`of`: give either `algorithm` or `least`",
        ),
    ] {
        let error = refused(test);
        assert!(error.starts_with(&expected), "{error} is not {expected}");
    }
    let twice = format!(
        "{HEAD}awaits = \"x\"\n{}",
        HEAD.split_once("[[claim]]").map_or("", |(_, rest)| rest)
    );
    let twice =
        twice.replacen("awaits = \"x\"\n", "awaits = \"x\"\n[[claim]]", 1) + "awaits = \"x\"\n";
    let error = ClaimsFile::parse(Path::new("c.toml"), &twice)
        .unwrap_err()
        .to_string();
    assert!(error.contains("`id`: two are called `i`"), "{error}");
    let error = ClaimsFile::parse(Path::new("c.toml"), HEAD)
        .unwrap_err()
        .to_string();
    assert!(error.contains("it has no [[claim.test]]"), "{error}");
}

#[test]
fn all_files_are_known_and_can_be_read() {
    let directory = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../bench-configs/papers/claims"
    );
    let mut found: Vec<String> = std::fs::read_dir(directory)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter_map(|name| name.strip_suffix(".toml").map(str::to_owned))
        .collect();
    found.sort_unstable();
    let names: Vec<&str> = FILES.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, found);
    let files = known().unwrap();
    let ids: Vec<&str> = files
        .iter()
        .flat_map(|file| file.claims().map(crate::claims::file::PaperClaim::id))
        .collect();
    assert_eq!(
        distinct(ids.iter().copied()).len(),
        ids.len(),
        "an id stands there twice"
    );
    for file in &files {
        let mut claims = file.claims();
        let wrong = claims.find(|claim| !claim.id().starts_with(&file.paper));
        assert!(wrong.is_none(), "{wrong:?}");
    }
}

/// Every suite, group, algorithm and model that a claim names exists.
#[test]
fn every_suite_group_algorithm_and_model_of_a_claim_exists() {
    use geobench_harness::plan::suite::Suite;

    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../bench-configs");
    for claim in known().unwrap().iter().flat_map(ClaimsFile::claims) {
        let id = claim.id();
        let Some(name) = &claim.suite else {
            continue;
        };
        let suite = Suite::read(&directory.join(format!("{name}.toml")));
        let suite = suite.unwrap_or_else(|error| panic!("{id}: {error}"));
        for test in claim.tests() {
            let unknown = test
                .groups
                .iter()
                .find(|group| suite.groups.iter().all(|known| known.name != **group));
            assert_eq!(unknown, None, "{id}: {name} has no such group");
            let groups = suite
                .groups
                .iter()
                .filter(|group| test.groups.is_empty() || test.groups.contains(&group.name));
            for operand in &test.of {
                let all = operand.algorithms.iter();
                let all: Vec<&Selection> = all
                    .chain(test.to.iter().flat_map(|to| &to.algorithms))
                    .collect();
                let able = groups.clone().filter(|group| {
                    let algorithms = &group.settings.algorithms.algorithms;
                    let algorithms = algorithms.iter().flat_map(|all| &all.0);
                    let run = |one: &Selection| one.clone().with_threads(1);
                    let planned: Vec<_> = algorithms.map(|one| plan::planned(&run(one))).collect();
                    all.iter()
                        .all(|selection| planned.iter().any(|one| is_same(selection, one)))
                });
                let able: Vec<_> = able.collect();
                assert!(
                    !able.is_empty(),
                    "{id}: no group of {name} has {}",
                    operand.in_words()
                );
                for pattern in &test.models {
                    let found = able.iter().any(|group| {
                        let models = group.settings.models.iter().flatten();
                        models.map(toml::Spanned::get_ref).any(|model| {
                            let path = model.path.strip_prefix("gen:").unwrap_or(&model.path);
                            let names = std::iter::once(path);
                            let mut names = names.chain(model.real.iter().map(String::as_str));
                            names.any(|name| is_like(pattern, name))
                        })
                    });
                    assert!(found, "{id}: {name} has no model like {pattern}");
                }
            }
        }
    }
}

/// Every claim has a topic, and every topic claims.
#[test]
fn topics_cover_all_claims() {
    let topics = crate::claims::topics::topics();
    assert_eq!(topics.len(), 10);
    let files = known().unwrap();
    let ids: Vec<&str> = files
        .iter()
        .flat_map(|file| file.claims().map(crate::claims::file::PaperClaim::id))
        .collect();
    for id in &ids {
        assert!(
            topics.iter().any(|topic| topic.is_of(id)),
            "{id} has no topic"
        );
    }
    for topic in &topics {
        assert!(ids.iter().any(|id| topic.is_of(id)), "{topic:?}");
    }
}

/// The page in `results` is up to date: it is what the program computes from the newest record
/// beside it.
#[test]
fn the_page_is_that_of_the_record() {
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results");
    let folders = results
        .read_dir()
        .unwrap()
        .map(|entry| entry.unwrap().file_name());
    let folders = folders.filter_map(|name| name.into_string().ok());
    let newest = folders
        .filter(|name| name.ends_with("-papers"))
        .max()
        .unwrap();
    let record = results.join(&newest).read_dir().unwrap();
    let paths = record.map(|entry| entry.unwrap().path());
    let inputs: Vec<Input> = paths
        .filter(|path| path.extension().is_some_and(|ending| ending == "json"))
        .map(|path| {
            let result = geobench_harness::schema::result_file::read(&path).unwrap();
            Input::new(path, result)
        })
        .collect();
    let report = judge(&known().unwrap(), &inputs).unwrap();
    let page = ClaimsFormat::Markdown
        .render(&report, Look::default())
        .unwrap();
    let kept = std::fs::read_to_string(results.join("paper-claims.md")).unwrap();
    let command = format!("geobench claims results/{newest} -o results/paper-claims.md");
    assert!(
        kept == page,
        "results/paper-claims.md is out of date: {command}"
    );
}
