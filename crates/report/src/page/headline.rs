//! The outcome of a group in one sentence, and warnings about its times.

use geobench_harness::figures::capitalised;
use geobench_harness::figures::time;
use geobench_harness::measure::statistics::{Variable, interval_of, median};
use geobench_harness::schema::{Cell, ResultFile, Status};

use crate::table::disturbance;
use crate::table::group::{GroupCells, distinct, is_same_problem, pairs};

/// The largest relative difference from the reference, beyond rounding, that counts as exact.
pub(super) const EXACT: f64 = 1e-6;

/// Names the algorithm that is fastest on most models, and its speed-up over the base of ratios. If
/// it is the base itself, or the base is not exact, the speed-up is over the next fastest
/// algorithm. `None` if no model has the times of two exact algorithms.
///
/// Models on which fewer than two exact algorithms ran are ignored: there is nothing to win there.
/// Approximate algorithms are ignored. The speed-up is the geometric mean over all models and
/// sources that both solved. Its interval is a bootstrap over the samples of each.
pub(crate) fn headline(group: &GroupCells<'_>) -> Option<String> {
    let exact: Vec<&str> = group
        .algorithms
        .iter()
        .copied()
        .filter(|name| is_exact(group, name))
        .collect();
    let ran = |model: &str, name: &str| {
        let mut cells = group.cells.iter();
        cells.any(|cell| cell.model == model && cell.algorithm == name)
    };
    // For each model: its exact algorithms that have a time, the fastest first.
    let ranked: Vec<Vec<&str>> = group
        .models
        .iter()
        .filter(|model| exact.iter().filter(|name| ran(&model.name, name)).count() > 1)
        .map(|model| {
            let names = exact.iter().copied();
            let mut times: Vec<(&str, f64)> = names
                .filter_map(|name| Some((name, group.value(time(), &model.name, name)?.value)))
                .collect();
            times.sort_by(|a, b| a.1.total_cmp(&b.1));
            times.into_iter().map(|(name, _)| name).collect()
        })
        .collect();
    if ranked.iter().all(|names| names.len() < 2) {
        return None;
    }
    let wins = |place: usize, name: &str| {
        ranked
            .iter()
            .filter(|names| names.get(place) == Some(&name))
            .count()
    };
    let most = |place: usize, but: Option<&str>| {
        let names = exact.iter().copied().filter(|name| Some(*name) != but);
        // `max_by_key` returns the last of several maxima, which is the first in the original
        // order.
        names
            .rev()
            .max_by_key(|name| wins(place, name))
            .filter(|name| wins(place, name) > 0)
    };
    let best = most(0, None)?;
    let models = match ranked.len() {
        1 => "the only model".to_owned(),
        all => format!("{} of {all} models", wins(0, best)),
    };
    let base = group.record.ratios_to.as_deref();
    let base = base.filter(|name| *name != best && exact.contains(name));
    let (other, which) = match base {
        Some(base) => (base, ""),
        None => (
            most(1, Some(best)).or_else(|| most(0, Some(best)))?,
            ", the next",
        ),
    };
    let mut text = format!("{best} is fastest on {models}");
    if let Some((factor, interval)) = factor(group, other, best) {
        let interval = interval.map_or_else(String::new, |[low, high]| {
            format!(" [{}, {}]", times(low), times(high))
        });
        text += &format!(
            ", {}{interval} times as fast as {other}{which}",
            times(factor)
        );
    }
    Some(text + ".")
}

/// Whether an algorithm is exact: not marked as approximate, and within [`EXACT`] of the reference
/// in every cell.
fn is_exact(group: &GroupCells<'_>, algorithm: &str) -> bool {
    let mut cells = group
        .cells
        .iter()
        .filter(|cell| cell.algorithm == algorithm);
    cells.all(|cell| {
        // Older files have no tolerance.
        let error = cell.check.least_tolerance.or(cell.check.max_rel);
        let is_close = error.is_none_or(|error| error <= EXACT);
        is_close && !cell.approximate
    })
}

