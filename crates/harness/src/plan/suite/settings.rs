//! Settings and their form in suite files.

use std::str::FromStr;

use geobench_mesh::generate::Spec;
#[cfg(feature = "cli")]
use geobench_registry as registry;
use geobench_registry::{Selection, UsageError};
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use toml::Spanned;

use super::options::{
    AlgorithmsOption, DecompressionOption, GoalOptions, LimitOptions, ReaderOption, SimdOption,
    SourceOption, ThreadsOption, ToleranceOption, WeldOption, Whole, list, options, text, words,
};
use crate::figures;
use crate::plan::Reference;
use crate::plan::sampling::{Sampling, Seconds, Share};
use crate::schema::Precision;
use crate::usage::document::{DocumentError, TableParts, TomlDocument, parsed, text_or_table};
use crate::usage::read_file;

/// Maximum number of subdivisions of a model.
const MOST_SUBDIVISIONS: u64 = 12;

/// Maximum number of timed runs or warm-ups of a cell.
const MOST_RUNS: u64 = 1_000_000;

options! {
    /// Settings from one source, which are options of `geobench run` and keys of suite files.
    /// `None` means unset.
    Settings {
        /// Models; without any, those of the suite, or a built-in suite of generated ones
        models: Vec<Spanned<WantedModel>>, [help_heading = None, value_name = "MODEL", value_parser = placeless::<WantedModel>], [deserialize_with = "list"];

        /// Run once from all sources together, with distances from the nearest, not once from each
        sources_together: bool, [help_heading = "Sources and targets", long, num_args = 0, default_missing_value = "true"], [];

        /// Timed runs of each cell [default: 6 to 100, as many as --precision needs]
        repeat: Whole<1, MOST_RUNS>, [help_heading = "Repetitions", long, value_name = "N", allow_negative_numbers = true], [];

        /// Repeat until the 95 % interval of the median time lies within this share of the median;
        /// short solves are timed in batches [default: 3%]
        precision: Share, [help_heading = "Repetitions", long, value_name = "P", conflicts_with = "repeat"], [deserialize_with = "text"];

        /// Least time that the timed runs of a cell take together, such as 1s [default: 0.2s]
        min_time: Seconds, [help_heading = "Repetitions", long, value_name = "T", conflicts_with = "repeat"], [deserialize_with = "text"];

        /// Time after which no timed run of a cell starts, such as 1m [default: 20s; 1s for the
        /// built-in suite]
        max_time: Seconds, [help_heading = "Repetitions", long, value_name = "T", conflicts_with = "repeat"], [deserialize_with = "text"];

        /// Untimed runs of each cell before the timed ones [default: 1]
        warmup: Whole<0, MOST_RUNS>, [help_heading = "Repetitions", long, value_name = "N", allow_negative_numbers = true], [];

        /// Only warm-ups and timed runs: no profiled run, which gives phases and peaks of memory,
        /// and no counted run, which takes several times as long as a timed one
        counts: bool, [help_heading = "Repetitions", long = "no-counts", num_args = 0, default_missing_value = "false"], [];

        /// Seed of the order in which the algorithms take turns [default: 1]
        seed: Whole<0, { u64::MAX }>, [help_heading = "Repetitions", long, value_name = "N", allow_negative_numbers = true], [];

        /// What answers must agree with: an algorithm, certificate (mmp with a proof of its
        /// distances), none, file (MODEL.sSOURCE.csv beside the model or in a folder named expected
        /// there or beside its folder), or the path of such a file [default: mmp-fast if it runs,
        /// else the first exact algorithm, else mmp-fast; another one for a single algorithm]
        check: Spanned<Reference>, [help_heading = "Checks", long, value_name = "REF", value_parser = placeless::<Reference>], [];

        /// Rows of tables: time, propagated and any other counter, generated, valid, ...; separated
        /// by commas [default: time, propagations and two measures of memory]
        rows: Vec<String>, [help_heading = "Output", long, value_name = "LIST", value_delimiter = ',', value_parser = row], [deserialize_with = "rows"];

        /// Show the ratio of each algorithm to this one as well; of times, the median of the ratios
        /// run by run
        ratios_to: Selection, [help_heading = "Output", long, value_name = "A", value_parser = registry::select_one], [deserialize_with = "text", rename = "ratios_to"];

        /// Keep samples of the wavefront of each counted run, for the plots of `geobench report`
        wavefront: bool, [help_heading = "Output", long, num_args = 0, default_missing_value = "true", conflicts_with = "counts"], [];

        "What runs": algorithms: AlgorithmsOption;
        "What runs": threads: ThreadsOption;
        "What runs": simd: SimdOption;
        "Sources and targets": source: SourceOption;
        "Sources and targets": goal: GoalOptions;
        "Checks": tolerance: ToleranceOption;
        "Processes": limits: LimitOptions;
        "Processes": decompression: DecompressionOption;
        "Processes": weld: WeldOption;
        "Processes": reader: ReaderOption;
    }
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

impl FromStr for WantedModel {
    type Err = UsageError;

    /// A mandatory model with only a path or a specification.
    fn from_str(path: &str) -> Result<Self, UsageError> {
        if path.is_empty() {
            return Err(UsageError("a model must have a `path`".to_owned()));
        }
        Ok(Self {
            path: path.to_owned(),
            ..Self::default()
        })
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
            subdivide: Option<Whole<0, MOST_SUBDIVISIONS>>,
        }

        fn of_path(path: &str) -> Result<WantedModel, String> {
            path.parse().map_err(|error: UsageError| error.0)
        }
        let of_table = |table: Table| {
            let subdivide = table.subdivide.map_or(0, |number| number.0 as u32);
            let model = of_path(&table.path)?;
            if subdivide > 0 && table.real.is_empty() {
                let problem = "`subdivide` is for a model that has `real`; let `path` be `gen:file,path=...,subdivide=...`";
                return Err(problem.to_owned());
            }
            Ok(Self {
                optional: table.optional,
                real: table.real,
                subdivide,
                ..model
            })
        };
        text_or_table(deserializer, of_path, of_table)
    }
}

