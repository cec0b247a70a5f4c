//! What a suite file says.

use std::ops::Range;
use std::path::{Path, PathBuf};

use geobench_mesh::generate::Spec;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::{MOST_RUNS, Settings, WantedModel, programs, tolerance};
use crate::exec::limits::LimitError;
use crate::plan::Reference;
use crate::plan::source::SourceSpec;
use crate::registry::{self, MOST_THREADS, Programs, Selection, nearest};
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

/// What is wrong with a suite file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{}: {problem}", path.display(), at(*line))]
pub struct SuiteError {
    /// The file.
    pub path: PathBuf,
    /// The line, counted from 1, if it is about one.
    pub line: Option<usize>,
    /// What is wrong there and what would be right.
    pub problem: String,
}

fn at(line: Option<usize>) -> String {
    line.map_or_else(String::new, |line| format!(", line {line}"))
}

/// A suite file while it is read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Document<'t> {
    pub(crate) path: &'t Path,
    pub(crate) text: &'t str,
}

/// A value with its key and its place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry<'t> {
    pub(crate) document: Document<'t>,
    pub(crate) key: &'t str,
    pub(crate) value: &'t Spanned<DeValue<'t>>,
}

impl<'t> Document<'t> {
    pub(crate) fn parse(&self) -> Result<DeTable<'t>, SuiteError> {
        match DeTable::parse(self.text) {
            Ok(table) => Ok(table.into_inner()),
            Err(error) => Err(self.error(error.span(), error.message())),
        }
    }

    pub(crate) fn error(&self, span: Option<Range<usize>>, problem: &str) -> SuiteError {
        SuiteError {
            path: self.path.to_owned(),
            line: span.map(|span| self.line(&span)),
            problem: problem.replace('\n', " "),
        }
    }

    fn line(&self, span: &Range<usize>) -> usize {
        let before = self.text.as_bytes().iter().take(span.start);
        1 + before.filter(|byte| **byte == b'\n').count()
    }

    /// Complains about a key that is none of `known`.
    pub(crate) fn unknown_key(&self, key: &Spanned<DeString<'_>>, known: &[&str]) -> SuiteError {
        let name = key.get_ref();
        let suggestion = nearest(&name.to_lowercase(), known)
            .map_or_else(String::new, |known| format!(", did you mean `{known}`?"));
        self.error(
            Some(key.span()),
            &format!(
                "there is no key `{name}` here{suggestion}; known are {}",
                known.join(", ")
            ),
        )
    }
}

impl<'t> Entry<'t> {
    pub(crate) fn error(&self, problem: &str) -> SuiteError {
        let problem = format!("`{}`: {problem}", self.key);
        self.document.error(Some(self.value.span()), &problem)
    }

    pub(crate) fn line(&self) -> usize {
        self.document.line(&self.value.span())
    }

    /// A text.
    pub(crate) fn text(&self) -> Result<&'t str, SuiteError> {
        match self.value.get_ref() {
            DeValue::String(text) => Ok(text),
            _ => Err(self.error("a text in quotes is expected")),
        }
    }

    pub(crate) fn boolean(&self) -> Result<bool, SuiteError> {
        match self.value.get_ref() {
            DeValue::Boolean(value) => Ok(*value),
            _ => Err(self.error("true or false is expected")),
        }
    }

    /// A whole number in `range`.
    pub(crate) fn whole(&self, range: Range<u32>) -> Result<u32, SuiteError> {
        let number = match self.value.get_ref() {
            DeValue::Integer(n) => u32::from_str_radix(n.as_str(), n.radix()).ok(),
            _ => None,
        };
        number.filter(|n| range.contains(n)).ok_or_else(|| {
            let (least, most) = (range.start, range.end.saturating_sub(1));
            self.error(&format!(
                "a whole number from {least} to {most} is expected"
            ))
        })
    }

    /// A number.
    pub(crate) fn number(&self) -> Option<f64> {
        match self.value.get_ref() {
            DeValue::Float(x) => x.as_str().parse().ok(),
            DeValue::Integer(n) if n.radix() == 10 => n.as_str().parse().ok(),
            _ => None,
        }
    }

    /// The text, or the number as it is written.
    pub(crate) fn word(&self) -> Result<String, SuiteError> {
        match self.value.get_ref() {
            DeValue::String(text) => Ok(text.clone().into_owned()),
            DeValue::Integer(n) => Ok(n.to_string()),
            DeValue::Float(x) => Ok(x.to_string()),
            _ => Err(self.error("a number or a word is expected")),
        }
    }

    /// The elements of a list that is not empty.
    pub(crate) fn list(&self) -> Result<Vec<Entry<'t>>, SuiteError> {
        match self.value.get_ref() {
            DeValue::Array(array) if !array.is_empty() => {
                Ok(array.iter().map(|value| Entry { value, ..*self }).collect())
            }
            DeValue::Array(_) => Err(self.error("the list is empty")),
            _ => Err(self.error("a list in [] is expected")),
        }
    }

    /// The keys and values of a table.
    pub(crate) fn table(&self) -> Result<&'t DeTable<'t>, SuiteError> {
        match self.value.get_ref() {
            DeValue::Table(table) => Ok(table),
            _ => Err(self.error("a table is expected")),
        }
    }
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
