//! CSV output: any table, and results with a row for each cell or each sample. Text that a
//! spreadsheet would take for a formula gets an apostrophe in front.

use std::collections::HashMap;

use csv::Writer;
use geobench_export::escape::csv_text;
use geobench_harness::schema::{Cell, ModelRecord, ResultFile};
use geobench_window::{Counter, Counters};
use serde_json::Value;

use crate::table::model::{Column, Entry, Table};

/// A table as CSV. The titles of its parts are in a first column, `Of`.
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

/// The columns of results before and after the counters, as JSON pointers into a cell.
const BEFORE_COUNTERS: &str = "/model /algorithm /source /goal /threads /approximate /status /message \
    /time/samples /time/median /time/min /time/mad /time/ci95 /time/note /time/setup /time/extraction \
    /time/outliers /time/places /time/solves /time/precision /time/outside /time/claimed /time/ping /time/doubted /time/unconfirmed";
const AFTER_COUNTERS: &str = "/memory/papers_bytes /memory/windows_peak_bytes /memory/heap_peak_bytes \
    /memory/rss_peak_bytes /phases/propagation /phases/pruning /phases/management /phases/samples \
    /check/reference /check/max_abs /check/max_rel /check/unreachable /check/compared \
    /check/worst_vertex /check/mean_rel /check/rms_rel /check/edge_excess /check/doubt /check/cluster \
    /check/wrong_labels /check/least_tolerance /check/proven /check/proof /check/replaced /group /instructions /instructions_simd /shard /simd";

/// The columns on the model and the machine of a cell.
const SURROUNDINGS: [&str; 4] = ["vertices", "faces", "edges", "machine"];

fn places() -> impl Iterator<Item = String> {
    let counters = Counter::ALL.iter().map(|counter| counter.key());
    let counters = counters.chain([Counters::WAVEFRONT_DEVIATION]);
    let places = |places: &'static str| places.split_whitespace().map(str::to_owned);
    places(BEFORE_COUNTERS)
        .chain(counters.map(|key| format!("/counters/{key}")))
        .chain(places(AFTER_COUNTERS))
}

/// The names of the columns of results: the JSON paths joined by `_`, then [`SURROUNDINGS`].
fn header() -> Vec<String> {
    let names = places().map(|place| place[1..].replace('/', "_"));
    names.chain(SURROUNDINGS.map(str::to_owned)).collect()
}

/// A row for each cell. `null` becomes an empty field, and the items of a list are joined by `;`.
pub(super) fn results(result: &ResultFile) -> anyhow::Result<Table> {
    let models = models(result);
    let row = |cell: &Cell| {
        let values = places().map(values(cell)?);
        let all = values.chain(surroundings(result, &models, cell));
        Ok(all.map(Entry::new).collect())
    };
    let rows: anyhow::Result<Vec<Vec<Entry>>> = result.cells.iter().map(row).collect();
    Ok(Table::new(Column::of(header(), [""; 0]), rows?))
}

/// A row for each sample, with its cell, model and machine.
pub(super) fn samples(result: &ResultFile) -> anyhow::Result<Table> {
    const OF_CELL: [&str; 6] = ["model", "algorithm", "source", "goal", "threads", "group"];
    let of_sample = ["sample", "place", "solves", "seconds"];
    let heads = OF_CELL.iter().chain(&of_sample).chain(&SURROUNDINGS);
    let models = models(result);
    let mut rows = Vec::new();
    for cell in &result.cells {
        let values = values(cell)?;
        let of_cell = OF_CELL.map(|name| values(format!("/{name}")));
        for i in 0..cell.time.samples.len() {
            let of_sample = [
                i.to_string(),
                values(format!("/time/places/{i}")),
                cell.time.solves.get(i).unwrap_or(&1).to_string(),
                values(format!("/time/samples/{i}")),
            ];
            let all = of_cell.iter().cloned().chain(of_sample);
            let all = all.chain(surroundings(result, &models, cell));
            rows.push(all.map(Entry::new).collect());
        }
    }
    Ok(Table::new(Column::of(heads, [""; 0]), rows))
}

/// The models by name; of several with one name the first.
fn models(result: &ResultFile) -> HashMap<&str, &ModelRecord> {
    let models = result.models.iter().rev();
    models.map(|model| (model.name.as_str(), model)).collect()
}

/// The values of [`SURROUNDINGS`] for a cell. The machine is its class, with the node in a cluster.
fn surroundings(
    result: &ResultFile,
    models: &HashMap<&str, &ModelRecord>,
    cell: &Cell,
) -> [String; 4] {
    let model = models.get(cell.model.as_str());
    let counts = model.map(|model| [model.vertices, model.faces, model.edges]);
    let [vertices, faces, edges] = counts
        .unwrap_or_default()
        .map(|count| count.map_or_else(String::new, |count| count.to_string()));
    let host = result.host_of(cell);
    let node = host.node.iter().map(|node| format!(", node {node}"));
    let machine = host.in_words() + &node.collect::<String>();
    [vertices, faces, edges, machine]
}

/// A function that returns the value at a JSON pointer into `cell`, as text.
fn values(cell: &Cell) -> anyhow::Result<impl Fn(String) -> String> {
    let cell = serde_json::to_value(cell)?;
    Ok(move |place: String| cell.pointer(&place).map_or_else(String::new, text))
}

/// A JSON value as text. Numbers have as many digits as needed to read them back exactly.
fn text(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(text).collect::<Vec<_>>().join(";"),
        Value::Number(number) if number.is_f64() => number.as_f64().unwrap_or_default().to_string(),
        other => other.to_string(),
    }
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
