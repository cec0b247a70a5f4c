//! Trade-offs between algorithms: error against time, and set-up time against the number of
//! sources.

use std::collections::HashMap;

use geobench_harness::figures::{figure, time};
use geobench_harness::measure::number::{self, grouped};
use geobench_harness::schema::{Cell, Check, ModelRecord};

use super::chart::{Axis, Chart, LinePoint, Lines, Series, front};
use super::document::Plot;
use super::headline::EXACT;
use super::setting::Setting;
use crate::table::group::{GroupCells, by_key, distinct};
use crate::table::{Column, Entry, Part, Table};

/// The least relative error that is drawn: the unit roundoff of `f64`.
const LEAST_ERROR: f64 = f64::EPSILON / 2.0;

/// Plots of errors against times. If a group has approximate algorithms: the mean and the largest
/// error, where errors below [`EXACT`] are drawn as [`EXACT`]. Otherwise: the rounding errors of
/// the exact algorithms.
pub(super) fn errors(group: &GroupCells<'_>, setting: Setting<'_>) -> Vec<Plot> {
    if group.cells.iter().any(|cell| cell.approximate) {
        let mean = error_of_models(group, setting, "mean-error", "Mean", |c| c.mean_rel);
        let largest = error_of_models(group, setting, "error", "Largest", |c| c.max_rel);
        return mean.into_iter().chain(largest).collect();
    }
    rounding(group, setting).into_iter().collect()
}

/// The plot of one kind of error against time: a point for each algorithm on each model, and the
/// Pareto front of each model.
fn error_of_models(
    group: &GroupCells<'_>,
    setting: Setting<'_>,
    id: &str,
    kind: &str,
    error: fn(&Check) -> Option<f64>,
) -> Option<Plot> {
    let point = |model: &str, algorithm: &str| {
        let of = |cell: &&Cell| {
            let is_reference = cell.check.reference.as_deref() == Some(algorithm);
            error(&cell.check).or(is_reference.then_some(0.0))
        };
        let errors: Option<Vec<f64>> = group.of(model, algorithm).iter().map(of).collect();
        // Of several sources, the worst.
        let error = errors?.into_iter().reduce(f64::max)?;
        let time = group.value(time(), model, algorithm)?.value;
        (time > 0.0).then(|| LinePoint::new(time, error.max(EXACT), model))
    };
    let series = series(group, setting, |algorithm| {
        let models = group.models.iter();
        models
            .filter_map(|model| point(&model.name, algorithm))
            .collect()
    });
    let points = || series.iter().flat_map(|series| &series.points);
    points().next()?;
    Some(Plot {
        id: format!("{}-{id}", setting.prefix),
        title: format!("{kind} error against time"),
        caption: format!(
            "{kind} error relative to the reference of the checks, and median time of a solve; each \
             point is a model, of several sources the worst. Less is better on both axes. Errors of \
             less than 1e-6 count as exact and are drawn there. Dotted: the Pareto front of each \
             model. {} Logarithmic scale.",
            on_fronts(group, &series)
        ),
        chart: Chart::Lines(Lines {
            front: true,
            ..Lines::new(
                Axis::fitting("Time (s)", points().map(|p| p.x)),
                Axis::log(format!("{kind} relative error")),
                series,
            )
        }),
    })
}

/// A sentence that names the algorithms on the Pareto fronts.
fn on_fronts(group: &GroupCells<'_>, series: &[Series]) -> String {
    let points = series.iter().flat_map(|series| {
        let points = by_key(&series.points, |point| point.model.as_str()).into_iter();
        let first = points.map(|(model, points)| (model, [points[0].x, points[0].value.value]));
        first.map(|(model, at)| (model, (series.algorithm.as_str(), at)))
    });
    let of_model: HashMap<&str, Vec<(&str, [f64; 2])>> = by_key(points, |(model, _)| *model)
        .into_iter()
        .map(|(model, points)| (model, points.into_iter().map(|(_, point)| point).collect()))
        .collect();
    let fronts = group.models.iter().map(|model| {
        let points = of_model
            .get(model.name.as_str())
            .map_or(&[][..], Vec::as_slice);
        let on = front(points.iter().map(|(_, at)| *at));
        let name = |at: &[f64; 2]| points.iter().find(|(_, p)| p == at).map(|(name, _)| *name);
        on.iter().filter_map(name).collect::<Vec<&str>>()
    });
    let fronts: Vec<Vec<&str>> = fronts.filter(|front| !front.is_empty()).collect();
    let names = distinct(fronts.iter().flatten().copied());
    let mut counted: Vec<(usize, &str)> = names
        .into_iter()
        .map(|name| (fronts.iter().filter(|f| f.contains(&name)).count(), name))
        .collect();
    // The most frequent first. The sort is stable, so the algorithms of a single model stay sorted
    // by time.
    counted.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
    let words = counted.iter().map(|(count, name)| match fronts.len() {
        1 => group.shown(name),
        all => format!("{} ({count} of {all})", group.shown(name)),
    });
    let words: Vec<String> = words.collect();
    format!("On the front: {}.", words.join(", "))
}

