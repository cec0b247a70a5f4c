//! Reads TOML files with serde. Errors name the file, the line and the key.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

use geobench_mesh::did_you_mean;
use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeOwned, Error, IgnoredAny, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_path_to_error::Segment;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// An error in a TOML file that a user wrote.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{}: {problem}", path.display(), at(*line))]
pub struct DocumentError {
    /// The file.
    pub path: PathBuf,
    /// The line, counted from 1; `None` if the error has no place in the file.
    pub line: Option<usize>,
    /// Description of the error, with the allowed values.
    pub problem: String,
}

fn at(line: Option<usize>) -> String {
    line.map_or_else(String::new, |line| format!(", line {line}"))
}

/// The path and the text of a TOML file.
#[derive(Clone, Debug)]
pub struct TomlDocument<'p> {
    path: &'p Path,
    text: String,
    /// The positions of the line ends.
    line_ends: Vec<usize>,
}

impl<'p> TomlDocument<'p> {
    /// A document with this text, which messages attribute to `path`.
    pub fn new(path: &'p Path, text: &str) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        Self {
            path,
            line_ends: ends.map(|(at, _)| at).collect(),
            text: text.to_owned(),
        }
    }

    /// Reads the file at `path`.
    ///
    /// # Errors
    ///
    /// When the file cannot be read.
    pub fn open(path: &'p Path) -> Result<Self, DocumentError> {
        let text = super::read_file(path).map_err(|error| DocumentError {
            path: path.to_owned(),
            line: None,
            problem: error.to_string(),
        })?;
        Ok(Self::new(path, &text))
    }

    /// The directory to which paths in the file are relative.
    pub(crate) fn directory(&self) -> &'p Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// Parses the file as TOML.
    ///
    /// # Errors
    ///
    /// At the first line that is no TOML.
    pub fn parse(&self) -> Result<Spanned<DeTable<'_>>, DocumentError> {
        DeTable::parse(&self.text).map_err(|error| self.error(error.span(), error.message()))
    }

    /// Deserializes a table.
    ///
    /// # Errors
    ///
    /// At the first key or value that `T` does not accept.
    pub fn read<T: DeserializeOwned>(
        &self,
        table: Spanned<DeTable<'_>>,
    ) -> Result<T, DocumentError> {
        let toml = toml::Deserializer::from(table);
        serde_path_to_error::deserialize(toml).map_err(|error| {
            let last_key = error.path().iter().rev().find_map(|segment| match segment {
                // The internal keys of `Spanned` are not keys of the file.
                Segment::Map { key } if !key.starts_with("$__serde_spanned") => Some(key.clone()),
                _ => None,
            });
            let error = error.into_inner();
            let unknown = names_of_unknown_key(error.message());
            match (
                unknown.map(|(name, known)| unknown_key(&name, &known)),
                last_key,
            ) {
                (None, Some(key)) => self.error_at(&key, error.span(), &plain(error.message())),
                (Some(problem), _) => self.error(error.span(), &problem),
                (None, None) => self.error(error.span(), &plain(error.message())),
            }
        })
    }

    /// The table that `value`, that of `key`, is.
    fn table<'t>(
        &self,
        key: &str,
        value: Spanned<DeValue<'t>>,
    ) -> Result<Spanned<DeTable<'t>>, DocumentError> {
        let span = value.span();
        match value.into_inner() {
            DeValue::Table(table) => Ok(Spanned::new(span, table)),
            _ => Err(self.error_at(key, Some(span), "a table is expected")),
        }
    }

    /// An error in the value of `key`.
    pub fn error_at(&self, key: &str, span: Option<Range<usize>>, problem: &str) -> DocumentError {
        self.error(span, &format!("`{key}`: {problem}"))
    }

    pub(crate) fn error(&self, span: Option<Range<usize>>, problem: &str) -> DocumentError {
        DocumentError {
            path: self.path.to_owned(),
            line: span.map(|span| self.line(&span)),
            problem: problem.replace('\n', " "),
        }
    }

    /// The line on which `span` starts, counted from 1.
    pub(crate) fn line(&self, span: &Range<usize>) -> usize {
        1 + self.line_ends.partition_point(|end| *end < span.start)
    }
}

/// A table whose keys are those of several types.
pub(crate) struct TableParts<'d, 't> {
    document: &'d TomlDocument<'d>,
    table: Spanned<DeTable<'t>>,
    /// The keys of the types read until now.
    known: Vec<String>,
}

impl<'d, 't> TableParts<'d, 't> {
    /// The keys `read` have been removed from the table.
    pub(crate) fn new(
        document: &'d TomlDocument<'d>,
        table: Spanned<DeTable<'t>>,
        read: &[&str],
    ) -> Self {
        Self {
            document,
            table,
            known: read.iter().map(ToString::to_string).collect(),
        }
    }

    /// Removes the keys of `T` and deserializes them. Serde's `flatten` would lose the lines of
    /// errors.
    ///
    /// # Errors
    ///
    /// At the first value that `T` does not accept.
    pub(crate) fn take<T: DeserializeOwned>(&mut self) -> Result<T, DocumentError> {
        let (keys, span) = (keys::<T>(), self.table.span());
        let table = std::mem::take(self.table.get_mut()).into_iter();
        let (own, rest) = table.partition(|(key, _)| keys.iter().any(|one| one == key.get_ref()));
        self.known.extend(keys);
        *self.table.get_mut() = rest;
        self.document.read(Spanned::new(span, own))
    }

