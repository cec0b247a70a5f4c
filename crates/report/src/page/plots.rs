//! The plots of a group.

use geobench_harness::figures::{Figure, figures, time};
use geobench_harness::measure::number::with_unit;
use geobench_harness::schema::{Cell, ModelRecord, PhaseSeconds, Status, WavefrontSample};

use super::chart::{
    Axis, Band, Bar, BarGroup, Bars, Chart, ChartPoint, Dots, Lane, LinePoint, Lines, MOST_LANES,
    Series,
};
use super::document::{Plot, slug};
use super::setting::Setting;
use super::{scaling, tradeoff};
use crate::table::group::{Estimate, GroupCells};

/// The plots of a group: those of times and errors, and the others.
pub(crate) fn plots(group: &GroupCells<'_>, setting: Setting<'_>) -> [Vec<Plot>; 2] {
    let [times, mut more] = scaling::plots(group, setting);
    let mut plots = Vec::new();
    plots.extend(values(group, setting, time()));
    plots.extend(setting.base.and_then(|base| ratios(group, setting, base)));
    plots.extend(times);
    plots.extend(tradeoff::errors(group, setting));
    more.extend(phases(group, setting));
    more.extend(wavefronts(group, setting));
    for figure in figures(&group.record.rows) {
        // Times and phases have plots of their own.
        if figure.key != "time" && !figure.key.starts_with("phase_") {
            more.extend(values(group, setting, figure));
        }
    }
    more.extend(spread(group, setting));
    more.extend(quantiles(group, setting));
    more.extend(tradeoff::sources(group, setting));
    [plots, more]
}

