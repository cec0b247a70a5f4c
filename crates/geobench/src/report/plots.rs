//! The plots of a group.

use super::chart::{Axis, Band, Bar, BarGroup, Bars, Chart, Dots, Lane, Point, Value};
use super::course;
use super::document::{Plot, slug};
use super::group::{Group, Setting, known};
use super::scaling;
use crate::schema::{ModelRecord, Phases};
use crate::table::figures::{Figure, figures};

/// All plots of a group.
pub(crate) fn plots(group: &Group<'_>, setting: Setting<'_>) -> Vec<Plot> {
    let time = known("time");
    let mut plots = Vec::new();
    plots.extend(time.and_then(|time| values(group, setting, time)));
    if let (Some(time), Some(base)) = (time, setting.base) {
        plots.extend(ratios(group, setting, time, base));
    }
    plots.extend(scaling::plots(group, setting));
    plots.extend(phases(group, setting));
    plots.extend(course::plots(group, setting));
    for figure in figures(&group.record.rows) {
        // Times and phases have plots of their own.
        if figure.key != "time" && !figure.key.starts_with("phase_") {
            plots.extend(values(group, setting, figure));
        }
    }
    plots
}

/// A lane for each algorithm on each model, with what `value` finds there; where that takes figures
/// of `base` too and this failed, it is what is said to be missing.
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

/// How many times as long as `base`.
fn ratios(
    group: &Group<'_>,
    setting: Setting<'_>,
    time: &'static Figure,
    base: &str,
) -> Option<Plot> {
    let mut bands = bands(group, setting, Some(base), |model, algorithm| {
        group.ratio(time, model, algorithm, base)
    });
    // Its own ratio is 1 everywhere.
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

/// Where the clocked time goes.
fn phases(group: &Group<'_>, setting: Setting<'_>) -> Option<Plot> {
    let parts = |phases: &Phases| Some([phases.propagation?, phases.pruning?, phases.management?]);
    let mut groups = Vec::new();
    for model in &group.models {
        let of = |algorithm: &str| -> Option<[f64; 3]> {
            // Of several sources the first; medians of parts do not add up.
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
            "Of a run whose clocks slow it down, so that sums are larger than the times above; of \
                  several sources the first."
                .to_owned(),
        chart: Chart::Bars(Bars {
            axis: Axis {
                label: "Clocked time, % of the slowest algorithm on the model".to_owned(),
                log: false,
            },
            parts: ["propagation", "pruning", "management"].map(str::to_owned),
            groups,
        }),
    })
}
