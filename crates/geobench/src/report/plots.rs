//! The plots of a group.

use super::chart::{Axis, Band, Bar, BarGroup, Bars, Chart, Dots, Lane, Lines, Point, Series};
use super::document::{Plot, slug};
use super::{Setting, scaling};
use crate::schema::{Cell, ModelRecord, Phases, Status, WavefrontRecord};
use crate::table::figures::{Figure, figures, time};
use crate::table::group::{Group, Value};

/// All plots of a group.
pub(crate) fn plots(group: &Group<'_>, setting: Setting<'_>) -> Vec<Plot> {
    let mut plots = Vec::new();
    plots.extend(values(group, setting, time()));
    plots.extend(setting.base.and_then(|base| ratios(group, setting, base)));
    plots.extend(scaling::plots(group, setting));
    plots.extend(phases(group, setting));
    plots.extend(course_plots(group, setting));
    for figure in figures(&group.record.rows) {
        // Times and phases have plots of their own.
        if figure.key != "time" && !figure.key.starts_with("phase_") {
            plots.extend(values(group, setting, figure));
        }
    }
    plots
}

/// A lane for each algorithm on each model, with its `value`. If the value needs a figure of `base`
/// and `base` failed, the lane shows that failure.
fn bands(
    group: &Group<'_>,
    setting: Setting<'_>,
    base: Option<&str>,
    value: impl Fn(&str, &str) -> Option<Value>,
) -> Vec<Band> {
    let lane = |model: &str, algorithm: &&str| {
        let found = value(model, algorithm);
        let absent = match found {
            Some(_) => None,
            None => group.failure(model, algorithm).or_else(|| {
                let base = base?;
                Some(format!("no ratio: {base} {}", group.failure(model, base)?))
            }),
        };
        let point = found.map(|value| Point {
            style: setting.style(algorithm),
            name: (*algorithm).to_owned(),
            value,
            hollow: false,
        });
        (point.is_some() || absent.is_some()).then(|| Lane {
            label: (*algorithm).to_owned(),
            points: point.into_iter().collect(),
            absent,
        })
    };
    let band = |model: &&ModelRecord| {
        let lanes = group.algorithms.iter();
        Band {
            title: model.name.clone(),
            lanes: lanes.filter_map(|name| lane(&model.name, name)).collect(),
        }
    };
    let bands = group.models.iter().map(band);
    bands.filter(|band| !band.lanes.is_empty()).collect()
}

fn drawn(bands: &[Band]) -> impl Iterator<Item = f64> {
    let lanes = bands.iter().flat_map(|band| &band.lanes);
    lanes.flat_map(|lane| &lane.points).map(|p| p.value.value)
}

/// The points of one figure, if there are any.
fn values(group: &Group<'_>, setting: Setting<'_>, figure: &'static Figure) -> Option<Plot> {
    let bands = bands(group, setting, None, |model, algorithm| {
        group.value(figure, model, algorithm)
    });
    drawn(&bands).next()?;
    let axis = Axis::fitting(&figure.label, drawn(&bands));
    let scale = axis.scale();
    let whiskers = if figure.key == "time" {
        " Median; whiskers are 95 % intervals where there are five samples or more."
    } else {
        ""
    };
    Some(Plot {
        id: format!("{}-{}", setting.prefix, slug(figure.key)),
        title: figure.label.clone(),
        caption: format!("{scale}{whiskers}"),
        chart: Chart::Dots(Dots {
            axis,
            reference: None,
            bands,
            legend: Vec::new(),
        }),
    })
}

/// The ratios of times to those of `base`.
fn ratios(group: &Group<'_>, setting: Setting<'_>, base: &str) -> Option<Plot> {
    let mut bands = bands(group, setting, Some(base), |model, algorithm| {
        group.ratio(time(), model, algorithm, base)
    });
    // The ratio of `base` to itself is always 1.
    for band in &mut bands {
        band.lanes.retain(|lane| lane.label != base);
    }
    bands.retain(|band| !band.lanes.is_empty());
    drawn(&bands).next()?;
    let axis = Axis {
        label: format!("Time as a multiple of {base}"),
        log: true,
    };
    Some(Plot {
        id: format!("{}-ratio", setting.prefix),
        title: format!("Time, ratio to {base}"),
        caption: format!(
            "Logarithmic scale; right of the dashed line {base} is faster. Medians of the ratios of \
             samples taken in turns, whiskers are 95 % intervals."
        ),
        chart: Chart::Dots(Dots {
            axis,
            reference: Some(1.0),
            bands,
            legend: Vec::new(),
        }),
    })
}

