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
/// algorithms with a time solved. `None` for fewer than two algorithms, or if no cell has a time.
///
/// The best of a row is the fastest exact algorithm, or the fastest if the group has no exact one.
/// Times that are claims are not the best. A row without a best has no ratios, and one with nothing
/// to compare it with has no mark.
pub(crate) fn matrix(group: &GroupCells<'_>) -> Option<Table> {
    if group.algorithms.len() < 2 {
        return None;
    }
    let names = || group.algorithms.iter();
    let mut may_be_best: Vec<bool> = names().map(|name| group.may_be_best(name)).collect();
    let has_exact = may_be_best.contains(&true);
    if !has_exact {
        may_be_best.fill(true);
    }
    let times = |model: &&ModelRecord| -> Vec<Option<f64>> {
        let value = |name: &&str| Some(group.value(time(), &model.name, name)?.value);
        names().map(value).collect()
    };
    let times: Vec<Vec<Option<f64>>> = group.models.iter().map(times).collect();
    if times.iter().flatten().all(Option::is_none) {
        return None;
    }
    // For each model, the ratios to its best.
    let rows = group.models.iter().zip(&times);
    let ratios: Vec<Vec<Option<f64>>> = rows
        .map(|(model, times)| ratios(group, &model.name, times, &may_be_best))
        .collect();
    let rows = group.models.iter().zip(times.iter().zip(&ratios));
    let rows = rows.map(|(model, (times, ratios))| {
        let marked = marks(times, best(times, &may_be_best), &may_be_best);
        let fields = names().zip(times.iter().zip(ratios)).zip(marked);
        let fields = fields.map(|((name, pair), mark)| match pair {
            (Some(seconds), Some(ratio)) => heated(
                format!("{} ({})", with_unit(*seconds), self::ratio(*ratio)),
                *ratio,
                mark,
            ),
            (Some(seconds), None) => Entry::new(with_unit(*seconds)),
            (None, _) => match group.failure(&model.name, name) {
                Some(failure) => Entry::marked(failure, Mark::Failed),
                None => Entry::new("-"),
            },
        });
        std::iter::once(Entry::new(&model.name))
            .chain(fields)
            .collect()
    });
    let mut table = Table {
        caption: format!(
            "Time, and in brackets its ratio to that of the fastest {}algorithm of the row.",
            if has_exact { "exact " } else { "" }
        ),
        rows_are: "model",
        columns_are_algorithms: true,
        ..Table::new(results::columns(group), rows.collect())
    };
    table.columns[0] = Column::text("Model");
    table.parts.extend(foot(&ratios, &may_be_best));
    Some(table)
}

/// The best time of a model; `None` if no algorithm with a time may be the best.
fn best(times: &[Option<f64>], may_be_best: &[bool]) -> Option<f64> {
    let candidates = times.iter().zip(may_be_best).filter(|(_, may)| **may);
    candidates.filter_map(|(time, _)| *time).reduce(f64::min)
}

/// The ratios of the times of a model to the best one, as in the other tables and in the headline:
/// medians over the rounds. `None` without a best time.
fn ratios(
    group: &GroupCells<'_>,
    model: &str,
    times: &[Option<f64>],
    may_be_best: &[bool],
) -> Vec<Option<f64>> {
    let mut both = times.iter().zip(may_be_best);
    let place = best(times, may_be_best)
        .and_then(|best| both.position(|(time, may)| *may && *time == Some(best)));
    let Some(base) = place.map(|place| group.algorithms[place]) else {
        return vec![None; times.len()];
    };
    let names = group.algorithms.iter();
    names
        .map(|name| Some(group.ratio(time(), model, name, base)?.value))
        .collect()
}

/// The marks of a row: `best` is marked if two values or more may be the best.
fn marks(values: &[Option<f64>], best: Option<f64>, may_be_best: &[bool]) -> Vec<Mark> {
    let both = || values.iter().zip(may_be_best);
    let is_compared = both()
        .filter(|(value, may)| value.is_some() && **may)
        .count()
        > 1;
    let is_best =
        |value: &Option<f64>, may: bool| is_compared && may && value.is_some() && *value == best;
    let mark = |(value, may): (&Option<f64>, &bool)| {
        if is_best(value, *may) {
            Mark::Best
        } else {
            Mark::None
        }
    };
    both().map(mark).collect()
}

