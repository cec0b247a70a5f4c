//! Verdicts on mock results.

use std::path::Path;

use geobench_harness::exec::mock::MockBackend;
use geobench_harness::measure::statistics::time;
use geobench_harness::run::mock::{self, result, run_mock};
use geobench_harness::schema::{
    Cell, GroupRecord, IsolationRecord, PlannedAlgorithm, SourceLabel, Status,
};
use geobench_window::Counter;

use super::cases::is_like;
use super::*;
use crate::table::Look;

mod files;

/// Results of these algorithms on models of 1,000, 4,000 and 16,000 faces with g = 1, 2 and 4. All
/// cells have the same times and counts.
fn made_up(algorithms: &str) -> ResultFile {
    let plan = mock::plan(&["small", "middle", "large"], algorithms, "0");
    let mut made = result(run_mock(&plan, &MockBackend::default()));
    made.command = ["geobench", "run", "--config", "bench-configs/s.toml"]
        .map(str::to_owned)
        .to_vec();
    let isolation = IsolationRecord {
        process: false,
        cpus: None,
        jobs: None,
    };
    made.plan = Some(geobench_harness::plan::record(&[plan], isolation));
    // The models are those of the suite.
    made.groups = vec![GroupRecord {
        shows: Some("what it shows".to_owned()),
        ..GroupRecord::default()
    }];
    for (i, model) in made.models.iter_mut().enumerate() {
        model.faces = Some(1000 << (2 * i));
        model.vertices = Some(500 << (2 * i));
        model.anisotropy = Some(f64::from(1 << i));
    }
    for cell in &mut made.cells {
        cell.time = time(vec![1.0, 1.1, 0.9, 1.05, 0.95, 1.0], None);
        cell.instructions = None;
        cell.simd = Some("scalar".into());
        cell.instructions_simd = Some("scalar".into());
        cell.counters.set(Counter::Propagated, 100);
        cell.counters.set(Counter::Children, 100);
        cell.phases.samples = Some(2500);
    }
    made
}

/// The cell of an algorithm on a model.
fn cell<'r>(result: &'r mut ResultFile, algorithm: &str, model: &str) -> &'r mut Cell {
    let mut cells = result.cells.iter_mut();
    cells
        .find(|c| c.algorithm == algorithm && c.model == model)
        .unwrap()
}

/// Multiplies the times of an algorithm on a model.
fn scale(result: &mut ResultFile, algorithm: &str, model: &str, by: f64) {
    let cell = cell(result, algorithm, model);
    cell.time = time(cell.time.samples.iter().map(|x| x * by).collect(), None);
}

fn count(result: &mut ResultFile, algorithm: &str, model: &str, propagated: u64) {
    let cell = cell(result, algorithm, model);
    cell.counters.set(Counter::Propagated, propagated);
}

const MODELS: [&str; 3] = ["small", "middle", "large"];

const HEAD: &str = "paper = \"x\"\ntitle = \"T\"\n[[claim]]\nid = \"i\"\nplace = \"p\"\nquote = \"q\"\nclaim = \"c\"\nsuite = \"s\"\n";

fn read(test: &str) -> Result<ClaimsFile, geobench_harness::DocumentError> {
    ClaimsFile::parse(
        Path::new("c.toml"),
        &format!("{HEAD}[[claim.test]]\n{test}\n"),
    )
}

/// The verdict of a claim with one test.
fn judge_one(test: &str, result: &ResultFile) -> JudgedClaim {
    let mut file = read(test).unwrap();
    file.is_of_paper = true;
    let input = Input::new("r.json".into(), result.clone());
    let mut report = judge(&[file], &[input]).unwrap();
    report.papers.remove(0).claims.remove(0)
}

/// The verdict and the reason.
fn verdict_of(test: &str, result: &ResultFile) -> (ClaimVerdict, String) {
    let judged = judge_one(test, result);
    (judged.verdict, judged.reason)
}

/// The only value.
fn value_of(test: &str, result: &ResultFile) -> f64 {
    let judged = judge_one(test, result);
    assert_eq!(judged.values.len(), 1, "{:?}", judged.values);
    judged.values.values().next().unwrap().value.unwrap()
}

use ClaimVerdict::{Confirmed, DirectionOnly, Not, Partly, Unjudged};

