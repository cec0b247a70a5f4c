//! `geobench trend`.

use std::path::PathBuf;

use clap::Args;
use geobench_export::json_lines;
use geobench_export::output::{OutputFile, check_files};
use geobench_harness::usage::files_in;
use geobench_report::history::{records, trend};
use geobench_report::page::trend_page;
use geobench_report::table::{self, Look};

use crate::args::ListFormat;
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
pub(crate) struct TrendOptions {
    /// Directory of the history
    #[arg(value_name = "DIR")]
    pub(crate) history: PathBuf,

    /// Page to write: one self-contained HTML file
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// How to show the change points
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t)]
    pub(crate) format: ListFormat,
}

pub(crate) fn trend(options: &TrendOptions, look: Look) -> anyhow::Result<Verdict> {
    let page = options
        .output
        .as_deref()
        .map(OutputFile::page)
        .transpose()?;
    check_files(&page, files_in(&options.history, "json")?)?;
    let records = records::read_all(&options.history)?;
    let series = trend::series(&records);
    let found = trend::change_points(&series);
    if let Some(page) = page {
        page.write(trend_page(&records, &series, &found).as_bytes())?;
        if page.is_standard_output() {
            return Ok(Verdict::Passed);
        }
    }
    terminal::print_rendered(&match options.format {
        ListFormat::Json => json_lines(&found)?,
        ListFormat::Table => table::change_points(&found, look),
    })?;
    Ok(Verdict::Passed)
}
