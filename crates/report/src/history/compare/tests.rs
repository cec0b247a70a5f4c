//! Comparisons of mock results.

use geobench_harness::exec::mock::MockBackend;
use geobench_harness::run::mock::{plan, result, run_mock};
use geobench_harness::schema::RepositoryRecord;
use geobench_window::Counter;

use super::*;
use crate::table::{ComparisonFormat, Look};

/// Two models and three algorithms, six samples each.
fn file() -> ResultFile {
    let plan = plan(&["cow|2", "horse"], "mmp,ich,vtp", "0");
    let mut file = result(run_mock(&plan, &MockBackend::default()));
    for (place, model) in file.models.iter_mut().enumerate() {
        model.sha256 = Some(format!("{place:064}"));
    }
    for cell in &mut file.cells {
        cell.instructions = Some(1_000_000);
    }
    file
}

fn cell<'f>(file: &'f mut ResultFile, model: &str, algorithm: &str) -> &'f mut Cell {
    let cells = file.cells.iter_mut();
    let mut found = cells.filter(|c| c.model == model && c.algorithm == algorithm);
    found.next().unwrap()
}

/// Multiplies every time of a cell by `factor`.
fn scale(cell: &mut Cell, factor: f64) {
    let samples = cell.time.samples.iter().map(|t| t * factor).collect();
    cell.time = geobench_harness::measure::statistics::time(samples, cell.time.setup);
}

fn compared(old: &ResultFile, new: &ResultFile, rules: &str) -> FileComparison {
    let rules = if rules.is_empty() {
        Rules::default()
    } else {
        rules.parse().unwrap()
    };
    compare(("old.json", old), ("new.json", new), &rules).unwrap()
}

/// The regressions, one per line.
fn worse(comparison: &FileComparison) -> Vec<String> {
    let cells = comparison.cells.iter();
    cells
        .flat_map(|c| {
            c.regressions
                .iter()
                .map(move |r| format!("{}: {}", c.cell, r.what))
        })
        .collect()
}

/// A new file with a change of every kind.
fn eventful() -> (ResultFile, ResultFile) {
    let (mut old, mut new) = (file(), file());
    (old.pairing, new.pairing) = (Some("turns".into()), Some("turns".into()));
    new.tool.commit = Some("0123456789abcdef0123456789abcdef01234567".into());
    scale(cell(&mut new, "horse", "mmp"), 1.2);
    scale(cell(&mut new, "horse", "vtp"), 0.7);
    cell(&mut new, "horse", "ich").instructions = Some(1_100_000);
    let crashed = cell(&mut new, "cow|2", "vtp");
    crashed.status = Status::Crashed;
    crashed.message = Some("the algorithm panicked: index out of bounds".into());
    crashed.time = geobench_harness::schema::Time::default();
    let ich = cell(&mut new, "cow|2", "ich");
    ich.counters.set(Counter::Propagated, 10);
    ich.memory.heap_peak_bytes = Some(310_000);
    old.cells.push(Cell::new("horse", "ch"));
    new.cells.push(Cell::new("horse", "vtp-fast"));
    (old, new)
}

const RULES: &str = "time=10%,propagated=0,instructions=2%,heap_peak_bytes=5%,kept=0";

#[test]
fn terminal() {
    let (old, new) = eventful();
    let shown = ComparisonFormat::Table.render(&compared(&old, &new, RULES), Look::default());
    insta::assert_snapshot!(shown.unwrap());
}

#[test]
fn markdown() {
    let (old, new) = eventful();
    let shown = ComparisonFormat::Markdown.render(&compared(&old, &new, RULES), Look::default());
    insta::assert_snapshot!(shown.unwrap());
}

#[test]
fn json() {
    let (mut old, mut new) = eventful();
    // Two cells are enough to see every field.
    old.cells.retain(|c| c.algorithm != "mmp");
    new.cells.retain(|c| c.algorithm != "mmp");
    old.cells.drain(1..3);
    new.cells.drain(1..3);
    let shown = ComparisonFormat::Json.render(&compared(&old, &new, RULES), Look::default());
    insta::assert_snapshot!(shown.unwrap());
}

