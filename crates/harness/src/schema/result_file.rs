//! Reads result files.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail};
use serde::Deserialize;

use crate::schema::{ResultFile, SCHEMA, labels, unfinished};
use crate::usage::{check_schema, read_text};

/// Reads a result file in JSON; `-` is standard input.
///
/// # Errors
///
/// If the file cannot be read or is not a valid result file of this version. The message names the
/// file and the field.
pub fn read(path: &Path) -> anyhow::Result<ResultFile> {
    let text = read_text(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    if let Some(mut file) = unfinished::is_one(path)
        .then(|| unfinished::parse(&text))
        .flatten()
    {
        labels::renew(&mut file);
        return Ok(file);
    }
    let mut file = parse(path, &text)?;
    if unfinished::complete(path, &mut file) {
        labels::renew(&mut file);
    }
    Ok(file)
}

/// Reads several files; returns each with its path as text.
///
/// # Errors
///
/// As [`read`].
pub fn read_all(paths: &[PathBuf]) -> anyhow::Result<Vec<(String, ResultFile)>> {
    let files = paths.iter();
    files
        .map(|path| Ok((path.display().to_string(), read(path)?)))
        .collect()
}

/// Parses `text`, the content of the result file `path`. Algorithms get the labels that this
/// version has for their parameters.
///
/// # Errors
///
/// If `text` is not a valid result file of this version. The message names the file and the field.
pub fn parse(path: &Path, text: &str) -> anyhow::Result<ResultFile> {
    /// The one field that all versions of the schema have.
    #[derive(Deserialize)]
    #[serde(expecting = "an object")]
    struct Head {
        schema: Option<serde_json::Value>,
    }

    let shown = path.display();
    let foreign = |problem: &str| {
        anyhow!(
            "{shown}: not a result file: {problem}; give a .json file that `geobench run -o` wrote"
        )
    };
    let head: Head = serde_json::from_str(text).map_err(|error| foreign(&error.to_string()))?;
    let found = head
        .schema
        .ok_or_else(|| foreign("it has no field `schema`"))?;
    check_schema(path, found.as_str().unwrap_or(&found.to_string()), SCHEMA)?;
    let mut json = serde_json::Deserializer::from_str(text);
    let mut file: ResultFile = serde_path_to_error::deserialize(&mut json)
        .map_err(|error| anyhow!("{shown}: field `{}`: {}", error.path(), error.inner()))?;
    if let Some((field, problem)) = negative_time(&file) {
        bail!("{shown}: field `{field}`: {problem}");
    }
    labels::renew(&mut file);
    Ok(file)
}

/// The field of the first negative sample, and the error message.
fn negative_time(file: &ResultFile) -> Option<(String, String)> {
    let cells = file.cells.iter().enumerate();
    let mut samples = cells.flat_map(|(cell, of)| {
        let samples = of.time.samples.iter().enumerate();
        samples.map(move |(sample, &seconds)| (cell, sample, seconds))
    });
    let (cell, sample, seconds) = samples.find(|&(_, _, seconds)| seconds < 0.0)?;
    Some((
        format!("cells[{cell}].time.samples[{sample}]"),
        format!("{seconds} is no time: it is below 0"),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::Cell;

    fn refused(text: &str) -> String {
        parse(Path::new("r.json"), text).unwrap_err().to_string()
    }

    #[test]
    fn other_files_than_results_are_refused() {
        let error = format!("{:#}", read(Path::new("/no/such.json")).unwrap_err());
        assert!(error.starts_with("/no/such.json: cannot be read: "));
        assert!(refused("").starts_with("r.json: not a result file: EOF"));
        assert!(refused("[]").starts_with("r.json: not a result file: invalid"));
        assert!(refused("0").contains("expected an object at line 1"));
        assert!(refused("{}").contains("it has no field `schema`; give a .json file"));
        for (schema, shown) in [("\"geobench/2\"", "geobench/2"), ("7", "7")] {
            assert_eq!(
                refused(&format!("{{\"schema\": {schema}}}")),
                format!(
                    "r.json: `schema` is `{shown}`, but this version of geobench reads `geobench/1`"
                )
            );
        }
    }

    #[test]
    fn a_bad_field_is_named() {
        let error = refused(
            r#"{"schema": "geobench/1", "tool": {"version": "1", "commit": 3}, "cells": []}"#,
        );
        assert!(
            error.starts_with("r.json: field `tool.commit`: invalid type: integer `3`"),
            "{error}"
        );
        let mut cell = Cell::new("cow", "vtp");
        cell.time.samples = vec![1.0, 2.0, -0.5];
        let file = serde_json::json!({
            "schema": SCHEMA,
            "tool": {"version": "1", "profile": "release", "features": []},
            "host": {"cores": 2, "os": "some system"},
            "command": [], "started": "", "finished": "", "models": [],
            "cells": [Cell::new("cow", "mmp"), cell],
        });
        assert_eq!(
            refused(&file.to_string()),
            "r.json: field `cells[1].time.samples[2]`: -0.5 is no time: it is below 0"
        );
        let error = refused(r#"{"schema": "geobench/1"}"#);
        assert!(error.contains("missing field `tool`"), "{error}");
    }
}

#[cfg(test)]
mod unfinished_tests {
    use super::*;
    use crate::run::Records;
    use crate::run::mock::result;
    use crate::schema::unfinished::Unfinished;
    use crate::schema::{Cell, ModelRecord};

    #[test]
    fn results_of_a_killed_run_are_read_from_its_store() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("r.json");
        let mut head = result(Records::default());
        let mut store = Unfinished::create(&path, &head).unwrap();
        for name in ["a", "b"] {
            let model = ModelRecord {
                name: name.to_owned(),
                ..ModelRecord::default()
            };
            store.add(&[], &model, &[Cell::new(name, "vtp")]).unwrap();
            if head.models.is_empty() {
                head.models.push(model);
                head.cells.push(Cell::new(name, "vtp"));
                std::fs::write(&path, serde_json::to_string(&head).unwrap()).unwrap();
            }
        }
        assert_eq!(read(&path).unwrap().cells.len(), 2);
        let whole = path.with_extension("json.unfinished");
        assert_eq!(read(&whole).unwrap().models.len(), 2);
        // A line that is not complete is ignored, and a store of another run, too.
        let text = std::fs::read_to_string(&whole).unwrap();
        std::fs::write(&whole, &text[..text.len() - 5]).unwrap();
        assert_eq!(read(&whole).unwrap().models.len(), 1);
        std::fs::write(&whole, &text).unwrap();
        head.started = "2026-01-01T00:00:00Z".into();
        std::fs::write(&path, serde_json::to_string(&head).unwrap()).unwrap();
        assert_eq!(read(&path).unwrap().cells.len(), 1);
        store.remove();
        assert!(!whole.exists());
    }
}
