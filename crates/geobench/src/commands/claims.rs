//! `geobench claims`.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args;
use geobench_export::output;
use geobench_harness::schema::result_file;
use geobench_harness::usage::files_in;
use geobench_report::claims::{self, ClaimsFile, ClaimsFormat, Input};
use geobench_report::table::Look;

use crate::args::{FormatOption, QuietOption};
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(
    after_help = "A claim is decided by the results of its suite (`run --suite SUITE`). docs/claims.md has \
    the rules and the form of files of claims. Exit status: 0 whatever the verdicts are; 2 a file cannot be used."
)]
pub(crate) struct ClaimsOptions {
    /// Result files (.json), or directories of some; at most one of each suite
    #[arg(value_name = "RESULT", required = true)]
    pub(crate) results: Vec<PathBuf>,

    /// File of claims (.toml), or a directory of some [default: those of the papers, which are part
    /// of the program]
    #[arg(long, value_name = "DIR|FILE")]
    pub(crate) claims: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) format: FormatOption<ClaimsFormat>,

    /// File to write instead, by its ending: .md, .json, .csv or .txt; may be repeated
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) quiet: QuietOption,
}

pub(crate) fn claims(options: &ClaimsOptions, look: Look) -> anyhow::Result<Verdict> {
    let outputs = output::prepare::<ClaimsFormat>(&options.output)?;
    let of_claims = options.claims.as_ref().map(|given| files(given, "toml"));
    let of_claims = of_claims.transpose()?;
    let results = options.results.iter().map(|given| files(given, "json"));
    let results = results.collect::<anyhow::Result<Vec<_>>>()?.concat();
    let read = of_claims.iter().flatten().chain(&results);
    output::check_files(outputs.iter().map(|(_, file)| file), read)?;
    let wanted = match of_claims {
        None => claims::known()?,
        Some(paths) => {
            let files = paths.iter().map(|path| ClaimsFile::read(path));
            files.collect::<Result<_, _>>()?
        }
    };
    let results = results.into_iter().map(|path| {
        let result = result_file::read(&path)?;
        Ok(Input::new(path, result))
    });
    let results = results.collect::<anyhow::Result<Vec<_>>>()?;
    let report = claims::judge(&wanted, &results)?;
    if !options.quiet.is_set {
        terminal::warnings(&report.notes);
    }
    for (format, file) in &outputs {
        file.write(
            format
                .render(&report, geobench_report::table::Look::default())?
                .as_bytes(),
        )?;
    }
    if outputs.is_empty() {
        terminal::print_rendered(&options.format.chosen().render(&report, look)?)?;
    }
    Ok(Verdict::Passed)
}

/// The file itself, or the files with this extension in the directory, sorted by name.
fn files(given: &Path, ending: &str) -> anyhow::Result<Vec<PathBuf>> {
    if !given.is_dir() {
        return Ok(vec![given.to_owned()]);
    }
    let paths = files_in(given, ending)?;
    if paths.is_empty() {
        bail!("{}: it holds no .{ending} file", given.display());
    }
    Ok(paths)
}