/// The time by phase.
fn phases(group: &Group<'_>, setting: Setting<'_>) -> Option<Plot> {
    let parts = |phases: &Phases| Some([phases.propagation?, phases.pruning?, phases.management?]);
    let mut groups = Vec::new();
    for model in &group.models {
        let of = |algorithm: &str| -> Option<[f64; 3]> {
            // The first of several sources: medians of parts do not add up.
            let cells = group.of(&model.name, algorithm);
            if group.failure(&model.name, algorithm).is_some() {
                return None;
            }
            parts(&cells.first()?.phases)
        };
        let slowest = group
            .algorithms
            .iter()
            .filter_map(|name| Some(of(name)?.iter().sum::<f64>()))
            .fold(0.0, f64::max);
        if slowest <= 0.0 {
            continue;
        }
        let bars = group.algorithms.iter().filter_map(|name| {
            let label = (*name).to_owned();
            Some(match of(name) {
                Some(parts) => Bar {
                    label,
                    parts: parts.map(|part| 100.0 * part / slowest),
                    note: format!("{:.3} s", parts.iter().sum::<f64>()),
                    failed: false,
                },
                None => Bar {
                    label,
                    parts: [0.0; 3],
                    note: group.failure(&model.name, name)?,
                    failed: true,
                },
            })
        });
        groups.push(BarGroup {
            title: model.name.clone(),
            bars: bars.collect(),
        });
    }
    (!groups.is_empty()).then(|| Plot {
        id: format!("{}-phases", setting.prefix),
        title: "Where the time goes".to_owned(),
        caption:
            "Shares by sampling, of runs apart from the timed ones; of several sources the first."
                .to_owned(),
        chart: Chart::Bars(Bars {
            axis: Axis {
                label: "Time, % of the slowest algorithm on the model".to_owned(),
                log: false,
            },
            parts: ["propagation", "pruning", "management"].map(str::to_owned),
            groups,
        }),
    })
}

/// A plot of one quantity of wavefronts over another.
struct CourseView {
    key: &'static str,
    title: &'static str,
    x: &'static str,
    y: &'static str,
    caption: &'static str,
    /// Place and value of a sample, given the number of windows that the whole run propagated.
    point: fn(&WavefrontRecord, f64) -> Option<(f64, f64)>,
}

const COURSE_VIEWS: [CourseView; 3] = [
    CourseView {
        key: "windows",
        title: "Windows on the wavefront against distance",
        x: "Mean distance of the wavefront from the source",
        y: "Windows on the wavefront",
        caption: "Sampled at even intervals of propagated windows.",
        point: |sample, _| Some((sample.distance, sample.windows as f64)),
    },
    CourseView {
        key: "deviation",
        title: "Deviation of the wavefront",
        x: "Share of the run's windows propagated",
        y: "Standard deviation of distances",
        caption: "Of the least distances of the windows that wait, in the units of the mesh; the less, the better \
                  the order of the distances is kept.",
        point: |sample, parents| Some((sample.parents as f64 / parents, sample.deviation)),
    },
    CourseView {
        key: "k",
        title: "K and the wavefront",
        x: "Share of the run's windows propagated",
        y: "Windows",
        caption: "How many windows a round was told to take (filled), and how many waited (outlines).",
        point: |sample, parents| Some((sample.parents as f64 / parents, sample.k? as f64)),
    },
];

/// The plots of the wavefronts that the group holds, model by model.
pub(crate) fn course_plots(group: &Group<'_>, setting: Setting<'_>) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (number, model) in group.models.iter().enumerate() {
        for view in &COURSE_VIEWS {
            plots.extend(course_plot(group, setting, number, model, view));
        }
    }
    plots
}

fn course_plot(
    group: &Group<'_>,
    setting: Setting<'_>,
    number: usize,
    model: &ModelRecord,
    view: &CourseView,
) -> Option<Plot> {
    let mut series: Vec<Series> = Vec::new();
    for name in &group.algorithms {
        // The first of several sources: curves of different sources are not comparable.
        let cells = group.of(&model.name, name);
        let Some(cell) = cells.first().filter(|cell| cell.status == Status::Ok) else {
            continue;
        };
        let line = |name: String, hollow, points| Series {
            style: setting.style(&cell.algorithm),
            name,
            joined: true,
            hollow,
            points,
        };
        let points = course_points(cell, view.point);
        if points.is_empty() {
            continue;
        }
        if view.key == "k" {
            let waiting =
                |s: &WavefrontRecord, all: f64| Some((s.parents as f64 / all, s.windows as f64));
            series.push(line(format!("{name}: K"), false, points));
            let points = course_points(cell, waiting);
            series.push(line(format!("{name}: waiting"), true, points));
        } else {
            series.push(line((*name).to_owned(), false, points));
        }
    }
    let all = || series.iter().flat_map(|series| &series.points);
    all().next()?;
    Some(Plot {
        id: format!("{}-course-{}-{number}", setting.prefix, slug(view.key)),
        title: format!("{}: {}", view.title, model.name),
        caption: view.caption.to_owned(),
        chart: Chart::Lines(Lines {
            x: Axis {
                label: view.x.to_owned(),
                log: false,
            },
            y: Axis {
                label: view.y.to_owned(),
                log: false,
            },
            reference: None,
            series,
        }),
    })
}

fn course_points(
    cell: &Cell,
    point: fn(&WavefrontRecord, f64) -> Option<(f64, f64)>,
) -> Vec<(f64, Value)> {
    let parents = cell
        .wavefront
        .last()
        .map_or(1.0, |last| last.parents as f64);
    let points = cell.wavefront.iter().filter_map(|sample| {
        let (at, value) = point(sample, parents)?;
        (at.is_finite() && value.is_finite()).then_some((at, value.into()))
    });
    let mut points: Vec<(f64, Value)> = points.collect();
    // The mean distance of a wavefront may decrease.
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}
