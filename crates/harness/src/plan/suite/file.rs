//! Suite files: groups of settings.

use std::path::{Path, PathBuf};

use geobench_registry::Programs;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::DeTable;

use super::Settings;
use super::programs;
use crate::usage::document::{DocumentError, TomlDocument};

/// A suite file.
#[derive(Clone, Debug)]
pub struct Suite {
    /// The file.
    pub path: PathBuf,
    /// Its groups, in the order of the file; at least one.
    pub groups: Vec<SuiteGroup>,
    /// The external programs described in the file.
    pub programs: Programs,
}

/// A group of a suite.
#[derive(Clone, Debug)]
pub struct SuiteGroup {
    /// Its name, unique within the file.
    pub name: String,
    /// What its table shows, as text for the reader.
    pub shows: Option<String>,
    /// Its settings, completed by the settings for all groups.
    pub settings: Settings,
    /// Settings that take precedence with `--full`, with the sizes of the paper.
    pub full: Settings,
}

impl Suite {
    /// Reads a suite file; paths in it are relative to its directory.
    ///
    /// # Errors
    ///
    /// Names the file, the line and the key.
    pub fn read(path: &Path) -> Result<Self, DocumentError> {
        Self::of(&TomlDocument::open(path)?, path)
    }

    /// Reads the text of a suite file; paths in it are relative to the directory of `path`.
    ///
    /// # Errors
    ///
    /// Names the file, the line and the key.
    pub fn parse(path: &Path, text: &str) -> Result<Self, DocumentError> {
        Self::of(&TomlDocument::new(path, text), path)
    }

    fn of(document: &TomlDocument<'_>, path: &Path) -> Result<Self, DocumentError> {
        #[derive(Default, Deserialize)]
        #[serde(default)]
        struct File {
            full: Settings,
        }
        #[derive(Default, Deserialize)]
        #[serde(default)]
        struct Group {
            name: String,
            shows: Option<String>,
            full: Settings,
        }

        let (mut table, mut groups) = (document.parse()?, Vec::<SuiteGroup>::new());
        let programs = programs::take_programs(document, &mut table)?.unwrap_or_default();
        let tables = document.take_tables(&mut table, "group")?;
        let known = ["group", "full", "ext"];
        let (file, common) = read_with_settings::<File>(document, table, &known)?;
        let mut common_full = file.full;
        common_full.resolve(document)?;
        for table in tables {
            let span = table.span();
            let error = |problem: &str| document.error_at("group", Some(span.clone()), problem);
            let known = ["name", "shows", "full"];
            let (mut group, settings) = read_with_settings::<Group>(document, table, &known)?;
            let name = group.name.trim().to_owned();
            if name.is_empty() {
                return Err(error("a group must have a `name`"));
            }
            if groups.iter().any(|other| other.name == name) {
                return Err(error(&format!("two are called `{name}`")));
            }
            group.full.resolve(document)?;
            groups.push(SuiteGroup {
                name,
                shows: group.shows.map(|shows| shows.trim().to_owned()),
                settings: settings.or(&common),
                full: group.full.or(&common_full),
            });
        }
        if groups.is_empty() {
            let problem = "there is no group; start one with [[group]] and give it a name";
            return Err(document.error(None, problem));
        }
        Ok(Self {
            path: path.to_owned(),
            groups,
            programs,
        })
    }
}

/// Deserializes a table with the keys of `T` and settings. Serde's `flatten` would lose the lines
/// of errors.
fn read_with_settings<T: DeserializeOwned>(
    document: &TomlDocument<'_>,
    table: Spanned<DeTable<'_>>,
    keys: &[&str],
) -> Result<(T, Settings), DocumentError> {
    let span = table.span();
    let (own, rest) = (table.into_inner().into_iter())
        .partition(|(key, _)| keys.contains(&key.get_ref().as_ref()));
    let own = document.read(Spanned::new(span.clone(), own), &[])?;
    let mut settings: Settings = document.read(Spanned::new(span, rest), keys)?;
    settings.resolve(document)?;
    Ok((own, settings))
}