/// The plot of the largest relative difference from the reference against the time: a point for
/// each cell.
fn rounding(group: &GroupCells<'_>, setting: Setting<'_>) -> Option<Plot> {
    let point = |cell: &&Cell| {
        let check = &cell.check;
        if check.reference.as_deref() == Some(&cell.algorithm) {
            return None;
        }
        let time = cell.time.median.filter(|time| *time > 0.0)?;
        let error = check.max_rel?.max(LEAST_ERROR);
        Some(LinePoint::new(time, error, &cell.model))
    };
    let series = series(group, setting, |algorithm| {
        let cells = group.cells.iter().copied();
        let own = cells.filter(|cell| cell.algorithm == algorithm);
        own.filter_map(|cell| point(&cell)).collect()
    });
    let points = || series.iter().flat_map(|series| &series.points);
    points().next()?;
    Some(Plot {
        id: format!("{}-error", setting.prefix),
        title: "Error against time".to_owned(),
        caption: "Largest relative difference from the reference of the checks, and median time; \
                  each point is a model and a source. Differences of less than 1.1e-16, the \
                  rounding of one operation, are drawn there. Logarithmic scale."
            .to_owned(),
        chart: Chart::Lines(Lines::new(
            Axis::fitting("Time (s)", points().map(|p| p.x)),
            Axis::log("Largest relative difference"),
            series,
        )),
    })
}

/// A series of markers without lines for each algorithm that has `points`.
fn series(
    group: &GroupCells<'_>,
    setting: Setting<'_>,
    points: impl Fn(&str) -> Vec<LinePoint>,
) -> Vec<Series> {
    let series = group.algorithms.iter().map(|name| {
        let mut points = points(name);
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        Series {
            joined: false,
            ..setting.series(name, points)
        }
    });
    series.filter(|series| !series.points.is_empty()).collect()
}

/// The times of an algorithm on a model, in seconds.
#[derive(Clone, Copy, Debug)]
struct Cost<'a> {
    algorithm: &'a str,
    /// The set-up, once for all sources.
    setup: f64,
    /// The solve of one source.
    solve: f64,
}

/// The numbers of sources for which an algorithm is faster than another one, set-up included.
#[derive(Clone, Copy, Debug, PartialEq)]
enum BreakEven {
    /// For every number of sources.
    Always,
    /// For at least `sources`, which is 2 or more. The total times are equal at `at` sources.
    From {
        sources: u64,
        at: f64,
    },
    /// For at most this number.
    Until(u64),
    Never,
}

impl Cost<'_> {
    fn total(self, sources: f64) -> f64 {
        self.setup + sources * self.solve
    }

    fn against(self, other: Self) -> BreakEven {
        let (more, less) = (self.setup - other.setup, other.solve - self.solve);
        // The number of sources at which the totals are equal.
        let at = more / less;
        if self.total(1.0) < other.total(1.0) {
            return if less < 0.0 {
                BreakEven::Until((at.ceil() as u64).saturating_sub(1))
            } else {
                BreakEven::Always
            };
        }
        if less > 0.0 && at.is_finite() {
            let sources = (at.floor() as u64).saturating_add(1);
            return BreakEven::From { sources, at };
        }
        BreakEven::Never
    }
}

