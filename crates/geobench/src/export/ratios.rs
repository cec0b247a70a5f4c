//! Ratios between algorithms over all models of a group, as in Table 2 of Qin et al. 2016.

use super::figures::{Figure, figures};
use super::grid::Entry;
use super::view::{ModelView, Row, algorithms, overall};
use crate::record::{Cell, GroupRecord};

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

fn models<'r>(cells: &[&'r Cell]) -> Vec<&'r str> {
    let mut models: Vec<&str> = Vec::new();
    for cell in cells {
        if !models.contains(&cell.model.as_str()) {
            models.push(&cell.model);
        }
    }
    models
}

fn row(figure: &Figure, baseline: &str, algorithms: &[&str], cells: &[&Cell]) -> Row {
    let value = |model: &str, algorithm: &str| {
        let cells: Vec<&Cell> = cells
            .iter()
            .copied()
            .filter(|c| c.model == model && c.algorithm == algorithm)
            .collect();
        overall(figure, &cells)
    };
    let entry = |algorithm: &&str| {
        let ratios: Vec<f64> = models(cells)
            .into_iter()
            .filter_map(|model| Some(value(model, algorithm)? / value(model, baseline)?))
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
