//! The table of the figures of a group, its notes, and the table of models.

use geobench_harness::measure::number::{grouped, seconds};
use geobench_harness::schema::{ModelRecord, ResultFile};

use crate::table::group::{GroupCells, by_key, distinct};
use crate::table::{Column, Entry, Mark, Note, Part, Table, results};

/// The table of the figures of a group: a part for each model, a column for each algorithm.
pub(crate) fn figures(id: &str, group: &GroupCells<'_>) -> Table {
    let mut table = Table {
        id: id.to_owned(),
        title: String::new(),
        caption: "Time, work and memory of each algorithm on each model; the best is bold."
            .to_owned(),
        titles: None,
        ..results::table(group)
    };
    "Quantity".clone_into(&mut table.columns[0].head);
    for part in table.parts.iter_mut().filter(|part| part.refused) {
        for row in &mut part.rows {
            "All".clone_into(&mut row[0].text);
        }
    }
    table
}

/// `table` transposed: a row for each algorithm and a column for each quantity. This is narrow
/// enough for pages, and rows can be sorted by a quantity.
pub(crate) fn by_algorithm(table: &Table) -> Table {
    let parts = || table.parts.iter();
    let labels = |part: &Part| -> Vec<String> {
        let rows = part.rows.iter().filter(|_| !part.refused);
        rows.map(|row| row[0].text.clone()).collect()
    };
    let quantities = distinct(parts().flat_map(labels));
    let part = |part: &Part| {
        let row = |(place, column): (usize, &Column)| {
            let entry = |quantity: &String| {
                let mut rows = part.rows.iter();
                let row = rows.find(|row| row[0].text == *quantity);
                row.map_or_else(Entry::default, |row| row[place].clone())
            };
            let name = Entry::new(&column.head);
            std::iter::once(name)
                .chain(quantities.iter().map(entry))
                .collect()
        };
        let mut rows: Vec<Vec<Entry>> = table.columns.iter().enumerate().skip(1).map(row).collect();
        // Rows are empty for algorithms that did not run on the model and for the base of ratios.
        rows.retain(|row| row[1..].iter().any(|entry| !entry.text.is_empty()));
        if part.refused {
            let entry = |i: usize| match i {
                0 => Entry::new("All"),
                1 => Entry::marked("refused", Mark::Failed),
                _ => Entry::default(),
            };
            rows = vec![(0..=quantities.len()).map(entry).collect()];
        }
        Part {
            rows,
            ..part.clone()
        }
    };
    Table {
        columns: Column::of(["Algorithm"], &quantities),
        parts: parts().map(part).collect(),
        rows_are: "algorithm",
        ..table.clone()
    }
}

/// The notes of `table`, failures first. Notes of several models that differ only in numbers are
/// merged into one, with the range of each number.
pub(crate) fn notes(table: &Table) -> Vec<Note> {
    let notes = || {
        table
            .parts
            .iter()
            .flat_map(|part| part.notes.iter().map(move |n| (part, n)))
    };
    let models = table
        .parts
        .iter()
        .filter(|part| !part.notes.is_empty())
        .count();
    let mut texts: Vec<Note> = Vec::new();
    let shapes = by_key(notes(), |(_, note)| (shape(&note.text), note.failure));
    for ((_, failure), same) in shapes {
        let titles = by_key(&same, |(part, _)| part.title.as_str());
        let titles: Vec<&str> = titles.into_iter().map(|(title, _)| title).collect();
        if failure || titles.len() < 2 {
            texts.extend(same.iter().map(|(part, note)| Note {
                text: format!("{}: {}", part.title, note.text),
                failure,
            }));
            continue;
        }
        let on = match titles.len() {
            all if all == models => format!("all {all} models"),
            _ => titles.join(", "),
        };
        let all: Vec<&str> = same.iter().map(|(_, note)| note.text.as_str()).collect();
        texts.push(Note::new(format!("{on}: {}", ranges(&all))));
    }
    texts.sort_by_key(|note| !note.failure);
    texts
}

/// Splits a text into its numbers and the pieces between them. Returns the pieces, which are one
/// more, and the numbers. Digits within a word, as in `ich1`, are not a number.
fn pieces(text: &str) -> (Vec<String>, Vec<&str>) {
    let (mut between, mut numbers) = (vec![String::new()], Vec::new());
    for word in text.split_inclusive(' ') {
        let (bare, end) = word.split_at(word.trim_end_matches([' ', ',', ';', ':']).len());
        if number(bare).is_some() {
            numbers.push(bare);
            between.push(end.to_owned());
        } else if let Some(last) = between.last_mut() {
            last.push_str(word);
        }
    }
    (between, numbers)
}

/// The value of a word that is a number, with or without thousands separators.
fn number(word: &str) -> Option<f64> {
    let number: f64 = word.replace(',', "").parse().ok()?;
    number.is_finite().then_some(number)
}

/// A text with each number replaced by `#`.
fn shape(text: &str) -> String {
    pieces(text).0.join("#")
}

/// Merges texts of the same shape into one, with the range of each number.
fn ranges(texts: &[&str]) -> String {
    let all: Vec<(Vec<String>, Vec<&str>)> = texts.iter().map(|text| pieces(text)).collect();
    let Some((between, first)) = all.first() else {
        return String::new();
    };
    let mut text = between[0].clone();
    for place in 0..first.len() {
        let number = |text: &&str| number(text).unwrap_or(f64::NAN);
        let mut found: Vec<&str> = all.iter().map(|(_, numbers)| numbers[place]).collect();
        found.sort_by(|a, b| number(a).total_cmp(&number(b)));
        text += found[0];
        let last = found[found.len() - 1];
        if last != found[0] {
            text += &format!(" to {last}");
        }
        text += &between[place + 1];
    }
    text
}

/// The table of the properties of the models.
pub(crate) fn models(id: &str, result: &ResultFile) -> Table {
    type Field = fn(&ModelRecord) -> Option<String>;
    let columns: [(&str, Field); 11] = [
        ("Vertices", |m| m.vertices.map(grouped)),
        ("Faces", |m| m.faces.map(grouped)),
        ("Edges", |m| m.edges.map(grouped)),
        ("Boundary edges", |m| m.boundary_edges.map(grouped)),
        ("Components", |m| m.components.map(grouped)),
        ("Genus", |m| m.genus.map(grouped)),
        ("Saddles", |m| m.saddles.map(grouped)),
        ("Anisotropy g", |m| m.anisotropy.map(|g| format!("{g:.3}"))),
        ("Load (s)", |m| m.load_seconds.map(|s| seconds(s, 9))),
        ("Build (s)", |m| m.build_seconds.map(|s| seconds(s, 9))),
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
        rows_are: "model",
        ..Table::new(
            heads.chain([Column::text("File or generator")]).collect(),
            result.models.iter().map(row).collect(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_differ_become_ranges() {
        let texts = [
            "times: 95 % intervals within 2.5 % of the medians of ich1",
            "times: 95 % intervals within 0.25 % of the medians of ich1",
        ];
        assert_eq!(
            ranges(&["at 1,024 of 9", "at 80 of 9"]),
            "at 80 to 1,024 of 9"
        );
        assert_eq!(shape(texts[0]), shape(texts[1]));
        assert_eq!(
            ranges(&texts),
            "times: 95 % intervals within 0.25 to 2.5 % of the medians of ich1"
        );
        assert_ne!(shape("a: 3"), shape("b: 3"));
        assert_eq!(ranges(&["none"]), "none");
        assert_eq!(
            ranges(&["up to 1e-9", "up to 3.0e-12"]),
            "up to 3.0e-12 to 1e-9"
        );
    }
}
