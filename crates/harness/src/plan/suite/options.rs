//! Options that several commands share. Suite files have the same keys, so clap and serde derive on
//! the same structs, in which `None` means unset. Their comments are the help texts.

use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::anyhow;
use geobench_mesh::io::ObjReader;
use geobench_mesh::{Weld, WeldError};
use geobench_registry::{self as registry, MOST_THREADS, Selection, SimdChoice, UsageError};
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use toml::{Spanned, Value};

use crate::exec::goal::GoalSpec;
use crate::exec::limits::{DecompressionLimit, Limits, MemoryLimit, Timeout};
use crate::exec::point_files::points_in;
use crate::exec::source::{SourceSpec, TargetSpec};
use crate::usage::document::{DocumentError, TableParts, text_or_table};

/// Defines structs of options: for each option its help text, key, value, argument of clap and
/// attribute of serde; then groups of options with their headings in help, `_` for none.
macro_rules! options {
    ($($(#[doc = $about:literal])* $name:ident {
        $($(#[doc = $help:literal])* $key:ident: $value:ty, [$($arg:tt)*], [$($serde:tt)*];)*
        $($heading:literal: $group:ident: $type:ty;)*
        $(_: $plain:ident: $plain_type:ty;)*
    })*) => {
        $(
            $(#[doc = $about])*
            #[derive(Clone, Debug, Default, serde::Deserialize)]
            #[cfg_attr(feature = "cli", derive(clap::Args))]
            #[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
            pub struct $name {
                $(
                    $(#[doc = $help])*
                    #[cfg_attr(feature = "cli", arg($($arg)*))]
                    #[serde($($serde)*)]
                    pub $key: Option<$value>,
                )*
                $(
                    /// A group of options.
                    #[cfg_attr(feature = "cli", command(flatten, next_help_heading = $heading))]
                    #[serde(skip)]
                    pub $group: $type,
                )*
                $(
                    /// A group of options, under the heading of these.
                    #[cfg_attr(feature = "cli", command(flatten))]
                    #[serde(skip)]
                    pub $plain: $plain_type,
                )*
            }

            impl $name {
                /// These settings, completed by those of `other`.
                #[must_use]
                pub fn completed_by(&self, other: &Self) -> Self {
                    Self {
                        $($key: self.$key.clone().or_else(|| other.$key.clone()),)*
                        $($group: self.$group.completed_by(&other.$group),)*
                        $($plain: self.$plain.completed_by(&other.$plain),)*
                    }
                }

                /// Reads the settings of a table.
                pub(super) fn take(table: &mut TableParts<'_, '_>) -> Result<Self, DocumentError> {
                    #[allow(unused_mut, reason = "some have no groups")]
                    let mut all: Self = table.take()?;
                    $(all.$group = <$type>::take(table)?;)*
                    $(all.$plain = <$plain_type>::take(table)?;)*
                    Ok(all)
                }
            }
        )*
    };
}
pub(super) use options;

options! {
    /// Which algorithms run.
    AlgorithmsOption {
        /// Algorithms by name, by family, or exact, or all; separated by commas; with parameters as
        /// name{key=value,...} [default: mmp,ich,fwp-mmp,fwp-ch,vtp with --simd scalar, and
        /// mmp-fast,ich-fast,vtp,vtp-fast with the widest instructions for the fast forms]
        algorithms: Algorithms, [long = "algo", value_name = "LIST"], [deserialize_with = "algorithms"];
    }

    /// Where runs start.
    SourceOption {
        /// Sources: first, largest (the first vertex of the largest component, vertex 0 if there is
        /// only one), a vertex number, random:N[,seed=S], all, edge:A-B,T (from vertex A the
        /// fraction T of the way to B), face:F,U,V,W (barycentric coordinates), at:X,Y,Z (the
        /// nearest point), or a list of these; may be repeated [default: largest]
        source: Vec<SourceSpec>, [long, value_name = "SRC", allow_negative_numbers = true], [deserialize_with = "points"];

        /// Sources from a file with one SRC in a line, beside those of --source
        sources: Spanned<PathBuf>, [long, value_name = "FILE", value_parser = path()], [];
    }

    /// Where runs may end.
    TargetOption {
        /// Only the distances of these points, in the forms of --source; may be repeated. Runs end
        /// as soon as they are final [default: all vertices]
        target: Vec<TargetSpec>, [long, value_name = "DST", allow_negative_numbers = true], [deserialize_with = "points"];

        /// Targets from a file with one DST in a line, beside those of --target
        targets: Spanned<PathBuf>, [long, value_name = "FILE", value_parser = path()], [];
    }

    /// What runs are to find.
    GoalOptions {
        /// Only distances up to R, in the units of the model; others are infinite. Runs end there
        radius: NotNegative, [long, value_name = "R", allow_negative_numbers = true], [];

        _: target: TargetOption;
    }

    /// The threads of a command.
    ThreadsOption {
        /// Threads of the parallel algorithms (pvtp, vsp, pch), of the set-up of svg, and of
        /// outside programs whose command has {threads} [default: 1]
        threads: Whole<1, { MOST_THREADS as u64 }>, [long, value_name = "N", allow_negative_numbers = true], [];
    }

    /// The vector instructions of algorithms.
    SimdOption {
        /// Instructions of every algorithm: auto (scalar for the algorithms of papers, the widest
        /// of the processor for the fast forms), scalar, avx2 or avx512; narrower ones where the
        /// processor lacks them. Distances and counts do not depend on it [default: auto]
        simd: SimdChoice, [long, value_name = "SIMD"], [deserialize_with = "text"];
    }

    /// The rule of right distances.
    ToleranceOption {
        /// Largest relative difference that passes, beside rounding [default: 1e-9]
        tolerance: NotNegative, [long, value_name = "T", allow_negative_numbers = true], [];
    }

    /// Limits of a run and its process.
    LimitOptions {
        /// Time limit of each run, such as 90s or 1h30m, or none; a cell that exceeds it ends as
        /// `timeout` [default: 10m]
        timeout: Timeout, [long, value_name = "DUR", allow_negative_numbers = true], [deserialize_with = "text"];

        /// Memory limit of the process of each cell, such as 8GiB, or none; a cell that exceeds it
        /// ends as `out_of_memory` [default: none]
        memory_limit: MemoryLimit, [long, value_name = "SIZE", allow_negative_numbers = true], [deserialize_with = "text"];
    }

    /// Limit of decompression.
    DecompressionOption {
        /// Bytes that a compressed model may decompress to, such as 16GiB [default: 100 times its
        /// size, at least 64MiB, at most 8GiB]
        max_decompressed: DecompressionLimit, [long, value_name = "SIZE", allow_negative_numbers = true], [deserialize_with = "text"];
    }

    /// The reader of OBJ files.
    ReaderOption {
        /// What reads OBJ files: direct (this program), or tobj (a library, to compare with)
        /// [default: direct]
        reader: ObjReader, [long, value_name = "READER"], [deserialize_with = "text"];
    }

    /// Which vertices of models are welded.
    WeldOption {
        /// Make vertices at one place one vertex: without TOL those at exactly one place, else
        /// those within TOL of the first, as a fraction of the diagonal of the bounding box.
        /// Vertices keep their numbers
        weld: Welding, [long, value_name = "TOL", num_args = 0..=1, require_equals = true, default_missing_value = "0"], [deserialize_with = "weld"];
    }
}

/// The help of `--simd` in commands without tables of results.
pub const WIDEST_SIMD_HELP: &str = "Instructions of every algorithm: auto (the widest of the \
    processor), scalar, avx2 or avx512; narrower ones where the processor lacks them. Distances and \
    counts do not depend on it [default: auto]";

/// A source or target as specified by the user, and its file and line if it was read from a file.
pub type Wanted<T> = (T, Option<String>);

/// Reads a file of the user.
type ReadText = fn(&Path) -> io::Result<String>;

/// The points `named` and those of `file`, which `read` reads.
fn with_file<T: Clone + FromStr<Err: Display>>(
    named: Option<&Vec<T>>,
    file: Option<&Spanned<PathBuf>>,
    noun: &str,
    read: ReadText,
) -> anyhow::Result<Vec<Wanted<T>>> {
    let named = named.into_iter().flatten();
    let mut all: Vec<Wanted<T>> = named.map(|point| (point.clone(), None)).collect();
    if let Some(path) = file.map(Spanned::get_ref) {
        let text = read(path).map_err(|error| anyhow!("{}: {error}", path.display()))?;
        let read = points_in(path, &text, noun)?.into_iter();
        all.extend(read.map(|(point, place)| (point, Some(place))));
    }
    Ok(all)
}

/// The points without their places; `None` if there are none.
fn without_places<T>(all: Vec<Wanted<T>>) -> Option<Vec<T>> {
    let all = all.into_iter().map(|(point, _)| point);
    Some(all.collect()).filter(|all: &Vec<_>| !all.is_empty())
}

impl SourceOption {
    /// The sources of the options and of the sources file, whose text `read` reads.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, has no sources, or has a line that is not a source.
    pub fn wanted(&self, read: ReadText) -> anyhow::Result<Vec<Wanted<SourceSpec>>> {
        with_file(self.source.as_ref(), self.sources.as_ref(), "source", read)
    }

    /// The sources file.
    pub fn file(&self) -> Option<&Path> {
        self.sources.as_ref().map(|file| &**file.get_ref())
    }

    /// Adds the sources of the sources file to the others.
    ///
    /// # Errors
    ///
    /// As [`wanted`](Self::wanted).
    pub fn read_sources(&mut self, read: ReadText) -> anyhow::Result<()> {
        self.source = without_places(self.wanted(read)?);
        Ok(())
    }
}

impl TargetOption {
    /// The targets of the options and of the targets file, whose text `read` reads. Empty for all
    /// vertices.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, has no targets, or has a line that is not a target.
    pub fn wanted(&self, read: ReadText) -> anyhow::Result<Vec<Wanted<TargetSpec>>> {
        with_file(self.target.as_ref(), self.targets.as_ref(), "target", read)
    }

    /// The targets file.
    pub fn file(&self) -> Option<&Path> {
        self.targets.as_ref().map(|file| &**file.get_ref())
    }

    /// Adds the targets of the targets file to the others.
    ///
    /// # Errors
    ///
    /// As [`wanted`](Self::wanted).
    pub fn read_targets(&mut self, read: ReadText) -> anyhow::Result<()> {
        self.target = without_places(self.wanted(read)?);
        Ok(())
    }
}

impl GoalOptions {
    /// The radius as a goal, without targets.
    pub fn limit(&self) -> GoalSpec {
        GoalSpec {
            targets: None,
            radius: self.radius.map(|radius| radius.0),
        }
    }

    /// The goal of runs, without the targets of a file that is not
    /// [read](TargetOption::read_targets).
    pub fn spec(&self) -> GoalSpec {
        GoalSpec {
            targets: self.target.target.clone().map(TargetSpec::of_all),
            ..self.limit()
        }
    }
}

impl ThreadsOption {
    /// The number of threads.
    pub fn number(&self) -> usize {
        self.threads.map_or(1, |threads| threads.0 as usize)
    }
}

impl ToleranceOption {
    /// The largest relative difference that passes.
    pub fn number(&self) -> f64 {
        self.tolerance.map_or(1e-9, |tolerance| tolerance.0)
    }
}

impl LimitOptions {
    /// These limits and that of decompression, with defaults.
    pub fn with(&self, decompression: &DecompressionOption) -> Limits {
        Limits {
            timeout: self.timeout.unwrap_or(Timeout::USUAL),
            memory: self.memory_limit.unwrap_or_default(),
            decompressed: decompression.limit(),
        }
    }
}

impl DecompressionOption {
    /// The limit, or the default.
    pub fn limit(&self) -> DecompressionLimit {
        self.max_decompressed.unwrap_or_default()
    }
}

impl WeldOption {
    /// Which vertices are welded.
    pub fn vertices(&self) -> Option<Weld> {
        self.weld.and_then(|welding| welding.0)
    }
}

/// Which vertices are welded: none if `false`, with which a group overrides a weld of all groups.
#[derive(Clone, Copy, Debug)]
pub struct Welding(Option<Weld>);

impl FromStr for Welding {
    type Err = WeldError;

    fn from_str(text: &str) -> Result<Self, WeldError> {
        text.parse().map(|weld| Self(Some(weld)))
    }
}

/// A list of algorithms. This is a separate type because clap treats a `Vec` as a repeated option.
#[derive(Clone, Debug)]
pub struct Algorithms(pub Vec<Selection>);

impl FromStr for Algorithms {
    type Err = UsageError;

    fn from_str(list: &str) -> Result<Self, UsageError> {
        registry::select(list).map(Self)
    }
}

/// A whole number from `LEAST` to `MOST`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Whole<const LEAST: u64, const MOST: u64>(pub u64);

impl<const LEAST: u64, const MOST: u64> FromStr for Whole<LEAST, MOST> {
    type Err = UsageError;

    fn from_str(text: &str) -> Result<Self, UsageError> {
        match text.parse() {
            Ok(number) if (LEAST..=MOST).contains(&number) => Ok(Self(number)),
            _ => Err(UsageError(format!(
                "a whole number from {LEAST} to {MOST} is expected"
            ))),
        }
    }
}

impl<'de, const LEAST: u64, const MOST: u64> Deserialize<'de> for Whole<LEAST, MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let number = Value::deserialize(deserializer)?.as_integer();
        let text = number.map_or_else(String::new, |number| number.to_string());
        text.parse().map_err(D::Error::custom)
    }
}

/// A finite number of at least 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NotNegative(pub f64);

impl FromStr for NotNegative {
    type Err = UsageError;

    fn from_str(text: &str) -> Result<Self, UsageError> {
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() && number >= 0.0 => Ok(Self(number)),
            _ => Err(UsageError("a number of 0 or more is expected".to_owned())),
        }
    }
}

impl<'de> Deserialize<'de> for NotNegative {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let number = real(&Value::deserialize(deserializer)?);
        let text = number.map_or_else(String::new, |number| number.to_string());
        text.parse().map_err(D::Error::custom)
    }
}