    /// Removes the value of `key`.
    fn take_value(&mut self, key: &str) -> Option<Spanned<DeValue<'t>>> {
        self.known.push(key.to_owned());
        self.table.get_mut().remove(key)
    }

    /// Removes the table at `key`.
    pub(crate) fn take_table(&mut self, key: &str) -> Result<Option<Self>, DocumentError> {
        let Some(value) = self.take_value(key) else {
            return Ok(None);
        };
        let table = self.document.table(key, value)?;
        Ok(Some(Self::new(self.document, table, &[])))
    }

    /// Removes the array of tables at `key`; empty if the key is absent.
    pub(crate) fn take_tables(
        &mut self,
        key: &str,
    ) -> Result<Vec<Spanned<DeTable<'t>>>, DocumentError> {
        let Some(value) = self.take_value(key) else {
            return Ok(Vec::new());
        };
        let span = value.span();
        let DeValue::Array(tables) = value.into_inner() else {
            let problem = "a list in [] is expected";
            return Err(self.document.error_at(key, Some(span), problem));
        };
        let tables = tables.into_iter();
        tables
            .map(|value| self.document.table(key, value))
            .collect()
    }

    /// Ends the reading of the table. Returns its document.
    ///
    /// # Errors
    ///
    /// If keys are left.
    pub(crate) fn end(self) -> Result<&'d TomlDocument<'d>, DocumentError> {
        let keys = self.table.get_ref().keys();
        match keys.min_by_key(|key| key.span().start) {
            Some(key) => {
                let problem = unknown_key(key.get_ref(), &self.known);
                Err(self.document.error(Some(key.span()), &problem))
            }
            None => Ok(self.document),
        }
    }
}

/// The keys of the struct `T`, which denies others.
fn keys<T: DeserializeOwned>() -> Vec<String> {
    let error = toml::from_str::<T>("'' = 0").err();
    let keys = error.and_then(|error| Some(names_of_unknown_key(error.message())?.1));
    keys.unwrap_or_default()
}

/// The message for the unknown key `name`.
fn unknown_key(name: &str, known: &[String]) -> String {
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    format!(
        "there is no key `{name}` here{}; known are {}",
        did_you_mean(name, &known),
        known.join(", ")
    )
}

/// The unknown key and the known keys in a message of serde, which puts them between backticks in
/// this order; `None` for another error.
fn names_of_unknown_key(message: &str) -> Option<(String, Vec<String>)> {
    let names = message.strip_prefix("unknown field")?.split('`').skip(1);
    let mut names = names.step_by(2).map(str::to_owned);
    Some((names.next()?, names.collect()))
}

/// Translates serde's message for a value of the wrong type into the terms of TOML. Other messages
/// come from this crate and stay as they are.
fn plain(message: &str) -> String {
    let wrong_type = message.strip_prefix("invalid type: ");
    let Some((_, expected)) = wrong_type.and_then(|rest| rest.rsplit_once(", expected ")) else {
        return message.to_owned();
    };
    let expected = match expected {
        "a string" => "a text in quotes",
        "a boolean" => "true or false",
        "a sequence" => "a list in []",
        "a map" => "a table",
        other => other,
    };
    format!("{expected} is expected")
}

/// Deserializes a string by `text`, or a table of type `T` by `table`. Errors of the visitor carry
/// the line of the value. Errors of `#[serde(try_from)]` in a list carry the line of the list.
///
/// # Errors
///
/// Those of `text` and `table`, and for a value of another type.
pub fn text_or_table<'de, D: Deserializer<'de>, T: Deserialize<'de>, V>(
    deserializer: D,
    text: fn(&str) -> Result<V, String>,
    table: fn(T) -> Result<V, String>,
) -> Result<V, D::Error> {
    struct TextOrTable<T, V> {
        text: fn(&str) -> Result<V, String>,
        table: fn(T) -> Result<V, String>,
    }
    impl<'de, T: Deserialize<'de>, V> Visitor<'de> for TextOrTable<T, V> {
        type Value = V;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a string")
        }

        fn visit_str<E: Error>(self, text: &str) -> Result<V, E> {
            (self.text)(text).map_err(E::custom)
        }

        fn visit_map<M: MapAccess<'de>>(self, map: M) -> Result<V, M::Error> {
            let table = T::deserialize(MapAccessDeserializer::new(map))?;
            (self.table)(table).map_err(M::Error::custom)
        }
    }
    deserializer.deserialize_any(TextOrTable { text, table })
}

/// Deserializes a string by `text`.
///
/// # Errors
///
/// Those of `text`, and for a value of another type.
pub fn parsed<'de, D: Deserializer<'de>, V>(
    deserializer: D,
    text: fn(&str) -> Result<V, String>,
) -> Result<V, D::Error> {
    let no_table = |_: IgnoredAny| Err("a text in quotes is expected".to_owned());
    text_or_table(deserializer, text, no_table)
}
