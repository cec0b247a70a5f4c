//! Settings and their form in suite files.

use std::fmt::Display;
use std::path::PathBuf;
use std::str::FromStr;

use anyhow::anyhow;
use geobench_mesh::Weld;
use geobench_mesh::generate::Spec;
use geobench_registry::{self as registry, MOST_THREADS, Selection, SimdChoice};
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use toml::{Spanned, Value};

use super::MOST_RUNS;
use crate::exec::goal;
use crate::exec::limits::{DecompressionLimit, MemoryLimit, Timeout};
use crate::exec::source::{SourceSpec, TargetSpec};
use crate::figures;
use crate::plan::Reference;
use crate::plan::sampling::{Sampling, Seconds, Share};
use crate::schema::Precision;
use crate::usage::document::{DocumentError, TomlDocument, parsed, text_or_table};
use crate::usage::read_file;

/// Maximum seed in a suite file.
const MOST_SEED: u32 = u32::MAX - 1;

/// Maximum number of subdivisions of a model.
const MOST_SUBDIVISIONS: u32 = 12;

/// Settings from one source. `None` means unset.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Settings {
    /// The models.
    #[serde(deserialize_with = "list")]
    pub models: Option<Vec<Spanned<WantedModel>>>,
    /// The algorithms.
    #[serde(deserialize_with = "algorithms")]
    pub algorithms: Option<Vec<Selection>>,
    /// The sources in each model.
    #[serde(deserialize_with = "source", rename = "source")]
    pub sources: Option<SourceSpec>,
    /// Whether each run starts from all sources together.
    #[serde(rename = "sources-together")]
    pub sources_together: Option<bool>,
    /// The points whose distances are computed.
    #[serde(deserialize_with = "target", rename = "target")]
    pub targets: Option<TargetSpec>,
    /// A file of target points.
    #[serde(rename = "targets")]
    pub targets_file: Option<Spanned<PathBuf>>,
    /// The radius of the search.
    #[serde(deserialize_with = "radius")]
    pub radius: Option<f64>,
    /// Number of timed runs of each cell, at least 1. Takes precedence over a precision.
    #[serde(deserialize_with = "whole::<_, _, 1, MOST_RUNS>")]
    pub repeat: Option<u32>,
    /// Requested half-width of the interval of the median, as a share of the median.
    #[serde(deserialize_with = "text")]
    pub precision: Option<Share>,
    /// Minimum time of the timed runs of a cell.
    #[serde(deserialize_with = "text", rename = "min-time")]
    pub min_time: Option<Seconds>,
    /// Time after which no timed run of a cell starts.
    #[serde(deserialize_with = "text", rename = "max-time")]
    pub max_time: Option<Seconds>,
    /// Number of untimed runs of each cell before the timed ones.
    #[serde(deserialize_with = "whole::<_, _, 0, MOST_RUNS>")]
    pub warmup: Option<u32>,
    /// Whether each cell has a profiled and a counted run.
    pub counts: Option<bool>,
    /// Largest relative difference from the reference that passes.
    #[serde(deserialize_with = "number")]
    pub tolerance: Option<f64>,
    /// Seed of the order of the runs.
    #[serde(deserialize_with = "whole::<_, _, 0, MOST_SEED>")]
    pub seed: Option<u64>,
    /// Number of threads of the parallel algorithms.
    #[serde(deserialize_with = "whole::<_, _, 1, MOST_THREADS>")]
    pub threads: Option<u32>,
    /// Vector instructions of all algorithms.
    #[serde(deserialize_with = "text")]
    pub simd: Option<SimdChoice>,
    /// Time limit of each run.
    #[serde(deserialize_with = "text")]
    pub timeout: Option<Timeout>,
    /// Memory limit of the process of a cell.
    #[serde(deserialize_with = "text", rename = "memory-limit")]
    pub memory_limit: Option<MemoryLimit>,
    /// Maximum decompressed size of a compressed model.
    #[serde(deserialize_with = "text", rename = "max-decompressed")]
    pub max_decompressed: Option<DecompressionLimit>,
    /// Which vertices of the models are welded.
    #[serde(deserialize_with = "weld")]
    pub weld: Option<Weld>,
    /// The reference of the checks.
    #[serde(rename = "check")]
    pub reference: Option<Spanned<Reference>>,
    /// Names of the rows of tables.
    #[serde(deserialize_with = "rows")]
    pub rows: Option<Vec<String>>,
    /// The base of a table of ratios.
    #[serde(deserialize_with = "text")]
    pub ratios_to: Option<Selection>,
    /// Whether results include samples of the wavefront.
    pub wavefront: Option<bool>,
}

/// A model or a directory of models, as the user specifies it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WantedModel {
    /// A file, a directory or a specification of a generator.
    pub path: String,
    /// Whether a missing file is skipped with a warning.
    pub optional: bool,
    /// Names of the real model for which this one is a substitute. The real model is used if the
    /// library has it.
    pub real: Vec<String>,
    /// How many times each face of the real model is split into four.
    pub subdivide: u32,
    /// Line in the suite file; `None` from the command line.
    pub line: Option<usize>,
}

