//! One setting of a suite file.

use std::path::Path;

use geobench_mesh::generate::Spec;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::document::{Entry, SuiteError};
use super::{MOST_RUNS, Settings, WantedModel, tolerance};
use crate::exec::limits::LimitError;
use crate::plan::Reference;
use crate::plan::source::SourceSpec;
use crate::registry::{self, MOST_THREADS, Selection};
use crate::table;

/// The keys of [`Settings`].
pub(super) const SETTINGS: [&str; 15] = [
    "models",
    "algorithms",
    "source",
    "repeat",
    "warmup",
    "tolerance",
    "seed",
    "threads",
    "timeout",
    "memory-limit",
    "max-decompressed",
    "check",
    "rows",
    "ratios_to",
    "wavefront",
];

/// Reads one of [`SETTINGS`].
pub(super) fn setting(
    entry: &Entry<'_>,
    key: &Spanned<DeString<'_>>,
    known: &[&str],
    settings: &mut Settings,
) -> Result<(), SuiteError> {
    match entry.key {
        "models" => {
            let models = entry.list()?.iter().map(model).collect::<Result<_, _>>()?;
            settings.models = Some(models);
        }
        "algorithms" => settings.algorithms = Some(algorithms(entry)?),
        "source" => settings.sources = Some(source(entry)?),
        "repeat" => settings.repeat = Some(entry.whole(1..MOST_RUNS + 1)?),
        "warmup" => settings.warmup = Some(entry.whole(0..MOST_RUNS + 1)?),
        "seed" => settings.seed = Some(entry.whole(0..u32::MAX)?.into()),
        "threads" => settings.threads = Some(entry.whole(1..MOST_THREADS + 1)?),
        "tolerance" => {
            settings.tolerance = Some(tolerance(entry.number()).map_err(|e| entry.error(&e))?);
        }
        "timeout" => {
            let time = entry.text()?.parse();
            settings.timeout = Some(time.map_err(|e: LimitError| entry.error(&e.to_string()))?);
        }
        "memory-limit" => {
            let size = entry.text()?.parse();
            settings.memory_limit =
                Some(size.map_err(|e: LimitError| entry.error(&e.to_string()))?);
        }
        "max-decompressed" => {
            let size = entry.text()?.parse();
            settings.max_decompressed =
                Some(size.map_err(|e: LimitError| entry.error(&e.to_string()))?);
        }
        "check" => {
            let reference = Reference::parse(entry.text()?, directory(entry));
            settings.reference = Some(reference.map_err(|e| entry.error(&e.to_string()))?);
        }
        "rows" => {
            let mut rows = Vec::new();
            for row in entry.list()? {
                let figure = table::figure(row.text()?).map_err(|e| row.error(&e.to_string()))?;
                rows.push(figure.key.to_owned());
            }
            settings.rows = Some(rows);
        }
        "wavefront" => settings.wavefront = Some(entry.boolean()?),
        "ratios_to" => {
            let one =
                registry::select_one(entry.text()?).map_err(|e| entry.error(&e.to_string()))?;
            settings.ratios_to = Some(one.label().to_owned());
        }
        _ => return Err(entry.document.unknown_key(key, known)),
    }
    Ok(())
}

/// The directory of the suite file.
fn directory<'t>(entry: &Entry<'t>) -> &'t Path {
    entry.document.path.parent().unwrap_or(Path::new(""))
}

/// Most times that a model can be subdivided.
const MOST_SUBDIVISIONS: u32 = 12;

/// A path or a spec, or a table of one, whether it may be missing, and what it stands for.
fn model(entry: &Entry<'_>) -> Result<WantedModel, SuiteError> {
    let (mut path, mut optional) = (None, false);
    let (mut real, mut subdivide) = (Vec::new(), 0);
    if let DeValue::Table(table) = entry.value.get_ref() {
        for (key, value) in table {
            let field = Entry {
                key: key.get_ref(),
                value,
                ..*entry
            };
            match field.key {
                "path" => path = Some(field.text()?),
                "optional" => optional = field.boolean()?,
                "real" => real = names(&field)?,
                "subdivide" => subdivide = field.whole(0..MOST_SUBDIVISIONS + 1)?,
                _ => {
                    let known = ["path", "optional", "real", "subdivide"];
                    return Err(field.document.unknown_key(key, &known));
                }
            }
        }
    } else {
        path = Some(entry.text()?);
    }
    let Some(path) = path.filter(|path| !path.is_empty()) else {
        return Err(entry.error("a model must have a `path`"));
    };
    if subdivide > 0 && real.is_empty() {
        let problem = "`subdivide` is for a model that has `real`; let `path` be `gen:file,path=...,subdivide=...`";
        return Err(entry.error(problem));
    }
    Ok(WantedModel {
        argument: if Spec::is_spec(path) {
            path.to_owned()
        } else {
            directory(entry).join(path).display().to_string()
        },
        optional,
        real,
        subdivide,
        line: Some(entry.line()),
    })
}

/// A name, or a list of them.
fn names(entry: &Entry<'_>) -> Result<Vec<String>, SuiteError> {
    let names = match entry.value.get_ref() {
        DeValue::Array(_) => entry.list()?,
        _ => vec![*entry],
    };
    let text = |name: &Entry<'_>| match name.text()?.trim() {
        "" => Err(entry.error("a name is empty")),
        text => Ok(text.to_owned()),
    };
    names.iter().map(text).collect()
}

/// Names, families and groups as on the command line, or tables of a name and parameters.
fn algorithms(entry: &Entry<'_>) -> Result<Vec<Selection>, SuiteError> {
    let mut chosen: Vec<Selection> = Vec::new();
    for item in entry.list()? {
        let text = match item.value.get_ref() {
            DeValue::Table(table) => with_parameters(&item, table)?,
            _ => item.text()?.to_owned(),
        };
        for selection in registry::select(&text).map_err(|e| item.error(&e.to_string()))? {
            if chosen.iter().all(|c| c.label() != selection.label()) {
                chosen.push(selection);
            }
        }
    }
    Ok(chosen)
}

/// A table of a name and parameters in the form of the command line.
fn with_parameters<'t>(item: &Entry<'t>, table: &'t DeTable<'t>) -> Result<String, SuiteError> {
    let (mut name, mut parameters) = (None, Vec::new());
    for (key, value) in table {
        let field = Entry {
            key: key.get_ref(),
            value,
            ..*item
        };
        if field.key == "name" {
            name = Some(field.text()?);
        } else {
            parameters.push(format!("{}={}", field.key, field.word()?));
        }
    }
    match name {
        Some(name) => Ok(format!("{name}{{{}}}", parameters.join(","))),
        None => Err(item.error("an algorithm must have a `name`")),
    }
}

/// A vertex, a list of vertices, or a text as on the command line.
fn source(entry: &Entry<'_>) -> Result<SourceSpec, SuiteError> {
    let text = match entry.value.get_ref() {
        DeValue::Array(_) => {
            let words: Result<Vec<String>, _> = entry.list()?.iter().map(Entry::word).collect();
            words?.join(",")
        }
        _ => entry.word()?,
    };
    text.parse()
        .map_err(|error| entry.error(&format!("{error}")))
}