#[test]
fn one_number_changes_a_verdict() {
    let mut result = made_up("ich,vtp");
    let test = "of = [\"ich\"]\nto = \"vtp\"\nfigure = \"propagated\"\nholds = \"> 1\"";
    for model in MODELS {
        count(&mut result, "ich", model, 250);
    }
    assert_eq!(verdict_of(test, &result), (Confirmed, String::new()));
    count(&mut result, "ich", "large", 99);
    assert_eq!(
        verdict_of(test, &result),
        (
            Partly,
            "it does not hold for: ich to vtp on large".to_owned()
        )
    );
    count(&mut result, "ich", "small", 100);
    assert_eq!(
        verdict_of(test, &result),
        (
            Not,
            "it does not hold for: ich to vtp on small, large".to_owned()
        )
    );
    count(&mut result, "ich", "middle", 100);
    assert_eq!(
        verdict_of(test, &result),
        (Not, "it holds in no case".to_owned())
    );
}

#[test]
fn cases_of_one_model_in_several_groups_are_all_kept() {
    let mut result = made_up("ich");
    let cells = result.cells.clone();
    for name in ["a", "b", "c"] {
        let cells = cells.iter().cloned();
        result.cells.extend(cells.map(|cell| Cell {
            group: Some(name.into()),
            ..cell
        }));
        let plan = result.plan.as_mut().unwrap();
        let mut group = plan.groups[0].clone();
        group.name = Some(name.into());
        plan.groups.push(group);
    }
    result.cells.retain(|cell| cell.group.is_some());
    let test = "of = [\"ich\"]\nfigure = \"propagated\"\nholds = \"> 0\"";
    let judged = judge_one(test, &result);
    assert_eq!(judged.values.len(), 9);
    assert!(judged.values.contains_key("ich, small in b"));
}

#[test]
fn the_range_of_sizes_meets_that_of_the_paper() {
    let mut result = made_up("ich,vtp");
    let test = |paper: &str| {
        format!(
            "of = [\"ich\"]\nto = \"vtp\"\nfigure = \"propagated\"\nholds = \"> 1\"\npaper = {paper}"
        )
    };
    for model in MODELS {
        count(&mut result, "ich", model, 300);
    }
    // A single value counts with 5 %.
    for fitting in ["3", "2.9", "3.1", "[1.5, 2.9]", "[3.1, 9]", "[2, 4]"] {
        assert_eq!(
            verdict_of(&test(fitting), &result).0,
            Confirmed,
            "{fitting}"
        );
    }
    for off in ["2.8", "3.2", "[1.5, 2.8]", "[3.2, 9]"] {
        assert_eq!(
            verdict_of(&test(off), &result),
            (DirectionOnly, "sizes unlike the paper's".to_owned()),
            "{off}"
        );
    }
    count(&mut result, "ich", "large", 500);
    assert_eq!(verdict_of(&test("[4.6, 9]"), &result).0, Confirmed);
    assert_eq!(verdict_of(&test("4"), &result).0, Confirmed);
    // The paper's own table: 6.45 to 16.2 times in time.
    let table = "of = [\"ich\"]\nto = \"vtp\"\nholds = \"> 1\"\npaper = \"000-table-1\"";
    for (by, verdict) in [
        (6.1, DirectionOnly),
        (6.2, Confirmed),
        (17.0, Confirmed),
        (17.2, DirectionOnly),
    ] {
        let mut result = made_up("ich,vtp");
        for model in MODELS {
            scale(&mut result, "ich", model, by);
        }
        assert_eq!(verdict_of(table, &result).0, verdict, "{by}");
    }
}