impl WantedModel {
    /// A mandatory model with only a path or a specification.
    pub fn new(path: &str) -> Self {
        Self {
            path: path.to_owned(),
            ..Self::default()
        }
    }
}

impl<'de> Deserialize<'de> for WantedModel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields, default, expecting = "a table")]
        #[derive(Default)]
        struct Table {
            path: String,
            optional: bool,
            #[serde(deserialize_with = "names")]
            real: Vec<String>,
            #[serde(deserialize_with = "whole::<_, _, 0, MOST_SUBDIVISIONS>")]
            subdivide: Option<u32>,
        }

        let of_path = |path: &str| match path {
            "" => Err("a model must have a `path`".to_owned()),
            path => Ok(Self::new(path)),
        };
        let of_table = |table: Table| {
            let subdivide = table.subdivide.unwrap_or(0);
            if table.path.is_empty() {
                return Err("a model must have a `path`".to_owned());
            }
            if subdivide > 0 && table.real.is_empty() {
                let problem = "`subdivide` is for a model that has `real`; let `path` be `gen:file,path=...,subdivide=...`";
                return Err(problem.to_owned());
            }
            Ok(Self {
                path: table.path,
                optional: table.optional,
                real: table.real,
                subdivide,
                line: None,
            })
        };
        text_or_table(deserializer, of_path, of_table)
    }
}

impl Settings {
    /// These settings, completed by those of `other`.
    #[must_use]
    pub fn or(&self, other: &Self) -> Self {
        macro_rules! settings {
            ($($key:ident)*) => {
                Self { $($key: self.$key.clone().or_else(|| other.$key.clone()),)* }
            };
        }
        let mut all = settings!(models algorithms sources sources_together targets targets_file radius repeat precision min_time max_time warmup
            counts tolerance seed threads simd timeout memory_limit max_decompressed weld reference rows ratios_to
            wavefront);
        // A precision here takes precedence over a number of runs in `other`.
        if self.repeat.is_none() && self.asks_for_precision() {
            all.repeat = None;
        }
        all
    }

    /// Whether they set any condition of a precision.
    const fn asks_for_precision(&self) -> bool {
        self.precision.is_some() || self.min_time.is_some() || self.max_time.is_some()
    }

    /// The timed runs of each cell.
    pub(super) fn sampling(&self) -> Sampling {
        if let Some(repeat) = self.repeat {
            return Sampling::Fixed(repeat as usize);
        }
        let usual = Precision::USUAL;
        Sampling::UntilPrecise(Precision {
            relative: self.precision.map_or(usual.relative, |share| share.0),
            min_time: self.min_time.map_or(usual.min_time, |time| time.0),
            max_time: self.max_time.map_or(usual.max_time, |time| time.0),
        })
    }

    /// Resolves paths and lines of the settings in `document`.
    pub(super) fn resolve(&mut self, document: &TomlDocument<'_>) -> Result<(), DocumentError> {
        for model in self.models.iter_mut().flatten() {
            let line = document.line(&model.span());
            let model = model.get_mut();
            model.line = Some(line);
            if !Spec::is_spec(&model.path) {
                let path = document.directory().join(&model.path);
                model.path = path.display().to_string();
            }
        }
        if let Some(file) = self.targets_file.take() {
            let span = Some(file.span());
            let path = document.directory().join(file.into_inner());
            let text = read_file(&path);
            let text = text.map_err(|error| anyhow!("{}: {error}", path.display()));
            let read = text.and_then(|text| goal::targets_in(&path, &text));
            let read = read
                .map_err(|error| document.error_at("targets", span.clone(), &error.to_string()))?;
            let read = read.into_iter().map(|(target, _)| target);
            self.targets = Some(TargetSpec::of_all(
                self.targets.take().into_iter().chain(read),
            ));
            self.targets_file = span.map(|span| Spanned::new(span, path));
        }
        if let Some(check) = &mut self.reference {
            let span = Some(check.span());
            let resolved = check.get_mut().resolve(document.directory());
            resolved.map_err(|error| document.error_at("check", span, &error.to_string()))?;
        }
        Ok(())
    }
}

/// Validates a tolerance.
///
/// # Errors
///
/// If it is not a finite number of at least 0.
pub fn tolerance(value: Option<f64>) -> Result<f64, String> {
    value
        .filter(|value| value.is_finite() && *value >= 0.0)
        .ok_or_else(|| "a tolerance is a number, 0 or more, such as 1e-9".to_owned())
}

/// Deserializes a non-empty list.
fn list<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<Vec<T>>, D::Error> {
    let list = Vec::deserialize(deserializer)?;
    if list.is_empty() {
        return Err(D::Error::custom("the list is empty"));
    }
    Ok(Some(list))
}

/// Deserializes a value by parsing a string.
fn text<'de, D: Deserializer<'de>, T: FromStr<Err: Display>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    let value = String::deserialize(deserializer)?.parse();
    value.map(Some).map_err(D::Error::custom)
}

