//! The keys of a suite file.

use std::fmt::Display;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use geobench_mesh::generate::Spec;
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use toml::{Spanned, Value};

use super::document::{Document, SuiteError, parsed, text_or_table};
use super::programs::{self, ProgramTables};
use super::{MOST_RUNS, Settings, WantedModel, tolerance};
use crate::exec::limits::{DecompressionLimit, MemoryLimit, Timeout};
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
    /// What its table shows.
    pub shows: Option<String>,
    /// Its settings, completed by those for all groups.
    pub settings: Settings,
    /// Settings that override these with `--full`, the sizes of the paper.
    pub full: Settings,
}

impl Suite {
    /// Reads a suite file; paths in it are relative to its directory.
    ///
    /// # Errors
    ///
    /// Names the file, the line and the key.
    pub fn read(path: &Path) -> Result<Self, SuiteError> {
        Self::of(&Document::open(path)?, path)
    }

    /// Reads the text of a suite file; paths in it are relative to the directory of `path`.
    ///
    /// # Errors
    ///
    /// Names the file, the line and the key.
    pub fn parse(path: &Path, text: &str) -> Result<Self, SuiteError> {
        Self::of(&Document::new(path, text), path)
    }

    fn of(document: &Document<'_>, path: &Path) -> Result<Self, SuiteError> {
        let file: FileTable = document.read()?;
        let full = |table: &Option<FullTable>| {
            let settings = table.as_ref().map(|full| full.settings(document));
            settings.transpose().map(Option::unwrap_or_default)
        };
        let (common, common_full) = (file.settings(document)?, full(&file.full)?);
        let mut groups: Vec<SuiteGroup> = Vec::new();
        for group in file.group.unwrap_or_default() {
            let (span, group) = (Some(group.span()), group.into_inner());
            let name = group.name.as_deref().map_or("", str::trim).to_owned();
            if name.is_empty() {
                return Err(document.error_at("group", span, "a group must have a `name`"));
            }
            if groups.iter().any(|other| other.name == name) {
                let problem = format!("two are called `{name}`");
                return Err(document.error_at("group", span, &problem));
            }
            groups.push(SuiteGroup {
                name,
                shows: group.shows.as_deref().map(|shows| shows.trim().to_owned()),
                settings: group.settings(document)?.or(&common),
                full: full(&group.full)?.or(&common_full),
            });
        }
        if groups.is_empty() {
            let problem = "there is no group; start one with [[group]] and give it a name";
            return Err(document.error(None, problem));
        }
        let programs = file.ext.map(|tables| programs::programs(tables, document));
        Ok(Self {
            path: path.to_owned(),
            groups,
            programs: programs.transpose()?.unwrap_or_default(),
        })
    }
}