/// The geometric means over the models that all algorithms solved, of several models. Algorithms
/// without any ratio do not count.
fn foot(ratios: &[Vec<Option<f64>>], may_be_best: &[bool]) -> Option<Part> {
    let counts: Vec<bool> = (0..may_be_best.len())
        .map(|column| ratios.iter().any(|row| row[column].is_some()))
        .collect();
    let is_whole = |row: &&Vec<Option<f64>>| {
        let mut both = row.iter().zip(&counts);
        both.all(|(ratio, counts)| ratio.is_some() || !counts)
    };
    let common: Vec<&Vec<Option<f64>>> = ratios.iter().filter(is_whole).collect();
    if ratios.len() < 2 || common.is_empty() || !counts.contains(&true) {
        return None;
    }
    let label = if counts.contains(&false) {
        format!(
            "geometric mean of the {} that the others solved",
            common.len()
        )
    } else if common.len() < ratios.len() {
        format!("geometric mean of the {} that all solved", common.len())
    } else {
        format!("geometric mean of {}", common.len())
    };
    let mean = |column: usize| {
        let ratios: Vec<f64> = common.iter().filter_map(|row| row[column]).collect();
        geometric_mean(&ratios)
    };
    let means: Vec<Option<f64>> = (0..counts.len()).map(mean).collect();
    // An algorithm that is the best on all models has the mean 1.
    let marked = marks(&means, Some(1.0), may_be_best);
    let entries = means.iter().zip(marked).map(|(mean, mark)| match mean {
        Some(mean) => heated(ratio(*mean), *mean, mark),
        None => Entry::new("-"),
    });
    Some(Part {
        is_foot: true,
        rows: vec![std::iter::once(Entry::new(label)).chain(entries).collect()],
        ..Part::default()
    })
}

/// An entry with the heat of a ratio. A ratio of 1 is the best.
fn heated(text: String, ratio: f64, mark: Mark) -> Entry {
    let heat = 1 + HEATS.iter().filter(|end| ratio > **end).count();
    Entry {
        heat: u8::try_from(heat).unwrap_or(Entry::HOTTEST),
        ..Entry::marked(text, mark)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fields of a row of the foot: texts and marks.
    fn foot_of(ratios: &[Vec<Option<f64>>], may_be_best: &[bool]) -> Option<Vec<(String, Mark)>> {
        let part = foot(ratios, may_be_best)?;
        let fields = part.rows[0].iter();
        Some(
            fields
                .map(|entry| (entry.text.clone(), entry.mark))
                .collect(),
        )
    }

    #[test]
    fn algorithms_that_solve_nothing_are_left_out_of_means() {
        let rows = [
            vec![Some(1.0), Some(2.0), None],
            vec![Some(1.0), Some(8.0), None],
        ];
        let found = foot_of(&rows, &[true; 3]).unwrap();
        let expected = [
            ("geometric mean of the 2 that the others solved", Mark::None),
            ("1.00", Mark::Best),
            ("4.00", Mark::None),
            ("-", Mark::None),
        ];
        assert_eq!(found, expected.map(|(text, mark)| (text.to_owned(), mark)));
        assert_eq!(foot_of(&[vec![None; 2], vec![None; 2]], &[true; 2]), None);
    }

    #[test]
    fn only_compared_cells_are_marked_as_best() {
        // The second is approximate.
        let may_be_best = [true, false, true];
        let marked = |row: [Option<f64>; 3]| {
            let best = best(&row, &may_be_best);
            (best, marks(&row, best, &may_be_best))
        };
        assert_eq!(
            marked([Some(4.0), Some(1.0), None]),
            (Some(4.0), vec![Mark::None; 3])
        );
        assert_eq!(
            marked([Some(4.0), Some(1.0), Some(8.0)]),
            (Some(4.0), vec![Mark::Best, Mark::None, Mark::None])
        );
        // No exact algorithm solved it.
        assert_eq!(marked([None, Some(1.0), None]), (None, vec![Mark::None; 3]));
    }
}