/// A band for each model, with the lanes of all algorithms. Empty bands are left out.
fn bands(group: &GroupCells<'_>, lane: impl Fn(&str, &str) -> Option<Lane>) -> Vec<Band> {
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

/// The point of an algorithm on a model.
fn point(setting: Setting<'_>, model: &str, algorithm: &str, value: Estimate) -> ChartPoint {
    ChartPoint {
        style: setting.style(algorithm),
        name: setting.shown(algorithm),
        model: Some(model.to_owned()),
        algorithm: None,
        value,
        hollow: false,
    }
}

/// A lane for each algorithm on each model, with its `value` or its failure. `base` is the
/// algorithm that a ratio needs; if it failed, the lane shows that failure.
fn bands_of_values(
    group: &GroupCells<'_>,
    setting: Setting<'_>,
    base: Option<&str>,
    value: impl Fn(&str, &str) -> Option<Estimate>,
) -> Vec<Band> {
    bands(group, |model, algorithm| {
        let found = value(model, algorithm);
        let absent = match found {
            Some(_) => None,
            None => group.failure(model, algorithm).or_else(|| {
                let base = base?;
                Some(format!("no ratio: {base} {}", group.failure(model, base)?))
            }),
        };
        let point = found.map(|value| point(setting, model, algorithm, value));
        (point.is_some() || absent.is_some()).then(|| Lane {
            points: point.into_iter().collect(),
            absent,
            ..setting.lane(algorithm)
        })
    })
}

fn drawn(bands: &[Band]) -> impl Iterator<Item = f64> {
    let lanes = bands.iter().flat_map(|band| &band.lanes);
    lanes.flat_map(|lane| &lane.points).map(|p| p.value.value)
}

/// The dot plot of one figure. `None` if there is no value.
fn values(group: &GroupCells<'_>, setting: Setting<'_>, figure: &'static Figure) -> Option<Plot> {
    let bands = bands_of_values(group, setting, None, |model, algorithm| {
        group.value(figure, model, algorithm)
    });
    drawn(&bands).next()?;
    let axis = Axis::fitting(&figure.label, drawn(&bands));
    let scale = axis.scale();
    let whiskers = if figure.key == "time" {
        " Median; whiskers are 95 % intervals where there are six samples or more."
    } else {
        ""
    };
    Some(Plot {
        id: format!("{}-{}", setting.prefix, slug(figure.key)),
        title: figure.label.clone(),
        caption: format!("{scale}{whiskers}"),
        chart: Chart::Dots(Dots::new(axis, None, bands)),
    })
}

/// The dot plot of the ratios of times to those of `base`.
fn ratios(group: &GroupCells<'_>, setting: Setting<'_>, base: &str) -> Option<Plot> {
    let mut bands = bands_of_values(group, setting, Some(base), |model, algorithm| {
        group.ratio(time(), model, algorithm, base)
    });
    // The ratio of `base` to itself is always 1.
    for band in &mut bands {
        band.lanes
            .retain(|lane| lane.algorithm.as_deref() != Some(base));
    }
    bands.retain(|band| !band.lanes.is_empty());
    drawn(&bands).next()?;
    let axis = Axis::log(format!("Time as a multiple of {base}"));
    Some(Plot {
        id: format!("{}-ratio", setting.prefix),
        title: format!("Time, ratio to {base}"),
        caption: format!(
            "Logarithmic scale; right of the dashed line {base} is faster. Medians of the ratios of \
             samples, round by round; whiskers are 95 % intervals."
        ),
        chart: Chart::Dots(Dots::new(axis, Some(1.0), bands)),
    })
}

/// The bar chart of the times of the phases.
fn phases(group: &GroupCells<'_>, setting: Setting<'_>) -> Option<Plot> {
    let parts =
        |phases: &PhaseSeconds| Some([phases.propagation?, phases.pruning?, phases.management?]);
    let mut groups = Vec::new();
    for model in &group.models {
        let of = |algorithm: &str| -> Option<[f64; 3]> {
            // Of several sources, only the first is used: medians of the phases would not add up to
            // the median of the time.
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
            let (label, algorithm) = (setting.shown(name), (*name).to_owned());
            Some(match of(name) {
                Some(parts) => Bar {
                    label,
                    algorithm,
                    parts: parts.map(|part| 100.0 * part / slowest),
                    note: match parts.iter().sum::<f64>() {
                        short if short < 0.1 => with_unit(short),
                        seconds => format!("{seconds:.3} s"),
                    },
                    failed: false,
                },
                None => Bar {
                    label,
                    algorithm,
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
        title: "Time by phase".to_owned(),
        caption:
            "Shares of the median time, by samples of a run of its own; of several sources the first."
                .to_owned(),
        chart: Chart::Bars(Bars {
            axis: Axis::linear("Time, % of the slowest on the model"),
            parts: ["propagation", "pruning", "management"].map(str::to_owned),
            groups,
        }),
    })
}

/// The dot plot of the samples of each cell, relative to their median.
fn spread(group: &GroupCells<'_>, setting: Setting<'_>) -> Option<Plot> {
    let relative = |cell: &&Cell| -> Vec<f64> {
        let median = cell.time.median.filter(|median| *median > 0.0);
        let median = median.filter(|_| cell.time.samples.len() >= FEWEST_FOR_SPREAD);
        let samples = cell.time.samples.iter();
        median.map_or_else(Vec::new, |median| samples.map(|s| s / median).collect())
    };
    let bands = bands(group, |model, algorithm| {
        let cells = group.of(model, algorithm);
        let samples: Vec<f64> = cells.iter().flat_map(relative).collect();
        let interval = match &cells[..] {
            [cell] => cell.time.ci95.zip(cell.time.median),
            _ => None,
        };
        let median = Estimate {
            value: 1.0,
            interval: interval.map(|(ends, median)| ends.map(|end| end / median)),
        };
        (!samples.is_empty()).then(|| Lane {
            points: vec![ChartPoint {
                hollow: true,
                ..point(setting, model, algorithm, median)
            }],
            samples,
            ..setting.lane(algorithm)
        })
    });
    // A chart with more lanes merges the lanes of a model, which would mix their samples.
    let lanes: usize = bands.iter().map(|band| band.lanes.len()).sum();
    if bands.is_empty() || lanes > MOST_LANES {
        return None;
    }
    Some(Plot {
        id: format!("{}-samples", setting.prefix),
        title: "Spread of the samples".to_owned(),
        caption: "Every timed run as a dot, relative to the median of its cell. Outlines are the \
                  medians, whiskers their 95 % intervals. Linear scale."
            .to_owned(),
        chart: Chart::Dots(Dots::new(
            Axis::linear("Time of a run / median of the cell"),
            Some(1.0),
            bands,
        )),
    })
}

/// The fewest samples of a cell in the spread plot.
const FEWEST_FOR_SPREAD: usize = 3;

/// The fewest cells of an algorithm for a quantile plot.
const FEWEST_FOR_QUANTILES: usize = 3;

/// The quantile plot: for each algorithm, the sorted times of its cells, which shows how many cells
/// it solves within a time.
fn quantiles(group: &GroupCells<'_>, setting: Setting<'_>) -> Option<Plot> {
    let series = |name: &&str| {
        let solved = group.cells.iter().filter(|cell| {
            cell.algorithm == **name && cell.status == Status::Ok && cell.time.median.is_some()
        });
        let mut times: Vec<(f64, &Cell)> = solved
            .filter_map(|cell| Some((cell.time.median?, *cell)))
            .collect();
        times.sort_by(|a, b| a.0.total_cmp(&b.0));
        let points = times.iter().enumerate();
        let points =
            points.map(|(i, (time, cell))| LinePoint::new((i + 1) as f64, *time, &cell.model));
        setting.series(name, points.collect())
    };
    let series: Vec<Series> = group.algorithms.iter().map(series).collect();
    let most = series.iter().map(|series| series.points.len()).max()?;
    if most < FEWEST_FOR_QUANTILES || series.len() < 2 {
        return None;
    }
    let values = series.iter().flat_map(|s| &s.points).map(|p| p.value.value);
    let y = Axis::fitting("Time (s)", values);
    Some(Plot {
        id: format!("{}-quantiles", setting.prefix),
        title: "Cells solved within a time".to_owned(),
        caption: format!(
            "Quantile plot: the cells of each algorithm, a model and a source each, by increasing \
             median time. Lower is faster; a line that ends early failed on the rest or did not run there. {}",
            y.scale()
        ),
        chart: Chart::Lines(Lines::new(
            Axis::linear("Cells, the fastest first"),
            y,
            series
                .into_iter()
                .filter(|s| !s.points.is_empty())
                .collect(),
        )),
    })
}

/// A plot of the wavefronts for each model: the number of waiting windows over their mean distance,
/// with the standard deviation of the distances. For queues that work in rounds, also the size K of
/// the rounds.
fn wavefronts(group: &GroupCells<'_>, setting: Setting<'_>) -> Vec<Plot> {
    let models = group.models.iter().enumerate();
    models
        .filter_map(|(number, model)| wavefront(group, setting, number, model))
        .collect()
}

fn wavefront(
    group: &GroupCells<'_>,
    setting: Setting<'_>,
    number: usize,
    model: &ModelRecord,
) -> Option<Plot> {
    let mut series: Vec<Series> = Vec::new();
    for name in &group.algorithms {
        // Of several sources, only the first is used: their curves are not comparable.
        let cells = group.of(&model.name, name);
        let Some(cell) = cells.first().filter(|cell| cell.status == Status::Ok) else {
            continue;
        };
        let waiting = wavefront_points(cell, |sample| Some(sample.windows as f64));
        let batches = wavefront_points(cell, |sample| Some(sample.k? as f64));
        if !waiting.is_empty() {
            series.push(setting.series(name, waiting));
        }
        if !batches.is_empty() {
            let batches = batches.into_iter().map(|point| LinePoint {
                deviation: None,
                ..point
            });
            series.push(Series {
                name: format!("{name}: K"),
                hollow: true,
                ..setting.series(name, batches.collect())
            });
        }
    }
    (!series.is_empty()).then(|| Plot {
        id: format!("{}-wavefront-{number}", setting.prefix),
        title: format!("Wavefront: {}", model.name),
        caption:
            "Windows that wait in the queue, over their mean distance from the source, sampled \
                  at even intervals of propagated windows. Horizontal whiskers: standard deviation \
                  of their distances; the shorter, the better the order of distances is kept. \
                  Outlines: K, the number of windows that a round was told to take."
                .to_owned(),
        chart: Chart::Lines(Lines::new(
            Axis::linear("Mean distance of the wavefront from the source"),
            Axis::linear("Windows"),
            series,
        )),
    })
}

fn wavefront_points(
    cell: &Cell,
    value: impl Fn(&WavefrontSample) -> Option<f64>,
) -> Vec<LinePoint> {
    let points = cell.wavefront.iter().filter_map(|sample| {
        let value = value(sample)?;
        sample.distance.is_finite().then(|| LinePoint {
            deviation: Some(sample.deviation).filter(|d| d.is_finite() && *d > 0.0),
            ..LinePoint::new(sample.distance, value, &cell.model)
        })
    });
    let mut points: Vec<LinePoint> = points.collect();
    // Samples are in the order of the run, in which the mean distance may decrease.
    points.sort_by(|a, b| a.x.total_cmp(&b.x));
    points
}
