//! The matrix of a group: models down, algorithms across, and in each field the time with its ratio
//! to the best of the row.

use geobench_harness::figures::time;
use geobench_harness::measure::number::{ratio, with_unit};
use geobench_harness::schema::ModelRecord;

use crate::table::group::{GroupCells, geometric_mean};
use crate::table::model::{Column, Entry, Mark, Part, Table};
use crate::table::results;

/// The upper ends of the ratios of each [`Entry::heat`] but the greatest.
const HEATS: [f64; Entry::HOTTEST as usize - 1] = [1.05, 1.5, 2.5, 5.0, 10.0];

/// The matrix of `group`. Its foot has the geometric means of the ratios over the models that all
/// algorithms solved. `None` for fewer than two algorithms, and without any time.
///
/// The best of a row is the fastest exact algorithm, or the fastest if none is exact.
pub(crate) fn matrix(group: &GroupCells<'_>) -> Option<Table> {
    if group.algorithms.len() < 2 {
        return None;
    }
    let times = |model: &&ModelRecord| -> Vec<Option<f64>> {
        let names = group.algorithms.iter();
        let value = |name: &&str| Some(group.value(time(), &model.name, name)?.value);
        names.map(value).collect()
    };
    let times: Vec<Vec<Option<f64>>> = group.models.iter().map(times).collect();
    // For each model, the ratios to its best.
    let ratios: Vec<Vec<Option<f64>>> = times.iter().map(|row| ratios(group, row)).collect();
    if times.iter().flatten().all(Option::is_none) {
        return None;
    }
    let rows = group.models.iter().zip(times.iter().zip(&ratios));
    let rows = rows.map(|(model, (times, ratios))| {
        let fields = group.algorithms.iter().zip(times.iter().zip(ratios));
        let fields = fields.map(|(name, pair)| match pair {
            (Some(seconds), Some(ratio)) => heated(
                format!("{} ({})", with_unit(*seconds), self::ratio(*ratio)),
                *ratio,
            ),
            _ => match group.failure(&model.name, name) {
                Some(failure) => Entry::marked(failure, Mark::Failed),
                None => Entry::new("-"),
            },
        });
        std::iter::once(Entry::new(&model.name))
            .chain(fields)
            .collect()
    });
    let mut table = Table {
        caption:
            "Time, and in brackets its ratio to that of the fastest exact algorithm of the row."
                .to_owned(),
        rows_are: "model",
        columns_are_algorithms: true,
        ..Table::new(results::columns(group), rows.collect())
    };
    table.columns[0] = Column::text("Model");
    table.parts.extend(foot(&ratios));
    Some(table)
}

/// The ratios of the times of a model to the best of them.
fn ratios(group: &GroupCells<'_>, times: &[Option<f64>]) -> Vec<Option<f64>> {
    let of = |exact: bool| {
        let names = group.algorithms.iter().zip(times);
        let times = names.filter(|(name, _)| !exact || !group.is_approximate(name));
        times.filter_map(|(_, time)| *time).reduce(f64::min)
    };
    let best = of(true).or_else(|| of(false)).unwrap_or(f64::NAN);
    let ratio = |time: &Option<f64>| time.map(|time| time / best).filter(|r| r.is_finite());
    times.iter().map(ratio).collect()
}

/// The geometric means over the models that all algorithms solved, of several models.
fn foot(ratios: &[Vec<Option<f64>>]) -> Option<Part> {
    let whole = ratios
        .iter()
        .filter_map(|row| row.iter().copied().collect());
    let common: Vec<Vec<f64>> = whole.collect();
    if ratios.len() < 2 || common.is_empty() {
        return None;
    }
    let label = if common.len() == ratios.len() {
        format!("geometric mean of {}", common.len())
    } else {
        format!("geometric mean of the {} that all solved", common.len())
    };
    let mean = |column: usize| {
        let ratios: Vec<f64> = common.iter().map(|row| row[column]).collect();
        let mean = geometric_mean(&ratios).unwrap_or(f64::NAN);
        heated(ratio(mean), mean)
    };
    let means = (0..common[0].len()).map(mean);
    Some(Part {
        is_foot: true,
        rows: vec![std::iter::once(Entry::new(label)).chain(means).collect()],
        ..Part::default()
    })
}

/// An entry with the heat of a ratio. A ratio of 1 is the best.
fn heated(text: String, ratio: f64) -> Entry {
    let mark = if ratio == 1.0 { Mark::Best } else { Mark::None };
    let heat = 1 + HEATS.iter().filter(|end| ratio > **end).count();
    Entry {
        heat: u8::try_from(heat).unwrap_or(Entry::HOTTEST),
        ..Entry::marked(text, mark)
    }
}
