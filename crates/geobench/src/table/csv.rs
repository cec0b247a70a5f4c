//! CSV: any table, and results with a row for each cell. A text that a spreadsheet would take for a
//! formula has an apostrophe before it.

use std::fmt::Display;

use csv::Writer;
use geobench_window::Counters;

use super::escape::csv_text;
use super::model::{Column, Entry, Table};
use crate::schema::{Cell, Host, ResultFile};

/// A table, the titles of its parts in a column of their own.
pub(crate) fn table(table: &Table) -> anyhow::Result<String> {
    let titled = table.parts.iter().any(|part| !part.title.is_empty());
    let mut writer = Writer::from_writer(Vec::new());
    let heads = table.columns.iter().map(|column| {
        let heads = [column.over.as_str(), column.head.as_str()].into_iter();
        let heads: Vec<&str> = heads.filter(|head| !head.is_empty()).collect();
        heads.join(", ")
    });
    let heads: Vec<String> = titled
        .then(|| "Of".to_owned())
        .into_iter()
        .chain(heads)
        .collect();
    writer.write_record(heads.iter().map(|head| csv_text(head).into_owned()))?;
    for part in &table.parts {
        let title = titled.then_some(part.title.as_str());
        for row in &part.rows {
            let texts = title.into_iter().chain(row.iter().map(|e| e.text.as_str()));
            writer.write_record(texts.map(|text| csv_text(text).into_owned()))?;
        }
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

/// A row for each cell. A column is named after its place in the JSON file, joined by `_`; `null`
/// is an empty field, and a list is joined by `;`. The last columns are those of the model and the
/// machine.
pub(super) fn results(result: &ResultFile) -> Table {
    let row = |cell: &Cell| {
        let of_cell = columns(cell).into_iter().map(|(_, value)| value);
        of_cell.chain(surroundings(result, cell)).map(Entry::new)
    };
    Table::new(
        header().iter().map(|name| Column::text(name)).collect(),
        result
            .cells
            .iter()
            .map(|cell| row(cell).collect())
            .collect(),
    )
}

/// A row for each sample, with the cell, the model and the machine that it belongs to.
pub(super) fn samples(result: &ResultFile) -> Table {
    const COLUMNS: [&str; 9] = [
        "model",
        "algorithm",
        "source",
        "goal",
        "threads",
        "group",
        "sample",
        "place",
        "solves",
    ];
    let heads = COLUMNS.iter().chain(&["seconds"]).chain(&SURROUNDINGS);
    let rows = result.cells.iter().flat_map(|cell| {
        cell.time
            .samples
            .iter()
            .enumerate()
            .map(move |(i, seconds)| {
                let own = [
                    cell.model.clone(),
                    cell.algorithm.clone(),
                    text(cell.source.as_ref()),
                    text(cell.goal.as_ref()),
                    cell.threads.to_string(),
                    text(cell.group.as_ref()),
                    i.to_string(),
                    text(cell.time.places.get(i)),
                    cell.time.solves.get(i).unwrap_or(&1).to_string(),
                    seconds.to_string(),
                ];
                let all = own.into_iter().chain(surroundings(result, cell));
                all.map(Entry::new).collect()
            })
    });
    Table::new(
        heads.map(|name| Column::text(name)).collect(),
        rows.collect(),
    )
}

/// The columns of the model and the machine of a cell.
const SURROUNDINGS: [&str; 4] = ["vertices", "faces", "edges", "machine"];

/// Their values.
fn surroundings(result: &ResultFile, cell: &Cell) -> [String; 4] {
    let model = result.models.iter().find(|model| model.name == cell.model);
    [
        text(model.and_then(|model| model.vertices)),
        text(model.and_then(|model| model.faces)),
        text(model.and_then(|model| model.edges)),
        machine(result.host_of(cell)),
    ]
}

/// The class of the machine, and its name in a cluster.
fn machine(host: &Host) -> String {
    let class = host.in_words();
    match &host.node {
        Some(node) => format!("{class}, node {node}"),
        None => class,
    }
}

/// The names of the columns of results.
pub fn header() -> Vec<String> {
    let nothing = Cell::new("", "");
    let of_cell = columns(&nothing).into_iter().map(|(name, _)| name);
    of_cell.chain(SURROUNDINGS.map(str::to_owned)).collect()
}

/// Name and value of every column.
fn columns(cell: &Cell) -> Vec<(String, String)> {
    let mut columns: Vec<(String, String)> = [
        ("model", cell.model.clone()),
        ("algorithm", cell.algorithm.clone()),
        ("source", text(cell.source.as_ref())),
        ("goal", text(cell.goal.as_ref())),
        ("threads", cell.threads.to_string()),
        ("approximate", cell.approximate.to_string()),
        ("status", cell.status.name().to_owned()),
        ("message", text(cell.message.as_ref())),
        ("time_samples", list(&cell.time.samples)),
        ("time_median", text(cell.time.median)),
        ("time_min", text(cell.time.min)),
        ("time_mad", text(cell.time.mad)),
        (
            "time_ci95",
            cell.time.ci95.map_or_else(String::new, |ci| list(&ci)),
        ),
        ("time_note", text(cell.time.note.as_ref())),
        ("time_setup", text(cell.time.setup)),
        ("time_extraction", text(cell.time.extraction)),
        ("time_outliers", text(cell.time.outliers)),
        ("time_places", list(&cell.time.places)),
        ("time_solves", list(&cell.time.solves)),
        ("time_precision", text(cell.time.precision)),
        ("time_outside", list(&cell.time.outside)),
        ("time_claimed", list(&cell.time.claimed)),
        ("time_doubted", cell.time.doubted.to_string()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    columns.extend(
        cell.counters
            .iter()
            .map(|(counter, count)| (format!("counters_{}", counter.key()), text(count))),
    );
    columns.push((
        format!("counters_{}", Counters::WAVEFRONT_DEVIATION),
        text(cell.counters.wavefront_deviation),
    ));
    columns.extend(
        [
            ("memory_papers_bytes", text(cell.memory.papers_bytes)),
            (
                "memory_windows_peak_bytes",
                text(cell.memory.windows_peak_bytes),
            ),
            ("memory_heap_peak_bytes", text(cell.memory.heap_peak_bytes)),
            ("memory_rss_peak_bytes", text(cell.memory.rss_peak_bytes)),
            ("phases_propagation", text(cell.phases.propagation)),
            ("phases_pruning", text(cell.phases.pruning)),
            ("phases_management", text(cell.phases.management)),
            ("phases_samples", text(cell.phases.samples)),
            ("check_reference", text(cell.check.reference.as_ref())),
            ("check_max_abs", text(cell.check.max_abs)),
            ("check_max_rel", text(cell.check.max_rel)),
            ("check_unreachable", text(cell.check.unreachable)),
            ("check_compared", text(cell.check.compared)),
            ("check_worst_vertex", text(cell.check.worst_vertex)),
            ("check_mean_rel", text(cell.check.mean_rel)),
            ("check_rms_rel", text(cell.check.rms_rel)),
            ("check_edge_excess", text(cell.check.edge_excess)),
            ("check_doubt", text(cell.check.doubt)),
            ("check_cluster", text(cell.check.cluster)),
            ("check_wrong_labels", text(cell.check.wrong_labels)),
            ("group", text(cell.group.as_ref())),
            ("instructions", text(cell.instructions)),
            ("instructions_simd", text(cell.instructions_simd.as_ref())),
            ("shard", text(cell.shard)),
            ("simd", text(cell.simd.as_ref())),
        ]
        .map(|(name, value)| (name.to_owned(), value)),
    );
    columns
}

/// The text, or the number with as many digits as reading it back exactly takes.
fn text(value: Option<impl Display>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

fn list(values: &[impl Display]) -> String {
    let values: Vec<String> = values.iter().map(ToString::to_string).collect();
    values.join(";")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names of all leaves, joined by `_`.
    fn leaves(prefix: &str, value: &serde_json::Value, names: &mut Vec<String>) {
        match value {
            serde_json::Value::Object(map) => {
                for (key, value) in map {
                    let name = if prefix.is_empty() {
                        key.clone()
                    } else {
                        format!("{prefix}_{key}")
                    };
                    leaves(&name, value, names);
                }
            }
            _ => names.push(prefix.to_owned()),
        }
    }

    #[test]
    fn the_columns_are_the_fields_of_the_json_file() {
        let cell = serde_json::to_value(Cell::new("m", "a")).unwrap();
        let (mut fields, mut columns) = (Vec::new(), header());
        leaves("", &cell, &mut fields);
        fields.extend(SURROUNDINGS.map(str::to_owned));
        fields.sort_unstable();
        columns.sort_unstable();
        assert_eq!(columns, fields);
    }
}