#[test]
fn a_file_is_no_worse_than_itself() {
    let file = file();
    let comparison = compared(
        &file,
        &file,
        "time=0,propagated=0,instructions=0,rss_peak_bytes=0",
    );
    assert_eq!(worse(&comparison), [""; 0]);
    assert_eq!(comparison.cells.len(), 6);
    assert!(comparison.missing.is_empty() && comparison.added.is_empty());
    assert_eq!(comparison.notes, [""; 0]);
    for cell in &comparison.cells {
        assert_eq!(cell.time.as_ref().unwrap().ratio, 1.0);
        assert!(cell.figures.iter().all(|f| f.ratio() == Some(1.0)));
    }
}

#[test]
fn only_files_that_took_turns_are_paired() {
    let (mut old, mut new) = (file(), file());
    assert!(!compared(&old, &new, "").paired);
    old.pairing = Some("a".into());
    new.pairing = Some("b".into());
    assert!(!compared(&old, &new, "").paired);
    new.pairing = Some("a".into());
    // One cell has a sample less, so it cannot be paired.
    let times = &mut cell(&mut new, "horse", "vtp").time;
    times.samples.pop();
    let comparison = compared(&old, &new, "");
    assert!(comparison.paired);
    let methods: Vec<TimeMethod> = comparison
        .cells
        .iter()
        .map(|c| c.time.as_ref().unwrap().method)
        .collect();
    assert_eq!(methods[..5], [TimeMethod::Paired; 5]);
    assert_eq!(methods[5], TimeMethod::Unpaired);
}

#[test]
fn a_rule_on_time_is_broken_only_by_an_interval_beyond_it() {
    let (mut old, mut new) = (file(), file());
    // All times are 12 % longer, so the interval is narrow.
    scale(cell(&mut new, "horse", "vtp"), 1.12);
    assert_eq!(worse(&compared(&old, &new, "time=20%")), [""; 0]);
    assert_eq!(worse(&compared(&old, &new, "")), [""; 0]);
    assert_eq!(worse(&compared(&old, &new, "time=5%")).len(), 1);
    // The same median, but one sample in three differs.
    cell(&mut old, "horse", "vtp").time.samples[0] = 1.0;
    cell(&mut old, "horse", "vtp").time.samples[1] = 1.0;
    assert_eq!(worse(&compared(&old, &new, "time=5%")), [""; 0]);
    // A cell with too few samples breaks no rule. A note reports it.
    let (mut old, mut new) = (file(), file());
    cell(&mut old, "horse", "vtp").time.samples.truncate(4);
    scale(cell(&mut new, "horse", "vtp"), 9.0);
    let comparison = compared(&old, &new, "time=5%");
    assert_eq!(worse(&comparison), [""; 0]);
    assert_eq!(
        comparison.notes,
        [
            "1 of 6 cells have too few samples for an interval of the time, so that the rule time=5% cannot be broken there"
        ]
    );
}

#[test]
fn a_cell_that_fails_now_is_worse_under_any_rules() {
    for status in [
        Status::Timeout,
        Status::OutOfMemory,
        Status::Crashed,
        Status::Wrong,
        Status::Refused,
    ] {
        let (mut old, mut new) = (file(), file());
        cell(&mut new, "horse", "vtp").status = status;
        let comparison = compared(&old, &new, "");
        assert_eq!(comparison.regressions, 1);
        assert!(worse(&comparison)[0].starts_with("horse, vtp, source 0: was ok, is "));
        // This cell also failed in the old file.
        cell(&mut old, "horse", "vtp").status = Status::Crashed;
        assert_eq!(compared(&old, &new, "time=0,propagated=0").regressions, 0);
        // This cell failed in the old file and is ok in the new one.
        cell(&mut new, "horse", "vtp").status = Status::Ok;
        assert_eq!(compared(&old, &new, "time=0,propagated=0").regressions, 0);
    }
}

