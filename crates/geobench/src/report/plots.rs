//! The plots of a group.

use geobench_mesh::generate::Spec;

use super::chart::{
    Axis, Band, Bar, BarGroup, Bars, Chart, Dots, Lane, Lines, Point, Series, Value,
};
use super::course;
use super::document::{Plot, slug};
use super::group::{Group, known};
use crate::export::figures::{Figure, figures};
use crate::export::number::grouped;
use crate::record::{ModelRecord, Phases};

/// What every plot needs to know beside its group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setting<'a> {
    /// What the identifiers of plots start with.
    pub(crate) prefix: &'a str,
    /// The algorithms of the whole result, in an order that gives each its marker.
    pub(crate) styles: &'a [&'a str],
    /// The algorithm to which ratios are taken.
    pub(crate) base: Option<&'a str>,
}

impl Setting<'_> {
    pub(crate) fn style(&self, algorithm: &str) -> usize {
        let found = self.styles.iter().position(|name| *name == algorithm);
        found.unwrap_or(0)
    }
}

/// All plots of a group.
pub(crate) fn plots(group: &Group<'_>, setting: Setting<'_>) -> Vec<Plot> {
    let time = known("time");
    let mut plots = Vec::new();
    plots.extend(time.and_then(|time| values(group, setting, time)));
    if let (Some(time), Some(base)) = (time, setting.base) {
        plots.extend(ratios(group, setting, time, base));
    }
    plots.extend(scaling(group, setting));
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

/// A lane for each algorithm on each model, with what `value` finds there; where that takes figures of `base` too
/// and this failed, it is what is said to be missing.
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
    let scale = scale(&axis);
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

/// In words whether an axis is one of equal ratios.
fn scale(axis: &Axis) -> String {
    let scale = if axis.log { "Logarithmic" } else { "Linear" };
    format!("{scale} scale.")
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

/// What models differ in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Against {
    Faces,
    Anisotropy,
}

impl Against {
    const ALL: [Self; 2] = [Self::Faces, Self::Anisotropy];

    const fn label(self) -> &'static str {
        match self {
            Self::Faces => "Faces",
            Self::Anisotropy => "Anisotropy g",
        }
    }

    fn of(self, model: &ModelRecord) -> Option<f64> {
        match self {
            Self::Faces => model.faces.map(|faces| faces as f64),
            Self::Anisotropy => model.anisotropy,
        }
    }

    /// The parameters of generators that change it.
    const fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Faces => &[
                "faces",
                "n",
                "nx",
                "ny",
                "nz",
                "subdiv",
                "parts",
                "subdivide",
                "slices",
                "stacks",
                "rings",
            ],
            Self::Anisotropy => &["g"],
        }
    }

    /// What models have in common that differ in this alone: their spec or file name without what
    /// says how much of it they have.
    fn family(self, model: &ModelRecord) -> String {
        if !Spec::is_spec(&model.path) {
            let name = model.name.trim_end_matches(|c: char| {
                c.is_ascii_digit() || matches!(c, '.' | '-' | '_' | ' ' | 'k' | 'K' | 'M')
            });
            return name.to_owned();
        }
        let is_size = |item: &&str| {
            let key = item.split('=').next().unwrap_or_default().trim();
            self.keys().contains(&key)
        };
        let spec = model.path.strip_prefix("gen:").unwrap_or(&model.path);
        let rest: Vec<&str> = spec.split(',').filter(|item| !is_size(item)).collect();
        rest.join(",")
    }
}

/// Fewest models that make a line.
const FEWEST: usize = 3;

