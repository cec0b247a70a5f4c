//! External programs.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::Command;
use std::sync::Arc;

use geobench_mesh::did_you_mean;
use geobench_window::Counter;
use serde::{Deserialize, Serialize};

use super::Algorithm;
use crate::UsageError;

/// An external program, as described by a TOML file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// Its name in lower case, with its parameter values as in `heat{width=0.5}`.
    pub name: String,
    /// Its parameter values by name.
    pub parameters: BTreeMap<String, String>,
    /// An untimed command before each run; empty for none.
    pub prepare: Vec<String>,
    /// An untimed command after each run; empty for none.
    pub cleanup: Vec<String>,
    /// The program and its arguments, with placeholders.
    pub command: Vec<String>,
    /// Working directory: the directory of the TOML file.
    pub directory: PathBuf,
    /// How it is asked.
    pub protocol: Protocol,
    /// Whether its distances are approximate. They are compared with the reference, but the
    /// tolerance does not apply.
    pub approximate: bool,
    /// Where it comes from.
    pub provenance: Provenance,
    /// Further files that belong to it, relative to the directory, such as the library of a script.
    pub files: Vec<String>,
}

/// Where an external program comes from, in the words of its TOML file.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// Its version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// Its source: an address, and a commit if it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// What was changed in its source.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub changes: Option<String>,
    /// The compiler that built it, or the interpreter that runs it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compiler: Option<String>,
    /// The options of the compiler.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flags: Option<String>,
}

/// The protocol of an external program; `docs/protocol.md` describes it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Protocol {
    /// Version 2: one process for all runs of a cell, which is told the source when it is asked to
    /// solve. Its times can be checked from outside.
    Two,
    /// Version 1: one process for all runs of a cell. Its command names the source, and each run is
    /// requested on standard input.
    #[default]
    Session,
    /// Version 1: one process for each run, which starts without a request.
    Once,
    /// One run, from the start of a command to its exit. The program writes the distances and no
    /// reply.
    Command,
}

impl Protocol {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Two, Self::Session, Self::Once, Self::Command];

    /// The name in TOML files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Two => "2",
            Self::Session => "session",
            Self::Once => "once",
            Self::Command => "none",
        }
    }

    /// Whether one process makes all runs of a cell.
    pub const fn keeps_process(self) -> bool {
        matches!(self, Self::Two | Self::Session)
    }
}

/// The placeholders of commands.
pub const PLACEHOLDERS: [&str; 4] = ["{model}", "{source}", "{threads}", "{output}"];

/// The values of the placeholders of a command.
#[derive(Clone, Debug)]
pub struct Call {
    /// The model, an OBJ file.
    pub model: PathBuf,
    /// The source vertex, counted from 0.
    pub source: u32,
    /// Number of threads that the program may use.
    pub threads: usize,
    /// The file to which the program writes distances.
    pub output: PathBuf,
}

impl Program {
    /// Whether its command has the placeholder of the number of threads.
    pub(crate) fn takes_threads(&self) -> bool {
        self.command.iter().any(|word| word.contains("{threads}"))
    }

    /// The name in its TOML file, without parameter values, as algorithm names have it.
    pub fn described_name(&self) -> String {
        let name = self.name.split('{').next().unwrap_or_default();
        format!("{PREFIX}{name}")
    }

    /// A process command from `words`, with the placeholders filled in.
    pub fn command(&self, words: &[String], call: &Call) -> Command {
        let fill = |word: &String| {
            let values = [
                call.model.display().to_string(),
                call.source.to_string(),
                call.threads.to_string(),
                call.output.display().to_string(),
            ];
            let pairs = PLACEHOLDERS.iter().zip(values);
            let word = pairs.fold(word.clone(), |word, (name, value)| {
                word.replace(name, &value)
            });
            self.parameters.iter().fold(word, |word, (name, value)| {
                word.replace(&format!("{{{name}}}"), value)
            })
        };
        let mut words = words.iter().map(fill);
        let program = words.next().unwrap_or_default();
        // A name without a slash is looked up in `PATH`. Otherwise it is relative to the TOML file.
        let program = if program.contains('/') {
            self.directory.join(program)
        } else {
            PathBuf::from(program)
        };
        let mut command = Command::new(program);
        command.args(words).current_dir(&self.directory);
        command
    }
}

/// External programs with different names, in the order of their files.
#[derive(Clone, Debug, Default)]
pub struct Programs(Vec<(String, Result<Arc<Program>, UsageError>)>);

