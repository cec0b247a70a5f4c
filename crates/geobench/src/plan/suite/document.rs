//! TOML values with the lines that they stand on.

use std::ops::Range;
use std::path::{Path, PathBuf};

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use crate::registry::nearest;

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