/// Time, and its ratio to the base, against what the models of the group differ in.
fn scaling(group: &Group<'_>, setting: Setting<'_>) -> Vec<Plot> {
    let mut plots = Vec::new();
    for against in Against::ALL {
        let mut families: Vec<(String, Vec<(f64, &ModelRecord)>)> = Vec::new();
        for model in &group.models {
            let Some(at) = against.of(model) else {
                continue;
            };
            let name = against.family(model);
            match families.iter_mut().find(|(family, _)| *family == name) {
                Some((_, models)) => models.push((at, model)),
                None => families.push((name, vec![(at, model)])),
            }
        }
        for (_, models) in &mut families {
            models.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        // Lines only mean something between models that differ in nothing else.
        let lines: Vec<_> = families
            .iter()
            .filter(|(_, models)| differ(models) >= FEWEST)
            .collect();
        for (i, (family, models)) in lines.iter().enumerate() {
            let name = if family.is_empty() {
                "all models"
            } else {
                family
            };
            plots.extend(against_plots(
                group,
                setting,
                against,
                (i, name),
                models,
                true,
            ));
        }
        if lines.is_empty() && against == Against::Faces {
            let mut all: Vec<_> = families.into_iter().flat_map(|(_, m)| m).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            if differ(&all) >= FEWEST {
                plots.extend(against_plots(
                    group,
                    setting,
                    against,
                    (0, "all models"),
                    &all,
                    false,
                ));
            }
        }
    }
    plots
}

/// How many of `models`, which are sorted, differ.
fn differ(models: &[(f64, &ModelRecord)]) -> usize {
    let mut places: Vec<f64> = models.iter().map(|(at, _)| *at).collect();
    places.dedup();
    places.len()
}

fn against_plots(
    group: &Group<'_>,
    setting: Setting<'_>,
    against: Against,
    (number, family): (usize, &str),
    models: &[(f64, &ModelRecord)],
    joined: bool,
) -> Vec<Plot> {
    let Some(time) = known("time") else {
        return Vec::new();
    };
    let series = |value: &dyn Fn(&str, &str) -> Option<Value>| -> Vec<Series> {
        let series = group.algorithms.iter().map(|name| Series {
            style: setting.style(name),
            name: (*name).to_owned(),
            joined,
            hollow: false,
            points: models
                .iter()
                .filter_map(|(at, model)| Some((*at, value(&model.name, name)?)))
                .collect(),
        });
        series.filter(|series| !series.points.is_empty()).collect()
    };
    let x = Axis::fitting(against.label(), models.iter().map(|(at, _)| *at));
    let range = match (models.first(), models.last()) {
        (Some((first, _)), Some((last, _))) if against == Against::Faces => {
            format!(
                ", {} to {} faces",
                grouped(*first as u64),
                grouped(*last as u64)
            )
        }
        _ => String::new(),
    };
    let lines = if joined {
        "Lines join models that differ in nothing else."
    } else {
        "Each point is a model."
    };
    let what = slug(against.label());
    let plot = |part: &str, title: &str, label: String, reference, series: Vec<Series>| {
        let y = Axis::fitting(
            &label,
            series.iter().flat_map(|s| &s.points).map(|(_, v)| v.value),
        );
        let caption = format!("{lines} {}", scale(&y));
        (!series.is_empty()).then(|| Plot {
            id: format!("{}-{part}-{what}-{number}", setting.prefix),
            title: format!(
                "{title} against {}: {family}{range}",
                against.label().to_lowercase()
            ),
            caption,
            chart: Chart::Lines(Lines {
                x: x.clone(),
                y,
                reference,
                series,
            }),
        })
    };
    let times = series(&|model, algorithm| group.value(time, model, algorithm));
    let mut plots = Vec::new();
    plots.extend(plot("time", "Time", "Time (s)".to_owned(), None, times));
    if let Some(base) = setting.base {
        let ratios = series(&|model, algorithm| group.ratio(time, model, algorithm, base));
        if ratios.len() > 1 {
            let label = format!("Time as a multiple of {base}");
            plots.extend(plot("ratio", "Ratio", label, Some(1.0), ratios));
        }
    }
    plots
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(name: &str, path: &str) -> ModelRecord {
        ModelRecord {
            name: name.into(),
            path: path.into(),
            ..ModelRecord::default()
        }
    }

    #[test]
    fn families_are_what_is_left_without_the_size() {
        let of = |against: Against, path: &str| against.family(&model("m_20k", path));
        assert_eq!(
            of(Against::Faces, "gen:torus,faces=20000,bump=0.1,seed=7"),
            of(Against::Faces, "gen:torus,faces=500,bump=0.1,seed=7")
        );
        assert_ne!(
            of(Against::Faces, "gen:torus,faces=20000,bump=0.1,seed=7"),
            of(Against::Faces, "gen:torus,faces=20000,bump=0.2,seed=7")
        );
        assert_eq!(
            of(Against::Anisotropy, "gen:anisotropic,g=4,faces=100"),
            "anisotropic,faces=100"
        );
        assert_eq!(of(Against::Faces, "models/m_20k.obj"), "m");
    }
}
