//! The figures that tables can show, one row each. A figure is a number that describes a cell.

use std::sync::LazyLock;

use geobench_mesh::did_you_mean;
use geobench_registry::UsageError;
use geobench_window::{Counter, Counters};
use serde::{Deserialize, Deserializer};

use crate::measure::statistics::median;
use crate::schema::Cell;
use crate::usage::document::parsed;

/// A figure of a cell: a row of a table.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Its name in suites and `--rows`.
    pub key: &'static str,
    /// The label of the row.
    pub label: String,
    /// The number format.
    pub style: Style,
    /// Whether less is better. If so, tables mark the least value and show ratios.
    pub less_is_better: bool,
    of: FigureSource,
}

/// By its name.
impl<'de> Deserialize<'de> for &'static Figure {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        parsed(deserializer, |name| {
            figure(name).map_err(|error| error.to_string())
        })
    }
}

/// A number format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// A whole number.
    Count,
    /// A number with as many decimals as needed, up to this number.
    Decimals(u8),
    /// Scientific notation.
    Scientific,
}

/// The source of a figure.
#[derive(Clone, Copy, Debug)]
enum FigureSource {
    Counter(Counter),
    Computed(fn(&Cell) -> Option<f64>),
    /// Computed from the cell and the number of vertices of its model.
    OnModel(fn(&Cell, f64) -> Option<f64>),
}

/// The mark of times that an external program claims and its protocol does not let anyone check.
pub const CLAIMED: &str = "(claimed)";

const MEGABYTE: f64 = 1e6;

/// The default rows of a table.
pub(crate) const USUAL: [&str; 4] = ["time", "propagated", "papers_memory", "heap_memory"];

/// The figure of this name, in any letter case.
///
/// # Errors
///
/// When there is no such figure. The message suggests the nearest name.
pub fn figure(name: &str) -> Result<&'static Figure, UsageError> {
    let name = name.trim().to_lowercase();
    let found = all().iter().find(|figure| figure.key == name);
    found.ok_or_else(|| {
        let known: Vec<&str> = all().iter().map(|figure| figure.key).collect();
        UsageError(format!(
            "there is no row `{name}`{}; known are {}",
            did_you_mean(&name, &known),
            known.join(", ")
        ))
    })
}

/// The time.
pub fn time() -> &'static Figure {
    &all()[0]
}

/// The figures with these names; the default rows if `names` is empty. Unknown names are ignored.
pub fn figures<S: AsRef<str>>(names: &[S]) -> Vec<&'static Figure> {
    if names.is_empty() {
        return figures(&USUAL);
    }
    names
        .iter()
        .flat_map(|name| figure(name.as_ref()))
        .collect()
}

impl Figure {
    /// A figure for which less is better.
    fn cost(key: &'static str, label: &str, style: Style, of: fn(&Cell) -> Option<f64>) -> Self {
        Self {
            key,
            label: label.to_owned(),
            style,
            less_is_better: true,
            of: FigureSource::Computed(of),
        }
    }

    /// A figure that is neither better nor worse.
    fn note(key: &'static str, label: &str, style: Style, of: fn(&Cell) -> Option<f64>) -> Self {
        Self {
            less_is_better: false,
            ..Self::cost(key, label, style, of)
        }
    }

    /// The figure of a cell on a model with this number of vertices, if known.
    pub fn of(&self, cell: &Cell, vertices: Option<u64>) -> Option<f64> {
        match self.of {
            FigureSource::Counter(counter) => count(cell, counter),
            FigureSource::Computed(of) => of(cell),
            FigureSource::OnModel(of) => of(cell, vertices? as f64),
        }
    }
}

fn megabytes(bytes: Option<u64>) -> Option<f64> {
    bytes.map(|n| n as f64 / MEGABYTE)
}

fn count(cell: &Cell, counter: Counter) -> Option<f64> {
    cell.counters.get(counter).map(|n| n as f64)
}

