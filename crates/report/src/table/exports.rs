//! Exports of results for services that track benchmarks over commits.

use geobench_export::escape::printable;
use geobench_harness::measure::number::counted;
use geobench_harness::schema::{Cell, ResultFile, Status};
use serde_json::{Map, Value, json};

use crate::history::compare::{CellKeys, Measure};

/// The figures that are exported in addition to the time, with their exported name and unit.
const FIGURES: [(&str, &str, &str); 3] = [
    ("instructions", "instructions", "instructions"),
    ("heap_peak_bytes", "heap-peak", "bytes"),
    ("propagated", "propagations", "windows"),
];

/// Nanoseconds per second.
const NANOSECONDS: f64 = 1e9;

/// The cells, each with its name, which has no characters that control a terminal or turn text
/// around.
fn cells(result: &ResultFile) -> impl Iterator<Item = (String, &Cell)> {
    let keys = CellKeys::of(result);
    let cells = result.cells.iter();
    cells.map(move |cell| (printable(&keys.key(cell).to_string()).into_owned(), cell))
}

/// The most characters of a name in Bencher.
const LONGEST_NAME: usize = 1024;

/// The measure of a cell that failed, whose value is 1. Others do not have it.
const FAILED: &str = "failed";

/// The exported figures of a cell: name, unit and value.
fn figures(cell: &Cell) -> impl Iterator<Item = (&'static str, &'static str, f64)> {
    Measure::all().filter_map(|measure| {
        let (_, name, unit) = FIGURES.iter().find(|(key, ..)| *key == measure.name())?;
        Some((*name, *unit, measure.of(cell)?))
    })
}

/// Bencher Metric Format: benchmarks by name, with their measures. `latency` is in nanoseconds.
pub(super) fn bencher(result: &ResultFile) -> Value {
    let mut all = Map::new();
    for (mut name, cell) in cells(result) {
        // The end names the algorithm and the source.
        let characters = name.chars().count();
        if characters > LONGEST_NAME {
            let rest = name.chars().skip(characters - LONGEST_NAME + 3);
            name = "...".chars().chain(rest).collect();
        }
        let mut measures = Map::new();
        if cell.status != Status::Ok {
            measures.insert(FAILED.to_owned(), json!({"value": 1}));
            all.insert(name, Value::Object(measures));
            continue;
        }
        if let Some(median) = cell.time.median {
            let mut latency = json!({"value": median * NANOSECONDS});
            if let Some([low, high]) = cell.time.ci95 {
                latency["lower_value"] = (low * NANOSECONDS).into();
                latency["upper_value"] = (high * NANOSECONDS).into();
            }
            measures.insert("latency".to_owned(), latency);
        }
        for (figure, _, value) in figures(cell) {
            measures.insert(figure.to_owned(), json!({"value": value}));
        }
        all.insert(name, Value::Object(measures));
    }
    Value::Object(all)
}

/// The list that github-action-benchmark reads with `tool: customSmallerIsBetter`. It posts names
/// as code in a table in Markdown, without escapes, so that they have neither backticks nor bars.
pub(super) fn github_action(result: &ResultFile) -> Value {
    let mut all = Vec::new();
    for (name, cell) in cells(result) {
        let name = name.replace('`', "'").replace('|', "/");
        if cell.status != Status::Ok {
            let message = cell.message.as_deref().unwrap_or_default();
            let why = format!("{}: {message}", cell.status.in_words());
            all.push(json!({
                "name": format!("{name}, {FAILED}"), "unit": FAILED, "value": 1, "extra": why,
            }));
            continue;
        }
        if let Some(median) = cell.time.median {
            let mut entry = json!({"name": name, "unit": "s", "value": median});
            if let Some(width) = cell.time.half_width() {
                entry["range"] = format!("± {}", width * median).into();
            }
            entry["extra"] = counted(cell.time.samples.len(), "sample").into();
            all.push(entry);
        }
        for (figure, unit, value) in figures(cell) {
            all.push(json!({"name": format!("{name}, {figure}"), "unit": unit, "value": value}));
        }
    }
    Value::Array(all)
}