#[test]
fn a_figure_that_one_of_the_files_lacks_breaks_its_rule() {
    let (mut old, mut new) = (file(), file());
    cell(&mut new, "horse", "vtp").instructions = None;
    assert_eq!(
        worse(&compared(&old, &new, "instructions=2%")),
        ["horse, vtp, source 0: instructions 1,000,000 -> none: missing in the new file"]
    );
    for cell in &mut old.cells {
        cell.instructions = None;
    }
    let comparison = compared(&old, &new, "instructions=2%,levels=0,propagated=0");
    assert_eq!(comparison.regressions, 6);
    let worse = worse(&comparison);
    assert_eq!(
        worse[0],
        "cow|2, mmp, source 0: instructions none -> 1,000,000: missing in the old file"
    );
    assert_eq!(
        worse[5],
        "horse, vtp, source 0: instructions none -> none: missing in both files"
    );
    assert_eq!(
        comparison.notes,
        [
            "`instructions` is missing in 6 of 6 cells: run both versions with --instructions, or leave the rule out",
            // None of these algorithms has this counter.
            "`levels` is not compared in 6 of 6 cells: neither file has it"
        ]
    );
    let shown = ComparisonFormat::Table
        .render(&comparison, Look::default())
        .unwrap();
    assert!(
        shown.contains("new !") && shown.contains("missing !"),
        "{shown}"
    );
    // Figures are required only by rules.
    assert!(!compared(&old, &new, "propagated=0").is_worse());
}

#[test]
fn a_counter_that_one_of_the_files_lacks_breaks_its_rule() {
    let (mut old, new) = (file(), file());
    let ich = cell(&mut old, "horse", "ich");
    let mut counters = geobench_window::Counters::default();
    counters.set(Counter::StoredWindows, 3);
    ich.counters = counters;
    assert_eq!(
        worse(&compared(&old, &new, "propagated=0")),
        ["horse, ich, source 0: propagated none -> 9: missing in the old file"]
    );
}

#[test]
fn a_file_of_another_repository_names_its_commit() {
    let (mut old, mut new) = (file(), file());
    for (file, digit) in [(&mut old, "a"), (&mut new, "b")] {
        file.tool.commit = Some("c".repeat(40));
        file.repository = Some(RepositoryRecord {
            commit: digit.repeat(40),
            dirty: false,
            ancestors: Vec::new(),
        });
    }
    let shown = |old: &ResultFile| {
        let comparison = compared(old, &new, "");
        let shown = ComparisonFormat::Table.render(&comparison, Look::default());
        shown.unwrap()
    };
    let names = "old: old.json (commit aaaaaaaaaaaa, by geobench cccccccccccc, ";
    assert!(shown(&old).starts_with(names), "{}", shown(&old));
    // That of geobench itself.
    let repository = old.repository.as_mut().unwrap();
    repository.ancestors.push("c".repeat(40));
    assert!(shown(&old).starts_with("old: old.json (commit cccccccccccc, "));
}

#[test]
fn outside_programs_have_no_instructions() {
    let (mut old, mut new) = (file(), file());
    for file in [&mut old, &mut new] {
        let cell = cell(file, "horse", "ich");
        cell.algorithm = "ext:other".to_owned();
        cell.instructions = None;
    }
    assert!(!compared(&old, &new, "instructions=0").is_worse());
}

#[test]
fn counts_with_different_vector_instructions_are_said() {
    let (mut old, mut new) = (file(), file());
    cell(&mut old, "horse", "vtp").instructions_simd = Some("avx2".to_owned());
    cell(&mut new, "horse", "vtp").instructions_simd = Some("scalar".to_owned());
    // Files of older versions lack the field.
    cell(&mut new, "horse", "ich").instructions_simd = Some("avx2".to_owned());
    assert_eq!(
        compared(&old, &new, "").notes,
        [
            "`instructions` were counted with different vector instructions and do not compare: \
             horse, vtp, source 0 (avx2 and scalar)"
        ]
    );
    assert_eq!(
        worse(&compared(&old, &new, "instructions=2%")),
        [
            "horse, vtp, source 0: instructions 1,000,000 with avx2 -> 1,000,000 with scalar do not compare"
        ]
    );
}

#[test]
fn times_that_are_gone_or_0_do_not_pass_a_rule_on_time_in_silence() {
    let (old, mut new) = (file(), file());
    cell(&mut new, "horse", "vtp").time = geobench_harness::schema::Time::default();
    scale(cell(&mut new, "cow|2", "ich"), 0.0);
    let comparison = compared(&old, &new, "time=10%");
    let median = old.cells.last().unwrap().time.median.unwrap();
    assert_eq!(
        worse(&comparison),
        [format!(
            "horse, vtp, source 0: time {median} s -> none: missing in the new file"
        )]
    );
    assert_eq!(
        comparison.notes,
        [
            "1 of 6 cells lack times above 0 in one of the files, so that the rule time=10% cannot be broken there"
        ]
    );
    let shown = ComparisonFormat::Table
        .render(&comparison, Look::default())
        .unwrap();
    assert!(shown.contains("missing !"), "{shown}");
    assert_eq!(
        worse(&compared(&new, &old, "time=10%")),
        [format!(
            "horse, vtp, source 0: time none -> {median} s: missing in the old file"
        )]
    );
    // The note does not need a rule on time.
    let comparison = compared(&old, &new, "propagated=0");
    assert_eq!(worse(&comparison), [""; 0]);
    assert_eq!(
        comparison.notes,
        ["2 of 6 cells lack times above 0 in one of the files"]
    );
}