/// All figures: computed ones, and every counter.
#[allow(clippy::too_many_lines)] // A list.
fn all() -> &'static [Figure] {
    use Style::{Count, Decimals, Scientific};
    static ALL: LazyLock<Vec<Figure>> = LazyLock::new(|| {
        let (cost, note) = (Figure::cost, Figure::note);
        let mut all = vec![
            cost("time", "Time (s)", Decimals(9), |c| c.time.median),
            cost("outside_time", "Time from outside (s)", Decimals(9), |c| {
                median(&c.time.outside)
            }),
            note("claimed_time", "Time it claims (s)", Decimals(9), |c| {
                median(&c.time.claimed)
            }),
            cost("setup", "Set-up (s)", Decimals(9), |c| c.time.setup),
            cost("extraction", "Stage 2, diagram (s)", Decimals(9), |c| {
                c.time.extraction
            }),
            cost(
                "papers_memory",
                "Peak memory, papers' count (MB)",
                Decimals(3),
                |c| megabytes(c.memory.papers_bytes),
            ),
            cost(
                "windows_memory",
                "Peak memory, windows (MB)",
                Decimals(3),
                |c| megabytes(c.memory.windows_peak_bytes),
            ),
            cost(
                "heap_memory",
                "Peak memory, measured (MB)",
                Decimals(3),
                |c| megabytes(c.memory.heap_peak_bytes),
            ),
            cost(
                "rss_memory",
                "Peak memory of the process (MB)",
                Decimals(3),
                |c| megabytes(c.memory.rss_peak_bytes),
            ),
            cost("instructions", "Instructions", Count, |c| {
                c.instructions.map(|n| n as f64)
            }),
            cost("generated", "Windows generated", Count, |c| {
                Some(count(c, Counter::Children)? + count(c, Counter::Spawned)?)
            }),
            cost("valid", "Valid windows", Count, |c| {
                Some(count(c, Counter::Kept)? + count(c, Counter::Reinserted).unwrap_or(0.0))
            }),
            note("prime_share", "Prime share", Decimals(4), prime_share),
            cost(
                Counters::WAVEFRONT_DEVIATION,
                "Wavefront deviation",
                Decimals(6),
                |c| c.counters.wavefront_deviation,
            ),
            cost(
                "phase_propagation",
                "Propagation, sampled (s)",
                Decimals(9),
                |c| c.phases.propagation,
            ),
            cost("phase_pruning", "Pruning, sampled (s)", Decimals(9), |c| {
                c.phases.pruning
            }),
            cost(
                "phase_management",
                "Management, sampled (s)",
                Decimals(9),
                |c| c.phases.management,
            ),
            note(
                "management_share",
                "Management share",
                Decimals(4),
                management,
            ),
            note("branching", "Children of a window", Decimals(4), |c| {
                let (children, parents) =
                    (count(c, Counter::Children)?, count(c, Counter::Parents)?);
                (parents > 0.0).then_some(children / parents)
            }),
            Figure {
                of: FigureSource::OnModel(|c, vertices| {
                    let levels = count(c, Counter::Levels)?;
                    (levels > 0.0).then(|| libm::pow(vertices, levels.recip()))
                }),
                ..note("b", "Estimate of b", Decimals(4), |_| None)
            },
            note("max_rel", "Largest relative difference", Scientific, |c| {
                c.check.max_rel
            }),
            note("mean_rel", "Mean relative error", Scientific, |c| {
                c.check.mean_rel
            }),
            note(
                "rms_rel",
                "Root mean square relative error",
                Scientific,
                |c| c.check.rms_rel,
            ),
            note("max_abs", "Largest difference", Scientific, |c| {
                c.check.max_abs
            }),
            note("edge_excess", "Excess along an edge", Scientific, |c| {
                c.check.edge_excess
            }),
            note("mean_wavefront", "Mean wavefront", Count, mean_wavefront),
            note(
                "k_correlation",
                "Correlation of K",
                Decimals(4),
                k_correlation,
            ),
        ];
        all.extend(Counter::ALL.iter().map(|&counter| Figure {
            key: counter.key(),
            label: label(counter),
            style: Count,
            less_is_better: counter == Counter::Propagated,
            of: FigureSource::Counter(counter),
        }));
        all
    });
    &ALL
}

/// The share of prime propagations in prime and secondary ones.
fn prime_share(cell: &Cell) -> Option<f64> {
    let (prime, secondary) = (
        count(cell, Counter::Prime)?,
        count(cell, Counter::Secondary)?,
    );
    (prime + secondary > 0.0).then(|| prime / (prime + secondary))
}

/// The share of management in the time of all phases.
fn management(cell: &Cell) -> Option<f64> {
    let phases = &cell.phases;
    let all = phases.propagation? + phases.pruning? + phases.management?;
    (all > 0.0).then_some(phases.management? / all)
}

/// The mean number of windows on the wavefront over its distances, by the trapezoidal rule on the
/// samples.
fn mean_wavefront(cell: &Cell) -> Option<f64> {
    let mut samples = cell.wavefront.clone();
    samples.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    let way = samples.last()?.distance - samples.first()?.distance;
    let pairs = samples.windows(2);
    let areas = pairs.map(|pair| {
        let height = f64::midpoint(pair[0].windows as f64, pair[1].windows as f64);
        height * (pair[1].distance - pair[0].distance)
    });
    (way > 0.0).then(|| areas.sum::<f64>() / way)
}

