//! Keys of a spec and their values.

use std::fmt;

use super::GenerateError;

/// A key that a family or a modifier takes.
#[derive(Debug)]
pub struct Key {
    /// Its name, lower case.
    pub name: &'static str,
    /// The kind of its value.
    pub kind: Kind,
    /// Its meaning, in a few words.
    pub summary: &'static str,
}

/// The kind of a value, with its range (ends included).
#[derive(Debug)]
#[allow(missing_docs)] // The fields are a default and a range throughout.
pub enum Kind {
    /// A whole number.
    Whole { default: u64, min: u64, max: u64 },
    /// A finite real number.
    Real { default: f64, min: f64, max: f64 },
    /// One of these words; the first is the default.
    Choice(&'static [&'static str]),
    /// A file's path; it has no default.
    Path,
    /// An abbreviation that sets all these keys of the same table to one value.
    All(&'static [&'static str]),
}

impl Key {
    pub(super) const fn whole(
        name: &'static str,
        default: u64,
        [min, max]: [u64; 2],
        summary: &'static str,
    ) -> Self {
        let kind = Kind::Whole { default, min, max };
        Self {
            name,
            kind,
            summary,
        }
    }

    pub(super) const fn real(
        name: &'static str,
        default: f64,
        [min, max]: [f64; 2],
        summary: &'static str,
    ) -> Self {
        let kind = Kind::Real { default, min, max };
        Self {
            name,
            kind,
            summary,
        }
    }

    /// The value if the key is not given; `None` for a path and for an abbreviation.
    pub(super) fn default(&self) -> Option<KeyValue> {
        match self.kind {
            Kind::Whole { default, .. } => Some(KeyValue::Whole(default)),
            Kind::Real { default, .. } => Some(KeyValue::Real(default)),
            Kind::Choice(words) => words.first().map(|word| KeyValue::Word(word)),
            Kind::Path | Kind::All(_) => None,
        }
    }

    /// Reads `text` as a value of this key.
    pub(super) fn parse(
        &self,
        family: &'static str,
        text: &str,
    ) -> Result<KeyValue, GenerateError> {
        let value = match self.kind {
            Kind::Whole { min, max, .. } => text
                .parse()
                .ok()
                .filter(|value| (min..=max).contains(value))
                .map(KeyValue::Whole),
            Kind::Real { min, max, .. } => text
                .parse()
                .ok()
                .filter(|value| (min..=max).contains(value))
                // Adding 0 turns -0 into 0, which would have another text.
                .map(|value: f64| KeyValue::Real(value + 0.0)),
            Kind::Choice(words) => words
                .iter()
                .find(|word| word.eq_ignore_ascii_case(text))
                .map(|word| KeyValue::Word(word)),
            Kind::Path => (!text.is_empty()).then(|| KeyValue::Path(text.to_owned())),
            Kind::All(_) => None,
        };
        value.ok_or_else(|| GenerateError::BadValue {
            family,
            key: self.name,
            value: text.to_owned(),
            wanted: self.wanted(),
        })
    }

    /// The values that the key takes, such as `0 to 12`.
    pub(super) fn range(&self) -> String {
        match self.kind {
            Kind::Whole { min, max, .. } => format!("{min} to {max}"),
            Kind::Real { min, max, .. } => format!("{} to {}", Real(min), Real(max)),
            Kind::Choice(words) => words.join(" or "),
            Kind::Path => "a path".to_owned(),
            Kind::All(keys) => keys.join(" and "),
        }
    }

    /// The values in a sentence, such as `a whole number from 0 to 12`.
    fn wanted(&self) -> String {
        let range = self.range();
        match self.kind {
            Kind::Whole { .. } => format!("a whole number from {range}"),
            Kind::Real { .. } => format!("a number from {range}"),
            Kind::Choice(_) => range,
            Kind::Path => "the path of a model file".to_owned(),
            Kind::All(_) => format!("short for {range}"),
        }
    }
}

/// A value that has been checked against its key.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum KeyValue {
    Whole(u64),
    Real(f64),
    Word(&'static str),
    Path(String),
}

impl fmt::Display for KeyValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole(value) => write!(f, "{value}"),
            Self::Real(value) => write!(f, "{}", Real(*value)),
            Self::Word(word) => f.write_str(word),
            Self::Path(path) => {
                let plain = !path.contains(',') && !path.starts_with('"') && path.trim() == path;
                if plain {
                    f.write_str(path)
                } else {
                    write!(f, "\"{}\"", path.replace('"', "\"\""))
                }
            }
        }
    }
}

/// The shortest text that reads back as the same number.
struct Real(f64);

impl fmt::Display for Real {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.0;
        if value == 0.0 || (1e-4..1e9).contains(&value.abs()) {
            write!(f, "{value}")
        } else {
            write!(f, "{value:e}")
        }
    }
}

/// The values of a family's keys.
pub(super) struct Params<'a> {
    pub(super) values: &'a [(&'static Key, KeyValue)],
    pub(super) seed: u64,
}

impl Params<'_> {
    fn value(&self, name: &str) -> &KeyValue {
        let found = self.values.iter().find(|(key, _)| key.name == name);
        // Only the families' code asks, for keys of their own table; tests build every family.
        &found.expect("a family asks for its own keys").1
    }

    /// The value of a key of [`Kind::Whole`].
    pub(super) fn whole(&self, name: &str) -> u64 {
        match self.value(name) {
            KeyValue::Whole(value) => *value,
            other => unreachable!("{name}={other} is not a whole number"),
        }
    }

    /// As [`whole`](Self::whole), as a `usize`.
    pub(super) fn count(&self, name: &str) -> usize {
        self.whole(name) as usize
    }

    /// The value of a key of [`Kind::Real`].
    pub(super) fn real(&self, name: &str) -> f64 {
        match self.value(name) {
            KeyValue::Real(value) => *value,
            other => unreachable!("{name}={other} is not a number"),
        }
    }

    /// Whether the key of [`Kind::Choice`] has this value.
    pub(super) fn is(&self, name: &str, word: &str) -> bool {
        matches!(self.value(name), KeyValue::Word(value) if *value == word)
    }
}