/// Deserializes an integer from `LEAST` to `MOST`.
fn whole<'de, D: Deserializer<'de>, T: From<u32>, const LEAST: u32, const MOST: u32>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    let number = Value::deserialize(deserializer)?.as_integer();
    match number.and_then(|number| u32::try_from(number).ok()) {
        Some(number) if (LEAST..=MOST).contains(&number) => Ok(Some(number.into())),
        _ => Err(D::Error::custom(format!(
            "a whole number from {LEAST} to {MOST} is expected"
        ))),
    }
}

/// The value of an integer or a floating-point number.
fn real(value: &Value) -> Option<f64> {
    let whole = value.as_integer().map(|number| number as f64);
    value.as_float().or(whole)
}

/// Deserializes a tolerance.
fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    let number = real(&Value::deserialize(deserializer)?);
    tolerance(number).map(Some).map_err(D::Error::custom)
}

/// Deserializes a list of algorithms. An element is a list in the notation of the command line, or
/// a table of a name and parameters.
fn algorithms<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Vec<Selection>>, D::Error> {
    struct Element(Vec<Selection>);
    impl<'de> Deserialize<'de> for Element {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            fn select(list: &str) -> Result<Element, String> {
                let algorithms = registry::select(list);
                algorithms.map(Element).map_err(|error| error.to_string())
            }
            text_or_table(deserializer, select, |table| {
                select(&with_parameters(table)?)
            })
        }
    }
    let elements: Option<Vec<Element>> = list(deserializer)?;
    let mut chosen: Vec<Selection> = Vec::new();
    for selection in elements.into_iter().flatten().flat_map(|list| list.0) {
        if chosen.iter().all(|c| c.label() != selection.label()) {
            chosen.push(selection);
        }
    }
    Ok(Some(chosen))
}

/// Deserializes names of rows.
fn rows<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Vec<String>>, D::Error> {
    struct Row(String);
    impl<'de> Deserialize<'de> for Row {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            parsed(deserializer, |name| match figures::figure(name) {
                Ok(figure) => Ok(Self(figure.key.to_owned())),
                Err(error) => Err(error.to_string()),
            })
        }
    }
    let rows: Option<Vec<Row>> = list(deserializer)?;
    Ok(rows.map(|rows| rows.into_iter().map(|row| row.0).collect()))
}

/// Deserializes sources: a vertex, a string in the notation of the command line, or a list of
/// these.
fn source<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<SourceSpec>, D::Error> {
    let words = words(deserializer)?;
    let sources = words.iter().map(|word| word.parse());
    let sources = sources.collect::<Result<Vec<SourceSpec>, _>>();
    let sources = sources.map_err(D::Error::custom)?;
    Ok(Some(SourceSpec::of_all(sources)))
}

/// Deserializes targets: a string, a number, or a list of these.
fn target<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<TargetSpec>, D::Error> {
    let words = words(deserializer)?;
    let targets = words.iter().map(|word| word.parse());
    let targets = targets.collect::<Result<Vec<TargetSpec>, _>>();
    let targets = targets.map_err(D::Error::custom)?;
    Ok(Some(TargetSpec::of_all(targets)))
}

/// Deserializes a weld: `true` for vertices at one place, or a tolerance.
fn weld<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Weld>, D::Error> {
    let tolerance = match Value::deserialize(deserializer)? {
        Value::Boolean(false) => return Ok(None),
        Value::Boolean(true) => 0.0,
        value => real(&value).unwrap_or(f64::NAN),
    };
    let weld = Weld::within(tolerance);
    weld.map(Some).map_err(D::Error::custom)
}

/// Deserializes a non-negative distance.
fn radius<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    let radius = real(&Value::deserialize(deserializer)?);
    let radius = radius.filter(|radius| *radius >= 0.0 && radius.is_finite());
    radius
        .map(Some)
        .ok_or_else(|| D::Error::custom("a radius is a distance of 0 or more"))
}

/// Deserializes a name or a list of names.
fn names<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<String>, D::Error> {
    let names = words(deserializer)?;
    if names.iter().any(|name| name.trim().is_empty()) {
        return Err(D::Error::custom("a name is empty"));
    }
    Ok(names.iter().map(|name| name.trim().to_owned()).collect())
}

/// Deserializes a string or a number, or a list of these.
fn words<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<String>, D::Error> {
    match Value::deserialize(deserializer)? {
        Value::Array(list) if list.is_empty() => Err("the list is empty".to_owned()),
        Value::Array(list) => list.iter().map(word).collect(),
        value => word(&value).map(|word| vec![word]),
    }
    .map_err(D::Error::custom)
}

/// Converts a table of a name and parameters to the notation of the command line.
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

/// The text of a string or a number.
fn word(value: &Value) -> Result<String, String> {
    match value {
        Value::String(text) => Ok(text.clone()),
        Value::Integer(number) => Ok(number.to_string()),
        Value::Float(number) => Ok(number.to_string()),
        _ => Err("a number or a word is expected".to_owned()),
    }
}
