//! Plots of times and ratios against a property of the models (size or anisotropy), with power laws
//! fitted to the times.

use geobench_harness::figures::time;
use geobench_harness::measure::number::grouped;
use geobench_harness::measure::statistics::{FEWEST_FOR_FIT, power_law};
use geobench_harness::schema::ModelRecord;
use geobench_mesh::generate::Spec;

use super::chart::{Axis, Chart, Fit, LinePoint, Lines, Series};
use super::document::{Plot, slug};
use super::setting::Setting;
use crate::table::group::{Estimate, GroupCells, by_key};

/// The property on the x-axis.
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

    /// Whether `models`, which are sorted by the property, vary enough in it for a plot. Generators
    /// meet a number of faces only nearly.
    fn varies(self, models: &[(f64, &ModelRecord)]) -> bool {
        match (self, models) {
            (Self::Faces, [(least, _), .., (most, _)]) => *most >= 1.5 * least,
            _ => true,
        }
    }

    /// The parameters of generators that determine the property.
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
                "holes",
            ],
            Self::Anisotropy => &["g"],
        }
    }

    /// The family of a model: its generator spec without the parameters of this property, or the
    /// name of its file without a number at the end, which is taken for its size. Models of one
    /// family differ in this property only. `None` for files that have no such name or property.
    fn family(self, model: &ModelRecord) -> Option<String> {
        if !Spec::is_spec(&model.path) {
            let size = model.name.trim_end_matches(['k', 'K', 'M']);
            let name = size.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.');
            let is_sized = self == Self::Faces && name != size;
            let name = name.trim_end_matches(['-', '_', ' ']);
            return (is_sized && !name.is_empty()).then(|| name.to_owned());
        }
        let is_size = |item: &&str| {
            let key = item.split('=').next().unwrap_or_default().trim();
            self.keys().contains(&key)
        };
        let spec = model.path.strip_prefix("gen:").unwrap_or(&model.path);
        let rest: Vec<&str> = spec.split(',').filter(|item| !is_size(item)).collect();
        Some(rest.join(","))
    }
}

/// Plots of the time, and those of its ratio to the base, against each property. There is a plot
/// for each family with enough models. If no family has enough, all models are plotted against
/// their size, as points without lines.
pub(super) fn plots(group: &GroupCells<'_>, setting: Setting<'_>) -> [Vec<Plot>; 2] {
    let (mut times, mut ratios) = (Vec::new(), Vec::new());
    for against in Against::ALL {
        let mut models: Vec<(f64, &ModelRecord)> = Vec::new();
        models.extend(
            group
                .models
                .iter()
                .filter_map(|m| Some((against.of(m)?, *m))),
        );
        models.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Lines join only models that differ in this property only, which are those of one family.
        let mut lines = families(against, &models);
        let joined = !lines.is_empty();
        if !joined
            && against == Against::Faces
            && differ(&models) >= FEWEST_FOR_FIT
            && against.varies(&models)
        {
            lines.push(("all models".to_owned(), models));
        }
        for (i, (family, models)) in lines.into_iter().enumerate() {
            let family = (i, family.as_str());
            let [time, ratio] = against_plots(group, setting, against, family, &models, joined);
            times.extend(time);
            ratios.extend(ratio);
        }
    }
    [times, ratios]
}

/// The series of models that differ in size alone, each in ascending order of size.
pub(super) fn series<'r>(group: &GroupCells<'r>) -> Vec<Vec<&'r ModelRecord>> {
    let sized = |model: &&'r ModelRecord| Some((Against::Faces.of(model)?, *model));
    let mut models: Vec<_> = group.models.iter().filter_map(sized).collect();
    models.sort_by(|a, b| a.0.total_cmp(&b.0));
    let series = families(Against::Faces, &models).into_iter();
    let models = |(_, own): (String, Vec<(f64, &'r ModelRecord)>)| {
        own.into_iter().map(|(_, model)| model).collect()
    };
    series.map(models).collect()
}