/// The correlation of K with the number of windows on the wavefront.
fn k_correlation(cell: &Cell) -> Option<f64> {
    let samples = cell.wavefront.iter();
    let points = samples.filter_map(|s| Some([s.windows as f64, s.k? as f64]));
    correlation(&points.collect::<Vec<_>>())
}

/// Pearson's correlation coefficient; `None` for fewer than three points, or if a coordinate is
/// constant.
fn correlation(points: &[[f64; 2]]) -> Option<f64> {
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|p| p[axis]).sum::<f64>() / count;
    let means = [mean(0), mean(1)];
    let product = |a: usize, b: usize| -> f64 {
        let terms = points.iter().map(|p| (p[a] - means[a]) * (p[b] - means[b]));
        terms.sum()
    };
    let found = product(0, 1) / (product(0, 0) * product(1, 1)).sqrt();
    (points.len() >= 3 && found.is_finite()).then_some(found)
}

/// The label of the row of a counter.
fn label(counter: Counter) -> String {
    match counter {
        Counter::Propagated => "Window propagations".to_owned(),
        Counter::StoredWindows => "Window limit".to_owned(),
        Counter::KPeak => "Largest K".to_owned(),
        _ => capitalised(&counter.key().replace('_', " ")),
    }
}

/// `text` with a capital first letter.
pub fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.collect::<String>() + letters.as_str()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_found() {
        for (i, Figure { key, .. }) in all().iter().enumerate() {
            assert_eq!(figure(key).unwrap().key, *key);
            let mut before = all()[..i].iter();
            assert!(
                before.all(|other| other.key != *key),
                "{key} stands there twice"
            );
        }
        assert_eq!(figures::<&str>(&[]).len(), USUAL.len());
        assert_eq!(time().key, "time");
        let message = figure("levls").unwrap_err().to_string();
        assert!(
            message
                .starts_with("there is no row `levls` (did you mean `levels`?); known are time,")
        );
    }

    #[test]
    fn the_wavefront_is_averaged_over_its_way_and_compared_with_k() {
        let sample = |distance: f64, windows: u64, k: u64| crate::schema::WavefrontSample {
            parents: 0,
            windows,
            distance,
            deviation: 0.0,
            k: Some(k),
        };
        let mut cell = Cell::new("m", "a");
        let of = |key: &str, cell: &Cell| figure(key).unwrap().of(cell, None);
        assert_eq!(of("mean_wavefront", &cell), None);
        // From 0 to 4 windows over the first unit of distance, then 4 for three units. The order of
        // the samples does not matter.
        cell.wavefront = vec![sample(4.0, 4, 8), sample(0.0, 0, 2), sample(1.0, 4, 8)];
        assert_eq!(of("mean_wavefront", &cell), Some(3.5));
        assert!((of("k_correlation", &cell).unwrap() - 1.0).abs() < 1e-12);
        cell.wavefront[0].k = Some(2);
        assert!((of("k_correlation", &cell).unwrap() - 0.5).abs() < 1e-12);
        cell.wavefront[0].k = None;
        assert_eq!(of("k_correlation", &cell), None);
    }

    #[test]
    fn a_figure_without_its_counters_is_absent() {
        let mut cell = Cell::new("m", "a");
        let of = |key: &str, cell: &Cell| figure(key).unwrap().of(cell, Some(48_484));
        assert_eq!(of("valid", &cell), None);
        assert_eq!(of("prime_share", &cell), None);
        cell.counters.set(Counter::Kept, 5);
        cell.counters.set(Counter::Prime, 0);
        cell.counters.set(Counter::Secondary, 0);
        assert_eq!(of("valid", &cell), Some(5.0));
        assert_eq!(of("prime_share", &cell), None);
        cell.counters.set(Counter::Reinserted, 2);
        cell.counters.set(Counter::Prime, 3);
        cell.counters.set(Counter::Secondary, 1);
        assert_eq!(of("valid", &cell), Some(7.0));
        assert_eq!(of("prime_share", &cell), Some(0.75));
        assert_eq!(of("iterations", &cell), None);
        // Table 5.1 of the transfer report (2016): 374 levels on the horse give b = 1.0293.
        assert_eq!(of("b", &cell), None);
        cell.counters.set(Counter::Levels, 374);
        assert!((of("b", &cell).unwrap() - 1.0293).abs() < 1e-4);
        assert_eq!(figure("b").unwrap().of(&cell, None), None);
        cell.counters.set(Counter::Parents, 4);
        assert_eq!(of("branching", &cell), None);
        cell.counters.set(Counter::Children, 6);
        assert_eq!(of("branching", &cell), Some(1.5));
        cell.phases.propagation = Some(1.0);
        cell.phases.pruning = Some(0.5);
        assert_eq!(of("management_share", &cell), None);
        cell.phases.management = Some(0.5);
        assert_eq!(of("management_share", &cell), Some(0.25));
    }
}
