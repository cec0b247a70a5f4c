//! The outcome of a group in one or two sentences, and warnings about its times.

use std::collections::HashSet;

use geobench_harness::figures::{capitalised, time};
use geobench_harness::measure::number::{self, counted, group, grouped};
use geobench_harness::measure::statistics::{FEWEST_FOR_INTERVAL, range_of};
use geobench_harness::schema::{ModelRecord, ResultFile};

use super::document::{Headline, Sentence};
use super::scaling;
use crate::table::disturbance;
use crate::table::group::{Estimate, GroupCells, distinct, geometric_mean};

/// The largest relative difference from the reference, beyond rounding, that counts as exact.
pub(super) const EXACT: f64 = 1e-6;

/// The most ranked algorithms for which a page has the sentences of all pairs.
const MOST_PAIRED: usize = 30;

/// The headline of a group; `None` if no two exact algorithms solved the same problem.
///
/// Algorithms that differ only in parameters or instructions count as one: the form that is faster
/// than most others stands for it. Approximate algorithms are ignored. The ranking is by the number
/// of algorithms that each is faster than, in the geometric mean over all problems that both
/// solved.
pub(crate) fn headline(group: &GroupCells<'_>) -> Option<Headline> {
    let names = group.algorithms.iter().copied();
    let exact: Vec<&str> = names.filter(|name| is_exact(group, name)).collect();
    let series = scaling::series(group);
    let compare = |slower: &str, faster: &str| Comparison::of(group, &series, slower, faster);
    let mut ranked: Vec<(&str, usize)> = exact.iter().map(|name| (*name, 0)).collect();
    for (i, first) in exact.iter().enumerate() {
        for (j, second) in exact.iter().enumerate().skip(i + 1) {
            if let Some(found) = compare(first, second) {
                let winner = if found.factor > 1.0 { j } else { i };
                ranked[winner].1 += 1;
            }
        }
    }
    ranked.sort_by_key(|(_, wins)| std::cmp::Reverse(*wins));
    let mut ranking: Vec<&str> = Vec::new();
    for (label, _) in ranked {
        if ranking.iter().all(|other| name_of(other) != name_of(label)) {
            ranking.push(label);
        }
    }
    let base = group.record.ratios_to.as_deref();
    let base = base.filter(|base| ranking.contains(base));
    // As the next, and as another.
    let sentences = |faster: &str, slower: &str| {
        let found = compare(slower, faster)?;
        Some([true, false].map(|of_next| Sentence {
            faster: faster.to_owned(),
            slower: slower.to_owned(),
            of_next,
            text: found.in_words(&group.shown(faster), &group.shown(slower), of_next),
        }))
    };
    let (best, next) = (*ranking.first()?, *ranking.get(1)?);
    let is_outside = |label: &&&str| label.starts_with(OUTSIDE) != best.starts_with(OUTSIDE);
    let rival = ranking[1..].iter().find(is_outside).copied();
    let rival = rival.or(base).filter(|rival| ![best, next].contains(rival));
    let of_next = sentences(best, next).map(|[of_next, _]| of_next);
    let of_rival = rival.and_then(|rival| sentences(best, rival));
    let of_rival = of_rival.map(|[_, of_rival]| of_rival);
    // Outside programs come first.
    let names_outside = rival.is_some_and(|rival| is_outside(&&rival));
    let (first, second) = if names_outside {
        (of_rival, of_next)
    } else {
        (of_next, of_rival)
    };
    let shown: Vec<Sentence> = first.into_iter().chain(second).collect();
    if shown.is_empty() {
        return None;
    }
    let mut others = Vec::new();
    // Of those that are not about the next, scripts show one with an outside program or the base.
    let can_be_shown = |one: &Sentence| {
        let differ = one.faster.starts_with(OUTSIDE) != one.slower.starts_with(OUTSIDE);
        one.of_next || differ || base == Some(&one.slower)
    };
    if ranking.len() <= MOST_PAIRED {
        for (i, faster) in ranking.iter().enumerate() {
            for slower in &ranking[i + 1..] {
                let both = sentences(faster, slower).into_iter().flatten();
                others.extend(both.filter(|one| can_be_shown(one) && !shown.contains(one)));
            }
        }
    }
    Some(Headline {
        base: base.map(str::to_owned),
        ranking: ranking.into_iter().map(str::to_owned).collect(),
        shown,
        others,
    })
}

/// The beginning of the labels of outside programs.
const OUTSIDE: &str = "ext:";

