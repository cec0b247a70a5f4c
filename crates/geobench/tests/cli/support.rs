//! Calls the program in a temporary directory.

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use tempfile::TempDir;

/// A triangulated unit square, 4 vertices and 2 faces.
pub(crate) const SQUARE: &str = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

/// A mesh that is refused: an edge from vertex 0 to vertex 1 that is too long.
pub(crate) const UNUSABLE: &str = "OFF\n3 1 0\n0 0 0\n1e99 0 0\n0 1 0\n3 0 1 2\n";

/// Variables under which git has no settings of the user and of the system.
pub(crate) const PLAIN_GIT: [(&str, &str); 2] = [
    ("GIT_CONFIG_GLOBAL", "/dev/null"),
    ("GIT_CONFIG_NOSYSTEM", "1"),
];

/// An empty directory in which the program is called.
pub(crate) struct Sandbox(TempDir);

/// The outcome of a call.
#[derive(Debug)]
pub(crate) struct Outcome {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Sandbox {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// A sandbox with the [`SQUARE`] as `square.off`.
    pub(crate) fn with_square() -> Self {
        let sandbox = Self::new();
        sandbox.write("square.off", SQUARE);
        sandbox
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, contents: &str) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap_or(Path::new("."))).unwrap();
        fs::write(path, contents).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    pub(crate) fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }

    /// The program with the words of `arguments`, ready to be called.
    pub(crate) fn command(&self, arguments: &str) -> Command {
        let mut command = Command::cargo_bin("geobench").unwrap();
        command
            .current_dir(self.0.path())
            .env_remove("NO_COLOR")
            // The width of help texts.
            .env_remove("COLUMNS")
            .args(arguments.split_whitespace());
        command
    }

    /// Calls the program with the words of `arguments`.
    pub(crate) fn call(&self, arguments: &str) -> Outcome {
        let output = self.command(arguments).output().unwrap();
        Outcome {
            code: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Calls the program, which must succeed, and returns its standard output.
    pub(crate) fn succeed(&self, arguments: &str) -> String {
        let outcome = self.call(arguments);
        assert_eq!(
            outcome.code, 0,
            "{arguments}: {}{}",
            outcome.stdout, outcome.stderr
        );
        outcome.stdout
    }

    /// Calls the program, which must fail with status 2 and one line on standard error. Returns
    /// that line without the common prefix of all errors.
    pub(crate) fn refuse(&self, arguments: &str) -> String {
        let outcome = self.call(arguments);
        assert_eq!(
            outcome.code, 2,
            "{arguments}: {}{}",
            outcome.stdout, outcome.stderr
        );
        assert_eq!(
            outcome.stderr.lines().count(),
            1,
            "{arguments}: {}",
            outcome.stderr
        );
        let message = outcome.stderr.strip_prefix("geobench: error: ");
        message
            .unwrap_or_else(|| panic!("{}", outcome.stderr))
            .trim_end()
            .to_owned()
    }
}
