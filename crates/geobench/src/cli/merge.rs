//! `geobench merge`.

use super::args::MergeOptions;
use super::run::{Tally, verdict};
use super::{Verdict, terminal};
use crate::history::join;
use crate::run::merge as parts;
use crate::schema::{ResultFile, result_file};

pub(super) fn merge(options: &MergeOptions) -> anyhow::Result<Verdict> {
    let outputs = options.csv_rows.outputs(&options.output)?;
    let files = options
        .parts
        .iter()
        .map(|path| Ok((path.display().to_string(), result_file::read(path)?)))
        .collect::<anyhow::Result<Vec<_>>>()?;
    // The parts of one run, or different runs.
    let is_part = |(_, file): &(String, ResultFile)| {
        file.plan.as_ref().is_some_and(|plan| plan.shard.is_some())
    };
    let whole = if files.iter().any(is_part) {
        parts::merge(files)?
    } else {
        let joined = join::join(files)?;
        for note in &joined.notes {
            terminal::warning(note);
        }
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
    Ok(verdict(&tallies))
}