/// The geometric mean of the time ratios of `over` to `under`, with its 95 % interval if each cell
/// has enough samples.
fn factor(group: &GroupCells<'_>, over: &str, under: &str) -> Option<(f64, Option<[f64; 2]>)> {
    let solved = |name: &str| -> Vec<&Cell> {
        let cells = group.cells.iter().copied();
        cells
            .filter(|c| c.algorithm == name && c.status == Status::Ok)
            .collect()
    };
    let below = solved(under);
    let ratios: Vec<Vec<f64>> = solved(over)
        .into_iter()
        .filter_map(|cell| {
            let same = below.iter().find(|other| is_same_problem(other, cell));
            let (above, below) = pairs(cell, same?);
            let ratios = above.iter().zip(below).map(|(a, b)| a / b);
            let ratios: Vec<f64> = ratios.filter(|r| r.is_finite() && *r > 0.0).collect();
            (!ratios.is_empty()).then_some(ratios)
        })
        .collect();
    let mean = |values: &[f64]| {
        let logarithms: f64 = values.iter().copied().map(libm::log).sum();
        libm::exp(logarithms / values.len() as f64)
    };
    let medians: Option<Vec<f64>> = ratios.iter().map(|ratios| median(ratios)).collect();
    let medians = medians.filter(|medians| !medians.is_empty())?;
    let variables: Vec<Variable<'_>> = ratios.iter().map(|r| Variable::Samples(r)).collect();
    Some((mean(&medians), interval_of(&variables, mean)))
}

/// A factor with two or three digits.
fn times(factor: f64) -> String {
    match factor {
        f if f >= 99.5 => format!("{f:.0}"),
        f if f >= 0.995 => format!("{f:.1}"),
        f => format!("{f:.2}"),
    }
}

