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
    /// Its name, in lower case.
    pub name: String,
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
}

impl ProcessLifetime {
    /// Both.
    pub(crate) const ALL: [Self; 2] = [Self::Session, Self::Once];

    /// The word for it in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Session => "session",
            Self::Once => "once",
        }
    }
}

/// The words that a command may hold in braces.
pub(crate) const PLACEHOLDERS: [&str; 4] = ["{model}", "{source}", "{threads}", "{output}"];

/// The values of the placeholders of a command.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Call<'c> {
    /// The model, an OBJ file.
    pub(crate) model: &'c Path,
    /// The source vertex, counted from 0.
    pub(crate) source: u32,
    /// Threads that it may use.
    pub(crate) threads: usize,
    /// The file to which distances go.
    pub(crate) output: &'c Path,
}

impl Program {
    /// Whether its command takes the number of threads.
    pub(crate) fn takes_threads(&self) -> bool {
        self.command.iter().any(|word| word.contains("{threads}"))
    }

    /// The command with its placeholders filled in.
    pub(crate) fn command(&self, call: Call<'_>) -> Command {
        let fill = |word: &String| {
            let values = [
                call.model.display().to_string(),
                call.source.to_string(),
                call.threads.to_string(),
                call.output.display().to_string(),
            ];
            let pairs = PLACEHOLDERS.iter().zip(values);
            pairs.fold(word.clone(), |word, (name, value)| {
                word.replace(name, &value)
            })
        };
        let mut words = self.command.iter().map(fill);
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

/// Outside programs by name.
#[derive(Clone, Debug, Default)]
pub struct Programs(BTreeMap<String, Arc<Program>>);

impl Programs {
    /// Adds a program; false if the name is taken.
    pub(crate) fn add(&mut self, program: Program) -> bool {
        let free = !self.0.contains_key(&program.name);
        if free {
            self.0.insert(program.name.clone(), Arc::new(program));
        }
        free
    }

    /// These, and those of `others` whose names are not among them.
    #[must_use]
    pub fn or(mut self, others: &Self) -> Self {
        for (name, program) in &others.0 {
            self.0
                .entry(name.clone())
                .or_insert_with(|| program.clone());
        }
        self
    }

    /// The program called `name`.
    ///
    /// # Errors
    ///
    /// When there is none of this name.
    pub fn find(&self, name: &str) -> Result<Arc<Program>, UsageError> {
        self.0.get(name).cloned().ok_or_else(|| {
            let known: Vec<&str> = self.0.keys().map(String::as_str).collect();
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
    exact: false,
    summary: "an outside program",
    departs: "",
    complexity: "its own",
    keeps: "its own",
    choose: "to compare with",
    memory_counter: Counter::StoredWindows,
    comfortable_faces: None,
    parameters: &[],
    build: |_, _| panic!("an outside program has no solver in this one"),
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
            ]
            .map(str::to_owned)
            .to_vec(),
            directory: "/here".into(),
            lifetime: ProcessLifetime::Once,
            approximate: false,
        };
        let command = program.command(Call {
            model: Path::new("/tmp/m.obj"),
            source: 7,
            threads: 2,
            output: Path::new("/tmp/d.csv"),
        });
        assert_eq!(command.get_program(), "/here/./run");
        let arguments: Vec<_> = command.get_args().collect();
        assert_eq!(arguments, ["/tmp/m.obj", "-s7", "2", "--to=/tmp/d.csv"]);
        assert_eq!(command.get_current_dir(), Some(Path::new("/here")));
    }
}
