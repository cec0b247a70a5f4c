//! The cells of one group, for tables and charts.

use std::collections::{HashMap, HashSet};
use std::hash::Hash;

use geobench_harness::figures::{CLAIMED, Figure};
use geobench_harness::measure::statistics::{Variable, interval_of, median};
use geobench_harness::schema::{Cell, GroupRecord, ModelRecord, SourceLabel, Status};

/// A group with its models and algorithms.
#[derive(Debug)]
pub(crate) struct GroupCells<'r> {
    pub(crate) record: &'r GroupRecord,
    pub(crate) cells: Vec<&'r Cell>,
    pub(crate) models: Vec<&'r ModelRecord>,
    /// In the order in which they first appear.
    pub(crate) algorithms: Vec<&'r str>,
    /// The cells of each model, in the order of the file, by algorithm.
    of_model: HashMap<&'r str, ModelCells<'r>>,
    /// The algorithms that are approximate in any cell.
    approximate: HashSet<&'r str>,
    /// The algorithms with times that are claims and nothing confirms.
    claimed: HashSet<&'r str>,
}

/// The cells of a model.
#[derive(Debug, Default)]
struct ModelCells<'r> {
    all: Vec<&'r Cell>,
    by_algorithm: HashMap<&'r str, Vec<&'r Cell>>,
    vertices: Option<u64>,
}

/// A value with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Estimate {
    pub(crate) value: f64,
    /// The ends of its 95 % interval.
    pub(crate) interval: Option<[f64; 2]>,
}

impl From<f64> for Estimate {
    fn from(value: f64) -> Self {
        Self {
            value,
            interval: None,
        }
    }
}

/// `items` without duplicates, in the order of first appearance. O(items × distinct items).
pub(crate) fn distinct<T: PartialEq>(items: impl IntoIterator<Item = T>) -> Vec<T> {
    items.into_iter().fold(Vec::new(), |mut all, item| {
        if !all.contains(&item) {
            all.push(item);
        }
        all
    })
}

/// `items` by their keys, in the order in which the keys first appear.
pub(crate) fn by_key<K: Eq + Hash + Clone, T>(
    items: impl IntoIterator<Item = T>,
    key: impl Fn(&T) -> K,
) -> Vec<(K, Vec<T>)> {
    let (mut groups, mut places) = (Vec::<(K, Vec<T>)>::new(), HashMap::new());
    for item in items {
        let key = key(&item);
        let place = *places.entry(key.clone()).or_insert(groups.len());
        if place == groups.len() {
            groups.push((key, Vec::new()));
        }
        groups[place].1.push(item);
    }
    groups
}

/// The geometric mean of positive `values`; `None` if there are none.
pub(crate) fn geometric_mean(values: &[f64]) -> Option<f64> {
    let sum: f64 = values.iter().copied().map(libm::log).sum();
    (!values.is_empty()).then(|| libm::exp(sum / values.len() as f64))
}

/// The algorithms of `cells`, in the order in which they first appear.
pub(crate) fn algorithms<'r>(cells: impl IntoIterator<Item = &'r Cell>) -> Vec<&'r str> {
    distinct(cells.into_iter().map(|cell| cell.algorithm.as_str()))
}

impl<'r> GroupCells<'r> {
    /// The group of `record`, with those of `models` and `cells` that belong to it.
    pub(crate) fn new(
        record: &'r GroupRecord,
        models: &'r [ModelRecord],
        cells: &'r [Cell],
    ) -> Self {
        let cells: Vec<&Cell> = cells.iter().filter(|c| c.group == record.name).collect();
        let mut of_model: HashMap<&str, ModelCells<'_>> = HashMap::new();
        for cell in &cells {
            let model = of_model.entry(&cell.model).or_default();
            model.all.push(cell);
            let same = model.by_algorithm.entry(&cell.algorithm);
            same.or_default().push(cell);
        }
        let mut measured = Vec::new();
        for model in models {
            if let Some(known) = of_model.get_mut(model.name.as_str()) {
                known.vertices = known.vertices.or(model.vertices);
                measured.push(model);
            }
        }
        let named = |is: fn(&Cell) -> bool| {
            let cells = cells.iter().filter(|cell| is(cell));
            cells.map(|cell| cell.algorithm.as_str()).collect()
        };
        Self {
            approximate: named(|cell| cell.approximate),
            claimed: named(|cell| cell.time.unconfirmed),
            record,
            models: measured,
            algorithms: algorithms(cells.iter().copied()),
            cells,
            of_model,
        }
    }

    /// The cells of all algorithms on a model, in the order of the file.
    pub(crate) fn on(&self, model: &str) -> &[&'r Cell] {
        self.of_model.get(model).map_or(&[], |model| &model.all)
    }

    /// Whether an algorithm is approximate in any cell.
    pub(crate) fn is_approximate(&self, algorithm: &str) -> bool {
        self.approximate.contains(algorithm)
    }

    /// Whether an algorithm may be the fastest: it is exact, and its times are measured or
    /// confirmed.
    pub(crate) fn may_be_best(&self, algorithm: &str) -> bool {
        !self.is_approximate(algorithm) && !self.claimed.contains(algorithm)
    }

    /// An algorithm as tables and plots show it: marked if it is approximate, and if its times are
    /// claims that nothing confirms.
    pub(crate) fn shown(&self, algorithm: &str) -> String {
        match (
            self.is_approximate(algorithm),
            self.claimed.contains(algorithm),
        ) {
            (false, false) => algorithm.to_owned(),
            (true, false) => format!("{algorithm} (approx.)"),
            (false, true) => format!("{algorithm} {CLAIMED}"),
            (true, true) => format!("{algorithm} (approx.) {CLAIMED}"),
        }
    }