/// Declares a table with the given keys and those of [`Settings`]. The `flatten` of serde would
/// lose the lines of errors.
macro_rules! settings_table {
    ($name:ident { $($key:ident: $type:ty,)* }) => {
        #[derive(Debug, Deserialize)]
        #[serde(deny_unknown_fields, expecting = "a table")]
        struct $name {
            $($key: Option<$type>,)*
            #[serde(default, deserialize_with = "list")]
            models: Option<Vec<Spanned<Model>>>,
            #[serde(default, deserialize_with = "algorithms")]
            algorithms: Option<Vec<Selection>>,
            #[serde(default, deserialize_with = "source")]
            source: Option<SourceSpec>,
            #[serde(default, deserialize_with = "whole::<_, 1, MOST_RUNS>")]
            repeat: Option<u32>,
            #[serde(default, deserialize_with = "whole::<_, 0, MOST_RUNS>")]
            warmup: Option<u32>,
            #[serde(default, deserialize_with = "number")]
            tolerance: Option<f64>,
            #[serde(default, deserialize_with = "whole::<_, 0, MOST_SEED>")]
            seed: Option<u32>,
            #[serde(default, deserialize_with = "whole::<_, 1, MOST_THREADS>")]
            threads: Option<u32>,
            #[serde(default, deserialize_with = "text")]
            timeout: Option<Timeout>,
            #[serde(default, deserialize_with = "text", rename = "memory-limit")]
            memory_limit: Option<MemoryLimit>,
            #[serde(default, deserialize_with = "text", rename = "max-decompressed")]
            max_decompressed: Option<DecompressionLimit>,
            check: Option<Spanned<String>>,
            #[serde(default, deserialize_with = "rows")]
            rows: Option<Vec<String>>,
            #[serde(default, deserialize_with = "text")]
            ratios_to: Option<Selection>,
            wavefront: Option<bool>,
        }

        impl $name {
            fn settings(&self, document: &Document<'_>) -> Result<Settings, SuiteError> {
                let models = self.models.as_ref().map(|models| {
                    models.iter().map(|model| model.get_ref().wanted(model.span(), document))
                });
                let check = |text: &Spanned<String>| {
                    Reference::parse(text.get_ref(), document.directory()).map_err(|error| {
                        document.error_at("check", Some(text.span()), &error.to_string())
                    })
                };
                let ratios_to = self.ratios_to.as_ref();
                Ok(Settings {
                    models: models.map(Iterator::collect),
                    algorithms: self.algorithms.clone(),
                    sources: self.source.clone(),
                    repeat: self.repeat,
                    warmup: self.warmup,
                    tolerance: self.tolerance,
                    seed: self.seed.map(u64::from),
                    threads: self.threads,
                    timeout: self.timeout,
                    memory_limit: self.memory_limit,
                    max_decompressed: self.max_decompressed,
                    reference: self.check.as_ref().map(check).transpose()?,
                    rows: self.rows.clone(),
                    ratios_to: ratios_to.map(|one| one.label().to_owned()),
                    wavefront: self.wavefront,
                })
            }
        }
    };
}

settings_table!(FileTable {
    group: Vec<Spanned<GroupTable>>,
    full: FullTable,
    ext: ProgramTables,
});
settings_table!(GroupTable {
    name: String,
    shows: String,
    full: FullTable,
});
settings_table!(FullTable {});

/// Greatest seed.
const MOST_SEED: u32 = u32::MAX - 1;

/// Greatest number of subdivisions of a model.
const MOST_SUBDIVISIONS: u32 = 12;

/// A model: a path, a generator's spec, or a table.
#[derive(Debug)]
struct Model(ModelTable);

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ModelTable {
    path: String,
    optional: bool,
    #[serde(deserialize_with = "names")]
    real: Vec<String>,
    #[serde(deserialize_with = "whole::<_, 0, MOST_SUBDIVISIONS>")]
    subdivide: Option<u32>,
}

impl<'de> Deserialize<'de> for Model {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let of_path = |path: &str| {
            Self::checked(ModelTable {
                path: path.to_owned(),
                ..ModelTable::default()
            })
        };
        text_or_table(deserializer, of_path, Self::checked)
    }
}

impl Model {
    fn checked(model: ModelTable) -> Result<Self, String> {
        if model.path.is_empty() {
            return Err("a model must have a `path`".to_owned());
        }
        if model.subdivide.is_some_and(|times| times > 0) && model.real.is_empty() {
            let problem = "`subdivide` is for a model that has `real`; let `path` be `gen:file,path=...,subdivide=...`";
            return Err(problem.to_owned());
        }
        Ok(Self(model))
    }

    fn wanted(&self, span: Range<usize>, document: &Document<'_>) -> WantedModel {
        let Self(model) = self;
        let argument = if Spec::is_spec(&model.path) {
            model.path.clone()
        } else {
            let path = document.directory().join(&model.path);
            path.display().to_string()
        };
        WantedModel {
            argument,
            optional: model.optional,
            real: model.real.clone(),
            subdivide: model.subdivide.unwrap_or(0),
            line: Some(document.line(&span)),
        }
    }
}

/// AlgorithmItem: a list as on the command line, or a table of a name and parameters.
struct AlgorithmItem(Vec<Selection>);

impl<'de> Deserialize<'de> for AlgorithmItem {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        text_or_table(deserializer, Self::select, |table| {
            Self::select(&with_parameters(table)?)
        })
    }
}

impl AlgorithmItem {
    fn select(list: &str) -> Result<Self, String> {
        let algorithms = registry::select(list);
        algorithms.map(Self).map_err(|error| error.to_string())
    }
}

