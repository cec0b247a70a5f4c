//! Compares the ratios of a paper with ours.

use geobench_harness::figures::Figure;
use geobench_harness::measure::number::counted;
use geobench_harness::measure::number::ratio as plain;
use geobench_harness::measure::statistics::range_of;

use super::{PaperTable, Printed};
use crate::page::chart::{Axis, Band, Chart, ChartPoint, Dots, Lane};
use crate::page::document::{Plot, SectionItem, slug};
use crate::page::setting::Setting;
use crate::table::group::{Estimate, GroupCells, distinct};
use crate::table::results::mean_and_deviation;
use crate::table::{Column, Entry, Part, Table};

/// The ratios of one figure between two algorithms, in the paper and here.
#[derive(Clone, Debug)]
struct Pair {
    figure: &'static Figure,
    algorithm: String,
    to: String,
    /// The paper's ratios.
    paper: Vec<Printed>,
    /// Our ratios, one for each model.
    ours: Vec<(String, Estimate)>,
}

/// A heading, a text, a table and plots of the ratios in `table` and in `group`, for the figures
/// and algorithms that both have; empty if there are none. The base of ratios is that of `setting`
/// if the table has it, else the last algorithm of the table.
pub(crate) fn compare(
    group: &GroupCells<'_>,
    table: &PaperTable,
    setting: Setting<'_>,
    prefix: &str,
) -> Vec<SectionItem> {
    let pairs = pairs(group, table, setting.base);
    if pairs.is_empty() {
        return Vec::new();
    }
    let source = format!("{}, {}", table.paper, table.table);
    let same = same_models(group, &pairs);
    let mut text = format!(
        "Ratios between algorithms in {source} and here. Machines and programs differ, so times themselves are \
         not compared."
    );
    text += &match &same[..] {
        [] => " No model is the paper's own; ranges are over different models.".to_owned(),
        [(paper, ours)] => format!(" {paper} is the same model as {ours} here, by name and size."),
        several => {
            let names: Vec<String> = several.iter().map(|(p, o)| format!("{p} ({o})")).collect();
            format!(" The same models, by name and size: {}.", names.join(", "))
        }
    };
    vec![
        SectionItem::Heading(format!("Beside {source}")),
        SectionItem::Text(text),
        SectionItem::Table(side_by_side(&pairs, &same, &source, prefix)),
        SectionItem::Plots(plots(&pairs, setting, &source, prefix)),
    ]
}

/// All ratios that both the paper's table and the group have.
fn pairs(group: &GroupCells<'_>, table: &PaperTable, base: Option<&str>) -> Vec<Pair> {
    let measured = || table.printed.iter().filter(|row| row.to.is_none());
    let last = measured().next_back().map(|row| row.algorithm.as_str());
    let base = base.filter(|base| measured().any(|row| row.algorithm == *base));
    let base = base.or(last);
    let ratio = |row: &Printed| {
        if row.to.is_some() {
            return Some(row.clone());
        }
        let base = base.filter(|base| row.algorithm != *base)?;
        let under = measured().find(|other| {
            other.algorithm == base
                && other.model == row.model
                && other.figure.key == row.figure.key
        })?;
        Some(Printed {
            to: Some(base.to_owned()),
            value: row.value / under.value,
            ..row.clone()
        })
    };
    let mut pairs: Vec<Pair> = Vec::new();
    for printed in table.printed.iter().filter_map(ratio) {
        let to = printed.to.clone().unwrap_or_default();
        let found = pairs.iter_mut().find(|pair| {
            pair.figure.key == printed.figure.key
                && pair.algorithm == printed.algorithm
                && pair.to == to
        });
        match found {
            Some(pair) => pair.paper.push(printed),
            None => pairs.push(Pair {
                figure: printed.figure,
                algorithm: printed.algorithm.clone(),
                to,
                paper: vec![printed],
                ours: Vec::new(),
            }),
        }
    }
    for pair in &mut pairs {
        let models = group.models.iter();
        pair.ours = models
            .filter_map(|model| {
                let ratio = group.ratio(pair.figure, &model.name, &pair.algorithm, &pair.to)?;
                Some((model.name.clone(), ratio))
            })
            .collect();
    }
    pairs.retain(|pair| !pair.ours.is_empty());
    // Sorted by figure; within a figure, algorithms stay in the paper's order.
    let order = distinct(pairs.iter().map(|pair| pair.figure.key));
    pairs.sort_by_key(|pair| order.iter().position(|key| *key == pair.figure.key));
    pairs
}

/// The paper's models that the group also has: the paper's name and ours. Models match if our name
/// contains the paper's, in any letter case, and the numbers of faces differ by at most 1 %.
fn same_models(group: &GroupCells<'_>, pairs: &[Pair]) -> Vec<(String, String)> {
    let found = |known: &Printed| {
        let (faces, name) = (known.faces?, known.model.to_lowercase());
        let model = group.models.iter().find(|model| {
            let close = |ours: u64| ours.abs_diff(faces) * 100 <= faces;
            model.name.to_lowercase().contains(&name) && model.faces.is_some_and(close)
        })?;
        Some((known.model.clone(), model.name.clone()))
    };
    let known = pairs.iter().flat_map(|pair| &pair.paper);
    let mut same: Vec<(String, String)> = Vec::new();
    for pair in known.filter_map(found) {
        if same.iter().all(|(paper, _)| *paper != pair.0) {
            same.push(pair);
        }
    }
    same
}

