//! Outside programs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use geobench_mesh::did_you_mean;
use geobench_window::Counter;

use super::Algorithm;
use crate::UsageError;

/// An outside program, as a TOML file describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// Its name, in lower case, with the values of its parameters as in `heat{width=0.5}`.
    pub name: String,
    /// The values of its parameters by name, in the order of their names.
    pub parameters: BTreeMap<String, String>,
    /// A command before each run, which is not timed; empty for none.
    pub prepare: Vec<String>,
    /// A command after each run, which is not timed; empty for none.
    pub cleanup: Vec<String>,
    /// The program and its arguments, with placeholders.
    pub command: Vec<String>,
    /// Working directory: that of the file that describes it.
    pub directory: PathBuf,
    /// How long its process lives.
    pub lifetime: ProcessLifetime,
    /// Whether its distances are approximate, so that they are compared but not held to the
    /// tolerance.
    pub approximate: bool,
}

/// How long the process of an outside program lives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProcessLifetime {
    /// For all runs of a cell; each run is requested on standard input.
    #[default]
    Session,
    /// For one run, which starts without a request.
    Once,
    /// For one run, from the start of a command to its end; it writes the distances and no answer.
    Command,
}

impl ProcessLifetime {
    /// All of them.
    pub(crate) const ALL: [Self; 3] = [Self::Session, Self::Once, Self::Command];

    /// The word for it in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Session => "session",
            Self::Once => "once",
            Self::Command => "none",
        }
    }
}

/// The words that a command may hold in braces.
pub(crate) const PLACEHOLDERS: [&str; 4] = ["{model}", "{source}", "{threads}", "{output}"];

/// The values of the placeholders of a command.
#[derive(Clone, Debug)]
pub(crate) struct Call<'c> {
    /// The model, an OBJ file.
    pub(crate) model: &'c Path,
    /// The source vertex, counted from 0.
    pub(crate) source: u32,
    /// Threads that it may use.
    pub(crate) threads: usize,
    /// The file to which distances go.
    pub(crate) output: PathBuf,
}

impl Program {
    /// Whether its command takes the number of threads.
    pub(crate) fn takes_threads(&self) -> bool {
        self.command.iter().any(|word| word.contains("{threads}"))
    }

    /// One of its commands with the placeholders filled in.
    pub(crate) fn command(&self, words: &[String], call: &Call<'_>) -> Command {
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
        // A name without a slash is looked up in `PATH`; else it is relative to the file.
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

/// Outside programs with different names, in the order of their files.
#[derive(Clone, Debug, Default)]
pub struct Programs(Vec<Arc<Program>>);

impl Programs {
    fn called(&self, name: &str) -> Option<&Arc<Program>> {
        self.0.iter().find(|program| program.name == name)
    }

    /// Adds a program; false if the name is taken.
    pub(crate) fn add(&mut self, program: Arc<Program>) -> bool {
        let is_free = self.called(&program.name).is_none();
        self.0.extend(is_free.then_some(program));
        is_free
    }

    /// These, and those of `others` whose names are not among them.
    #[must_use]
    pub fn or(mut self, others: &Self) -> Self {
        for program in &others.0 {
            self.add(program.clone());
        }
        self
    }

    /// The names of the programs that `name` stands for: its own, or, if its parameters have several
    /// values, that of each combination, in the order of the file.
    pub(crate) fn meant_by(&self, name: &str) -> Vec<String> {
        if self.called(name).is_some() {
            return vec![name.to_owned()];
        }
        let begins = |full: &&str| full.strip_prefix(name).is_some_and(|r| r.starts_with('{'));
        let names = self.0.iter().map(|program| program.name.as_str());
        names.filter(begins).map(str::to_owned).collect()
    }

    /// The program called `name`.
    ///
    /// # Errors
    ///
    /// When there is none of this name.
    pub fn find(&self, name: &str) -> Result<Arc<Program>, UsageError> {
        self.called(name).cloned().ok_or_else(|| {
            let mut known: Vec<&str> = self.0.iter().map(|p| p.name.as_str()).collect();
            known.sort_unstable();
            let prefixed: Vec<String> =
                known.iter().map(|name| format!("{PREFIX}{name}")).collect();
            let prefixed: Vec<&str> = prefixed.iter().map(String::as_str).collect();
            let hint = did_you_mean(&format!("{PREFIX}{name}"), &prefixed);
            let described = if known.is_empty() {
                String::new()
            } else {
                format!("; described are {}", known.join(", "))
            };
            UsageError(format!(
                "there is no outside program `{name}`{hint}: describe it in a table [ext.{name}] \
                 of the suite file, or of a file given with --ext{described}"
            ))
        })
    }
}

/// Prefix of the names of outside programs.
pub(super) const PREFIX: &str = "ext:";

/// The registry entry of all outside programs.
pub(super) static OUTSIDE: Algorithm = Algorithm {
    name: "ext",
    family: "ext",
    paper: "its own",
    summary: "an outside program",
    complexity: "its own",
    keeps: "its own",
    choose: "to compare with",
    memory_counter: Counter::StoredWindows,
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
            lifetime: ProcessLifetime::Once,
            approximate: false,
        };
        let call = Call {
            model: Path::new("/tmp/m.obj"),
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
        assert_eq!(command.get_current_dir(), Some(Path::new("/here")));
    }
}
