//! `geobench merge`.

use super::args::MergeOptions;
use super::run::{Tally, verdict};
use super::{Verdict, terminal};
use crate::run::merge as parts;
use crate::schema::result_file;
use crate::table::output;

pub(super) fn merge(options: &MergeOptions) -> anyhow::Result<Verdict> {
    let outputs = output::results(&options.output)?;
    let files = options
        .parts
        .iter()
        .map(|path| Ok((path.display().to_string(), result_file::read(path)?)))
        .collect::<anyhow::Result<_>>()?;
    let whole = parts::merge(files)?;
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
    let tallies: Vec<Tally> = groups
        .map(|group| {
            let cells = whole.cells.iter().filter(|cell| cell.group == group.name);
            Tally::of(group.reference != "none", cells)
        })
        .collect();
    Ok(verdict(&tallies))
}
