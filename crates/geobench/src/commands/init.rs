//! `geobench init`.

use std::path::Path;

use anyhow::bail;
use clap::Args;
use geobench_export::output::{OutputFile, make_directory};

use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
pub(crate) struct InitOptions {
    /// Write nothing; list the files, and which of them exist
    #[arg(long)]
    list: bool,

    /// Replace files that exist
    #[arg(long)]
    force: bool,

    /// The action that the workflow uses: the repository of geobench with a commit, as in
    /// OWNER/REPOSITORY@HASH
    #[arg(long, value_name = "ACTION", default_value = ACTION, value_parser = action)]
    action: String,
}

/// The action in the repository that a release was built from.
const ACTION: &str = match option_env!("GEOBENCH_ACTION") {
    Some(action) => action,
    None => concat!("OWNER/geobench@v", env!("CARGO_PKG_VERSION")),
};

/// A file, with its text.
struct TemplateFile {
    path: &'static str,
    shows: &'static str,
    text: &'static str,
}

const FILES: [TemplateFile; 4] = [
    TemplateFile {
        path: "benchmarks/suite.toml",
        shows: "what is measured",
        text: include_str!("../../templates/suite.toml"),
    },
    TemplateFile {
        path: "benchmarks/programs.toml",
        shows: "how the solver is started",
        text: include_str!("../../templates/programs.toml"),
    },
    TemplateFile {
        path: "benchmarks/solver.py",
        shows: "a solver to be replaced",
        text: include_str!("../../templates/solver.py"),
    },
    TemplateFile {
        path: ".github/workflows/benchmarks.yml",
        shows: "records pushes, compares pull requests",
        text: include_str!("../../templates/benchmarks.yml"),
    },
];

/// What to do after the files are written.
const NEXT: &str = "\
next:
  1. geobench run --config benchmarks/suite.toml --ext benchmarks/programs.toml
  2. put your solver in the place of benchmarks/solver.py, and its command into programs.toml
  3. commit the files and push them
  4. on GitHub, Settings > Pages: deploy from the branch benchmark-history (there after the first push)
docs/track-your-solver.md in the repository of geobench has every step, and how a pull request turns red
";

pub(crate) fn init(options: &InitOptions) -> anyhow::Result<Verdict> {
    let exists = |file: &&TemplateFile| Path::new(file.path).symlink_metadata().is_ok();
    if options.list {
        let lines = FILES.iter().map(|file| {
            let state = match (exists(&file), options.force) {
                (false, _) => "",
                (true, false) => " (exists)",
                (true, true) => " (exists, would be replaced)",
            };
            format!("{}: {}{state}\n", file.path, file.shows)
        });
        terminal::print(&lines.collect::<String>())?;
        tell_place();
        return Ok(Verdict::Passed);
    }
    let present: Vec<&str> = FILES.iter().filter(exists).map(|file| file.path).collect();
    if !present.is_empty() && !options.force {
        bail!(
            "{} {} already; nothing was written (--force replaces, --list shows)",
            present.join(", "),
            if present.len() == 1 {
                "exists"
            } else {
                "exist"
            }
        );
    }
    // All folders first, so that nothing is written if one cannot be made.
    let mut outputs = Vec::new();
    for file in &FILES {
        let path = Path::new(file.path);
        if let Some(directory) = path.parent() {
            make_directory(directory)?;
        }
        outputs.push(OutputFile::prepare(path)?);
    }
    let mut said = Vec::new();
    for (file, output) in FILES.iter().zip(&outputs) {
        let text = file.text.replace("{action}", &options.action);
        output.write(text.as_bytes())?;
        said.push(format!("{}: {}\n", file.path, file.shows));
    }
    if options.action.starts_with("OWNER/") {
        let replace = "replace OWNER in the workflow by the owner of the repository of geobench, or \
                       give --action\n";
        said.push(replace.to_owned());
    }
    terminal::print(&(said.concat() + NEXT))?;
    tell_place();
    Ok(Verdict::Passed)
}

/// Writes a note if the current directory is not the top one of a repository, the only one whose
/// workflows GitHub reads and in which the action runs.
fn tell_place() {
    let Ok(here) = std::env::current_dir() else {
        return;
    };
    // In a work tree and in a submodule it is a file.
    let top = here.ancestors().find(|path| path.join(".git").exists());
    let note = match top {
        Some(top) if top == here => return,
        Some(top) => format!(
            "the top directory of the repository is {}: GitHub reads no workflow below it, and the \
             action looks for benchmarks there; run init there, or move the files",
            top.display()
        ),
        None => "the current directory is in no repository: GitHub reads workflows in the top \
                 directory of one only; run git init here, or move the files into that directory"
            .to_owned(),
    };
    terminal::notes(&[note]);
}

/// An action with its version.
fn action(text: &str) -> Result<String, String> {
    let is_name = |part: &str| {
        let mut letters = part.chars();
        !part.is_empty() && letters.all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c))
    };
    let (repository, version) = text.split_once('@').unwrap_or((text, ""));
    match repository.split_once('/') {
        Some((owner, name)) if is_name(owner) && is_name(name) && is_name(version) => {
            Ok(text.to_owned())
        }
        _ => Err("write OWNER/REPOSITORY@HASH".to_owned()),
    }
}