#[test]
fn times_decide_by_their_interval_else_instructions_do() {
    let mut result = made_up("ich,vtp");
    let test = "of = [\"ich\"]\nto = \"vtp\"\nelse = [\"instructions\"]\nholds = \"> 1\"";
    for model in MODELS {
        scale(&mut result, "ich", model, 2.0);
    }
    let judged = judge_one(test, &result);
    assert_eq!(judged.verdict, Confirmed);
    // The ratio is 2 in every round, although the times of the rounds differ.
    assert_eq!(judged.values["ich to vtp, small"].ci95, Some([2.0, 2.0]));

    // The median is longer, but the interval includes 1.
    let wide = [0.9, 1.3, 0.8, 1.2, 1.0, 1.05].to_vec();
    cell(&mut result, "ich", "large").time = time(wide.clone(), None);
    assert_eq!(
        verdict_of(test, &result),
        (
            Partly,
            "the 95 % interval holds both sides: ich to vtp on large".to_owned()
        )
    );
    for model in MODELS {
        cell(&mut result, "ich", model).time = time(wide.clone(), None);
    }
    assert_eq!(
        verdict_of(test, &result),
        (Unjudged, "the 95 % interval holds both sides".to_owned())
    );

    // Instructions decide instead. They cannot confirm the size of a ratio of times.
    for model in MODELS {
        cell(&mut result, "ich", model).instructions = Some(300);
        cell(&mut result, "vtp", model).instructions = Some(100);
    }
    let judged = judge_one(test, &result);
    assert_eq!(judged.verdict, Confirmed);
    assert_eq!(judged.values["ich to vtp, small"].figure, "instructions");
    assert!(
        judged
            .reason
            .starts_with("decided by instructions, because the 95 %")
    );
    let sized = format!("{test}\npaper = 3");
    assert_eq!(verdict_of(&sized, &result).0, DirectionOnly);
    cell(&mut result, "ich", "small").instructions = Some(50);
    cell(&mut result, "ich", "middle").instructions = Some(50);
    assert_eq!(verdict_of(test, &result).0, Not);
}

#[test]
fn a_claim_without_data_is_unjudged() {
    let time_test = "of = [\"ich\"]\nto = \"vtp\"\nholds = \"> 1\"";
    let why = |result: &ResultFile, test: &str| {
        let (verdict, reason) = verdict_of(test, result);
        assert_eq!(verdict, Unjudged);
        reason
    };
    let mut few = made_up("ich,vtp");
    for cell in &mut few.cells {
        cell.time = time(vec![1.0], None);
    }
    assert_eq!(why(&few, time_test), "1 sample; an interval takes 6");
    let mut debug = made_up("ich,vtp");
    debug.tool.profile = "debug".into();
    assert_eq!(why(&debug, time_test), "it was measured with a debug build");
    let mut disturbed = made_up("ich,vtp");
    disturbed.isolation = Some(IsolationRecord {
        process: true,
        cpus: None,
        jobs: Some(2),
    });
    assert_eq!(
        why(&disturbed, time_test),
        "cells ran at the same time, which disturbs times"
    );

    let mut failed = made_up("ich,vtp");
    for (model, status) in MODELS
        .into_iter()
        .zip([Status::Timeout, Status::OutOfMemory])
    {
        cell(&mut failed, "ich", model).status = status;
    }
    failed
        .cells
        .retain(|c| c.algorithm != "ich" || c.model != "large");
    assert_eq!(
        why(&failed, time_test),
        "ich: timeout: ich to vtp on small; ich: out of memory: ich to vtp on middle; ich has no \
         cell: ich to vtp on large"
    );
    let none = made_up("ich,vtp");
    assert_eq!(
        why(
            &none,
            "of = [\"vtp\"]\nfigure = \"k_peak\"\nholds = \"> 1\""
        ),
        "vtp has no `k_peak`"
    );
    assert_eq!(
        why(&none, "of = [\"ich1\"]\nto = \"vtp\"\nholds = \"> 1\""),
        "ich1 was not run"
    );
    assert_eq!(
        why(&none, "models = [\"x*\"]\nof = [\"vtp\"]\nholds = \"> 1\""),
        "no model of the result is one that the claim is about"
    );
}

#[test]
fn times_and_instructions_of_vector_code_do_not_decide() {
    let mut result = made_up("ich,vtp");
    for model in MODELS {
        scale(&mut result, "ich", model, 2.0);
        cell(&mut result, "ich", model).instructions = Some(300);
        let vector = cell(&mut result, "vtp", model);
        vector.instructions = Some(100);
        vector.simd = Some("avx512".into());
    }
    let test = "of = [\"ich\"]\nto = \"vtp\"\nholds = \"> 1\"";
    let reason = "vtp ran with vector instructions (avx512); only scalar runs decide".to_owned();
    assert_eq!(verdict_of(test, &result), (Unjudged, reason.clone()));
    assert_eq!(
        verdict_of(&format!("{test}\nsimd = \"any\""), &result).0,
        Confirmed
    );
    // Callgrind counts narrower instructions than the timed runs used. Only the counted ones matter
    // for a figure of instructions.
    let counted = format!("{test}\nfigure = \"instructions\"");
    assert_eq!(verdict_of(&counted, &result).0, Confirmed);
    for cell in &mut result.cells {
        cell.instructions_simd = Some("avx2".into());
    }
    assert_eq!(
        verdict_of(&counted, &result),
        (
            Unjudged,
            "ich ran with vector instructions (avx2); only scalar runs decide".to_owned()
        )
    );
    // Counts do not depend on the SIMD level.
    let propagated = test.replace(
        "holds = \"> 1\"",
        "figure = \"propagated\"\nholds = \"0.9 to 1.1\"",
    );
    assert_eq!(verdict_of(&propagated, &result).0, Confirmed);
    cell(&mut result, "vtp", "small").simd = None;
    let (verdict, reason) = verdict_of(test, &result);
    assert_eq!(verdict, Unjudged);
    assert!(reason.contains("the result does not say which vector instructions ran"));
}

