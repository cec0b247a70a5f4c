//! The papers' tables, and the comparison of their ratios with ours.
//!
//! `bench-configs/papers` has a file for each table; its README defines the columns. Times of
//! different machines cannot be compared, so only ratios between algorithms of a table are
//! compared.

use geobench_harness::figures::{Figure, figure};
use geobench_harness::schema::{ResultFile, Status};
use geobench_registry::UsageError;

mod compare;

pub(crate) use compare::compare;

/// The name and the content of a file of `bench-configs/papers`.
macro_rules! file {
    ($name:literal) => {
        (
            $name,
            include_str!(concat!("../../../papers/", $name, ".csv")),
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
    file!("002-table-3"),
    file!("003-table-1"),
    file!("004-table-1"),
    file!("004-table-2"),
    file!("004-table-3"),
    file!("004-table-4"),
    file!("004-table-5"),
    file!("004-table-6"),
];

/// The names of all tables, which are also the names of their suites.
fn known() -> Vec<&'static str> {
    let names = FILES.iter().map(|(name, _)| *name);
    names.filter(|name| !name.ends_with(RATIOS)).collect()
}

/// The suffix of the names of files that hold only the ratios of a table. The file without the
/// suffix holds its other numbers.
const RATIOS: &str = "-ratios";

/// The papers' tables that results are compared with.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Tables {
    /// The table of the suite of a result.
    #[default]
    OfSuite,
    /// None.
    None,
    /// The tables with these names.
    Named(Vec<String>),
}

impl std::str::FromStr for Tables {
    type Err = UsageError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "none" {
            return Ok(Self::None);
        }
        let names = text.split(',').map(|name| name.trim().to_owned());
        let names: Vec<String> = names.collect();
        match names.iter().find(|name| !known().contains(&name.as_str())) {
            Some(name) => Err(UsageError(format!(
                "there is no paper table `{name}`; known are {}",
                known().join(", ")
            ))),
            None => Ok(Self::Named(names)),
        }
    }
}

impl Tables {
    /// The tables for `result`.
    pub(crate) fn of(&self, result: &ResultFile) -> Vec<PaperTable> {
        let names = match self {
            Self::None => Vec::new(),
            Self::Named(names) => names.clone(),
            Self::OfSuite => result.suite_with_its_models().into_iter().collect(),
        };
        let wanted = |file: &str| names.iter().any(|n| n == file.trim_end_matches(RATIOS));
        FILES
            .iter()
            .filter(|(name, _)| wanted(name))
            .filter_map(|(name, text)| parse(name, text).ok())
            .collect()
    }
}

/// A table of a paper.
#[derive(Clone, Debug)]
pub(crate) struct PaperTable {
    /// The authors and the year.
    pub(crate) paper: String,
    /// The name of the table in the paper.
    pub(crate) table: String,
    /// The numbers, in the order of the table.
    pub(crate) printed: Vec<Printed>,
    /// How many numbers were skipped, because they are no figures here or their algorithm does not
    /// exist here.
    pub(crate) others: usize,
}

/// A figure of an algorithm on a model, or its ratio to that of another algorithm.
#[derive(Clone, Debug)]
pub(crate) struct Printed {
    /// The model, or a name for the models of a mean.
    pub(crate) model: String,
    pub(crate) faces: Option<u64>,
    /// The label of the algorithm in this program.
    pub(crate) algorithm: String,
    /// The label of the base, if the number is a ratio.
    pub(crate) to: Option<String>,
    pub(crate) figure: &'static Figure,
    pub(crate) value: f64,
    /// The standard deviation, if the number is a mean.
    pub(crate) deviation: Option<f64>,
}

impl PaperTable {
    /// The file of `bench-configs/papers` of this name.
    ///
    /// # Errors
    ///
    /// When there is no such file, or a line does not follow the README of the tables. The message
    /// names all files, or the line.
    pub(crate) fn named(name: &str) -> anyhow::Result<Self> {
        let Some((name, text)) = FILES.iter().find(|(known, _)| *known == name) else {
            let known: Vec<&str> = FILES.iter().map(|(name, _)| *name).collect();
            let known = known.join(", ");
            anyhow::bail!("there is no paper table `{name}`; known are {known}");
        };
        parse(name, text)
    }
}

/// Columns without a figure.
#[rustfmt::skip]
const FACTS: [&str; 9] = [
    "paper", "table", "model", "vertices", "faces", "algorithm", "printed", "status", "note",
];

/// Columns with numbers that are no figures here.
const OTHERS: [&str; 6] = [
    "log_b_n",
    "b",
    "precomputation",
    "mean_error",
    "extraction_time",
    "extraction_memory",
];

/// Whether `label` names an algorithm; `false` if it is empty. Rows of programs that do not exist
/// here have an empty label, and their numbers are skipped like those of the columns [`OTHERS`].
///
/// # Errors
///
/// When `label` is not empty and there is no such algorithm.
fn is_registered(label: &str) -> Result<bool, UsageError> {
    if label.is_empty() {
        return Ok(false);
    }
    geobench_registry::select_one(label).map(|_| true)
}