#[test]
fn a_gate_on_missing_cells_does_not_pass_a_file_that_lacks_some() {
    let (old, mut new) = (file(), file());
    new.cells.pop();
    assert!(!compared(&old, &new, "propagated=0").is_worse());
    assert!(!compared(&old, &new, "missing=20%").is_worse());
    let comparison = compared(&old, &new, "missing=0");
    assert!(comparison.is_worse());
    assert_eq!(comparison.regressions, 0);
    assert_eq!(comparison.overall[0].what, "1 of 6 cells is missing");
    assert_eq!(comparison.overall[0].rule.as_deref(), Some("missing=0"));
    // New cells are not missing.
    assert!(!compared(&new, &old, "missing=0").is_worse());
}

#[test]
fn cells_are_matched_by_hash_and_parameters_not_by_name() {
    let (mut old, mut new) = (file(), file());
    // The model has another name, and its cells are in another order.
    for cell in &mut new.cells {
        if cell.model == "horse" {
            cell.model = "horse #2".into();
        }
    }
    new.models[1].name = "horse #2".into();
    new.cells.reverse();
    let comparison = compared(&old, &new, "propagated=0");
    assert_eq!(comparison.cells.len(), 6);
    assert_eq!(comparison.cells[0].cell.model, "horse #2");

    // The same name, but another model.
    let mut new = file();
    new.models[1].sha256 = Some("f".repeat(64));
    let comparison = compared(&old, &new, "");
    assert_eq!((comparison.missing.len(), comparison.added.len()), (3, 3));
    assert_eq!(
        comparison.notes,
        ["the model horse is not what it was: its hash differs"]
    );

    // Two copies of one model have their own cells each.
    old.models[1].sha256 = old.models[0].sha256.clone();
    let mut new = old.clone();
    cell(&mut new, "horse", "vtp").instructions = Some(2_000_000);
    new.cells.reverse();
    let comparison = compared(&old, &new, "instructions=2%");
    assert_eq!(
        worse(&comparison),
        ["horse, vtp, source 0: instructions 1,000,000 -> 2,000,000 (+100.0 %)"]
    );
    assert_eq!((comparison.missing.len(), comparison.added.len()), (0, 0));
}

#[test]
fn files_with_nothing_in_common_are_refused() {
    let (old, mut new) = (file(), file());
    for cell in &mut new.cells {
        cell.source = Some(7.into());
    }
    let error = compare(("a", &old), ("b", &new), &Rules::default()).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("a and b have no cell in common")
    );
}

#[test]
fn other_machines_and_builds_are_said() {
    let (mut old, mut new) = (file(), file());
    new.host.cores = 64;
    new.tool.rustc = None;
    new.tool.rustflags = Some(String::new());
    old.tool.profile = "debug".into();
    assert_eq!(
        compared(&old, &new, "").notes,
        [
            "the files are from different machines: times say little",
            "the compilers differ: rustc 1.89.0 and unknown",
            "the compilers' flags differ: '-C opt-level=3' and ''",
            "the old file is of a debug build: its times mean little"
        ]
    );
    // Kernels report slightly different sizes of the same memory.
    let (old, mut new) = (file(), file());
    let memory = old.host.memory_bytes.unwrap();
    new.host.memory_bytes = Some(memory - memory / 200);
    assert_eq!(compared(&old, &new, "").notes, [""; 0]);
    new.host.memory_bytes = Some(memory / 2);
    assert_eq!(compared(&old, &new, "").notes.len(), 1);
    // Files of older versions lack the field.
    let (old, mut new) = (file(), file());
    new.tool.rustflags = None;
    assert_eq!(compared(&old, &new, "").notes, [""; 0]);
}