#[test]
fn an_algorithm_of_other_parameters_is_another_one() {
    let test = "of = [\"ich\"]\nto = \"vtp\"\nfigure = \"propagated\"\nholds = \"0.9 to 1.1\"";
    let mut result = made_up("ich,vtp");
    assert_eq!(verdict_of(test, &result).0, Confirmed);
    let without_plan = ResultFile {
        plan: None,
        ..result.clone()
    };
    assert_eq!(
        verdict_of(test, &without_plan),
        (
            Unjudged,
            "ich cannot be told from others: the result does not hold its plan".to_owned()
        )
    );
    let unknown = |result: &mut ResultFile, change: fn(&mut PlannedAlgorithm)| {
        let planned = &mut result.plan.as_mut().unwrap().groups[0].algorithms;
        change(
            planned
                .iter_mut()
                .find(|planned| planned.label == "ich")
                .unwrap(),
        );
    };
    // An older program used the label for other parameters, or had fewer or more parameters.
    let changes: [fn(&mut PlannedAlgorithm); 3] = [
        |planned| {
            *planned.parameters.values_mut().next().unwrap() = 0.5.into();
        },
        |planned| planned.parameters.clear(),
        |planned| {
            planned.parameters.insert("turn".into(), "list".into());
        },
    ];
    let original = result.clone();
    for change in changes {
        result = original.clone();
        unknown(&mut result, change);
        assert_eq!(
            verdict_of(test, &result),
            (
                Unjudged,
                "ich was run with other parameters than the claim has".to_owned()
            )
        );
    }
    // The claim finds its algorithm by the parameters, not by the label.
    let mut relabelled = original;
    unknown(&mut relabelled, |planned| {
        planned.label = "ich{old=1}".into();
    });
    for cell in relabelled.cells.iter_mut().filter(|c| c.algorithm == "ich") {
        cell.algorithm = "ich{old=1}".into();
    }
    assert_eq!(verdict_of(test, &relabelled).0, Confirmed);
}

#[test]
fn growth_is_a_fit_over_the_models_of_a_group() {
    let mut result = made_up("ich,vtp");
    for (model, by) in MODELS.into_iter().zip([1.0, 4.0, 16.0]) {
        scale(&mut result, "ich", model, by);
        count(&mut result, "ich", model, (100.0 * by) as u64);
    }
    let growth = |over: &str, figure: &str, to: &str| {
        let test = format!(
            "of = [\"ich\"]\n{to}\nover = \"{over}\"\nfigure = \"{figure}\"\nholds = \"> 15\""
        );
        judge_one(&test, &result)
    };
    for (over, range) in [("faces", [1000.0, 16000.0]), ("anisotropy", [1.0, 4.0])] {
        for (figure, to) in [("propagated", ""), ("time", "to = \"vtp\"")] {
            let judged = growth(over, figure, to);
            let case = judged.values.values().next().unwrap();
            assert!((case.value.unwrap() - 16.0).abs() < 1e-9);
            assert_eq!(case.range, Some(range));
            assert_eq!(judged.verdict, Confirmed);
        }
    }
    // Without pairs, the times of each model vary independently.
    let judged = growth("faces", "time", "");
    let [low, high] = judged.values.values().next().unwrap().ci95.unwrap();
    assert!(low < 15.0 && high > 17.0, "{low} {high}");
    assert_eq!(judged.verdict, Unjudged);

    cell(&mut result, "ich", "large").status = Status::Timeout;
    let test = "of = [\"ich\"]\nover = \"faces\"\nholds = \"> 1\"";
    assert_eq!(
        verdict_of(test, &result),
        (
            Unjudged,
            "fewer than 3 models of the series have a value: ich: timeout".to_owned()
        )
    );
}

