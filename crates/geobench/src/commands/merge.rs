//! `geobench merge`.

use std::path::PathBuf;

use clap::Args;
use geobench_export::output::check_files;
use geobench_harness::run::merge as parts;
use geobench_harness::schema::{ResultFile, result_file};
use geobench_report::history::join;

use crate::args::CsvOptions;
use crate::terminal;
use crate::verdict::{self, Tally, Verdict};

#[derive(Args, Debug)]
#[command(
    after_help = "The exit status is that of the whole run: 1 if a cell failed, 2 if a model was refused."
)]
pub(crate) struct MergeOptions {
    /// Result files (.json) of all parts, in any order, or of different runs, of which the first
    /// has the cells that several have
    #[arg(value_name = "PART", required = true)]
    pub(crate) parts: Vec<PathBuf>,

    /// Result file, by its ending: .json, .csv, .md, .tex, .bmf.json (Bencher) or
    /// .gab.json (github-action-benchmark); may be repeated
    #[arg(short, long, value_name = "FILE", required = true)]
    pub(crate) output: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) csv_rows: CsvOptions,
}

pub(crate) fn merge(options: &MergeOptions) -> anyhow::Result<Verdict> {
    let outputs = options.csv_rows.outputs(&options.output)?;
    check_files(outputs.iter().map(|(_, file)| file), &options.parts)?;
    let files = result_file::read_all(&options.parts)?;
    // Files of shards are merged as one benchmark; other files are joined as different runs.
    let is_part = |(_, file): &(String, ResultFile)| {
        file.plan.as_ref().is_some_and(|plan| plan.shard.is_some())
    };
    let whole = if files.iter().any(is_part) {
        parts::merge(files)?
    } else {
        let joined = join::join(files)?;
        terminal::warnings(&joined.notes);
        joined.file
    };
    if !parts::is_of_one_machine(&whole) {
        terminal::warning(
            "the parts ran on different machines: times of different parts do not compare \
             (`sessions` has the machines, `shard` the part of each cell)",
        );
    }
    for (format, file) in &outputs {
        file.write(format.render(&whole)?.as_bytes())?;
    }
    let groups = whole.plan.iter().flat_map(|plan| &plan.groups);
    let mut tallies: Vec<Tally> = groups
        .map(|group| {
            let cells = whole.cells.iter().filter(|cell| cell.group == group.name);
            Tally::of(group.reference != "none", cells)
        })
        .collect();
    if whole.plan.is_none() {
        tallies.push(Tally::of(false, &whole.cells));
    }
    Ok(verdict::of_cells(&tallies))
}