/// The families of `models`, which are sorted by the property, that vary enough in it for a fit.
fn families<'r>(
    against: Against,
    models: &[(f64, &'r ModelRecord)],
) -> Vec<(String, Vec<(f64, &'r ModelRecord)>)> {
    let families = by_key(models.iter().copied(), |(_, model)| against.family(model));
    let families = families
        .into_iter()
        .filter_map(|(family, own)| Some((family?, own)));
    let varied = families.filter(|(_, own)| differ(own) >= FEWEST_FOR_FIT && against.varies(own));
    varied.collect()
}

/// Number of distinct values of the property, by which `models` is sorted.
fn differ(models: &[(f64, &ModelRecord)]) -> usize {
    let mut places: Vec<f64> = models.iter().map(|(at, _)| *at).collect();
    places.dedup();
    places.len()
}

fn against_plots(
    group: &GroupCells<'_>,
    setting: Setting<'_>,
    against: Against,
    (number, family): (usize, &str),
    models: &[(f64, &ModelRecord)],
    joined: bool,
) -> [Option<Plot>; 2] {
    let series = |value: &dyn Fn(&str, &str) -> Option<Estimate>| -> Vec<Series> {
        let series = group.algorithms.iter().map(|name| {
            let points = models.iter().filter_map(|(at, model)| {
                Some(LinePoint::new(*at, value(&model.name, name)?, &model.name))
            });
            Series {
                joined,
                ..setting.series(name, points.collect())
            }
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
        "Lines join models that differ only in this property."
    } else {
        "Each point is a model."
    };
    let what = slug(against.label());
    let plot = |part: &str, title: &str, label: String, reference, series: Vec<Series>| {
        let y = Axis::fitting(
            &label,
            series.iter().flat_map(|s| &s.points).map(|p| p.value.value),
        );
        let growth = match part {
            "time" if joined && against == Against::Faces => growth(&series),
            _ => String::new(),
        };
        let caption = format!("{lines} {}{growth}", y.scale());
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
                front: false,
                series,
            }),
        })
    };
    let mut times = series(&|model, algorithm| group.value(time(), model, algorithm));
    if joined && against == Against::Faces {
        for series in &mut times {
            series.fit = fit(series);
        }
    }
    let ratio = setting.base.and_then(|base| {
        let ratios = series(&|model, algorithm| group.ratio(time(), model, algorithm, base));
        let label = format!("Time as a multiple of {base}");
        (ratios.len() > 1).then(|| plot("ratio", "Ratio", label, Some(1.0), ratios))?
    });
    [
        plot("time", "Time", "Time (s)".to_owned(), None, times),
        ratio,
    ]
}

/// The power law fitted to a series.
fn fit(series: &Series) -> Option<Fit> {
    let points = series.points.iter().map(|p| [p.x, p.value.value]);
    let [factor, exponent] = power_law(points)?;
    Some(Fit {
        exponent,
        factor,
        ends: [series.points.first()?.x, series.points.last()?.x],
    })
}

/// A sentence with the fitted exponent of each series; empty if no series has a fit.
fn growth(series: &[Series]) -> String {
    let grows = |series: &Series| Some(format!("{} {:.2}", series.name, series.fit?.exponent));
    let grows: Vec<String> = series.iter().filter_map(grows).collect();
    if grows.is_empty() {
        return String::new();
    }
    format!(
        " Times grow with the faces to the power (dashed; least squares on logarithms): {}.",
        grows.join(", ")
    )
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
    fn a_family_is_the_specification_without_the_size() {
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
            Some("anisotropic,faces=100".into())
        );
    }

    #[test]
    fn files_are_a_family_if_their_names_end_with_sizes() {
        let of = |against: Against, name: &str| against.family(&model(name, "models/file.obj"));
        assert_eq!(of(Against::Faces, "horse_20k"), Some("horse".into()));
        // Their sizes differ, so their anisotropy is not all that differs.
        assert_eq!(of(Against::Anisotropy, "horse_20k"), None);
        assert_eq!(of(Against::Faces, "duck_5k"), Some("duck".into()));
        for unrelated in ["12", "horse", "duck"] {
            assert_eq!(of(Against::Faces, unrelated), None);
        }
    }
}