impl Programs {
    fn called(&self, name: &str) -> Option<&Result<Arc<Program>, UsageError>> {
        let found = self.0.iter().find(|(known, _)| known == name);
        found.map(|(_, program)| program)
    }

    /// Adds a program; false if the name is taken.
    pub fn add(&mut self, program: Arc<Program>) -> bool {
        let is_free = self.called(&program.name).is_none();
        let entry = is_free.then(|| (program.name.clone(), Ok(program)));
        self.0.extend(entry);
        is_free
    }

    /// Adds a description with an error, which is reported if the program is selected.
    pub fn add_faulty(&mut self, name: &str, error: UsageError) {
        self.0.retain(|(known, _)| known != name);
        self.0.push((name.to_owned(), Err(error)));
    }

    /// These programs, and those of `others` with other names.
    #[must_use]
    pub fn or(mut self, others: &Self) -> Self {
        for (name, program) in &others.0 {
            if self.called(name).is_none() {
                self.0.push((name.clone(), program.clone()));
            }
        }
        self
    }

    /// The full names that `name` selects: itself, or, if its parameters have several values, the
    /// name of each combination, in the order of the file.
    pub(crate) fn meant_by(&self, name: &str) -> Vec<String> {
        if self.called(name).is_some() {
            return vec![name.to_owned()];
        }
        let begins = |full: &&str| full.strip_prefix(name).is_some_and(|r| r.starts_with('{'));
        let names = self.0.iter().map(|(name, _)| name.as_str());
        names.filter(begins).map(str::to_owned).collect()
    }

    /// The program called `name`.
    ///
    /// # Errors
    ///
    /// If there is no program of this name, or its description has an error.
    pub fn find(&self, name: &str) -> Result<Arc<Program>, UsageError> {
        let described = name.split('{').next().unwrap_or(name);
        if let Some(known) = self.called(name) {
            return known.clone();
        }
        if let Some(Err(error)) = self.called(described) {
            return Err(error.clone());
        }
        let mut known: Vec<&str> = self.0.iter().map(|(name, _)| name.as_str()).collect();
        known.sort_unstable();
        let prefixed: Vec<String> = known.iter().map(|name| format!("{PREFIX}{name}")).collect();
        let prefixed: Vec<&str> = prefixed.iter().map(String::as_str).collect();
        let hint = did_you_mean(&format!("{PREFIX}{name}"), &prefixed);
        let described = if known.is_empty() {
            "; `geobench init` writes an example, scripts/peers in the repository of geobench a \
             file with public programs"
                .to_owned()
        } else {
            format!("; described are {}", known.join(", "))
        };
        Err(UsageError(format!(
            "there is no outside program `{name}`{hint}: describe it in a table [ext.{name}] of \
             the suite file, or of a file given with --ext{described}"
        )))
    }
}

/// Prefix of the names of external programs.
pub(crate) const PREFIX: &str = "ext:";

/// The registry entry of all external programs.
pub(crate) static OUTSIDE: Algorithm = Algorithm {
    name: "ext",
    family: "ext",
    paper: "its own",
    summary: "an outside program",
    complexity: "its own",
    keeps: "its own",
    choose: "to compare with",
    memory_counter: Counter::StoredWindows,
    ends_early: false,
    ..Algorithm::APPROXIMATE
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_filled_in_and_found_beside_its_file() {
        let program = Program {
            name: "p".into(),
            command: [
                "./run",
                "{model}",
                "-s{source}",
                "{threads}",
                "--to={output}",
                "{width}",
            ]
            .map(str::to_owned)
            .to_vec(),
            parameters: BTreeMap::from([("width".to_owned(), "0.5".to_owned())]),
            prepare: Vec::new(),
            cleanup: Vec::new(),
            directory: "/here".into(),
            protocol: Protocol::Once,
            approximate: false,
            provenance: Provenance::default(),
            files: Vec::new(),
        };
        let call = Call {
            model: "/tmp/m.obj".into(),
            source: 7,
            threads: 2,
            output: "/tmp/d.csv".into(),
        };
        let command = program.command(&program.command, &call);
        assert_eq!(command.get_program(), "/here/./run");
        let arguments: Vec<_> = command.get_args().collect();
        assert_eq!(
            arguments,
            ["/tmp/m.obj", "-s7", "2", "--to=/tmp/d.csv", "0.5"]
        );
        assert_eq!(command.get_current_dir(), Some("/here".as_ref()));
    }
}
