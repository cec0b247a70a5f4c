//! External programs in TOML files: tables `[ext.NAME]`.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use geobench_registry::{PLACEHOLDERS, Program, Programs, Protocol, Provenance, UsageError};
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::usage::document::{DocumentError, TomlDocument};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ProgramTable {
    #[serde(default)]
    command: Option<Spanned<Vec<String>>>,
    #[serde(default, deserialize_with = "protocol")]
    protocol: Protocol,
    #[serde(default)]
    approximate: bool,
    #[serde(default)]
    prepare: Vec<String>,
    #[serde(default)]
    cleanup: Vec<String>,
    #[serde(default)]
    parameters: BTreeMap<String, Vec<toml::Value>>,
    #[serde(default)]
    version: Option<String>,
    #[serde(default)]
    source: Option<String>,
    #[serde(default)]
    changes: Option<String>,
    #[serde(default)]
    compiler: Option<String>,
    #[serde(default)]
    flags: Option<String>,
    #[serde(default)]
    files: Vec<String>,
}

/// Reads the tables `[ext.NAME]` of a file: a suite file, or one that holds nothing else.
///
/// # Errors
///
/// If the file is no TOML or has no such table. Errors in a table are reported if its program is
/// selected.
pub fn read_programs(path: &Path) -> Result<Programs, DocumentError> {
    let document = TomlDocument::open(path)?;
    match take_programs(&document, &mut document.parse()?)? {
        Some(programs) => Ok(programs),
        None => Err(document.error(None, "there is no table [ext.NAME] here")),
    }
}

/// Removes the tables `[ext.NAME]` from a file and returns their programs; `None` if there are no
/// such tables.
///
/// # Errors
///
/// If `ext` is no table. Errors in a table are reported if its program is selected.
pub(super) fn take_programs(
    document: &TomlDocument<'_>,
    file: &mut Spanned<DeTable<'_>>,
) -> Result<Option<Programs>, DocumentError> {
    let Some(tables) = file.get_mut().remove("ext") else {
        return Ok(None);
    };
    let span = tables.span();
    let DeValue::Table(tables) = tables.into_inner() else {
        return Err(document.error_at("ext", Some(span), "a table is expected"));
    };
    let mut all = Programs::default();
    for (name, table) in tables {
        let name = name.get_ref().to_string();
        let read = read_table(document, &name, table).and_then(|(span, programs)| {
            let mut programs = programs.into_iter();
            if programs.all(|program| all.add(Arc::new(program))) {
                return Ok(());
            }
            let problem = "two are called so, letter case apart";
            Err(document.error_at(&name, span, problem))
        });
        if let Err(error) = read {
            all.add_faulty(&name.to_lowercase(), UsageError(error.to_string()));
        }
    }
    Ok(Some(all))
}

/// The programs of a table, one for each combination of parameters, and its place.
fn read_table(
    document: &TomlDocument<'_>,
    name: &str,
    table: Spanned<DeValue<'_>>,
) -> Result<(Option<Range<usize>>, Vec<Program>), DocumentError> {
    // The parent of a bare file name is empty, which is not a valid directory for the system.
    let folder = Some(document.directory()).filter(|folder| *folder != Path::new(""));
    let folder = folder.unwrap_or(Path::new("."));
    let directory = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    let span = table.span();
    let error = |problem: &str| document.error_at(name, Some(span.clone()), problem);
    let DeValue::Table(table) = table.into_inner() else {
        return Err(error("a table is expected"));
    };
    if name.contains(|c: char| " ,{}=:".contains(c)) || name.is_empty() {
        return Err(error("a name is a word without any of `,{}=:`"));
    }
    let table: ProgramTable = document.read(Spanned::new(span.clone(), table))?;
    let no_command = Spanned::new(0..0, Vec::new());
    let command = table.command.unwrap_or(no_command);
    let command_span = Some(command.span());
    let command = command.into_inner();
    if command.is_empty() {
        return Err(error("an outside program must have a `command`"));
    }
    let combinations = combinations(&table.parameters).map_err(|problem| error(&problem))?;
    check_command(&command, table.protocol, &table.parameters)
        .map_err(|problem| document.error_at("command", command_span, &problem))?;
    for word in table.prepare.iter().chain(&table.cleanup) {
        check_word(word, &table.parameters).map_err(|problem| error(&problem))?;
    }
    let provenance = Provenance {
        version: table.version,
        source: table.source,
        changes: table.changes,
        compiler: table.compiler,
        flags: table.flags,
    };
    let program = |parameters: BTreeMap<String, String>| {
        let values: Vec<String> = parameters.iter().map(|(k, v)| format!("{k}={v}")).collect();
        Program {
            name: if values.is_empty() {
                name.to_lowercase()
            } else {
                format!("{}{{{}}}", name.to_lowercase(), values.join(","))
            },
            parameters,
            prepare: table.prepare.clone(),
            cleanup: table.cleanup.clone(),
            command: command.clone(),
            directory: directory.clone(),
            protocol: table.protocol,
            approximate: table.approximate,
            provenance: provenance.clone(),
            files: table.files.clone(),
        }
    };
    let programs = combinations.into_iter().map(program).collect();
    Ok((Some(span.clone()), programs))
}

