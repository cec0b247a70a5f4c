//! `geobench site`.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use geobench_report::history::trend;
use geobench_report::page::trend_page;
use geobench_report::site::{SiteRecords, StaticSite};

use super::corpus::CorpusOption;
use super::trend::{LineOptions, ordered};
use crate::args::QuietOption;
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
pub(crate) struct SiteOptions {
    /// Result files and files of certificates (.json), or directories of some
    #[arg(value_name = "RESULT", required = true)]
    results: Vec<PathBuf>,

    /// Directory to write the pages to
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,

    /// Directory of a history, for a page of trends
    #[arg(long, value_name = "DIR")]
    history: Option<PathBuf>,

    #[command(flatten)]
    line: LineOptions,

    #[command(flatten)]
    models: CorpusOption,

    #[command(flatten)]
    quiet: QuietOption,
}

pub(crate) fn site(options: &SiteOptions) -> anyhow::Result<Verdict> {
    if options.output.exists() && !options.output.is_dir() {
        bail!("{}: not a directory", options.output.display());
    }
    let records = SiteRecords::read(&options.results)?;
    let corpus = options.models.read()?;
    let trend = options.history.as_deref().map(|history| {
        let history = ordered(history, &options.line)?;
        let series = trend::series(&history.records);
        let found = trend::change_points(&series);
        anyhow::Ok(trend_page(&history, &series, &found))
    });
    let site = StaticSite::build(&records, &corpus, trend.transpose()?)?;
    let pages = site.write(&records, &options.output)?;
    if !options.quiet.is_set {
        terminal::notes(&records.notes);
        terminal::print(&format!("{pages} pages in {}\n", options.output.display()))?;
    }
    Ok(Verdict::Passed)
}
