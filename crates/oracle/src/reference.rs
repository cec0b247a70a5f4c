//! Stored distances of models on which the oracle is slow.

use std::path::Path;
use std::{fs, io};

use crate::model::Model;

/// The number of sources of each slow model whose distances are stored.
pub const SOURCES: usize = 3;

/// The name of the file with the distances of `model`.
pub fn file_name(model: &Model) -> String {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() || c == '.' {
            c
        } else {
            '-'
        }
    };
    let name: String = model.name.chars().map(plain).collect();
    format!("{}.csv", name.replace("--", "-"))
}

/// The stored distances of `model`: for each source those of all vertices, computed in
/// double-double and rounded to the nearest `f64`.
///
/// # Errors
///
/// If the file cannot be read or was not written by `make_reference`.
pub fn read(model: &Model) -> io::Result<Vec<(u32, Vec<f64>)>> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let path = directory.join(file_name(model));
    let text = fs::read_to_string(&path)?;
    let mut fields: Vec<(u32, Vec<f64>)> = Vec::new();
    for (number, line) in text.lines().enumerate().skip(1) {
        let damaged = || {
            let message = format!("{}, line {}: {line}", path.display(), number + 1);
            io::Error::new(io::ErrorKind::InvalidData, message)
        };
        let mut columns = line.split(',');
        let source = columns.next().and_then(|s| s.parse().ok());
        let vertex = columns.next().and_then(|s| s.parse().ok());
        let distance = columns.next().and_then(|s| s.parse().ok());
        let (Some(source), Some(vertex), Some(distance)) = (source, vertex, distance) else {
            return Err(damaged());
        };
        if fields.last().is_none_or(|(last, _)| *last != source) {
            fields.push((source, Vec::new()));
        }
        match fields.last_mut() {
            Some((_, field)) if field.len() == vertex => field.push(distance),
            _ => return Err(damaged()),
        }
    }
    Ok(fields)
}