/// The name in a label, without parameters.
fn name_of(label: &str) -> &str {
    label.split('{').next().unwrap_or(label)
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

/// The ratios of the times of a slower algorithm to those of a faster one.
struct Comparison {
    /// The geometric mean over the models.
    factor: f64,
    /// Its 95 % interval; `None` if a model has too few samples.
    interval: Option<[f64; 2]>,
    /// The ratio of each model.
    ratios: Vec<f64>,
    /// Whether both algorithms solved all models of the group.
    solved_all: bool,
    /// The geometric means over the largest and the smallest models of series over size, and the
    /// faces of the largest and smallest if there is one series and nothing else. `None` without
    /// series.
    growth: Option<Growth>,
}

/// The ratio in series over size.
struct Growth {
    /// The geometric mean of the ratios at the smallest sizes.
    smallest: f64,
    /// The least and the greatest number of faces of the only series; `None` if there are several.
    faces: Option<[u64; 2]>,
}

impl Comparison {
    /// Compares the times from all sources of the models that both algorithms solved. Of each
    /// series over size, only the largest of these models counts.
    fn of<'r>(
        group: &GroupCells<'r>,
        series: &[Vec<&'r ModelRecord>],
        slower: &str,
        faster: &str,
    ) -> Option<Self> {
        type Compared<'r> = Option<(Estimate, &'r ModelRecord)>;
        let ratio_of = |model: &&'r ModelRecord| -> Compared<'r> {
            let ratio = group.ratio(time(), &model.name, slower, faster)?;
            Some((ratio, *model))
        };
        let in_series = series.iter().flatten().map(|model| model.name.as_str());
        let in_series: HashSet<&str> = in_series.collect();
        let is_in_series = |model: &&ModelRecord| in_series.contains(model.name.as_str());
        let alone = group
            .models
            .iter()
            .copied()
            .filter(|model| !is_in_series(model));
        let mut counted: Vec<(Estimate, &ModelRecord)> =
            alone.filter_map(|m| ratio_of(&m)).collect();
        let is_only_series = counted.is_empty();
        let mut common = counted.len();
        let mut ends = Vec::new();
        for one in series {
            let solved: Vec<_> = one.iter().filter_map(ratio_of).collect();
            common += solved.len();
            match solved[..] {
                [] => {}
                [only] => counted.push(only),
                [first, .., last] => {
                    counted.push(last);
                    ends.push((first, last));
                }
            }
        }
        let values: Vec<f64> = counted.iter().map(|(ratio, _)| ratio.value).collect();
        let factor = geometric_mean(&values)?;
        let smallest: Vec<f64> = ends.iter().map(|((first, _), _)| first.value).collect();
        Some(Self {
            factor,
            interval: interval_of_mean(factor, counted.iter().map(|(ratio, _)| *ratio)),
            ratios: values,
            solved_all: common == group.models.len(),
            growth: geometric_mean(&smallest).map(|smallest| Growth {
                smallest,
                faces: match ends[..] {
                    [(first, last)] if is_only_series && counted.len() == 1 => {
                        first.1.faces.zip(last.1.faces).map(|(a, b)| [a, b])
                    }
                    _ => None,
                },
            }),
        })
    }

    /// The comparison of the algorithms the other way round.
    fn reversed(&self) -> Self {
        Self {
            factor: 1.0 / self.factor,
            interval: self.interval.map(|[low, high]| [1.0 / high, 1.0 / low]),
            ratios: self.ratios.iter().map(|ratio| 1.0 / ratio).collect(),
            solved_all: self.solved_all,
            growth: self.growth.as_ref().map(|growth| Growth {
                smallest: 1.0 / growth.smallest,
                faces: growth.faces,
            }),
        }
    }

    fn in_words(&self, faster: &str, slower: &str, of_next: bool) -> String {
        let factor = grouped_ratio(self.factor);
        let models = self.models_in_words();
        let Some([low, high]) = self.interval else {
            return format!(
                "{faster} is {factor} times as fast as {slower}{models}; no winner, since fewer \
                 than {FEWEST_FOR_INTERVAL} runs of a model have no interval."
            );
        };
        if high < 1.0 {
            // The ranking is by all pairs, of which each has its own models.
            return self.reversed().in_words(slower, faster, false);
        }
        if low <= 1.0 {
            let factor = format!("{factor} [{}, {}]", grouped_ratio(low), grouped_ratio(high));
            return format!(
                "No difference between {faster} and {slower}: {faster} is {factor} times as \
                 fast{models}."
            );
        }
        let factor = format!("{factor} [{}, {}]", above_one(low), above_one(high));
        if of_next {
            let on_average = if self.slower_on() > 0 {
                " on average"
            } else {
                ""
            };
            format!(
                "{faster} is fastest{on_average}, {factor} times as fast as the next, \
                 {slower}{models}."
            )
        } else {
            format!("{faster} is {factor} times as fast as {slower}{models}.")
        }
    }

    /// The number of models, of several, on which it is the slower one.
    fn slower_on(&self) -> usize {
        match &self.ratios[..] {
            [_] => 0,
            all => all.iter().filter(|ratio| **ratio < 1.0).count(),
        }
    }

    /// The models, to follow the factor.
    fn models_in_words(&self) -> String {
        let models = self.ratios.len();
        let solved = if self.solved_all {
            ""
        } else {
            " that both solved"
        };
        let largest = if self.growth.is_some() {
            ", the largest of each size series"
        } else {
            ""
        };
        let range = match range_of(self.ratios.iter().copied()) {
            Some([low, high]) if models > 1 => {
                format!(", {} to {}", grouped_ratio(low), grouped_ratio(high))
            }
            _ => String::new(),
        };
        let slower = match self.slower_on() {
            0 => String::new(),
            lost => format!("; slower on {lost}"),
        };
        match &self.growth {
            Some(Growth {
                smallest,
                faces: Some([few, many]),
            }) => format!(
                ", at {} faces, the largest size{solved}; {} at {} faces",
                grouped(*many),
                grouped_ratio(*smallest),
                grouped(*few)
            ),
            Some(Growth { smallest, .. }) => format!(
                " (geometric mean over {}{largest}{solved}{range}{slower}; {} at the smallest sizes)",
                counted(models, "model"),
                grouped_ratio(*smallest)
            ),
            None if models == 1 => format!(", on the only model{solved}"),
            None => format!(" (geometric mean over {models} models{solved}{range}{slower})"),
        }
    }
}