/// The costs of all algorithms on a model that have both times, and the base: the fastest exact
/// algorithm for one source, or the fastest of all if none is exact. `None` if fewer than two
/// algorithms have both times.
fn costs<'a>(group: &GroupCells<'a>, model: &str) -> Option<(Vec<Cost<'a>>, Cost<'a>)> {
    let setup = figure("setup").ok()?;
    let cost = |algorithm: &&'a str| {
        Some(Cost {
            algorithm,
            setup: group.value(setup, model, algorithm)?.value,
            solve: group.value(time(), model, algorithm)?.value,
        })
    };
    let costs: Vec<Cost<'a>> = group.algorithms.iter().filter_map(cost).collect();
    let exact = |cost: &&Cost<'a>| !group.is_approximate(cost.algorithm);
    let least = |a: &&Cost<'a>, b: &&Cost<'a>| a.total(1.0).total_cmp(&b.total(1.0));
    let base = costs.iter().filter(exact).min_by(least);
    let base = *base.or_else(|| costs.iter().min_by(least))?;
    (costs.len() > 1).then_some((costs, base))
}

/// The algorithms that are slower than `base` for one source and faster for many. Each has the
/// number of sources from which it is faster, and the number at which both take the same time.
fn winners<'a>(costs: &[Cost<'a>], base: Cost<'a>) -> Vec<(Cost<'a>, u64, f64)> {
    let mut winners: Vec<(Cost<'a>, u64, f64)> = costs
        .iter()
        .filter_map(|cost| match cost.against(base) {
            BreakEven::From { sources, at } => Some((*cost, sources, at)),
            _ => None,
        })
        .collect();
    winners.sort_by_key(|(_, sources, _)| *sources);
    winners
}

/// The x-axis ends at least at the first number of sources. The meeting points that lengthen it
/// count up to the second.
const DRAWN: [f64; 2] = [100.0, 1e6];

/// A plot of the time against the number of sources for each model on which an algorithm overtakes
/// the base.
pub(super) fn sources(group: &GroupCells<'_>, setting: Setting<'_>) -> Vec<Plot> {
    let models = group.models.iter().enumerate();
    let plot = |(number, model): (usize, &&ModelRecord)| {
        let (costs, base) = costs(group, &model.name)?;
        let winners = winners(&costs, base);
        let last = winners.last()?.2.min(DRAWN[1]);
        let mut most = DRAWN[0];
        while most < 2.0 * last {
            most *= 10.0;
        }
        let series = sources_series(setting, &model.name, (&costs, base), &winners, most);
        let values = series.iter().flat_map(|s| &s.points).map(|p| p.value.value);
        let y = Axis::fitting("Set-up and solves (s)", values);
        let words = winners.iter().map(|(cost, sources, _)| {
            format!("{} from {} sources on", cost.algorithm, grouped(*sources))
        });
        Some(Plot {
            id: format!("{}-sources-{number}", setting.prefix),
            title: format!("Time against the number of sources: {}", model.name),
            caption: format!(
                "Set-up once and a solve for each source, by medians. Outlines: where a line meets \
                 that of {}, {}. Faster than that are: {}. {}",
                base.algorithm,
                fastest(group, base),
                words.collect::<Vec<String>>().join(", "),
                y.scale()
            ),
            chart: Chart::Lines(Lines::new(Axis::log("Sources"), y, series)),
        })
    };
    models.filter_map(plot).collect()
}

fn fastest(group: &GroupCells<'_>, base: Cost<'_>) -> &'static str {
    if group.is_approximate(base.algorithm) {
        "the fastest for one source"
    } else {
        "the fastest exact one for one source"
    }
}

