//! Parsing and formatting of specs, and making their models.

use std::fmt;
use std::str::FromStr;

use super::families::{FAMILIES, Family, Seeding};
use super::keys::{Key, KeyValue, Kind, Params};
use super::modifiers::{MODIFIER_KEYS, Modifiers};
use super::{GenerateError, MAX_FACES};
use crate::soup::TriangleSoup;
use crate::suggestion::did_you_mean;

/// A valid spec, whose model can be made.
///
/// Its text is canonical: all keys of the family with their values, then the modifiers that change
/// the model. Specs with the same text name the same model, in all versions. Parsing accepts any
/// letter case of names, any order of keys, spaces around them, and a missing `gen:`.
#[derive(Clone, Debug)]
pub struct Spec {
    family: &'static Family,
    /// A value for each of the family's keys that has one, in the table's order.
    values: Vec<(&'static Key, KeyValue)>,
    modifiers: Modifiers,
    face_count: Option<u64>,
}

/// The prefix that distinguishes specs from file names.
const PREFIX: &str = "gen:";

impl Spec {
    /// Whether `text` is meant as a spec rather than as a path: it starts with `gen:`.
    pub fn is_spec(text: &str) -> bool {
        text.starts_with(PREFIX)
    }

    /// The family of the spec.
    pub fn family(&self) -> &'static Family {
        self.family
    }

    /// The model file of `gen:file`. The caller reads it and applies
    /// [`modifiers`](Self::modifiers).
    pub fn path(&self) -> Option<&str> {
        self.values.iter().find_map(|(_, value)| match value {
            KeyValue::Path(path) => Some(path.as_str()),
            _ => None,
        })
    }

    /// The modifiers of the family's shape, or of the file's.
    pub fn modifiers(&self) -> &Modifiers {
        &self.modifiers
    }

    /// The exact number of triangles of the model; `None` for a file, which has not been read.
    pub fn face_count(&self) -> Option<u64> {
        self.face_count
    }

    fn params(&self) -> Params<'_> {
        Params {
            values: &self.values,
            seed: self.modifiers.seed,
        }
    }

    /// Whether the shape, apart from modifiers, depends on the seed.
    fn is_seeded(&self) -> bool {
        match self.family.seeding {
            Seeding::Never => false,
            Seeding::Always => true,
            Seeding::With(key) => self.params().real(key) != 0.0,
        }
    }
}

impl PartialEq for Spec {
    /// Whether both name the same model.
    fn eq(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }
}

impl fmt::Display for Spec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{PREFIX}{}", self.family.name)?;
        for (key, value) in &self.values {
            write!(f, ",{}={value}", key.name)?;
        }
        for (name, value) in self.modifiers.settings(self.is_seeded()) {
            write!(f, ",{name}={value}")?;
        }
        Ok(())
    }
}

impl FromStr for Spec {
    type Err = GenerateError;

    /// Reads a spec and checks that its model can be made and is not too large.
    fn from_str(text: &str) -> Result<Self, GenerateError> {
        let text = text.strip_prefix(PREFIX).unwrap_or(text);
        let (name, settings) = text.split_once(',').unwrap_or((text, ""));
        let family = find_family(name.trim())?;
        let mut given: Vec<(&'static Key, KeyValue)> = Vec::new();
        let mut settings = SpecPieces { rest: settings };
        while let Some(setting) = settings.next_setting(family)? {
            let (name, text) = setting;
            for key in find_keys(family, name)? {
                if given.iter().any(|(other, _)| other.name == key.name) {
                    return Err(GenerateError::Repeated {
                        family: family.name,
                        key: key.name,
                    });
                }
                given.push((key, key.parse(family.name, &text)?));
            }
        }
        let mut spec = Self {
            family,
            values: Vec::new(),
            modifiers: Modifiers::default(),
            face_count: None,
        };
        for key in MODIFIER_KEYS {
            if let Some((_, value)) = given.iter().find(|(other, _)| other.name == key.name) {
                spec.modifiers.set(key, value);
            }
        }
        for key in family.keys {
            let value = given.iter().find(|(other, _)| other.name == key.name);
            match (value.map(|(_, value)| value.clone()), key.default()) {
                (Some(value), _) | (None, Some(value)) => spec.values.push((key, value)),
                (None, None) if matches!(key.kind, Kind::Path) => {
                    return Err(GenerateError::Missing {
                        family: family.name,
                        key: key.name,
                        summary: key.summary,
                    });
                }
                (None, None) => {}
            }
        }
        if let Some(shape) = &family.shape {
            let faces = (shape.faces)(&spec.params())?;
            spec.face_count = Some(spec.modifiers.face_count(faces)?);
        }
        Ok(spec)
    }
}

fn find_family(name: &str) -> Result<&'static Family, GenerateError> {
    let names = |family: &'static Family| {
        std::iter::once(family.name).chain(family.aliases.iter().copied())
    };
    FAMILIES
        .iter()
        .find(|family| names(family).any(|known| known.eq_ignore_ascii_case(name)))
        .ok_or_else(|| GenerateError::UnknownFamily {
            name: name.to_owned(),
            hint: did_you_mean(name, &FAMILIES.iter().flat_map(names).collect::<Vec<_>>()),
            known: join(FAMILIES.iter().map(|family| family.name)),
        })
}

