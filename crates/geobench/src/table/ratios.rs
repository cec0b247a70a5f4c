//! Ratios between algorithms: in each model with their intervals, and over all models of a group as in
//! Table 2 of Qin et al. 2016. Times are compared run by run: those of one round were taken next to each
//! other, so that a machine that drifts does not disturb their ratio.

use super::figures::{Figure, figures};
use super::grid::Entry;
use super::view::{ModelView, Row, algorithms, overall};
use crate::measure::statistics::{FEWEST_FOR_INTERVAL, Ratio, paired_ratio};
use crate::schema::{Cell, GroupRecord};

/// For each figure of which less is better, the mean and the standard deviation of the ratio to
/// the algorithm that the group names; none if it names none or nothing can be compared.
pub(super) fn view<'r>(group: &GroupRecord, cells: &[&'r Cell]) -> Option<ModelView<'r>> {
    let baseline = group.ratios_to.as_deref()?;
    let algorithms: Vec<&str> = algorithms(cells.iter().copied())
        .into_iter()
        .filter(|name| *name != baseline)
        .collect();
    let rows: Vec<Row> = figures(&group.rows)
        .into_iter()
        .filter(|figure| figure.less_is_better)
        .map(|figure| row(figure, baseline, &algorithms, cells))
        .collect();
    let compared = rows.iter().flat_map(|r| &r.entries).any(|e| e.text != "-");
    compared.then(|| ModelView {
        name: format!("ratios to {baseline}"),
        size: format!(
            "mean / standard deviation over {} models",
            models(cells).len()
        ),
        sources: String::new(),
        algorithms,
        rows,
        refused: false,
        notes: Vec::new(),
    })
}

/// The algorithm to which ratios are taken: the one that the group names, else `vtp`, else the reference of
/// the checks of `cells`, else the first. None if there is nothing to compare it with.
pub(crate) fn base<'r>(
    group: &'r GroupRecord,
    algorithms: &[&'r str],
    cells: &[&'r Cell],
) -> Option<&'r str> {
    let ran = |name: &&str| algorithms.contains(name);
    let reference = cells.iter().find_map(|c| c.check.reference.as_deref());
    let base = group
        .ratios_to
        .as_deref()
        .filter(ran)
        .or_else(|| Some("vtp").filter(ran))
        .or_else(|| reference.filter(ran))
        .or_else(|| algorithms.first().copied())?;
    (algorithms.len() > 1).then_some(base)
}

fn models<'r>(cells: &[&'r Cell]) -> Vec<&'r str> {
    let mut models: Vec<&str> = Vec::new();
    for cell in cells {
        if !models.contains(&cell.model.as_str()) {
            models.push(&cell.model);
        }
    }
    models
}

/// The row of a model's table with the ratios of the times to those of the algorithm that the group names, and
/// what a reader must know of it; a column holds the cells of an algorithm. None if the group names none, or
/// nothing can be compared.
pub(super) fn times(
    group: &GroupRecord,
    algorithms: &[&str],
    columns: &[Vec<&Cell>],
) -> Option<(Row, Option<String>)> {
    let baseline = group.ratios_to.as_deref()?;
    let under = &columns[algorithms.iter().position(|name| *name == baseline)?];
    let ratios: Vec<Option<Ratio>> = columns
        .iter()
        .zip(algorithms)
        .map(|(over, name)| paired(over, under).filter(|_| *name != baseline))
        .collect();
    let known = || ratios.iter().flatten();
    known().next()?;
    let without = known().any(|ratio| ratio.ci95.is_none());
    let entry = |ratio: &Option<Ratio>| {
        Entry::plain(match ratio {
            Some(Ratio {
                ratio,
                ci95: Some([low, high]),
            }) => format!("{ratio:.2} [{low:.2}, {high:.2}]"),
            Some(Ratio { ratio, ci95: None }) => format!("{ratio:.2}"),
            None => "-".to_owned(),
        })
    };
    let interval = if without { "" } else { " [95 %]" };
    let row = Row {
        label: format!("Time / that of {baseline}{interval}"),
        entries: ratios.iter().map(entry).collect(),
    };
    let note = without.then(|| {
        format!("ratios of times: no interval from fewer than {FEWEST_FOR_INTERVAL} pairs")
    });
    Some((row, note))
}

/// The ratio of the times of the cells `over` to those of `under`, pairs of all sources together; none
/// unless both ended well from the same sources.
fn paired(over: &[&Cell], under: &[&Cell]) -> Option<Ratio> {
    let (mut above, mut below) = (Vec::new(), Vec::new());
    if over.len() != under.len() {
        return None;
    }
    for over in over {
        let under = under.iter().find(|c| c.source == over.source)?;
        if over.time.samples.len() != under.time.samples.len() {
            return None;
        }
        above.extend_from_slice(&over.time.samples);
        below.extend_from_slice(&under.time.samples);
    }
    paired_ratio(&above, &below)
}

fn row(figure: &Figure, baseline: &str, algorithms: &[&str], cells: &[&Cell]) -> Row {
    let of = |model: &str, algorithm: &str| -> Vec<&Cell> {
        let cells = cells.iter().copied();
        cells
            .filter(|c| c.model == model && c.algorithm == algorithm)
            .collect()
    };
    let ratio = |model: &str, algorithm: &str| {
        let (over, under) = (of(model, algorithm), of(model, baseline));
        if figure.key == "time" {
            Some(paired(&over, &under)?.ratio)
        } else {
            // A figure that takes the model as well is not one to be compared.
            Some(overall(figure, &over, None)? / overall(figure, &under, None)?)
        }
    };
    let entry = |algorithm: &&str| {
        let ratios: Vec<f64> = models(cells)
            .into_iter()
            .filter_map(|model| ratio(model, algorithm))
            .filter(|ratio| ratio.is_finite())
            .collect();
        let n = ratios.len() as f64;
        let mean = ratios.iter().sum::<f64>() / n;
        let squares: f64 = ratios.iter().map(|r| (r - mean).powi(2)).sum();
        Entry {
            text: match ratios.len() {
                0 => "-".to_owned(),
                1 => format!("{mean:.2} / -"),
                _ => format!("{mean:.2} / {:.2}", (squares / (n - 1.0)).sqrt()),
            },
            best: false,
            failed: false,
        }
    };
    Row {
        label: figure.label.clone(),
        entries: algorithms.iter().map(entry).collect(),
    }
}
