//! `geobench info`.

use std::fmt::Write;

use clap::Args;
use geobench_export::escape::printable;
use geobench_export::json_lines;
use geobench_harness::exec::model::{LoadedModel, ModelError, ModelRef};
use geobench_harness::measure::number::grouped;
use geobench_mesh::{DefectSummary, Report, Severity};
use serde_json::{Value, json};

use crate::args::{FormatOption, ListFormat, MODELS_HELP};
use crate::isolation::ReadingOptions;
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
pub(crate) struct InfoOptions {
    /// Models
    #[arg(value_name = "MODEL", required = true)]
    pub(crate) models: Vec<String>,

    #[command(flatten)]
    pub(crate) reading: ReadingOptions,

    #[command(flatten)]
    pub(crate) format: FormatOption<ListFormat>,
}

pub(crate) fn info(options: &InfoOptions) -> anyhow::Result<Verdict> {
    let mut verdict = Verdict::Passed;
    let mut list = Vec::new();
    let as_json = options.format.chosen() == ListFormat::Json;
    for (i, model) in options.reading.models(&options.models)?.iter().enumerate() {
        if as_json {
            let loaded = model.load(&options.reading);
            if let Err(error) = &loaded {
                verdict = Verdict::BadInput;
                terminal::error(&error.to_string());
            }
            list.push(in_json(model, &loaded));
            continue;
        }
        if i > 0 {
            terminal::print("\n")?;
        }
        match model.load(&options.reading) {
            Ok(loaded) => terminal::print(&describe(&loaded))?,
            Err(error) => {
                verdict = Verdict::BadInput;
                terminal::print(&describe_unusable(model, &error))?;
                terminal::error(&error.to_string());
            }
        }
    }
    if as_json {
        terminal::print_rendered(&json_lines(&list)?)?;
    }
    Ok(verdict)
}

/// A model as a JSON object: its record as in result files, further measures, and its defects. For
/// a model that cannot be used, `usable` is false and `error` is the reason.
fn in_json(model: &ModelRef, loaded: &Result<LoadedModel, ModelError>) -> Value {
    let defects = |report: &Report| -> Vec<Value> {
        let summaries = report.summaries();
        let defect = |summary: &DefectSummary| {
            json!({
                "severity": severity(summary.kind.severity()),
                "text": summary.text,
                "advice": Some(&summary.advice).filter(|advice| !advice.is_empty()),
            })
        };
        summaries.iter().map(defect).collect()
    };
    let (record, further) = match loaded {
        Ok(loaded) => {
            let m = &loaded.measures;
            let further = json!({
                "usable": true,
                "boundary_loops": m.boundary_loops,
                "isolated_vertices": m.isolated_vertices,
                "pinched_vertices": m.pinched_vertices,
                "flat_faces": m.flat_faces,
                "euler_characteristic": m.euler_characteristic,
                "edge_length": {
                    "min": m.min_edge_length,
                    "mean": m.mean_edge_length,
                    "max": m.max_edge_length,
                },
                "area": m.area,
                "bounding_box": m.bounding_box,
                "defects": defects(&loaded.report),
            });
            (loaded.record.clone(), further)
        }
        Err(error) => {
            let defects = match error {
                ModelError::Invalid { error, .. } => defects(&error.report),
                _ => Vec::new(),
            };
            let further = json!({
                "usable": false,
                "error": error.to_string(),
                "defects": defects,
            });
            (model.record(), further)
        }
    };
    let mut all = json!(record);
    if let (Some(all), Value::Object(further)) = (all.as_object_mut(), further) {
        all.extend(further);
    }
    all
}

const fn severity(severity: Severity) -> &'static str {
    match severity {
        Severity::Fatal => "fatal",
        Severity::Repaired => "repaired",
        Severity::Noted => "noted",
    }
}

fn describe(loaded: &LoadedModel) -> String {
    let m = &loaded.measures;
    let mut text = heading(&loaded.record.name, &loaded.record.path);
    let counts = [
        ("vertices", m.vertices),
        ("faces", m.faces),
        ("edges", m.edges),
        ("boundary edges", m.boundary_edges),
        ("junctions", m.junctions),
        ("boundary loops", m.boundary_loops),
        ("components", m.components),
        ("genus", m.genus),
        ("saddle vertices", m.saddles),
        ("isolated vertices", m.isolated_vertices),
        ("pinched vertices", m.pinched_vertices),
        ("faces without area", m.flat_faces),
    ];
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<20} {value}"); // Writing to a string cannot fail.
    };
    for (name, count) in counts {
        line(name, grouped(count as u64));
    }
    line("Euler characteristic", m.euler_characteristic.to_string());
    line("anisotropy g", format!("{:.4}", m.anisotropy));
    line(
        "edge lengths",
        format!(
            "{:.6e} to {:.6e}, mean {:.6e}",
            m.min_edge_length, m.max_edge_length, m.mean_edge_length
        ),
    );
    line("area", format!("{:.6e}", m.area));
    if let Some([low, high]) = m.bounding_box {
        line("bounding box", format!("{} to {}", point(low), point(high)));
    }
    text += &defects(&loaded.report);
    text
}

fn heading(name: &str, path: &str) -> String {
    format!("{}  ({})\n", printable(name), printable(path))
}

fn describe_unusable(model: &ModelRef, error: &ModelError) -> String {
    let mut text = heading(&model.name, &model.path);
    match error {
        ModelError::Invalid { error, .. } => text += &defects(&error.report),
        _ => text += "  cannot be read\n",
    }
    text
}

/// One line for each kind of defect, with its first elements. Fatal defects come first.
fn defects(report: &Report) -> String {
    let summaries = report.summaries();
    if summaries.is_empty() {
        return "  defects              none\n".to_owned();
    }
    summaries.iter().fold(String::new(), |text, summary| {
        let severity = severity(summary.kind.severity());
        let advice = match summary.advice.as_str() {
            "" => String::new(),
            advice => format!("; {advice}"),
        };
        text + &format!("  defect ({severity}): {}{advice}\n", summary.text)
    })
}

fn point(p: [f64; 3]) -> String {
    let [x, y, z] = p.map(|c| format!("{c}"));
    format!("({x}, {y}, {z})")
}