/// A ratio in words, with thousands separators.
fn grouped_ratio(value: f64) -> String {
    if value < 999.5 {
        number::ratio(value)
    } else {
        group(&format!("{value:.0}"))
    }
}

/// A ratio above 1, which is not shown as 1.
fn above_one(value: f64) -> String {
    let text = grouped_ratio(value);
    if text == "1.00" {
        format!("{value:.4}")
    } else {
        text
    }
}

/// The 95 % interval of the geometric mean of independent `ratios`, from the interval of each: the
/// squares of the distances to the ends add up, each side for itself (Zou and Donner 2008,
/// "Construction of confidence limits about effect measures", equation 3), on logarithms. `None` if
/// one of them has no interval.
fn interval_of_mean(mean: f64, ratios: impl Iterator<Item = Estimate>) -> Option<[f64; 2]> {
    let (mut count, mut below, mut above) = (0.0, 0.0, 0.0);
    for ratio in ratios {
        let [low, high] = ratio.interval?;
        let distance = |end: f64| libm::log(end / ratio.value).powi(2);
        count += 1.0;
        below += distance(low);
        above += distance(high);
    }
    let end = |squares: f64, side: f64| mean * libm::exp(side * squares.sqrt() / count);
    Some([end(below, -1.0), end(above, 1.0)])
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
    use geobench_harness::schema::{Cell, GroupRecord, Status};

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

    /// The sentences that are shown, with the base of ratios.
    fn said(result: &ResultFile, base: &str) -> Vec<String> {
        let record = GroupRecord {
            ratios_to: Some(base.to_owned()),
            ..GroupRecord::default()
        };
        let group = GroupCells::new(&record, &result.models, &result.cells);
        let shown = headline(&group).map_or_else(Vec::new, |headline| headline.shown);
        shown.into_iter().map(|sentence| sentence.text).collect()
    }

    /// Times of a series over size, of two algorithms.
    fn sizes(surface: &str, times: &[(u64, f64, f64)]) -> ResultFile {
        let name = |faces: u64| format!("{surface}_{faces}");
        let names: Vec<String> = times.iter().map(|(faces, ..)| name(*faces)).collect();
        let cells = times.iter().zip(&names).flat_map(|((_, vtp, fast), name)| {
            [
                (name.as_str(), "vtp", *vtp),
                (name.as_str(), "vtp-fast", *fast),
            ]
        });
        let cells: Vec<_> = cells.collect();
        let mut result = result(&cells);
        for (model, (faces, ..)) in result.models.iter_mut().zip(times) {
            model.faces = Some(*faces);
            model.path = format!("{}.obj", model.name);
        }
        result
    }

    /// Results whose one line was wrong, or could be. Each is reviewed by hand.
    #[test]
    fn awkward_results() {
        let mut cases: Vec<(&str, Vec<String>)> = Vec::new();
        let mut case = |what, result: &ResultFile, base| cases.push((what, said(result, base)));

        let clear = [
            ("a", "mmp", 4.0),
            ("a", "vtp", 2.0),
            ("a", "vtp-fast", 1.0),
            ("b", "mmp", 16.0),
            ("b", "vtp", 8.0),
            ("b", "vtp-fast", 1.0),
        ];
        case("a winner everywhere, with a base", &result(&clear), "mmp");
        case("the base is the next", &result(&clear), "vtp");

        let mut once = result(&[
            ("a", "vtp", 1.0),
            ("a", "vtp-fast", 1.02),
            ("b", "vtp", 1.02),
            ("b", "vtp-fast", 1.0),
        ]);
        for cell in &mut once.cells {
            cell.time.samples.truncate(1);
        }
        case("one run of each", &once, "vtp");

        let even = [
            ("a", "vtp", 1.0),
            ("a", "vtp-fast", 1.04),
            ("b", "vtp", 1.04),
            ("b", "vtp-fast", 1.0),
        ];
        case("each wins one model", &result(&even), "vtp");

        let mixed = [
            ("a", "vtp", 0.95),
            ("a", "fwp-ch", 1.0),
            ("b", "vtp", 1.31),
            ("b", "fwp-ch", 1.0),
            ("c", "vtp", 1.1),
            ("c", "fwp-ch", 1.0),
        ];
        case("faster on average, slower on one", &result(&mixed), "vtp");

        let outside = [
            ("a", "vtp-fast{simd=scalar}", 1.0),
            ("a", "vtp-fast", 0.8),
            ("a", "mmp", 2.0),
            ("a", "ext:cgal", 12.0),
            ("a", "ext:authors-vtp", 4.0),
            ("b", "vtp-fast{simd=scalar}", 0.7),
            ("b", "vtp-fast", 0.8),
            ("b", "mmp", 2.0),
            ("b", "ext:cgal", 9.0),
            ("b", "ext:authors-vtp", 5.0),
        ];
        case(
            "outside programs, and two forms of one algorithm",
            &result(&outside),
            "mmp",
        );

        let beaten = [("a", "vtp", 3.0), ("a", "mmp", 4.0), ("a", "ext:new", 1.0)];
        case("an outside program is fastest", &result(&beaten), "vtp");

        let mut failed = result(&[
            ("a", "mmp", 4.0),
            ("a", "vtp", 2.0),
            ("b", "mmp", 16.0),
            ("b", "vtp", 1.0),
        ]);
        failed.cells[3].status = Status::OutOfMemory;
        failed.cells[3].time = geobench_harness::schema::Time::default();
        case("the faster one failed on a model", &failed, "mmp");

        let circle = [
            ("a", "vtp", 2.0),
            ("a", "mmp", 1.0),
            ("b", "vtp", 1.0),
            ("b", "ich", 4.0),
            ("c", "mmp", 4.0),
            ("c", "ich", 1.0),
        ];
        case("each is faster than one other", &result(&circle), "vtp");

        let mut approximate = result(&[("a", "heat", 0.1), ("a", "mmp", 2.0), ("a", "vtp", 1.0)]);
        approximate.cells[0].check.least_tolerance = Some(0.01);
        case("an approximate answer is no winner", &approximate, "heat");

        let growing = [(1_000, 0.01, 0.01), (10_000, 0.2, 0.1), (100_000, 6.0, 1.0)];
        case("a series over size", &sizes("torus", &growing), "vtp");
        let mut stopped = sizes("torus", &growing);
        stopped.cells[4].status = Status::OutOfMemory;
        stopped.cells[4].time = geobench_harness::schema::Time::default();
        case("one failed at the largest size", &stopped, "vtp");
        let mut two = sizes("torus", &growing);
        let other = sizes(
            "cow",
            &[(1_000, 0.01, 0.01), (8_000, 0.1, 0.05), (64_000, 8.0, 2.0)],
        );
        two.models.extend(other.models);
        two.cells.extend(other.cells);
        case("two series over size", &two, "vtp");

        case("one algorithm", &result(&clear[..1]), "mmp");
        insta::assert_snapshot!(
            cases
                .iter()
                .map(|(what, said)| format!("{what}:\n  {}", said.join("\n  ")))
                .collect::<Vec<_>>()
                .join("\n")
        );
    }

    #[test]
    fn sentences_for_every_selection_are_in_the_page() {
        let found = |cells: &[(&str, &str, f64)]| {
            let result = result(cells);
            let record = GroupRecord::default();
            headline(&GroupCells::new(&record, &result.models, &result.cells)).unwrap()
        };
        let few = [
            ("a", "mmp", 4.0),
            ("a", "ext:x", 3.0),
            ("a", "vtp", 2.0),
            ("a", "vtp-fast", 1.0),
        ];
        let page = found(&few);
        assert_eq!(page.ranking, ["vtp-fast", "vtp", "ext:x", "mmp"]);
        // Each of six pairs as the fastest and the next, and three with the outside program.
        assert_eq!((page.shown.len(), page.others.len()), (2, 7));
        let names: Vec<String> = (1..=28).map(|i| format!("a{i}")).collect();
        let many = names.iter().zip(1..);
        let many: Vec<(&str, &str, f64)> = many
            .map(|(name, time)| ("a", name.as_str(), f64::from(time)))
            .collect();
        let page = found(&many);
        assert_eq!(page.shown.len() + page.others.len(), 28 * 27 / 2);
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
