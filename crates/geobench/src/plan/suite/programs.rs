//! Outside programs in TOML files: tables `[ext.NAME]`.

use std::path::Path;

use super::document::{Document, Entry, SuiteError};
use crate::registry::{Keeping, PLACEHOLDERS, Program, Programs};

/// The key under which the tables stand.
pub(crate) const KEY: &str = "ext";

/// Reads the tables `[ext.NAME]` of a file that holds nothing else, or of a suite file.
///
/// # Errors
///
/// Names the file, the line and the key.
pub fn read_programs(path: &Path) -> Result<Programs, SuiteError> {
    let text = std::fs::read_to_string(path).map_err(|error| SuiteError {
        path: path.to_owned(),
        line: None,
        problem: error.to_string(),
    })?;
    let document = Document { path, text: &text };
    let table = document.parse()?;
    for (key, value) in &table {
        if key.get_ref() == KEY {
            return tables(&Entry {
                document,
                key: key.get_ref(),
                value,
            });
        }
    }
    Err(document.error(None, "there is no table [ext.NAME] here"))
}

/// Reads all tables under [`KEY`].
pub(crate) fn tables(entry: &Entry<'_>) -> Result<Programs, SuiteError> {
    let mut programs = Programs::default();
    for (name, value) in entry.table()? {
        let table = Entry {
            key: name.get_ref(),
            value,
            ..*entry
        };
        if name.get_ref().contains(|c: char| " ,{}=:".contains(c)) || name.get_ref().is_empty() {
            return Err(table.error("a name is a word without any of `,{}=:`"));
        }
        if !programs.add(program(&table)?) {
            return Err(table.error("two are called so, letter case apart"));
        }
    }
    Ok(programs)
}

fn program(table: &Entry<'_>) -> Result<Program, SuiteError> {
    // The parent of a bare name is empty, which is no directory to the system.
    let folder = table
        .document
        .path
        .parent()
        .filter(|folder| *folder != Path::new(""));
    let folder = folder.unwrap_or(Path::new("."));
    let directory = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    let mut program = Program {
        name: table.key.to_lowercase(),
        command: Vec::new(),
        directory,
        keeping: Keeping::default(),
        approximate: false,
    };
    for (key, value) in table.table()? {
        let field = Entry {
            key: key.get_ref(),
            value,
            ..*table
        };
        match field.key {
            "command" => program.command = command(&field)?,
            "protocol" => {
                let word = field.text()?;
                let known = Keeping::ALL.into_iter().find(|k| k.name() == word);
                program.keeping =
                    known.ok_or_else(|| field.error("\"session\" or \"once\" is expected"))?;
            }
            "approximate" => program.approximate = field.boolean()?,
            _ => {
                let known = ["command", "protocol", "approximate"];
                return Err(field.document.unknown_key(key, &known));
            }
        }
    }
    if program.command.is_empty() {
        return Err(table.error("an outside program must have a `command`"));
    }
    Ok(program)
}

/// A list of words, each with known placeholders only; the model and the output must be among
/// them.
fn command(entry: &Entry<'_>) -> Result<Vec<String>, SuiteError> {
    let mut words = Vec::new();
    for word in entry.list()? {
        let text = word.text()?;
        let rest = PLACEHOLDERS
            .iter()
            .fold(text.to_owned(), |rest, name| rest.replace(name, ""));
        if rest.contains(['{', '}']) {
            return Err(word.error(&format!(
                "`{text}` has braces that are no placeholder; known are {}",
                PLACEHOLDERS.join(", ")
            )));
        }
        words.push(text.to_owned());
    }
    for needed in ["{model}", "{source}", "{output}"] {
        if !words.iter().any(|word| word.contains(needed)) {
            return Err(entry.error(&format!("{needed} is missing: nothing else tells it")));
        }
    }
    Ok(words)
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
        assert_eq!(fast.keeping, Keeping::Once);
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
                "[ext.a]\ncommand = ['x', '{model}', '{source}']\n",
                "peers.toml, line 2: `command`: {output} is missing: nothing else tells it",
            ),
            (
                "[ext.a]\nprotocol = 'twice'\n",
                "peers.toml, line 2: `protocol`: \"session\" or \"once\" is expected",
            ),
            (
                "[ext.a]\ncomand = []\n",
                "peers.toml, line 2: there is no key `comand` here, did you mean `command`?; known are command, protocol, approximate",
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
