//! The tables of a group and of its models.

use crate::measure::number::grouped;
use crate::schema::{ModelRecord, ResultFile};
use crate::table::group::Group;
use crate::table::{Column, Entry, Note, Table, results};

/// The figures of a group: a part for each model, a column for each algorithm.
pub(crate) fn figures(id: &str, group: &Group<'_>) -> Table {
    let mut table = Table {
        id: id.to_owned(),
        title: String::new(),
        caption: "Figures of each algorithm; the best of a row is bold. Columns are algorithms."
            .to_owned(),
        titles: None,
        ..results::table(group)
    };
    "Figure".clone_into(&mut table.columns[0].head);
    for part in table.parts.iter_mut().filter(|part| part.refused) {
        for row in &mut part.rows {
            "All figures".clone_into(&mut row[0].text);
        }
    }
    table
}

/// The notes of `table`: failures, then checks.
pub(crate) fn notes(table: &Table) -> Vec<Note> {
    let parts = table.parts.iter();
    let notes = parts.flat_map(|part| part.notes.iter().map(|note| (&part.title, note)));
    let mut notes: Vec<Note> = notes
        .map(|(title, note)| Note {
            text: format!("{title}: {}", note.text),
            failure: note.failure,
        })
        .collect();
    notes.sort_by_key(|note| !note.failure);
    notes
}

/// The properties of the models.
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
        let values = columns.iter().map(|(_, of)| of(model));
        let values = values.map(|value| Entry::new(value.unwrap_or_else(|| "-".into())));
        let name = Entry::new(&model.name);
        std::iter::once(name)
            .chain(values)
            .chain([Entry::new(&model.path)])
            .collect()
    };
    let heads = columns.iter().map(|(head, _)| match *head {
        "SHA-256" => Column::text(head),
        _ => Column::number(head),
    });
    let heads = std::iter::once(Column::text("Model")).chain(heads);
    Table {
        id: id.to_owned(),
        caption: "Models: counts as read, g as in the papers (1 for equilateral faces), the start of the hash."
            .to_owned(),
        ..Table::new(
            heads.chain([Column::text("File or generator")]).collect(),
            result.models.iter().map(row).collect(),
        )
    }
}
