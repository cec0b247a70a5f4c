//! Suite files: groups of settings.

use std::path::{Path, PathBuf};

use geobench_registry::Programs;
use serde::Deserialize;

use super::Settings;
use super::programs;
use crate::usage::document::{DocumentError, TableParts, TomlDocument};

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
        #[serde(default, deny_unknown_fields)]
        struct Group {
            name: String,
            shows: Option<String>,
        }

        let mut table = document.parse()?;
        let programs = programs::take_programs(document, &mut table)?.unwrap_or_default();
        let mut table = TableParts::new(document, table, &["ext"]);
        let tables = table.take_tables("group")?;
        let common_full = full(&mut table)?;
        let common = Settings::read(table)?;
        let mut groups = Vec::<SuiteGroup>::new();
        for table in tables {
            let span = table.span();
            let error = |problem: &str| document.error_at("group", Some(span.clone()), problem);
            let mut table = TableParts::new(document, table, &[]);
            let group: Group = table.take()?;
            let full = full(&mut table)?;
            let settings = Settings::read(table)?;
            let name = group.name.trim().to_owned();
            if name.is_empty() {
                return Err(error("a group must have a `name`"));
            }
            if groups.iter().any(|other| other.name == name) {
                return Err(error(&format!("two are called `{name}`")));
            }
            groups.push(SuiteGroup {
                name,
                shows: group.shows.map(|shows| shows.trim().to_owned()),
                settings: settings.or(&common),
                full: full.or(&common_full),
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

/// The settings of the table `full` in `table`.
fn full(table: &mut TableParts<'_, '_>) -> Result<Settings, DocumentError> {
    let full = table.take_table("full")?;
    full.map_or_else(|| Ok(Settings::default()), Settings::read)
}
