//! The suites of `bench-configs`, which are part of the program. The link `suites` of this crate
//! puts them into its package, too.

use std::path::Path;

use geobench_mesh::did_you_mean;
use geobench_registry::UsageError;

use super::Suite;
use crate::usage::DocumentError;

/// A suite that is part of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EmbeddedSuite {
    /// Its name, that of its file without the ending.
    pub name: &'static str,
    text: &'static str,
}

/// The suite of a file of `bench-configs`.
macro_rules! file {
    ($name:literal) => {
        EmbeddedSuite {
            name: $name,
            text: include_str!(concat!("../../../suites/", $name, ".toml")),
        }
    };
}

/// Every suite of `bench-configs`, by name, but `peers`, whose programs `scripts/peers` installs,
/// and `002-section-7.2`, whose stored distances lie beside it.
pub const SUITES: &[EmbeddedSuite] = &[
    file!("000-figure-10"),
    file!("000-figure-12"),
    file!("000-figure-8"),
    file!("000-figure-9"),
    file!("000-section-5.3"),
    file!("000-section-6.2"),
    file!("000-table-1"),
    file!("000-table-2"),
    file!("000-table-3"),
    file!("001-figure-5.10"),
    file!("001-figure-5.8"),
    file!("001-section-5.3"),
    file!("001-table-5.1"),
    file!("001-table-5.2"),
    file!("002-figure-1"),
    file!("002-figure-10"),
    file!("002-figure-11"),
    file!("002-figure-12"),
    file!("002-figure-13"),
    file!("002-figure-14"),
    file!("002-figure-15"),
    file!("002-figure-4"),
    file!("002-figure-6"),
    file!("002-figure-7"),
    file!("002-figure-8"),
    file!("002-figure-9"),
    file!("002-proposition-2"),
    file!("002-section-5"),
    file!("002-table-1"),
    file!("002-table-3"),
    file!("003-table-1"),
    file!("004-figure-15"),
    file!("004-figure-16"),
    file!("004-figure-17"),
    file!("004-figure-18"),
    file!("004-figure-8"),
    file!("004-table-1"),
    file!("004-table-2"),
    file!("004-table-3"),
    file!("004-table-4"),
    file!("004-table-5"),
    file!("004-table-6"),
    file!("approximate"),
    file!("growth"),
    file!("quick"),
    file!("regression"),
];

impl EmbeddedSuite {
    /// The suite of this name.
    ///
    /// # Errors
    ///
    /// When there is no such suite. The message suggests the nearest name.
    pub fn named(name: &str) -> Result<Self, UsageError> {
        let found = SUITES.iter().find(|suite| suite.name == name);
        found.copied().ok_or_else(|| {
            let names: Vec<&str> = SUITES.iter().map(|suite| suite.name).collect();
            let hint = did_you_mean(name, &names);
            UsageError(format!(
                "there is no suite `{name}`{hint}; `geobench suites` lists them"
            ))
        })
    }

    /// Reads the suite. Paths in it are relative to the current directory.
    ///
    /// # Errors
    ///
    /// Never for the suites of this version, by a test.
    pub fn read(self) -> Result<Suite, DocumentError> {
        Suite::parse(Path::new(&format!("{}.toml", self.name)), self.text)
    }

    /// What it shows: the first sentence of its comment.
    pub fn line(self) -> String {
        let comment = self.text.lines().map_while(|line| line.strip_prefix('#'));
        let comment: Vec<&str> = comment.map(str::trim).collect();
        let comment = comment.join(" ");
        let sentence = comment.split(". ").next().unwrap_or_default();
        sentence.trim_end_matches('.').to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_suite_is_embedded_and_can_be_read() {
        let directory = concat!(env!("CARGO_MANIFEST_DIR"), "/../../bench-configs");
        let mut found: Vec<String> = std::fs::read_dir(directory)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter_map(|name| name.strip_suffix(".toml").map(str::to_owned))
            .filter(|name| !["peers", "002-section-7.2"].contains(&name.as_str()))
            .collect();
        found.sort_unstable();
        let names: Vec<&str> = SUITES.iter().map(|suite| suite.name).collect();
        assert_eq!(names, found);
        for suite in SUITES {
            assert!(!suite.read().unwrap().groups.is_empty(), "{}", suite.name);
            let length = suite.line().chars().count();
            assert!(
                (10..200).contains(&length),
                "{}: {}",
                suite.name,
                suite.line()
            );
        }
    }

    #[test]
    fn an_unknown_suite_is_named() {
        let error = EmbeddedSuite::named("000-table-9").unwrap_err().to_string();
        assert!(error.contains("did you mean `000-table-"), "{error}");
    }
}