/// The key of this name, or the keys that it abbreviates.
fn find_keys(family: &'static Family, name: &str) -> Result<Vec<&'static Key>, GenerateError> {
    let known = || family.keys.iter().chain(MODIFIER_KEYS);
    let find = |name: &str| known().find(|key| key.name.eq_ignore_ascii_case(name));
    let key = find(name).ok_or_else(|| GenerateError::UnknownKey {
        family: family.name,
        key: name.to_owned(),
        hint: did_you_mean(name, &known().map(|key| key.name).collect::<Vec<_>>()),
        known: join(known().map(|key| key.name)),
    })?;
    Ok(match key.kind {
        Kind::All(names) => names.iter().filter_map(|name| find(name)).collect(),
        _ => vec![key],
    })
}

fn join(names: impl Iterator<Item = &'static str>) -> String {
    names.collect::<Vec<_>>().join(", ")
}

/// Iterates over the `key=value` pieces of a spec.
struct SpecPieces<'a> {
    rest: &'a str,
}

impl<'a> SpecPieces<'a> {
    /// The next key and its value, both without spaces around them.
    ///
    /// A value that starts with a quotation mark ends with the next one that is not doubled, as in
    /// CSV; any other ends at the next comma.
    fn next_setting(
        &mut self,
        family: &Family,
    ) -> Result<Option<(&'a str, String)>, GenerateError> {
        if self.rest.trim().is_empty() {
            return Ok(None);
        }
        let piece = self.rest.split(',').next().unwrap_or_default();
        let Some((key, value)) = piece.split_once('=') else {
            return Err(GenerateError::NoValue {
                family: family.name,
                piece: piece.trim().to_owned(),
            });
        };
        let key_and_sign = key.len() + 1;
        let key = key.trim();
        if !value.trim_start().starts_with('"') {
            let value = value.trim().to_owned();
            self.rest = self.rest.get(piece.len() + 1..).unwrap_or_default();
            return Ok(Some((key, value)));
        }
        let open = || GenerateError::OpenQuote {
            key: key.to_owned(),
        };
        let mut rest = &self.rest[key_and_sign..].trim_start()[1..];
        let mut value = String::new();
        loop {
            let (part, after) = rest.split_once('"').ok_or_else(open)?;
            value.push_str(part);
            rest = after;
            let Some(after) = rest.strip_prefix('"') else {
                break;
            };
            value.push('"');
            rest = after;
        }
        let after = rest.trim_start();
        if !after.is_empty() && !after.starts_with(',') {
            return Err(open());
        }
        self.rest = after.get(1..).unwrap_or_default();
        Ok(Some((key, value)))
    }
}

/// Makes the model of `spec`.
///
/// Takes O(n) time and memory for n triangles.
///
/// # Errors
///
/// [`GenerateError::NeedsFile`] for `gen:file`: load [`Spec::path`] and apply
/// [`Spec::modifiers`] to it instead. Everything else was checked when the spec was read.
pub fn generate(spec: &Spec) -> Result<TriangleSoup, GenerateError> {
    let Some(shape) = &spec.family.shape else {
        return Err(GenerateError::NeedsFile {
            path: spec.path().unwrap_or_default().to_owned(),
        });
    };
    debug_assert!(spec.face_count.is_some_and(|faces| faces <= MAX_FACES));
    let soup = (shape.build)(&spec.params())?;
    spec.modifiers.apply_to_generated(soup)
}