/// Reads the table in the file `name`.
///
/// # Errors
///
/// When a line does not follow the README of the papers' tables. The message names the line.
fn parse(name: &str, text: &str) -> anyhow::Result<PaperTable> {
    use anyhow::{Context, bail};

    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let head: Vec<String> = reader.headers()?.iter().map(str::to_owned).collect();
    let column = |wanted: &str| head.iter().position(|h| h == wanted);
    let mut table = PaperTable {
        paper: String::new(),
        table: String::new(),
        printed: Vec::new(),
        others: 0,
    };
    for (i, record) in reader.records().enumerate() {
        let line = i + 2;
        let record = record.with_context(|| format!("{name}, line {line}"))?;
        let field = |wanted: &str| {
            let text = column(wanted)
                .and_then(|c| record.get(c))
                .unwrap_or_default();
            (!text.is_empty()).then(|| text.to_owned())
        };
        let text = |wanted: &str| {
            field(wanted).with_context(|| format!("{name}, line {line}: `{wanted}` is missing"))
        };
        let number = |wanted: &str| -> anyhow::Result<Option<f64>> {
            let Some(text) = field(wanted) else {
                return Ok(None);
            };
            let value: f64 = text
                .parse()
                .with_context(|| format!("{name}, line {line}: `{wanted}` is no number"))?;
            if !(value.is_finite() && value > 0.0) {
                bail!("{name}, line {line}: `{wanted}` is not above 0");
            }
            Ok(Some(value))
        };
        (table.paper, table.table) = (text("paper")?, text("table")?);
        let (model, algorithm) = (text("model")?, field("algorithm").unwrap_or_default());
        let known =
            |label: &str| is_registered(label).with_context(|| format!("{name}, line {line}"));
        let is_known = known(&algorithm)?;
        text("printed")?;
        let faces = number("faces")?.map(|faces| faces as u64);
        if column("to").is_some() {
            let to = text("to")?;
            if !(is_known && known(&to)?) {
                table.others += 1;
                continue;
            }
            table.printed.push(Printed {
                model,
                faces,
                algorithm,
                to: Some(to),
                figure: figure(&text("figure")?)?,
                value: number("ratio")?
                    .with_context(|| format!("{name}, line {line}: `ratio` is missing"))?,
                deviation: number("deviation")?,
            });
            continue;
        }
        let ended_well = match text("status")?.as_str() {
            status if status == Status::Ok.name() => true,
            "timeout" | "out_of_memory" | "refused" => false,
            other => bail!("{name}, line {line}: `status` is `{other}`"),
        };
        let mut numbers = 0;
        for key in head.iter().filter(|key| !FACTS.contains(&key.as_str())) {
            let Some(value) = number(key)? else {
                continue;
            };
            numbers += 1;
            if OTHERS.contains(&key.as_str()) || !is_known {
                table.others += 1;
            } else if ended_well {
                table.printed.push(Printed {
                    model: model.clone(),
                    faces,
                    algorithm: algorithm.clone(),
                    to: None,
                    figure: figure(key)?,
                    value,
                    deviation: None,
                });
            }
        }
        if ended_well && numbers == 0 {
            bail!("{name}, line {line}: it ended well and has no numbers");
        }
    }
    Ok(table)
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
            assert!(!table.printed.is_empty() || table.others > 0, "{name}");
        }
    }

    #[test]
    fn rows_name_an_algorithm_or_none() {
        assert!(is_registered("mmp{queue=fifo}").unwrap());
        assert!(!is_registered("").unwrap());
        assert!(is_registered("mpp").is_err());
    }

    #[test]
    fn the_suite_is_found_in_the_command() {
        let result = |command: &str| ResultFile {
            command: command.split(' ').map(str::to_owned).collect(),
            ..geobench_harness::run::mock::result(geobench_harness::run::Records::default())
        };
        let of = |command: &str| result(command).suite();
        assert_eq!(
            of("geobench run --config a/001-table-5.2.toml --quiet").unwrap(),
            "001-table-5.2"
        );
        assert_eq!(
            of("geobench run --config=000-table-1.toml").unwrap(),
            "000-table-1"
        );
        assert_eq!(of("geobench run x.obj --config"), None);
        assert_eq!(
            of("geobench run --suite 000-section-6.2").unwrap(),
            "000-section-6.2"
        );
        let mut result = result("geobench run --suite 002-table-1");
        assert_eq!(Tables::OfSuite.of(&result).len(), 0);
        result.groups = vec![geobench_harness::schema::GroupRecord {
            shows: Some("text".into()),
            ..Default::default()
        }];
        assert_eq!(Tables::OfSuite.of(&result).len(), 2);
        assert_eq!(Tables::None.of(&result).len(), 0);
        let error = "000-table-9".parse::<Tables>().unwrap_err().to_string();
        assert!(
            error.starts_with("there is no paper table `000-table-9`; known are 000-figure-12,")
        );
    }

    fn refused(text: &str) -> String {
        format!("{:#}", parse("x", text).unwrap_err())
    }

    #[test]
    fn errors_name_the_line() {
        let head = "paper,table,model,vertices,faces,algorithm,printed,status,time,note\n";
        let line = |fields: &str| refused(&format!("{head}P,T,m,,10,mmp,MMP,ok,1.5,\n{fields}\n"));
        assert!(line("P,T,m,,10,mpp,MMP,ok,1.5,").starts_with("x, line 3: there is no algorithm"));
        assert_eq!(
            line("P,T,m,,10,mmp,MMP,ok,,"),
            "x, line 3: it ended well and has no numbers"
        );
        assert_eq!(
            line("P,T,m,,10,mmp,MMP,fine,1,"),
            "x, line 3: `status` is `fine`"
        );
        assert_eq!(
            line("P,T,m,,10,mmp,MMP,ok,0,"),
            "x, line 3: `time` is not above 0"
        );
        assert!(
            line("P,T,m,,10,mmp,MMP,ok,\"1,5\",").starts_with("x, line 3: `time` is no number")
        );
        assert_eq!(
            line("P,T,,,10,mmp,MMP,ok,1,"),
            "x, line 3: `model` is missing"
        );
    }
}
