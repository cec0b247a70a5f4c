//! The cells of one group, as plots and comparisons look at them.

use crate::measure::statistics::{median, paired_ratio};
use crate::schema::{Cell, GroupRecord, ModelRecord, ResultFile, Status};
use crate::table::base;
use crate::table::figures::{Figure, figure};
use crate::table::view::{algorithms, overall};

use super::chart::Value;

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

/// A group with its models and algorithms.
#[derive(Debug)]
pub(crate) struct Group<'r> {
    pub(crate) record: &'r GroupRecord,
    pub(crate) cells: Vec<&'r Cell>,
    pub(crate) models: Vec<&'r ModelRecord>,
    pub(crate) algorithms: Vec<&'r str>,
}

impl<'r> Group<'r> {
    pub(crate) fn new(record: &'r GroupRecord, result: &'r ResultFile) -> Self {
        let cells: Vec<&Cell> = result
            .cells
            .iter()
            .filter(|cell| cell.group == record.name)
            .collect();
        let models = result.models.iter();
        Self {
            record,
            models: models
                .filter(|model| cells.iter().any(|cell| cell.model == model.name))
                .collect(),
            algorithms: algorithms(cells.iter().copied()),
            cells,
        }
    }

    /// The cells of an algorithm on a model, one for each source.
    pub(crate) fn of(&self, model: &str, algorithm: &str) -> Vec<&'r Cell> {
        self.cells
            .iter()
            .copied()
            .filter(|cell| cell.model == model && cell.algorithm == algorithm)
            .collect()
    }

    /// The figure of an algorithm on a model: the median over the sources, with the interval of a
    /// time if there is but one.
    pub(crate) fn value(&self, figure: &Figure, model: &str, algorithm: &str) -> Option<Value> {
        let cells = self.of(model, algorithm);
        let value = overall(figure, &cells, self.vertices(model))?;
        let interval = match (&cells[..], figure.key) {
            ([cell], "time") => cell.time.ci95,
            _ => None,
        };
        Some(Value { value, interval })
    }

    /// How many times as much of a figure an algorithm takes on a model as `base`. For times it is
    /// the median over the pairs of samples that were taken in turns, with an interval if there is
    /// but one source; for several sources the median of their ratios.
    pub(crate) fn ratio(
        &self,
        figure: &Figure,
        model: &str,
        algorithm: &str,
        base: &str,
    ) -> Option<Value> {
        let (over, under) = (self.of(model, algorithm), self.of(model, base));
        // What has failed from one source has no figure.
        overall(figure, &over, self.vertices(model))?;
        overall(figure, &under, self.vertices(model))?;
        let pairs: Vec<(&Cell, &Cell)> = over
            .into_iter()
            .filter_map(|a| Some((a, *under.iter().find(|b| b.source == a.source)?)))
            .collect();
        let ratios: Option<Vec<Value>> = pairs.iter().map(|(a, b)| ratio(figure, a, b)).collect();
        match &ratios?[..] {
            [one] => Some(*one),
            several => Some(Value {
                value: median(&several.iter().map(|r| r.value).collect::<Vec<_>>())?,
                interval: None,
            }),
        }
    }

    /// How many vertices a model has.
    fn vertices(&self, model: &str) -> Option<u64> {
        let mut models = self.models.iter();
        models.find(|record| record.name == model)?.vertices
    }

    /// Why an algorithm has no figure on a model, if it failed there: the status in words.
    pub(crate) fn failure(&self, model: &str, algorithm: &str) -> Option<String> {
        let cells = self.of(model, algorithm);
        let failed = cells.iter().find(|cell| cell.status != Status::Ok)?;
        Some(failed.status.in_words())
    }

    /// The algorithm to which ratios are taken, if there is anything to compare it with.
    pub(crate) fn base(&self) -> Option<&'r str> {
        base(self.record, &self.algorithms, &self.cells)
    }
}

/// The ratio of a figure between two cells of the same source.
fn ratio(figure: &Figure, over: &Cell, under: &Cell) -> Option<Value> {
    if figure.key == "time"
        && let Some(ratio) = paired_ratio(&over.time.samples, &under.time.samples)
    {
        return Some(Value {
            value: ratio.ratio,
            interval: ratio.ci95,
        });
    }
    let value = figure.of(over, None)? / figure.of(under, None)?;
    value.is_finite().then_some(Value {
        value,
        interval: None,
    })
}

/// The figure of this name, which is known to exist.
pub(crate) fn known(name: &str) -> Option<&'static Figure> {
    figure(name).ok()
}