/// Parses a path of the command line, which has no place in a document.
#[cfg(feature = "cli")]
fn path() -> impl clap::builder::TypedValueParser<Value = Spanned<PathBuf>> {
    use clap::builder::{PathBufValueParser, TypedValueParser};
    PathBufValueParser::new().map(unplaced)
}

/// A value of the command line, which has no place in a document.
#[cfg(feature = "cli")]
pub(super) fn unplaced<T>(value: T) -> Spanned<T> {
    Spanned::new(0..0, value)
}

/// Deserializes a non-empty list.
pub(super) fn list<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<Vec<T>>, D::Error> {
    let list = Vec::deserialize(deserializer)?;
    if list.is_empty() {
        return Err(D::Error::custom("the list is empty"));
    }
    Ok(Some(list))
}

/// Deserializes a value by parsing a string.
pub(super) fn text<'de, D: Deserializer<'de>, T: FromStr<Err: Display>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    let value = String::deserialize(deserializer)?.parse();
    value.map(Some).map_err(D::Error::custom)
}

/// The value of an integer or a floating-point number.
fn real(value: &Value) -> Option<f64> {
    let whole = value.as_integer().map(|number| number as f64);
    value.as_float().or(whole)
}

/// Deserializes a weld: `true` for vertices at one place, `false` for none, or a tolerance.
fn weld<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Welding>, D::Error> {
    let tolerance = match Value::deserialize(deserializer)? {
        Value::Boolean(false) => return Ok(Some(Welding(None))),
        Value::Boolean(true) => 0.0,
        value => real(&value).unwrap_or(f64::NAN),
    };
    let weld = Weld::within(tolerance).map_err(D::Error::custom)?;
    Ok(Some(Welding(Some(weld))))
}

/// Deserializes a list of algorithms. An element is a list in the notation of the command line, or
/// a table of a name and parameters.
fn algorithms<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Algorithms>, D::Error> {
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
    let elements = elements.into_iter().flatten();
    let chosen = registry::distinct(elements.flat_map(|list| list.0));
    Ok(Some(Algorithms(chosen)))
}

/// Deserializes sources or targets: a vertex, a string in the notation of the command line, or a
/// list of these.
fn points<'de, D: Deserializer<'de>, T: FromStr<Err: Display>>(
    deserializer: D,
) -> Result<Option<Vec<T>>, D::Error> {
    let words = words(deserializer)?;
    let points = words.iter().map(|word| word.parse());
    let points: Result<Vec<T>, _> = points.collect();
    points.map(Some).map_err(D::Error::custom)
}

/// Deserializes a string or a number, or a list of these.
pub(super) fn words<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<String>, D::Error> {
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
