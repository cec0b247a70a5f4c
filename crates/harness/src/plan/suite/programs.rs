//! External programs in TOML files: tables `[ext.NAME]`.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use geobench_registry::{PLACEHOLDERS, ProcessLifetime, Program, Programs};
use serde::{Deserialize, Deserializer};
use toml::Spanned;

use crate::usage::document::{DocumentError, TomlDocument, parsed};

/// The tables `[ext.NAME]`.
pub(super) type ProgramTables = BTreeMap<String, Spanned<ProgramTable>>;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ProgramTable {
    #[serde(default)]
    command: Option<Spanned<Vec<String>>>,
    #[serde(default, deserialize_with = "protocol")]
    protocol: ProcessLifetime,
    #[serde(default)]
    approximate: bool,
    #[serde(default)]
    prepare: Vec<String>,
    #[serde(default)]
    cleanup: Vec<String>,
    #[serde(default)]
    parameters: BTreeMap<String, Vec<toml::Value>>,
}

/// Reads the tables `[ext.NAME]` of a file: a suite file, or one that holds nothing else.
///
/// # Errors
///
/// Names the file, the line and the key.
pub fn read_programs(path: &Path) -> Result<Programs, DocumentError> {
    /// Other keys are ignored.
    #[derive(Deserialize)]
    struct File {
        ext: Option<ProgramTables>,
    }

    let document = TomlDocument::open(path)?;
    match document.read::<File>(document.parse()?, &[])?.ext {
        Some(tables) => programs(tables, &document),
        None => Err(document.error(None, "there is no table [ext.NAME] here")),
    }
}

/// The programs of all tables.
pub(super) fn programs(
    tables: ProgramTables,
    document: &TomlDocument<'_>,
) -> Result<Programs, DocumentError> {
    // The parent of a bare file name is empty, which is not a valid directory for the system.
    let folder = Some(document.directory()).filter(|folder| *folder != Path::new(""));
    let folder = folder.unwrap_or(Path::new("."));
    let directory = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    let mut programs = Programs::default();
    for (name, table) in tables {
        let (span, table) = (Some(table.span()), table.into_inner());
        let error = |problem| Err(document.error_at(&name, span.clone(), problem));
        if name.contains(|c: char| " ,{}=:".contains(c)) || name.is_empty() {
            return error("a name is a word without any of `,{}=:`");
        }
        let no_command = Spanned::new(0..0, Vec::new());
        let command = table.command.unwrap_or(no_command);
        let command_span = Some(command.span());
        let command = command.into_inner();
        if command.is_empty() {
            return error("an outside program must have a `command`");
        }
        let combinations = match combinations(&table.parameters) {
            Ok(combinations) => combinations,
            Err(problem) => return error(&problem),
        };
        if let Err(problem) = check_command(&command, &table.parameters) {
            return Err(document.error_at("command", command_span, &problem));
        }
        for word in table.prepare.iter().chain(&table.cleanup) {
            if let Err(problem) = check_word(word, &table.parameters) {
                return error(&problem);
            }
        }
        for parameters in combinations {
            let values: Vec<String> = parameters.iter().map(|(k, v)| format!("{k}={v}")).collect();
            let added = programs.add(Arc::new(Program {
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
                lifetime: table.protocol,
                approximate: table.approximate,
            }));
            if !added {
                return error("two are called so, letter case apart");
            }
        }
    }
    Ok(programs)
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

/// Checks that a command contains the placeholders of the model, the source and the output.
fn check_command(
    command: &[String],
    parameters: &BTreeMap<String, Vec<toml::Value>>,
) -> Result<(), String> {
    for word in command {
        check_word(word, parameters)?;
    }
    for needed in ["{model}", "{source}", "{output}"] {
        if !command.iter().any(|word| word.contains(needed)) {
            return Err(format!("{needed} is missing: nothing else tells it"));
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

fn protocol<'de, D: Deserializer<'de>>(deserializer: D) -> Result<ProcessLifetime, D::Error> {
    parsed(deserializer, |word| {
        let mut all = ProcessLifetime::ALL.into_iter();
        let known = all.find(|lifetime| lifetime.name() == word);
        known.ok_or_else(|| "\"session\", \"once\" or \"none\" is expected".to_owned())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Programs, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("peers.toml");
        std::fs::write(&path, text).unwrap();
        let place = format!("{}", path.display());
        read_programs(&path).map_err(|error| error.to_string().replace(&place, "peers.toml"))
    }

    #[test]
    fn tables_are_read_and_names_know_no_case() {
        let programs = read(
            "[ext.Fast]\ncommand = ['./fast', '{model}', '{source}', '{output}']\n\
             protocol = 'once'\napproximate = true\n",
        )
        .unwrap();
        let fast = programs.find("fast").unwrap();
        assert_eq!(fast.lifetime, ProcessLifetime::Once);
        assert!(fast.approximate && fast.directory.is_absolute());
        assert_eq!(
            programs.find("fats").unwrap_err().to_string(),
            "there is no outside program `fats`, did you mean `ext:fast`?: describe it in a table \
             [ext.fats] of the suite file, or of a file given with --ext; described are fast"
        );
    }

    #[test]
    fn what_is_not_understood_is_named_with_its_line() {
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
                "peers.toml, line 2: `command`: {output} is missing: nothing else tells it",
            ),
            (
                "[ext.a]\nprotocol = 'twice'\n",
                "peers.toml, line 2: `protocol`: \"session\", \"once\" or \"none\" is expected",
            ),
            (
                "[ext.a]\ncomand = []\n",
                "peers.toml, line 2: there is no key `comand` here, did you mean `command`?; known are command, protocol, approximate, prepare, cleanup, parameters",
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