/// Reasons to doubt the times of a result, without repetitions.
pub(crate) fn warnings(result: &ResultFile) -> Vec<String> {
    let mut warnings = Vec::new();
    if result.tool.profile != "release" {
        warnings.push("This was not a release build: its times mean little.".to_owned());
    }
    for warning in result
        .conditions
        .iter()
        .flat_map(|conditions| conditions.warnings.clone())
        .chain(disturbance(result))
    {
        let text = capitalised(&warning) + ".";
        if !warnings.contains(&text) {
            warnings.push(text);
        }
    }
    let timed = || {
        result
            .cells
            .iter()
            .filter(|cell| !cell.time.samples.is_empty())
    };
    let imprecise = timed().filter(|cell| cell.time.is_imprecise()).count();
    if imprecise > 0 {
        let wanted = timed().filter(|cell| cell.time.is_imprecise());
        let wanted = distinct(wanted.filter_map(|cell| cell.time.precision));
        let wanted: Vec<String> = wanted
            .into_iter()
            .map(|share| format!("{} %", (1e6 * share).round() / 1e4))
            .collect();
        warnings.push(format!(
            "{imprecise} of {} times have a 95 % interval wider than the {} wanted; tables mark them with ~.",
            timed().count(),
            wanted.join(" or ")
        ));
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;
    use geobench_harness::schema::GroupRecord;

    /// A result with these times. Each cell has six equal samples, except that the last is 10 %
    /// longer.
    fn result(times: &[(&str, &str, f64)]) -> ResultFile {
        let mut result =
            geobench_harness::run::mock::result(geobench_harness::run::Records::default());
        result.models.clear();
        result.cells.clear();
        for (model, algorithm, seconds) in times {
            if result.models.iter().all(|m| m.name != *model) {
                let name = (*model).to_owned();
                let model = geobench_harness::schema::ModelRecord {
                    name,
                    ..Default::default()
                };
                result.models.push(model);
            }
            let mut cell = Cell::new(model, algorithm);
            let mut samples = vec![*seconds; 6];
            samples[5] *= 1.1;
            cell.time = geobench_harness::measure::statistics::time(samples, None);
            result.cells.push(cell);
        }
        result
    }

    fn line(times: &[(&str, &str, f64)], base: &str) -> Option<String> {
        let result = result(times);
        let record = GroupRecord {
            ratios_to: Some(base.to_owned()),
            ..GroupRecord::default()
        };
        headline(&GroupCells::new(&record, &result.models, &result.cells))
    }

    #[test]
    fn the_fastest_is_compared_with_the_base_or_with_the_next() {
        let times = [
            ("a", "mmp", 4.0),
            ("a", "vtp", 2.0),
            ("a", "fast", 1.0),
            ("b", "mmp", 16.0),
            ("b", "vtp", 8.0),
            ("b", "fast", 1.0),
        ];
        // The geometric mean of 2 and 8.
        assert_eq!(
            line(&times, "vtp").unwrap(),
            "fast is fastest on 2 of 2 models, 4.0 [4.0, 4.0] times as fast as vtp."
        );
        assert_eq!(
            line(&times[..2], "vtp").unwrap(),
            "vtp is fastest on the only model, 2.0 [2.0, 2.0] times as fast as mmp, the next."
        );
        let split = [
            times[0],
            times[1],
            ("b", "mmp", 1.0),
            ("b", "vtp", 2.0),
            times[2],
        ];
        assert!(
            line(&split, "vtp")
                .unwrap()
                .starts_with("mmp is fastest on 1 of 2 models, ")
        );
        assert_eq!(line(&times[..1], "vtp"), None);
    }

    #[test]
    fn models_that_one_algorithm_ran_on_counted_as_won() {
        let times = [("a", "mmp", 4.0), ("a", "vtp", 2.0), ("b", "mmp", 16.0)];
        assert!(
            line(&times, "vtp")
                .unwrap()
                .starts_with("vtp is fastest on the only model, ")
        );
    }

    #[test]
    fn the_only_algorithm_that_solved_a_model_is_the_fastest_there() {
        let mut result = result(&[
            ("a", "mmp", 4.0),
            ("a", "vtp", 2.0),
            ("b", "mmp", 16.0),
            ("b", "vtp", 1.0),
        ]);
        result.cells[3].status = Status::OutOfMemory;
        result.cells[3].time = geobench_harness::schema::Time::default();
        let record = GroupRecord::default();
        let group = GroupCells::new(&record, &result.models, &result.cells);
        let text = headline(&group).unwrap();
        assert!(text.contains(" is fastest on 1 of 2 models, "), "{text}");
    }

    #[test]
    fn approximate_answers_are_not_the_fastest() {
        let mut result = result(&[("a", "heat", 0.1), ("a", "mmp", 2.0), ("a", "vtp", 1.0)]);
        result.cells[0].check.least_tolerance = Some(0.01);
        let record = GroupRecord::default();
        let group = GroupCells::new(&record, &result.models, &result.cells);
        let text = headline(&group).unwrap();
        assert!(
            text.starts_with("vtp is fastest on the only model, 2.0"),
            "{text}"
        );
    }

    #[test]
    fn each_warning_is_given_once() {
        let mut result = result(&[("a", "mmp", 2.0), ("a", "vtp", 1.0)]);
        result.tool.profile = "debug".to_owned();
        let warning = "other programs kept 1.0 processors busy".to_owned();
        result.conditions = Some(geobench_harness::schema::Conditions {
            warnings: vec![warning.clone(), warning],
            ..Default::default()
        });
        for cell in &mut result.cells {
            cell.time.precision = Some(0.001);
            cell.time.ci95 = Some([0.5, 3.0]);
        }
        assert_eq!(
            warnings(&result),
            [
                "This was not a release build: its times mean little.",
                "Other programs kept 1.0 processors busy.",
                "2 of 2 times have a 95 % interval wider than the 0.1 % wanted; tables mark them with ~.",
            ]
        );
    }
}
