//! What the papers printed, and our ratios beside theirs.
//!
//! The numbers stand in `bench-configs/papers`, a file for each table; its README defines the columns.
//! Times of other machines mean nothing here, so only ratios between the algorithms of a table are compared.

mod compare;
mod data;

pub(crate) use compare::compare;
pub(crate) use data::PaperTable;

use data::parse;

/// A file of `bench-configs/papers` with its name.
macro_rules! file {
    ($name:literal) => {
        (
            $name,
            include_str!(concat!(
                "../../../../../bench-configs/papers/",
                $name,
                ".csv"
            )),
        )
    };
}

/// Every file of `bench-configs/papers`, by name.
const FILES: &[(&str, &str)] = &[
    file!("000-figure-12"),
    file!("000-table-1"),
    file!("000-table-2"),
    file!("000-table-3"),
    file!("001-table-5.1"),
    file!("001-table-5.2"),
    file!("002-table-1"),
    file!("002-table-1-ratios"),
    file!("003-table-1"),
];

/// A name of a table that there is not.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no paper table `{name}`; known are {}", known().join(", "))]
pub struct UnknownTable {
    name: String,
}

/// The names of all tables: those of their suites.
fn known() -> Vec<&'static str> {
    let names = FILES.iter().map(|(name, _)| *name);
    names.filter(|name| !name.ends_with(RATIOS)).collect()
}

/// The end of the name of a file that holds only ratios of a table whose numbers are in another.
const RATIOS: &str = "-ratios";

/// Which tables to compare with.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Tables {
    /// That of the suite that a result was made with.
    #[default]
    OfSuite,
    /// None.
    None,
    /// Those of these names.
    Named(Vec<String>),
}

impl std::str::FromStr for Tables {
    type Err = UnknownTable;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "none" {
            return Ok(Self::None);
        }
        let names = text.split(',').map(|name| name.trim().to_owned());
        let names: Vec<String> = names.collect();
        match names.iter().find(|name| !known().contains(&name.as_str())) {
            Some(name) => Err(UnknownTable { name: name.clone() }),
            None => Ok(Self::Named(names)),
        }
    }
}

impl Tables {
    /// The tables to compare a result with that `command` made.
    pub(crate) fn of(&self, command: &[String]) -> Vec<PaperTable> {
        let names = match self {
            Self::None => Vec::new(),
            Self::Named(names) => names.clone(),
            Self::OfSuite => suite(command).into_iter().collect(),
        };
        let wanted = |file: &str| names.iter().any(|n| n == file.trim_end_matches(RATIOS));
        FILES
            .iter()
            .filter(|(name, _)| wanted(name))
            .filter_map(|(name, text)| parse(name, text).ok())
            .collect()
    }
}

/// The name of the suite file in a command, if it has one.
fn suite(command: &[String]) -> Option<String> {
    let given = command
        .iter()
        .enumerate()
        .find_map(|(i, word)| match word.as_str() {
            "--config" => command.get(i + 1).map(String::as_str),
            word => word.strip_prefix("--config="),
        })?;
    let path = std::path::Path::new(given);
    Some(path.file_stem()?.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_known_and_can_be_read() {
        let directory = concat!(env!("CARGO_MANIFEST_DIR"), "/../../bench-configs/papers");
        let mut found: Vec<String> = std::fs::read_dir(directory)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter_map(|name| name.strip_suffix(".csv").map(str::to_owned))
            .collect();
        found.sort_unstable();
        let names: Vec<&str> = FILES.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, found);
        for (name, text) in FILES {
            let table = parse(name, text).unwrap_or_else(|error| panic!("{name}.csv: {error}"));
            assert!(!table.is_empty(), "{name}");
        }
    }

    #[test]
    fn the_suite_is_found_in_the_command() {
        let of = |text: &str| suite(&text.split(' ').map(str::to_owned).collect::<Vec<_>>());
        assert_eq!(
            of("geobench run --config a/001-table-5.2.toml --quiet").unwrap(),
            "001-table-5.2"
        );
        assert_eq!(
            of("geobench run --config=000-table-1.toml").unwrap(),
            "000-table-1"
        );
        assert_eq!(of("geobench run x.obj --config"), None);
        let command: Vec<String> = ["geobench", "run", "--config", "002-table-1.toml"]
            .map(str::to_owned)
            .to_vec();
        assert_eq!(Tables::OfSuite.of(&command).len(), 2);
        assert_eq!(Tables::None.of(&command).len(), 0);
        let error = "000-table-9".parse::<Tables>().unwrap_err().to_string();
        assert!(
            error.starts_with("there is no paper table `000-table-9`; known are 000-figure-12,")
        );
    }
}
