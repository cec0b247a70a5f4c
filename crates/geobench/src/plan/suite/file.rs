//! What a suite file says.

use std::path::{Path, PathBuf};

use geobench_mesh::generate::Spec;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::document::{Document, Entry, SuiteError};
use super::{MOST_RUNS, Settings, WantedModel, programs, tolerance};
use crate::exec::limits::LimitError;
use crate::plan::Reference;
use crate::plan::source::SourceSpec;
use crate::registry::{self, MOST_THREADS, Programs, Selection};
use crate::table;

/// A suite file.
#[derive(Clone, Debug)]
pub struct Suite {
    /// The file.
    pub path: PathBuf,
    /// Its groups, in the order of the file; at least one.
    pub groups: Vec<SuiteGroup>,
    /// The outside programs that it describes.
    pub programs: Programs,
}

/// A group of a suite.
#[derive(Clone, Debug)]
pub struct SuiteGroup {
    /// Its name, unique within the file.
    pub name: String,
    /// What it is to show.
    pub shows: Option<String>,
    /// Its settings, and those that hold for all groups where it has none.
    pub settings: Settings,
    /// What comes before them where somebody wants the sizes of the paper.
    pub full: Settings,
}

/// The key of the table of settings for the sizes of the paper.
const FULL: &str = "full";

impl Suite {
    /// Reads a suite file.
    ///
    /// # Errors
    ///
    /// Names the file, the line and the key.
    pub fn read(path: &Path) -> Result<Self, SuiteError> {
        let text = std::fs::read_to_string(path).map_err(|error| SuiteError {
            path: path.to_owned(),
            line: None,
            problem: error.to_string(),
        })?;
        Self::parse(path, &text)
    }

    /// Reads the text of a suite file; paths in it are relative to the directory of `path`.
    ///
    /// # Errors
    ///
    /// Names the file, the line and the key.
    pub fn parse(path: &Path, text: &str) -> Result<Self, SuiteError> {
        let document = Document { path, text };
        let table = document.parse()?;
        let (mut common, mut full) = (Settings::default(), Settings::default());
        let mut groups: Vec<SuiteGroup> = Vec::new();
        let mut programs = Programs::default();
        let known: Vec<&str> = ["group", FULL, programs::KEY]
            .into_iter()
            .chain(SETTINGS)
            .collect();
        for (key, value) in &table {
            let entry = Entry {
                document,
                key: key.get_ref(),
                value,
            };
            if entry.key == "group" {
                for place in entry.list()? {
                    let group = read_group(&place)?;
                    if groups.iter().any(|other| other.name == group.name) {
                        return Err(place.error(&format!("two are called `{}`", group.name)));
                    }
                    groups.push(group);
                }
            } else if entry.key == FULL {
                full = read_settings(&entry)?;
            } else if entry.key == programs::KEY {
                programs = programs::tables(&entry)?;
            } else {
                setting(&entry, key, &known, &mut common)?;
            }
        }
        if groups.is_empty() {
            return Err(document.error(
                None,
                "there is no group; start one with [[group]] and give it a name",
            ));
        }
        for group in &mut groups {
            group.settings = group.settings.or(&common);
            group.full = group.full.or(&full);
        }
        Ok(Self {
            path: path.to_owned(),
            groups,
            programs,
        })
    }
}

fn read_group(group: &Entry<'_>) -> Result<SuiteGroup, SuiteError> {
    let own = ["name", "shows", FULL];
    let known: Vec<&str> = own.into_iter().chain(SETTINGS).collect();
    let (mut name, mut shows) = (None, None);
    let (mut settings, mut full) = (Settings::default(), Settings::default());
    for (key, value) in group.table()? {
        let entry = Entry {
            key: key.get_ref(),
            value,
            ..*group
        };
        match entry.key {
            "name" => name = Some(entry.text()?.trim()).filter(|name| !name.is_empty()),
            "shows" => shows = Some(entry.text()?.trim().to_owned()),
            FULL => full = read_settings(&entry)?,
            _ => setting(&entry, key, &known, &mut settings)?,
        }
    }
    let Some(name) = name else {
        return Err(group.error("a group must have a `name`"));
    };
    Ok(SuiteGroup {
        name: name.to_owned(),
        shows,
        settings,
        full,
    })
}

/// A table of nothing but settings.
fn read_settings(table: &Entry<'_>) -> Result<Settings, SuiteError> {
    let mut settings = Settings::default();
    for (key, value) in table.table()? {
        let entry = Entry {
            key: key.get_ref(),
            value,
            ..*table
        };
        setting(&entry, key, &SETTINGS, &mut settings)?;
    }
    Ok(settings)
}

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