/// All combinations of parameter values, by parameter name; one empty combination if there are no
/// parameters.
fn combinations(
    parameters: &BTreeMap<String, Vec<toml::Value>>,
) -> Result<Vec<BTreeMap<String, String>>, String> {
    let mut all = vec![BTreeMap::new()];
    for (name, values) in parameters {
        let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
        let taken = PLACEHOLDERS.contains(&format!("{{{name}}}").as_str());
        if name.is_empty() || !name.chars().all(is_word) || taken {
            return Err(format!("`{name}` cannot be the name of a parameter"));
        }
        let texts = values.iter().map(|value| match value {
            toml::Value::String(text) => Ok(text.clone()),
            toml::Value::Integer(number) => Ok(number.to_string()),
            toml::Value::Float(number) => Ok(number.to_string()),
            _ => Err(format!(
                "the values of `{name}` are numbers or words in a list, such as [0.5, 1, 2]"
            )),
        });
        let texts = texts.collect::<Result<Vec<String>, String>>()?;
        if (1..texts.len()).any(|i| texts[..i].contains(&texts[i])) {
            return Err(format!("a value of `{name}` is given twice"));
        }
        if texts.is_empty() || texts.iter().any(|text| text.contains([',', '{', '}', '='])) {
            return Err(format!(
                "the values of `{name}` are one or more numbers or words without any of `,{{}}=`"
            ));
        }
        all = all
            .into_iter()
            .flat_map(|one: BTreeMap<String, String>| {
                texts.iter().map(move |text| {
                    let mut one = one.clone();
                    one.insert(name.clone(), text.clone());
                    one
                })
            })
            .collect();
    }
    Ok(all)
}

/// Checks that a command contains the placeholders of the model, the source and the output, or, in
/// protocol 2, none of them.
fn check_command(
    command: &[String],
    protocol: Protocol,
    parameters: &BTreeMap<String, Vec<toml::Value>>,
) -> Result<(), String> {
    for word in command {
        check_word(word, parameters)?;
    }
    for placeholder in ["{model}", "{source}", "{output}"] {
        let is_there = command.iter().any(|word| word.contains(placeholder));
        match (protocol, is_there) {
            (Protocol::Two, true) => {
                return Err(format!(
                    "{placeholder} is not known at the start: protocol 2 tells it in a request"
                ));
            }
            (Protocol::Two, false) | (_, true) => {}
            (_, false) => {
                return Err(format!(
                    "{placeholder} is missing: nothing else tells it, except in protocol 2"
                ));
            }
        }
    }
    Ok(())
}

/// Checks that all braces in a word are placeholders or parameters.
fn check_word(word: &str, parameters: &BTreeMap<String, Vec<toml::Value>>) -> Result<(), String> {
    let names = parameters.keys().map(|name| format!("{{{name}}}"));
    let known = PLACEHOLDERS.iter().map(|&name| name.to_owned());
    let known: Vec<String> = known.chain(names).collect();
    let rest = known
        .iter()
        .fold(word.to_owned(), |rest, name| rest.replace(name, ""));
    if rest.contains(['{', '}']) {
        return Err(format!(
            "`{word}` has braces that are no placeholder; known are {}",
            known.join(", ")
        ));
    }
    Ok(())
}