#[test]
fn rows_with_the_label_come_before_those_with_the_name() {
    let printed = |of: &str| -> Vec<f64> {
        let test = format!(
            "of = [\"{of}\"]\nto = \"window-vtp\"\ncombine = \"mean\"\nholds = \"> 1\"\npaper = \"004-table-2\""
        );
        let file = read(&test).unwrap();
        let test = file.claims().next().unwrap().tests().next().unwrap();
        let numbers = test.printed(&test.of[0]).into_iter();
        numbers.map(|number| number.value).collect()
    };
    assert_eq!(printed("lct11"), [3.98]);
    assert_eq!(printed("lct11{queue=buckets}"), [1.21]);
    // No row has this label, so rows are found by the name of the algorithm.
    assert_eq!(printed("lct11{filter=vertices}"), [3.98, 1.21]);
}

#[test]
fn growth_over_sources_is_a_fit_over_the_groups_of_a_model() {
    let one = made_up("ich,vtp");
    let mut result = one.clone();
    result.cells.clear();
    let mut plans = Vec::new();
    for (group, sources, propagated) in [
        ("one", "random:1,seed=1", 100),
        ("ten", "random:10,seed=1", 400),
        ("many", "random:100,seed=1", 1600),
    ] {
        for cell in &one.cells {
            let mut cell = cell.clone();
            cell.group = Some(group.to_owned());
            cell.source = Some(SourceLabel::Other(sources.to_owned()));
            if cell.algorithm == "ich" {
                cell.counters.set(Counter::Propagated, propagated);
            }
            result.cells.push(cell);
        }
        for planned in one.plan.iter().flat_map(|plan| &plan.groups) {
            let mut planned = planned.clone();
            planned.name = Some(group.to_owned());
            plans.push(planned);
        }
    }
    result.plan.as_mut().unwrap().groups = plans;
    let test = "of = [\"ich\"]\nover = \"sources\"\nfigure = \"propagated\"\nholds = \"> 15\"";
    let judged = judge_one(test, &result);
    assert_eq!(judged.values.len(), MODELS.len());
    for case in judged.values.values() {
        assert!((case.value.unwrap() - 16.0).abs() < 1e-9);
        assert_eq!(case.range, Some([1.0, 100.0]));
    }
    let two = format!("{test}\ngroup = [\"one\", \"ten\"]");
    let judged = judge_one(&two, &result);
    assert_eq!(judged.verdict, Unjudged, "two points are no series");
}

#[test]
fn values_of_models_become_one() {
    let mut result = made_up("ich,vtp");
    for (model, propagated) in MODELS.into_iter().zip([100, 200, 900]) {
        count(&mut result, "ich", model, propagated);
    }
    for (combine, expected) in [
        ("mean", 4.0),
        ("median", 2.0),
        ("geometric_mean", 18_f64.cbrt()),
        ("spread", 9.0),
    ] {
        let test = format!(
            "of = [\"ich\"]\nto = \"vtp\"\nfigure = \"propagated\"\ncombine = \"{combine}\"\nholds = \"> 1\""
        );
        let value = value_of(&test, &result);
        assert!((value - expected).abs() < 1e-12, "{combine}: {value}");
    }
    let one = "models = [\"lar*\"]\nfigure = \"propagated\"\nholds = \"> 0\"\n";
    assert_eq!(value_of(&format!("{one}of = [\"ich\"]"), &result), 900.0);
    assert_eq!(
        value_of(&format!("{one}of = [\"ich\"]\nper = \"faces\""), &result),
        900.0 / 16e3
    );
    assert_eq!(
        value_of(&format!("{one}of = [\"ich\"]\nper = \"vertices\""), &result),
        900.0 / 8e3
    );
    let saved = format!("{one}of = [\"vtp\"]\nto = \"ich\"\nshow = \"saving\"");
    assert!((value_of(&saved, &result) - 8.0 / 9.0).abs() < 1e-12);
    let least = format!("{one}of = [\"ich\"]\nto = {{ least = [\"ich\", \"vtp\"] }}");
    assert_eq!(value_of(&least, &result), 9.0);
    let other =
        format!("{one}of = [\"ich\"]\nto = {{ algorithm = \"ich\", figure = \"children\" }}");
    assert_eq!(value_of(&other, &result), 9.0);
}

