//! `geobench info`.

use std::fmt::Write;

use geobench_mesh::{Report, Severity};

use super::Verdict;
use super::args::InfoOptions;
use super::terminal;
use crate::exec::model::{self, LoadedModel, ModelError, ModelRef};
use crate::measure::number::grouped;
use crate::table::escape::printable;

pub(super) fn info(options: &InfoOptions) -> anyhow::Result<Verdict> {
    let mut verdict = Verdict::Passed;
    for (i, model) in model::collect(&options.models)?.iter().enumerate() {
        if i > 0 {
            terminal::print("\n")?;
        }
        match model.load_within(options.reading) {
            Ok(loaded) => terminal::print(&describe(&loaded))?,
            Err(error) => {
                verdict = Verdict::BadInput;
                terminal::print(&describe_unusable(model, &error))?;
                terminal::error(&error.to_string());
            }
        }
    }
    Ok(verdict)
}

fn describe(loaded: &LoadedModel) -> String {
    let m = &loaded.measures;
    let mut text = heading(&loaded.record.name, &loaded.record.path);
    let counts = [
        ("vertices", m.vertices),
        ("faces", m.faces),
        ("edges", m.edges),
        ("boundary edges", m.boundary_edges),
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

/// Every kind of defect with its first elements, the fatal ones first.
fn defects(report: &Report) -> String {
    let summaries = report.summaries();
    if summaries.is_empty() {
        return "  defects              none\n".to_owned();
    }
    summaries.iter().fold(String::new(), |text, summary| {
        let severity = match summary.kind.severity() {
            Severity::Fatal => "fatal",
            Severity::Repaired => "repaired",
            Severity::Noted => "noted",
        };
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