fn side_by_side(pairs: &[Pair], same: &[(String, String)], source: &str, prefix: &str) -> Table {
    let column = |over: &str, head: &str| Column {
        over: over.to_owned(),
        ..Column::number(head)
    };
    let mut columns = vec![
        Column::text("Ratio"),
        column("mean", "paper"),
        column("mean", "here"),
        column("least to greatest", "paper"),
        column("least to greatest", "here"),
    ];
    for (paper, _) in same {
        columns.extend([column(paper, "paper"), column(paper, "here")]);
    }
    let row = |pair: &Pair| {
        let paper: Vec<f64> = pair.paper.iter().map(|known| known.value).collect();
        let ours: Vec<f64> = pair.ours.iter().map(|(_, ratio)| ratio.value).collect();
        let printed = match &pair.paper[..] {
            [
                Printed {
                    deviation: Some(deviation),
                    value,
                    ..
                },
            ] => {
                format!("{} \u{b1} {}", plain(*value), plain(*deviation))
            }
            _ => mean(&paper),
        };
        let mut row = vec![
            format!("{} / {}", pair.algorithm, pair.to),
            printed,
            mean(&ours),
            range(&paper),
            range(&ours),
        ];
        for (theirs, name) in same {
            let printed = pair.paper.iter().find(|known| known.model == *theirs);
            let found = pair.ours.iter().find(|(model, _)| model == name);
            row.push(printed.map_or_else(|| "-".to_owned(), |known| plain(known.value)));
            row.push(found.map_or_else(|| "-".to_owned(), |(_, ratio)| plain(ratio.value)));
        }
        row.into_iter().map(Entry::new).collect()
    };
    let mut parts: Vec<Part> = Vec::new();
    for pair in pairs {
        let title = without_unit(&pair.figure.label).to_owned();
        match parts.last_mut().filter(|part| part.title == title) {
            Some(part) => part.rows.push(row(pair)),
            None => parts.push(Part {
                title,
                detail: models(pair),
                rows: vec![row(pair)],
                ..Part::default()
            }),
        }
    }
    Table {
        id: format!("{prefix}-table"),
        caption: format!(
            "Ratios in {source} and here; means with the standard deviation over models."
        ),
        columns,
        parts,
        ..Table::default()
    }
}

/// The numbers of models in the paper and here, in words.
fn models(pair: &Pair) -> String {
    let paper = match &pair.paper[..] {
        [one] => one.model.clone(),
        several => counted(several.len(), "model"),
    };
    format!(
        "paper: {paper}; here: {}",
        counted(pair.ours.len(), "model")
    )
}

fn mean(values: &[f64]) -> String {
    match mean_and_deviation(values) {
        None => "-".to_owned(),
        Some((mean, None)) => plain(mean),
        Some((mean, Some(deviation))) => format!("{} \u{b1} {}", plain(mean), plain(deviation)),
    }
}

fn range(values: &[f64]) -> String {
    match range_of(values.iter().copied()) {
        Some([least, most]) if values.len() > 1 => format!("{} to {}", plain(least), plain(most)),
        _ => "-".to_owned(),
    }
}

/// A plot for each figure, because the ratios of different figures have different magnitudes.
fn plots(pairs: &[Pair], setting: Setting<'_>, source: &str, prefix: &str) -> Vec<Plot> {
    let of_figure = pairs.chunk_by(|a, b| a.figure.key == b.figure.key);
    of_figure
        .map(|pairs| plot(pairs, setting, source, prefix))
        .collect()
}

fn plot(pairs: &[Pair], setting: Setting<'_>, source: &str, prefix: &str) -> Plot {
    let figure = pairs[0].figure;
    let name = without_unit(&figure.label);
    Plot {
        id: format!("{prefix}-{}", slug(figure.key)),
        title: format!("{name}: ratios in {source} and here"),
        caption: "Logarithmic scale. Outlines: the paper's models, or its mean with the standard deviation; filled: \
                  the models here."
            .to_owned(),
        chart: Chart::Dots(Dots {
            axis: Axis::log(format!("{name}, ratio")),
            reference: Some(1.0),
            bands: vec![Band {
                title: String::new(),
                lanes: pairs.iter().map(|pair| lane(pair, setting)).collect(),
            }],
            legend: vec![(0, true, "paper".to_owned()), (0, false, "here".to_owned())],
        }),
    }
}

/// The lane of a pair, with a point for each of the paper's models and of ours.
fn lane(pair: &Pair, setting: Setting<'_>) -> Lane {
    let style = setting.style(&pair.algorithm);
    let paper = pair.paper.iter().map(|known| ChartPoint {
        style,
        name: format!("paper, {}", known.model),
        model: None,
        algorithm: None,
        value: Estimate {
            value: known.value,
            // The lower end must be above 0 on the logarithmic axis, also if the deviation exceeds
            // the mean.
            interval: known
                .deviation
                .map(|d| [(known.value - d).max(known.value / 10.0), known.value + d]),
        },
        hollow: true,
    });
    // Our intervals are left out, because they would overlap.
    let ours = pair.ours.iter().map(|(model, ratio)| ChartPoint {
        style,
        name: format!("here, {model}"),
        model: Some(model.clone()),
        algorithm: None,
        value: ratio.value.into(),
        hollow: false,
    });
    Lane {
        label: format!("{} / {}", pair.algorithm, pair.to),
        points: paper.chain(ours).collect(),
        ..setting.lane(&pair.algorithm)
    }
}

/// The name of a figure without its unit. Ratios have none.
fn without_unit(label: &str) -> &str {
    label.split(" (").next().unwrap_or(label)
}
