//! What a suite file says.

use std::path::{Path, PathBuf};

use super::Settings;
use super::document::{Document, Entry, SuiteError};
use super::programs;
use super::setting::{SETTINGS, setting};
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
    /// What it is to show.
    pub shows: Option<String>,
    /// Its settings, and those that hold for all groups where it has none.
    pub settings: Settings,
    /// What comes before them where somebody wants the sizes of the paper.
    pub full: Settings,
}

/// The key of the table of settings for the sizes of the paper.
const FULL: &str = "full";

impl Suite {
    /// Reads a suite file.
    ///
    /// # Errors
    ///
    /// Names the file, the line and the key.
    pub fn read(path: &Path) -> Result<Self, SuiteError> {
        let text = std::fs::read_to_string(path).map_err(|error| SuiteError {
            path: path.to_owned(),
            line: None,
            problem: error.to_string(),
        })?;
        Self::parse(path, &text)
    }

    /// Reads the text of a suite file; paths in it are relative to the directory of `path`.
    ///
    /// # Errors
    ///
    /// Names the file, the line and the key.
    pub fn parse(path: &Path, text: &str) -> Result<Self, SuiteError> {
        let document = Document { path, text };
        let table = document.parse()?;
        let (mut common, mut full) = (Settings::default(), Settings::default());
        let mut groups: Vec<SuiteGroup> = Vec::new();
        let mut programs = Programs::default();
        let known: Vec<&str> = ["group", FULL, programs::KEY]
            .into_iter()
            .chain(SETTINGS)
            .collect();
        for (key, value) in &table {
            let entry = Entry {
                document,
                key: key.get_ref(),
                value,
            };
            if entry.key == "group" {
                for place in entry.list()? {
                    let group = read_group(&place)?;
                    if groups.iter().any(|other| other.name == group.name) {
                        return Err(place.error(&format!("two are called `{}`", group.name)));
                    }
                    groups.push(group);
                }
            } else if entry.key == FULL {
                full = read_settings(&entry)?;
            } else if entry.key == programs::KEY {
                programs = programs::tables(&entry)?;
            } else {
                setting(&entry, key, &known, &mut common)?;
            }
        }
        if groups.is_empty() {
            return Err(document.error(
                None,
                "there is no group; start one with [[group]] and give it a name",
            ));
        }
        for group in &mut groups {
            group.settings = group.settings.or(&common);
            group.full = group.full.or(&full);
        }
        Ok(Self {
            path: path.to_owned(),
            groups,
            programs,
        })
    }
}

fn read_group(group: &Entry<'_>) -> Result<SuiteGroup, SuiteError> {
    let own = ["name", "shows", FULL];
    let known: Vec<&str> = own.into_iter().chain(SETTINGS).collect();
    let (mut name, mut shows) = (None, None);
    let (mut settings, mut full) = (Settings::default(), Settings::default());
    for (key, value) in group.table()? {
        let entry = Entry {
            key: key.get_ref(),
            value,
            ..*group
        };
        match entry.key {
            "name" => name = Some(entry.text()?.trim()).filter(|name| !name.is_empty()),
            "shows" => shows = Some(entry.text()?.trim().to_owned()),
            FULL => full = read_settings(&entry)?,
            _ => setting(&entry, key, &known, &mut settings)?,
        }
    }
    let Some(name) = name else {
        return Err(group.error("a group must have a `name`"));
    };
    Ok(SuiteGroup {
        name: name.to_owned(),
        shows,
        settings,
        full,
    })
}

/// A table of nothing but settings.
fn read_settings(table: &Entry<'_>) -> Result<Settings, SuiteError> {
    let mut settings = Settings::default();
    for (key, value) in table.table()? {
        let entry = Entry {
            key: key.get_ref(),
            value,
            ..*table
        };
        setting(&entry, key, &SETTINGS, &mut settings)?;
    }
    Ok(settings)
}