/// A line for each algorithm, and an outlined marker where it meets the line of the base.
fn sources_series(
    setting: Setting<'_>,
    model: &str,
    (costs, base): (&[Cost<'_>], Cost<'_>),
    winners: &[(Cost<'_>, u64, f64)],
    most: f64,
) -> Vec<Series> {
    let point = |cost: Cost<'_>, sources| LinePoint::new(sources, cost.total(sources), model);
    let mut places = Vec::new();
    let mut decade = 1.0;
    while decade < most {
        places.extend([1.0, 2.0, 5.0].map(|factor| factor * decade));
        decade *= 10.0;
    }
    places.push(most);
    let line = |cost: &Cost<'_>| {
        let points = places.iter().map(|sources| point(*cost, *sources));
        setting.series(cost.algorithm, points.collect())
    };
    let meeting = |(cost, _, at): &(Cost<'_>, u64, f64)| Series {
        name: format!("{} meets {}", cost.algorithm, base.algorithm),
        joined: false,
        hollow: true,
        ..setting.series(cost.algorithm, vec![point(*cost, *at)])
    };
    let met = winners.iter().filter(|(.., at)| *at <= most);
    costs.iter().map(line).chain(met.map(meeting)).collect()
}

/// A table of the numbers of sources for which each algorithm is faster than the base, for the
/// models that [`sources`] draws. `None` if there are none.
pub(super) fn crossings(id: &str, group: &GroupCells<'_>) -> Option<Table> {
    let part = |model: &&ModelRecord| {
        let (costs, base) = costs(group, &model.name)?;
        if winners(&costs, base).is_empty() {
            return None;
        }
        let row = |cost: &Cost<'_>| {
            let when = if cost.algorithm == base.algorithm {
                String::new()
            } else {
                match cost.against(base) {
                    BreakEven::Always => "always".to_owned(),
                    BreakEven::From { sources, .. } => format!("from {} on", grouped(sources)),
                    BreakEven::Until(sources) => format!("up to {}", grouped(sources)),
                    BreakEven::Never => "never".to_owned(),
                }
            };
            let totals = [1.0, 100.0, 10_000.0].map(|sources| cost.total(sources));
            let seconds = [cost.setup, cost.solve].into_iter().chain(totals);
            std::iter::once(Entry::new(group.shown(cost.algorithm)))
                .chain(seconds.map(|seconds| Entry::new(number::seconds(seconds, 9))))
                .chain([Entry::new(when)])
                .collect()
        };
        Some(Part {
            title: model.name.clone(),
            detail: format!(
                "compared with {}, {}",
                group.shown(base.algorithm),
                fastest(group, base)
            ),
            rows: costs.iter().map(row).collect(),
            ..Part::default()
        })
    };
    let parts: Vec<Part> = group.models.iter().filter_map(part).collect();
    let numbers = [
        "Set-up (s)",
        "Solve (s)",
        "1 source (s)",
        "100 (s)",
        "10,000 (s)",
        "Faster, sources",
    ];
    (!parts.is_empty()).then(|| Table {
        id: id.to_owned(),
        title: "Time against the number of sources".to_owned(),
        caption: "Set-up is paid once, a solve for each source. The last column is the number of \
                  sources for which both together are faster than the algorithm that the model's \
                  line names."
            .to_owned(),
        columns: Column::of(["Algorithm"], numbers),
        rows_are: "algorithm",
        parts,
        ..Table::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cost(setup: f64, solve: f64) -> Cost<'static> {
        Cost {
            algorithm: "a",
            setup,
            solve,
        }
    }

    #[test]
    fn crossings_are_numbers_of_sources() {
        let base = cost(1.0, 2.0);
        let of = |setup, solve| cost(setup, solve).against(base);
        // 5 + k = 1 + 2 k at 4, where both are equal.
        assert_eq!(
            of(5.0, 1.0),
            BreakEven::From {
                sources: 5,
                at: 4.0
            }
        );
        assert_eq!(
            of(5.5, 1.0),
            BreakEven::From {
                sources: 5,
                at: 4.5
            }
        );
        assert_eq!(of(0.0, 2.25), BreakEven::Until(3));
        assert_eq!(of(0.0, 1.0), BreakEven::Always);
        assert_eq!(of(0.5, 2.0), BreakEven::Always);
        assert_eq!(of(2.0, 2.0), BreakEven::Never);
        assert_eq!(of(1.0, 3.0), BreakEven::Never);
        assert_eq!(base.against(base), BreakEven::Never);
        for (setup, solve) in [(5.0, 1.0), (5.5, 1.0), (0.0, 2.25)] {
            let other = cost(setup, solve);
            let faster = |k: u64| other.total(k as f64) < base.total(k as f64);
            match other.against(base) {
                BreakEven::From { sources, .. } => assert!(!faster(sources - 1) && faster(sources)),
                BreakEven::Until(sources) => assert!(faster(sources) && !faster(sources + 1)),
                other => panic!("{other:?}"),
            }
        }
    }
}