impl Settings {
    /// These settings, completed by those of `other`.
    #[must_use]
    pub fn or(&self, other: &Self) -> Self {
        let mut all = self.completed_by(other);
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
    ///
    /// # Errors
    ///
    /// If the least time is above the greatest.
    pub(super) fn sampling(&self) -> Result<Sampling, UsageError> {
        if let Some(repeat) = self.repeat {
            return Ok(Sampling::Fixed(repeat.0 as usize));
        }
        if let (Some(Seconds(least)), Some(Seconds(greatest))) = (self.min_time, self.max_time)
            && least > greatest
        {
            return Err(UsageError(format!(
                "`min-time` is {least} s and above the {greatest} s of `max-time`; lower it, or \
                 raise `max-time`"
            )));
        }
        let usual = Precision::USUAL;
        Ok(Sampling::UntilPrecise(Precision {
            relative: self.precision.map_or(usual.relative, |share| share.0),
            min_time: self.min_time.map_or(usual.min_time, |time| time.0),
            max_time: self.max_time.map_or(usual.max_time, |time| time.0),
        }))
    }

    /// Reads settings from the keys of a table that are left.
    pub(super) fn read(mut table: TableParts<'_, '_>) -> Result<Self, DocumentError> {
        let mut settings = Self::take(&mut table)?;
        let document = table.end()?;
        settings.resolve(document)?;
        Ok(settings)
    }

    /// Resolves paths and lines of the settings in `document`.
    fn resolve(&mut self, document: &TomlDocument<'_>) -> Result<(), DocumentError> {
        for model in self.models.iter_mut().flatten() {
            let line = document.line(&model.span());
            let model = model.get_mut();
            model.line = Some(line);
            if !Spec::is_spec(&model.path) {
                let path = document.directory().join(&model.path);
                model.path = path.display().to_string();
            }
        }
        let (sources, targets) = (&mut self.source, &mut self.goal.target);
        for file in sources.sources.iter_mut().chain(&mut targets.targets) {
            *file.get_mut() = document.directory().join(file.get_ref());
        }
        let span = sources.sources.as_ref().map(Spanned::span);
        let read = sources.read_sources(read_file);
        read.map_err(|error| document.error_at("sources", span, &error.to_string()))?;
        let span = targets.targets.as_ref().map(Spanned::span);
        let read = targets.read_targets(read_file);
        read.map_err(|error| document.error_at("targets", span, &error.to_string()))?;
        if let Some(check) = &mut self.check {
            let span = Some(check.span());
            let resolved = check.get_mut().resolve(document.directory());
            resolved.map_err(|error| document.error_at("check", span, &error.to_string()))?;
        }
        Ok(())
    }
}

/// Parses a value of the command line, which has no place in a document.
#[cfg(feature = "cli")]
fn placeless<T: FromStr>(text: &str) -> Result<Spanned<T>, T::Err> {
    text.parse().map(super::options::unplaced)
}

/// Parses the name of a row of tables.
fn row(name: &str) -> Result<String, UsageError> {
    figures::figure(name).map(|figure| figure.key.to_owned())
}

/// Deserializes names of rows.
fn rows<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Vec<String>>, D::Error> {
    struct Row(String);
    impl<'de> Deserialize<'de> for Row {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            parsed(deserializer, |name| {
                row(name).map(Self).map_err(|error| error.to_string())
            })
        }
    }
    let rows: Option<Vec<Row>> = list(deserializer)?;
    Ok(rows.map(|rows| rows.into_iter().map(|row| row.0).collect()))
}

/// Deserializes a name or a list of names.
fn names<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<String>, D::Error> {
    let names = words(deserializer)?;
    if names.iter().any(|name| name.trim().is_empty()) {
        return Err(D::Error::custom("a name is empty"));
    }
    Ok(names.iter().map(|name| name.trim().to_owned()).collect())
}