#[test]
fn the_best_value_of_a_parameter_is_found() {
    let mut result = made_up("fwp-ch{k=200},fwp-ch{k=500},fwp-ch{k=8000}");
    scale(&mut result, "fwp-ch{k=500}", "small", 0.5);
    scale(&mut result, "fwp-ch{k=500}", "middle", 0.5);
    scale(&mut result, "fwp-ch{k=8000}", "large", 0.5);
    let test = "of = [{ least = [\"fwp-ch{k=200}\", \"fwp-ch{k=500}\", \"fwp-ch{k=8000}\"] }]\nbest = \"k\"\ncombine = \"spread\"\nholds = \"> 2\"";
    assert_eq!(value_of(test, &result), 16.0);
    assert_eq!(verdict_of(test, &result).0, Confirmed);
}

#[test]
fn shares_decide_if_they_were_sampled() {
    let mut result = made_up("ich,vtp");
    for model in MODELS {
        let phases = &mut cell(&mut result, "vtp", model).phases;
        (phases.propagation, phases.pruning, phases.management) = (Some(0.4), Some(0.4), Some(0.2));
    }
    // 1/7 for ich, 0.2 for vtp.
    let share = "of = [\"vtp\"]\nto = \"ich\"\nfigure = \"management_share\"\nholds = \"> 1\"";
    let judged = judge_one(share, &result);
    let [low, high] = judged.values["vtp to ich, small"].ci95.unwrap();
    assert!(
        low > 1.2 && low < 1.35 && high > 1.45 && high < 1.65,
        "{low} {high}"
    );
    assert_eq!(judged.verdict, Confirmed);
    // The time in a phase is its share of the timed runs.
    let phase = "of = [\"vtp\"]\nto = \"ich\"\nfigure = \"phase_pruning\"\nholds = \"> 1\"";
    let value = judge_one(phase, &result).values["vtp to ich, small"]
        .value
        .unwrap();
    assert!((value - 0.4 / (2.0 / 7.0)).abs() < 1e-9, "{value}");

    let mut few = result.clone();
    few.cells
        .iter_mut()
        .for_each(|cell| cell.phases.samples = Some(20));
    assert_eq!(
        verdict_of(share, &few),
        (Unjudged, "the 95 % interval holds both sides".to_owned())
    );
    result
        .cells
        .iter_mut()
        .for_each(|cell| cell.phases.samples = None);
    let (verdict, reason) = verdict_of(share, &result);
    assert_eq!(verdict, Unjudged);
    assert!(
        reason.starts_with("the phases were not sampled"),
        "{reason}"
    );
}

#[test]
fn runs_that_must_fail_are_looked_for_on_large_models() {
    let mut result = made_up("ich,vtp");
    let test =
        |faces: u64| format!("of = [\"ich\"]\nends = \"out_of_memory\"\nat_least_faces = {faces}");
    assert_eq!(verdict_of(&test(16_000), &result).0, Not);
    cell(&mut result, "ich", "large").status = Status::OutOfMemory;
    assert_eq!(verdict_of(&test(16_000), &result).0, Confirmed);
    let elsewhere = format!("group = [\"memory\"]\n{}", test(0));
    assert_eq!(
        verdict_of(&elsewhere, &result),
        (
            Unjudged,
            "no model of the result is one that the claim is about".to_owned()
        )
    );
    assert_eq!(
        verdict_of(&test(1_000_000), &result),
        (
            Unjudged,
            "the largest model has 16,000 faces, the claim is about 1,000,000".to_owned()
        )
    );
}

#[test]
fn claims_without_results_have_a_reason() {
    let file = |rest: &str| {
        let head = HEAD.replace("suite = \"s\"\n", rest);
        ClaimsFile::parse(Path::new("c.toml"), &head).unwrap()
    };
    let awaiting = file("awaits = \"the heat method\"\n");
    let report = judge(&[awaiting], &[]).unwrap();
    let judged = &report.papers[0].claims[0];
    assert_eq!(judged.verdict, Unjudged);
    assert_eq!(judged.reason, "not available yet: the heat method");

    let deciding = read("of = [\"vtp\"]\nholds = \"> 1\"").unwrap();
    let input = |name: &str| Input::new(name.into(), made_up("vtp"));
    let report = judge(std::slice::from_ref(&deciding), &[]).unwrap();
    let judged = &report.papers[0].claims[0];
    assert_eq!(judged.reason, "there is no result of the suite s");
    let twice = judge(
        std::slice::from_ref(&deciding),
        &[input("a.json"), input("b.json")],
    );
    assert_eq!(
        twice.unwrap_err().to_string(),
        "a.json and b.json are both results of the suite s; give one of them"
    );
    let mut other = input("c.json");
    other.result.command.clear();
    let report = judge(&[deciding], &[other]).unwrap();
    assert_eq!(report.notes, ["c.json: no claim is decided by its suite"]);
}

