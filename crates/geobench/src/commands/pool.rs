//! `geobench pool`.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use geobench_export::output;
use geobench_harness::schema::result_file;
use geobench_report::history::pool as rounds;
use geobench_report::table::ResultFormat;

use crate::verdict::Verdict;

#[derive(Args, Debug)]
pub(crate) struct PoolOptions {
    /// Result files (.json) of the rounds, in the order in which they were run
    #[arg(value_name = "ROUND", required = true)]
    pub(crate) rounds: Vec<PathBuf>,

    /// Result file, by its ending: .json, .csv, .md, .tex, .bmf.json (Bencher) or
    /// .gab.json (github-action-benchmark); may be repeated
    #[arg(short, long, value_name = "FILE", required = true)]
    pub(crate) output: Vec<PathBuf>,

    /// Text that the files of both versions share; `compare` then pairs sample i of the one with
    /// sample i of the other
    #[arg(long, value_name = "ID")]
    pub(crate) pairing: Option<String>,
}

pub(crate) fn pool(options: &PoolOptions) -> anyhow::Result<Verdict> {
    let outputs = output::prepare::<ResultFormat>(&options.output)?;
    output::check_files(outputs.iter().map(|(_, file)| file), &options.rounds)?;
    for (i, round) in options.rounds.iter().enumerate() {
        if options.rounds[..i].contains(round) {
            bail!("{}: given twice; each round counts once", round.display());
        }
    }
    let files = result_file::read_all(&options.rounds)?;
    let joined = rounds::pool(files, options.pairing.clone())?;
    for (format, file) in &outputs {
        file.write(format.render(&joined)?.as_bytes())?;
    }
    Ok(Verdict::Passed)
}