/// A protocol by its name, or the number 2.
fn protocol<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Protocol, D::Error> {
    struct Name;
    impl Visitor<'_> for Name {
        type Value = Protocol;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("2, \"session\", \"once\" or \"none\"")
        }

        fn visit_str<E: Error>(self, word: &str) -> Result<Protocol, E> {
            let mut all = Protocol::ALL.into_iter();
            let known = all.find(|protocol| protocol.name() == word);
            known.ok_or_else(|| E::custom("2, \"session\", \"once\" or \"none\" is expected"))
        }

        fn visit_i64<E: Error>(self, number: i64) -> Result<Protocol, E> {
            self.visit_str(&number.to_string())
        }
    }
    deserializer.deserialize_any(Name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Programs, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("peers.toml");
        std::fs::write(&path, text).unwrap();
        let place = format!("{}", path.display());
        let short = |error: String| error.replace(&place, "peers.toml");
        let programs = read_programs(&path).map_err(|error| short(error.to_string()))?;
        // An error in a table is that of its program.
        for name in ["a", "a,b"] {
            if let Err(error) = programs.find(name)
                && !error.0.starts_with("there is no outside program")
            {
                return Err(short(error.0));
            }
        }
        Ok(programs)
    }

    #[test]
    fn tables_are_read_and_names_know_no_case() {
        let programs = read(
            "[ext.Fast]\ncommand = ['./fast', '{model}', '{source}', '{output}']\n\
             protocol = 'once'\napproximate = true\nversion = '3'\nflags = '-O2'\nfiles = ['fast.so']\n",
        )
        .unwrap();
        let fast = programs.find("fast").unwrap();
        assert_eq!(fast.protocol, Protocol::Once);
        assert!(fast.approximate && fast.directory.is_absolute());
        assert_eq!(fast.provenance.version.as_deref(), Some("3"));
        assert_eq!(fast.provenance.flags.as_deref(), Some("-O2"));
        assert_eq!(fast.files, ["fast.so"]);
        assert_eq!(
            programs.find("fats").unwrap_err().to_string(),
            "there is no outside program `fats` (did you mean `ext:fast`?): describe it in a table \
             [ext.fats] of the suite file, or of a file given with --ext; described are fast"
        );
    }

    #[test]
    fn a_table_that_is_not_used_is_not_checked() {
        let programs = read(
            "[ext.other]\ncomand = ['x']\n[ext.number]\nprotocol = 2\ncommand = ['x']\n\
             [ext.word]\nprotocol = '2'\ncommand = ['x']\n",
        )
        .unwrap();
        for name in ["number", "word"] {
            assert_eq!(programs.find(name).unwrap().protocol, Protocol::Two);
        }
        let error = programs.find("other").unwrap_err().to_string();
        assert!(error.contains("did you mean `command`?"), "{error}");
    }

    #[test]
    fn errors_name_file_and_line() {
        let complaints = [
            (
                "repeat = 3\n",
                "peers.toml: there is no table [ext.NAME] here",
            ),
            (
                "[ext.a]\n",
                "peers.toml, line 1: `a`: an outside program must have a `command`",
            ),
            (
                "[ext.a]\ncommand = ['x', '{modell}']\n",
                "peers.toml, line 2: `command`: `{modell}` has braces that are no placeholder; known are {model}, {source}, {threads}, {output}",
            ),
            (
                "[ext.a]\ncommand = ['x',\n '{modell}']\n",
                "peers.toml, line 2: `command`: `{modell}` has braces that are no placeholder; known are {model}, {source}, {threads}, {output}",
            ),
            (
                "[ext.a]\ncommand = ['x', '{model}', '{source}']\n",
                "peers.toml, line 2: `command`: {output} is missing: nothing else tells it, except in protocol 2",
            ),
            (
                "[ext.a]\nprotocol = 2\ncommand = ['x', '{source}']\n",
                "peers.toml, line 3: `command`: {source} is not known at the start: protocol 2 tells it in a request",
            ),
            (
                "[ext.a]\nprotocol = 3\n",
                "peers.toml, line 2: `protocol`: 2, \"session\", \"once\" or \"none\" is expected",
            ),
            (
                "[ext.a]\nprotocol = 'twice'\n",
                "peers.toml, line 2: `protocol`: 2, \"session\", \"once\" or \"none\" is expected",
            ),
            (
                "[ext.a]\ncomand = []\n",
                "peers.toml, line 2: there is no key `comand` here (did you mean `command`?); known are command, protocol, approximate, prepare, cleanup, parameters, version, source, changes, compiler, flags, files",
            ),
            (
                "[ext.'a,b']\ncommand = []\n",
                "peers.toml, line 1: `a,b`: a name is a word without any of `,{}=:`",
            ),
        ];
        for (text, complaint) in complaints {
            assert_eq!(read(text).unwrap_err(), complaint);
        }
    }
}
