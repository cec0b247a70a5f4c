//! Suite files: groups of settings.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::Settings;
use super::document::{Document, SuiteError};
use super::programs::{self, ProgramTables};
use crate::registry::Programs;

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
        #[derive(Default, Deserialize)]
        #[serde(default)]
        struct File {
            full: Settings,
            ext: ProgramTables,
        }
        #[derive(Default, Deserialize)]
        #[serde(default)]
        struct Group {
            name: String,
            shows: Option<String>,
            full: Settings,
        }

        let (mut table, mut groups) = (document.parse()?, Vec::<SuiteGroup>::new());
        let tables = document.take_tables(&mut table, "group")?;
        let known = ["group", "full", "ext"];
        let (file, common) = document.read_with_settings::<File>(table, &known)?;
        let mut common_full = file.full;
        common_full.resolve(document)?;
        for table in tables {
            let span = table.span();
            let error = |problem: &str| document.error_at("group", Some(span.clone()), problem);
            let known = ["name", "shows", "full"];
            let (mut group, settings) = document.read_with_settings::<Group>(table, &known)?;
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
            programs: programs::programs(file.ext, document)?,
        })
    }
}