    /// The cells of an algorithm on a model, one for each source.
    pub(crate) fn of(&self, model: &str, algorithm: &str) -> Vec<&'r Cell> {
        let model = self.of_model.get(model);
        let cells = model.and_then(|model| model.by_algorithm.get(algorithm));
        cells.cloned().unwrap_or_default()
    }

    /// The figure of an algorithm on a model: the median over the sources. Only the time from a
    /// single source has an interval.
    pub(crate) fn value(&self, figure: &Figure, model: &str, algorithm: &str) -> Option<Estimate> {
        let cells = self.of(model, algorithm);
        let value = overall(figure, &cells, self.vertices(model))?;
        let interval = match (&cells[..], figure.key) {
            ([cell], "time") => cell.time.ci95,
            _ => None,
        };
        Some(Estimate { value, interval })
    }

    /// The ratio of a figure of an algorithm on a model to that of `base`: the median over the
    /// sources. The ratio of times from one source is the median over the pairs of samples from the
    /// same round. Ratios of times have an interval, if all cells have enough samples.
    pub(crate) fn ratio(
        &self,
        figure: &Figure,
        model: &str,
        algorithm: &str,
        base: &str,
    ) -> Option<Estimate> {
        let (over, under) = (self.of(model, algorithm), self.of(model, base));
        // There is no ratio if one of the algorithms failed from any source.
        overall(figure, &over, self.vertices(model))?;
        overall(figure, &under, self.vertices(model))?;
        let pairs = over.into_iter().filter_map(|over| {
            let under = under.iter().find(|under| under.source == over.source)?;
            Some((over, *under))
        });
        let pairs: Vec<(&Cell, &Cell)> = pairs.collect();
        if figure.key == "time" {
            return ratio_of_times(&pairs);
        }
        let ratio = |(over, under): &(&Cell, &Cell)| {
            let value = figure.of(over, None)? / figure.of(under, None)?;
            value.is_finite().then_some(value)
        };
        let ratios = pairs.iter().map(ratio).collect::<Option<Vec<f64>>>()?;
        median(&ratios).map(Estimate::from)
    }

    /// The number of vertices of a model.
    fn vertices(&self, model: &str) -> Option<u64> {
        self.of_model.get(model)?.vertices
    }

    /// The status in words of an algorithm that failed on a model; `None` if it did not fail.
    pub(crate) fn failure(&self, model: &str, algorithm: &str) -> Option<String> {
        let cells = self.of(model, algorithm);
        let failed = cells.iter().find(|cell| cell.status != Status::Ok)?;
        Some(failed.status.in_words())
    }

    /// The base of ratios: the algorithm that the group names, else `vtp`, else the reference of
    /// the checks, else the first. `None` if the group has no other algorithm.
    pub(crate) fn base(&self) -> Option<&'r str> {
        let ran = |name: &&str| self.algorithms.contains(name);
        let mut references = self.cells.iter().map(|c| c.check.reference.as_deref());
        let reference = references.find_map(|reference| reference);
        let wanted = [self.record.ratios_to.as_deref(), Some("vtp"), reference];
        let base = wanted.into_iter().flatten().find(ran);
        let base = base.or_else(|| self.algorithms.first().copied())?;
        (self.algorithms.len() > 1).then_some(base)
    }
}

/// The median of a figure over the cells of all sources, on a model with this number of vertices.
/// `None` if a cell failed or lacks the figure.
pub(crate) fn overall(figure: &Figure, cells: &[&Cell], vertices: Option<u64>) -> Option<f64> {
    let of = |cell: &&Cell| {
        let value = figure.of(cell, vertices);
        value.filter(|_| cell.status == Status::Ok)
    };
    median(&cells.iter().map(of).collect::<Option<Vec<f64>>>()?)
}

/// The distances that a cell asks for: of a model, from a source, within a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Problem<'r> {
    model: &'r str,
    source: Option<&'r SourceLabel>,
    goal: Option<&'r str>,
}

impl<'r> Problem<'r> {
    pub(crate) fn of(cell: &'r Cell) -> Self {
        Self {
            model: &cell.model,
            source: cell.source.as_ref(),
            goal: cell.goal.as_deref(),
        }
    }
}

/// The samples of the rounds that both cells have. The cells can have different numbers of samples
/// if the number of runs was not fixed.
pub(crate) fn pairs<'c>(over: &'c Cell, under: &'c Cell) -> (&'c [f64], &'c [f64]) {
    let [over, under] = [over, under].map(|cell| &cell.time.samples[..]);
    let rounds = over.len().min(under.len());
    (&over[..rounds], &under[..rounds])
}

/// The median over pairs of cells of the ratios of their times, with its interval. `None` if a cell
/// has no times.
fn ratio_of_times(cells: &[(&Cell, &Cell)]) -> Option<Estimate> {
    let ratios = cells.iter().map(|(over, under)| {
        let (above, below) = pairs(over, under);
        let ratios = above.iter().zip(below).map(|(a, b)| a / b);
        let ratios: Vec<f64> = ratios.collect();
        let usable = !ratios.is_empty() && ratios.iter().all(|r| r.is_finite() && *r > 0.0);
        usable.then_some(ratios)
    });
    let ratios = ratios.collect::<Option<Vec<Vec<f64>>>>()?;
    let medians: Vec<f64> = ratios.iter().filter_map(|ratios| median(ratios)).collect();
    let variables: Vec<Variable<'_>> = ratios.iter().map(|r| Variable::Samples(r)).collect();
    Some(Estimate {
        value: median(&medians)?,
        interval: interval_of(&variables, |medians| median(medians).unwrap_or(f64::NAN)),
    })
}