#[test]
fn every_form_has_the_verdict() {
    let mut result = made_up("ich,vtp");
    count(&mut result, "ich", "small", 250);
    let file =
        read("of = [\"ich\"]\nto = \"vtp\"\nfigure = \"propagated\"\nholds = \"> 1\"").unwrap();
    let input = Input::new("r.json".into(), result);
    let report = judge(&[file], &[input]).unwrap();
    let render = |form: ClaimsFormat| form.render(&report, Look::default()).unwrap();
    let json: serde_json::Value = serde_json::from_str(&render(ClaimsFormat::Json)).unwrap();
    let claim = &json[0];
    for key in [
        "id", "paper", "place", "claim", "verdict", "values", "reason",
    ] {
        assert!(!claim[key].is_null(), "{key}");
    }
    assert_eq!(claim["verdict"], "not");
    assert_eq!(claim["cause"], "open");
    assert_eq!(claim["values"]["ich to vtp, small"]["value"], 2.5);
    assert_eq!(claim["values"]["ich to vtp, large"]["holds"], false);
    let here = "ich to vtp: small 2.50, middle 1.00 (no), large 1.00 (no)";
    for form in [ClaimsFormat::Markdown, ClaimsFormat::Csv] {
        assert!(render(form).contains(here), "{}", render(form));
    }
    assert!(
        render(ClaimsFormat::Markdown)
            .contains("| **not (open)** | it does not hold for: ich to vtp on middle, large. |")
    );
    assert!(
        render(ClaimsFormat::Csv)
            .starts_with("id,paper,place,claim,quote,printed,suite,verdict,cause,values,reason\n")
    );
    assert!(render(ClaimsFormat::Text).contains("i: c"));
}

#[test]
fn claims_without_results_are_counted_in_text() {
    let files = super::known().unwrap();
    let claims: usize = files.iter().map(|file| file.claims().count()).sum();
    let report = super::judge(&files, &[]).unwrap();
    let text = ClaimsFormat::Text.render(&report, crate::table::Look::default());
    let text = text.unwrap();
    assert!(!text.contains("000:"), "{text}");
    let rest = format!("{claims} claims without results; --format markdown has them.\n");
    assert!(text.ends_with(&rest), "{text}");
}

#[test]
fn patterns_match_whole_names() {
    for (pattern, text, expected) in [
        ("horse", "horse", true),
        ("horse", "horse-x4", false),
        ("torus*", "torus,faces=5", true),
        ("*g=8", "anisotropic,g=8", true),
        ("*g=8", "anisotropic,g=80", false),
        ("a*b*c", "a-b-c", true),
        ("a*b*c", "a-c", false),
        ("*", "", true),
    ] {
        assert_eq!(is_like(pattern, text), expected, "{pattern} {text}");
    }
}

#[test]
fn a_claim_whose_heaps_disagree_is_unjudged() {
    let mut result = made_up("ich,ich{queue=heap4},vtp");
    let test = "of = [\"ich\"]\nto = \"vtp\"\nholds = \"> 1\"";
    for model in MODELS {
        scale(&mut result, "ich", model, 2.0);
        scale(&mut result, "ich{queue=heap4}", model, 1.5);
    }
    assert_eq!(verdict_of(test, &result).0, Confirmed);
    let sized = format!("{test}\npaper = 2");
    assert_eq!(
        verdict_of(&sized, &result),
        (
            Unjudged,
            "it rests on the queue: confirmed with a binary heap, direction only with one of four \
             children a node"
                .to_owned()
        )
    );
    // Counts do not rest on the queue, and a record without the second heap is judged by the first.
    let counts = format!("{test}\nfigure = \"propagated\"").replace("> 1", "0.9 to 1.1");
    count(&mut result, "ich{queue=heap4}", "small", 900);
    assert_eq!(verdict_of(&counts, &result).0, Confirmed);
    result
        .cells
        .retain(|cell| cell.algorithm != "ich{queue=heap4}");
    assert_eq!(verdict_of(&sized, &result).0, Confirmed);
}