/// A table of a name and parameters in the form of the command line.
fn with_parameters(mut table: toml::Table) -> Result<String, String> {
    let name = match table.remove("name") {
        Some(name) => word(&name)?,
        None => return Err("an algorithm must have a `name`".to_owned()),
    };
    let parameters = table
        .iter()
        .map(|(key, value)| Ok(format!("{key}={}", word(value)?)));
    let parameters: Vec<String> = parameters.collect::<Result<_, String>>()?;
    Ok(format!("{name}{{{}}}", parameters.join(",")))
}

/// A text, or a number as text.
fn word(value: &Value) -> Result<String, String> {
    match value {
        Value::String(text) => Ok(text.clone()),
        Value::Integer(number) => Ok(number.to_string()),
        Value::Float(number) => Ok(number.to_string()),
        _ => Err("a number or a word is expected".to_owned()),
    }
}

// What `deserialize_with` names above. Each gives an option, since every key may be missing.

/// A list that is not empty.
fn list<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<Vec<T>>, D::Error> {
    let list = Vec::deserialize(deserializer)?;
    if list.is_empty() {
        return Err(D::Error::custom("the list is empty"));
    }
    Ok(Some(list))
}

/// A value written as text.
fn text<'de, D: Deserializer<'de>, T: FromStr<Err: Display>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    let value = String::deserialize(deserializer)?.parse();
    value.map(Some).map_err(D::Error::custom)
}

/// A whole number from `LEAST` to `MOST`.
fn whole<'de, D: Deserializer<'de>, const LEAST: u32, const MOST: u32>(
    deserializer: D,
) -> Result<Option<u32>, D::Error> {
    let number = Value::deserialize(deserializer)?.as_integer();
    match number.and_then(|number| u32::try_from(number).ok()) {
        Some(number) if (LEAST..=MOST).contains(&number) => Ok(Some(number)),
        _ => Err(D::Error::custom(format!(
            "a whole number from {LEAST} to {MOST} is expected"
        ))),
    }
}

/// A tolerance.
fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    let number = match Value::deserialize(deserializer)? {
        Value::Float(number) => Some(number),
        Value::Integer(number) => Some(number as f64),
        _ => None,
    };
    tolerance(number).map(Some).map_err(D::Error::custom)
}

fn algorithms<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Vec<Selection>>, D::Error> {
    let mut chosen: Vec<Selection> = Vec::new();
    for selection in list(deserializer)?
        .into_iter()
        .flatten()
        .flat_map(|AlgorithmItem(list)| list)
    {
        if chosen.iter().all(|c| c.label() != selection.label()) {
            chosen.push(selection);
        }
    }
    Ok(Some(chosen))
}

/// Names of rows.
fn rows<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Vec<String>>, D::Error> {
    struct Row(String);
    impl<'de> Deserialize<'de> for Row {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            parsed(deserializer, |name| match table::figure(name) {
                Ok(figure) => Ok(Self(figure.key.to_owned())),
                Err(error) => Err(error.to_string()),
            })
        }
    }
    let rows: Option<Vec<Row>> = list(deserializer)?;
    Ok(rows.map(|rows| rows.into_iter().map(|row| row.0).collect()))
}

/// A vertex, a list of vertices, or a text as on the command line.
fn source<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<SourceSpec>, D::Error> {
    let text = match Value::deserialize(deserializer)? {
        Value::Array(list) if list.is_empty() => Err("the list is empty".to_owned()),
        Value::Array(list) => list
            .iter()
            .map(word)
            .collect::<Result<Vec<_>, _>>()
            .map(|list| list.join(",")),
        value => word(&value),
    };
    let source = text.map_err(D::Error::custom)?.parse();
    source.map(Some).map_err(D::Error::custom)
}

/// A name, or a list of names.
fn names<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<String>, D::Error> {
    let names = match Value::deserialize(deserializer)? {
        Value::Array(list) if list.is_empty() => return Err(D::Error::custom("the list is empty")),
        Value::Array(list) => list,
        name => vec![name],
    };
    let name = |name: &Value| match name.as_str().map(str::trim) {
        Some("") => Err(D::Error::custom("a name is empty")),
        Some(name) => Ok(name.to_owned()),
        None => Err(D::Error::custom("a text in quotes is expected")),
    };
    names.iter().map(name).collect()
}
