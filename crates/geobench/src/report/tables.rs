//! The tables of a group and of its models.

use super::document::{Column, Entry, Mark, Note, Table, TablePart};
use crate::measure::number::grouped;
use crate::schema::{ModelRecord, ResultFile};
use crate::table::view::{self, ModelView, Section};

/// The figures of a group: a part for each model, a column for each algorithm.
pub(crate) fn figures(id: &str, section: &Section<'_>) -> Table {
    let columns = section.algorithms.iter().map(|name| Column::number(name));
    Table {
        id: id.to_owned(),
        caption: "Figures of each algorithm; the best of a row is bold. Columns are algorithms."
            .to_owned(),
        columns: std::iter::once(Column::text("Figure"))
            .chain(columns)
            .collect(),
        parts: section
            .views
            .iter()
            .map(|view| part(view, &section.algorithms))
            .collect(),
    }
}

fn part(view: &ModelView<'_>, algorithms: &[&str]) -> TablePart {
    let row = |row: &view::Row| {
        let label = if row.label.is_empty() {
            // The one row of a model that was refused.
            Entry::new("All figures")
        } else {
            Entry::new(&row.label)
        };
        let entries = algorithms.iter().map(|name| match view.entry(row, name) {
            Some(entry) => Entry {
                text: entry.text.clone(),
                mark: match (entry.best, entry.failed) {
                    (true, _) => Mark::Best,
                    (_, true) => Mark::Failed,
                    _ => Mark::None,
                },
            },
            None => Entry::default(),
        });
        std::iter::once(label).chain(entries).collect()
    };
    // Of a refused model the sources say nothing.
    let sources = if view.refused {
        ""
    } else {
        view.sources.as_str()
    };
    let details = [view.size.as_str(), sources];
    let details: Vec<&str> = details.into_iter().filter(|d| !d.is_empty()).collect();
    TablePart {
        title: view.name.clone(),
        detail: details.join("; "),
        rows: view.rows.iter().map(row).collect(),
    }
}

/// What a reader must know beside the figures: checks and failures.
pub(crate) fn notes(section: &Section<'_>) -> Vec<Note> {
    let mut notes = Vec::new();
    for view in &section.views {
        for text in &view.notes {
            let failure = view.refused || is_failure(view, text);
            let text = format!("{}: {text}", view.name);
            notes.push(Note { text, failure });
        }
    }
    notes.sort_by_key(|note| !note.failure);
    notes
}

/// Whether a note is on an algorithm that failed.
fn is_failure(view: &ModelView<'_>, note: &str) -> bool {
    view.algorithms.iter().any(|name| {
        let failed = view
            .rows
            .iter()
            .any(|row| view.entry(row, name).is_some_and(|e| e.failed));
        failed
            && note
                .strip_prefix(name)
                .is_some_and(|rest| rest.starts_with([',', ':']))
    })
}

/// What is known of the models.
pub(crate) fn models(id: &str, result: &ResultFile) -> Table {
    type Of = fn(&ModelRecord) -> Option<String>;
    let columns: [(&str, Of); 11] = [
        ("Vertices", |m| m.vertices.map(grouped)),
        ("Faces", |m| m.faces.map(grouped)),
        ("Edges", |m| m.edges.map(grouped)),
        ("Boundary edges", |m| m.boundary_edges.map(grouped)),
        ("Components", |m| m.components.map(grouped)),
        ("Genus", |m| m.genus.map(grouped)),
        ("Saddles", |m| m.saddles.map(grouped)),
        ("Anisotropy g", |m| m.anisotropy.map(|g| format!("{g:.3}"))),
        ("Load (s)", |m| m.load_seconds.map(|s| format!("{s:.3}"))),
        ("Build (s)", |m| m.build_seconds.map(|s| format!("{s:.3}"))),
        ("SHA-256", |m| {
            Some(m.sha256.as_ref()?.chars().take(12).collect())
        }),
    ];
    let row = |model: &ModelRecord| {
        let values = columns
            .iter()
            .map(|(_, of)| Entry::new(of(model).unwrap_or_else(|| "-".into())));
        let mut row = vec![Entry::new(&model.name)];
        row.extend(values);
        row.push(Entry::new(&model.path));
        row
    };
    let heads = columns.iter().map(|(head, _)| match *head {
        "SHA-256" => Column::text(head),
        _ => Column::number(head),
    });
    Table {
        id: id.to_owned(),
        caption: "Models: counts as read, g as in the papers (1 for equilateral faces), the start of the hash."
            .to_owned(),
        columns: std::iter::once(Column::text("Model"))
            .chain(heads)
            .chain(std::iter::once(Column::text("File or generator")))
            .collect(),
        parts: vec![TablePart {
            rows: result.models.iter().map(row).collect(),
            ..TablePart::default()
        }],
    }
}
