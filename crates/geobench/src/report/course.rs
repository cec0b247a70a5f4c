//! The plots of wavefronts: how many windows wait, how far apart they are and how many a round
//! takes, in the course of a run.

use super::chart::{Axis, Chart, Lines, Series, Value};
use super::document::{Plot, slug};
use super::group::{Group, Setting};
use crate::schema::{Cell, ModelRecord, Status, WavefrontSample};

/// What is plotted over what.
struct View {
    key: &'static str,
    title: &'static str,
    x: &'static str,
    y: &'static str,
    caption: &'static str,
    /// A sample's place, given the windows that the whole run propagated, and its value.
    point: fn(&WavefrontSample, f64) -> Option<(f64, f64)>,
}

const VIEWS: [View; 3] = [
    View {
        key: "windows",
        title: "Windows on the wavefront against distance",
        x: "Mean distance of the wavefront from the source",
        y: "Windows on the wavefront",
        caption: "Sampled at even intervals of propagated windows.",
        point: |sample, _| Some((sample.distance, sample.windows as f64)),
    },
    View {
        key: "deviation",
        title: "Deviation of the wavefront",
        x: "Share of the run's windows propagated",
        y: "Standard deviation of distances",
        caption: "Of the least distances of the windows that wait, in the units of the mesh; the less, the better \
                  the order of the distances is kept.",
        point: |sample, parents| Some((sample.parents as f64 / parents, sample.deviation)),
    },
    View {
        key: "k",
        title: "K and the wavefront",
        x: "Share of the run's windows propagated",
        y: "Windows",
        caption: "How many windows a round was told to take (filled), and how many waited (outlines).",
        point: |sample, parents| Some((sample.parents as f64 / parents, sample.k? as f64)),
    },
];

/// The plots of the wavefronts that the group holds, model by model.
pub(crate) fn plots(group: &Group<'_>, setting: Setting<'_>) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (number, model) in group.models.iter().enumerate() {
        for view in &VIEWS {
            plots.extend(plot(group, setting, number, model, view));
        }
    }
    plots
}

fn plot(
    group: &Group<'_>,
    setting: Setting<'_>,
    number: usize,
    model: &ModelRecord,
    view: &View,
) -> Option<Plot> {
    let mut series: Vec<Series> = Vec::new();
    for name in &group.algorithms {
        // Of several sources the first: courses of different ones do not lie above each other.
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
        let points = points(cell, view.point);
        if points.is_empty() {
            continue;
        }
        if view.key == "k" {
            let waiting =
                |s: &WavefrontSample, all: f64| Some((s.parents as f64 / all, s.windows as f64));
            series.push(line(format!("{name}: K"), false, points));
            let points = self::points(cell, waiting);
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

fn points(
    cell: &Cell,
    point: fn(&WavefrontSample, f64) -> Option<(f64, f64)>,
) -> Vec<(f64, Value)> {
    let parents = cell
        .wavefront
        .last()
        .map_or(1.0, |last| last.parents as f64);
    let points = cell.wavefront.iter().filter_map(|sample| {
        let (at, value) = point(sample, parents)?;
        let value = Value {
            value,
            interval: None,
        };
        (at.is_finite() && value.value.is_finite()).then_some((at, value))
    });
    let mut points: Vec<(f64, Value)> = points.collect();
    // The mean distance of a wavefront may step back.
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}