#[test]
fn causes_come_from_the_authors_programs() {
    let mut result = made_up("mmp,vtp");
    let mut authors = made_up("mmp,vtp");
    authors.command.clear();
    for cell in &mut authors.cells {
        cell.simd = None;
        cell.algorithm = match cell.algorithm.as_str() {
            "mmp" => "ext:kirsanov".to_owned(),
            _ => "ext:vtp".to_owned(),
        };
    }
    for model in MODELS {
        scale(&mut result, "mmp", model, 3.0);
    }
    let test = "of = [\"mmp\"]\nto = \"vtp\"\nholds = \"> 1\"\npaper = 6";
    let judged = |test: &str, authors: Option<&ResultFile>| {
        let inputs = std::iter::once(&result).chain(authors);
        let inputs = inputs.map(|result| Input::new("r.json".into(), result.clone()));
        let file = read(test).unwrap();
        let mut report = judge(&[file], &inputs.collect::<Vec<_>>()).unwrap();
        assert!(report.notes.is_empty());
        let claim = report.papers.remove(0).claims.remove(0);
        (claim.verdict, claim.cause)
    };
    assert_eq!(judged(test, None), (DirectionOnly, Some(ClaimCause::Open)));
    let cause = |authors: &ResultFile| judged(test, Some(authors)).1;
    for model in MODELS {
        scale(&mut authors, "ext:kirsanov", model, 2.0);
    }
    assert_eq!(cause(&authors), Some(ClaimCause::Paper));
    for model in MODELS {
        scale(&mut authors, "ext:kirsanov", model, 3.0);
    }
    assert_eq!(cause(&authors), Some(ClaimCause::Implementation));
    let inputs = [&result, &authors].map(|one| Input::new("r.json".into(), one.clone()));
    let report = judge(&[read(test).unwrap()], &inputs).unwrap();
    let why = page::why(&report.papers[0].claims[0]);
    let shown = "with the authors' programs mmp to vtp: small 6.00 (6.00 to 6.00), middle";
    assert!(why.contains(shown), "{why}");
    let confirmed = test.replace("paper = 6", "paper = 3");
    assert_eq!(judged(&confirmed, Some(&authors)), (Confirmed, None));
    let counts = test.replace("holds", "figure = \"propagated\"\nholds");
    assert_eq!(judged(&counts, Some(&authors)).1, Some(ClaimCause::Open));
}

#[test]
fn models_of_a_user_decide_no_claim() {
    let mut result = made_up("ich,vtp");
    let test = "of = [\"ich\"]\nfigure = \"propagated\"\nholds = \"> 1\"";
    assert_eq!(verdict_of(test, &result).0, Confirmed);
    // The text of a suite goes with its models.
    for group in &mut result.groups {
        group.shows = None;
    }
    assert_eq!(verdict_of(test, &result).0, Unjudged);
}

#[test]
fn models_unlike_the_papers_do_not_decide() {
    let result = made_up("ich,vtp");
    let test = "of = [\"ich\"]\nfigure = \"propagated\"\nholds = \"> 1\"";
    let judged = judge_one(&format!("{test}\nat_least_faces = 4_000"), &result);
    assert_eq!((judged.verdict, judged.values.len()), (Confirmed, 2));
    let (verdict, reason) = verdict_of(&format!("{test}\nfaces_per_source = 20_000"), &result);
    assert_eq!(verdict, Unjudged);
    assert_eq!(
        reason,
        "the largest model has 16,000 faces for 1 source, the claim is about 20,000 faces for each"
    );
}

#[test]
fn a_difference_below_the_interval_does_not_decide() {
    let mut result = made_up("ich,vtp");
    for model in MODELS {
        cell(&mut result, "ich", model).time = time(vec![0.5, 0.8, 0.7, 0.6, 0.9, 0.75], None);
    }
    let test = "of = [\"ich\"]\nto = \"vtp\"\nholds = \"> 1\"";
    assert_eq!(verdict_of(test, &result).0, Not);
    assert_eq!(
        verdict_of(&format!("{test}\npaper = 1.05"), &result),
        (
            Unjudged,
            "the claimed difference is smaller than the 95 % interval".to_owned()
        )
    );
    assert_eq!(verdict_of(&format!("{test}\npaper = 5"), &result).0, Not);
}

/// The names of verdicts in JSON, which scripts rely on.
#[test]
fn verdicts_have_their_names_in_json() {
    let names = serde_json::to_value(ClaimVerdict::ALL).unwrap();
    let expected = ["confirmed", "direction", "partly", "not", "unjudged"];
    assert_eq!(names, serde_json::json!(expected));
}
