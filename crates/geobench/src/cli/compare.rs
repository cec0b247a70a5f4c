//! `geobench compare`.

use super::Verdict;
use super::args::CompareOptions;
use super::terminal::{self, Terminal};
use crate::history::compare as comparing;
use crate::schema::result_file;
use crate::table::output;
use crate::table::{ComparisonFormat, Look};

pub(super) fn compare(options: &CompareOptions, terminal: Terminal) -> anyhow::Result<Verdict> {
    let outputs = output::prepare(&options.output, ComparisonFormat::of_path)?;
    let old = result_file::read(&options.old)?;
    let new = result_file::read(&options.new)?;
    let names = [&options.old, &options.new].map(|path| path.display().to_string());
    let comparison = comparing::compare((&names[0], &old), (&names[1], &new), &options.fail_on)?;
    for (format, file) in &outputs {
        file.write(format.render(&comparison, Look::default())?.as_bytes())?;
    }
    if outputs.iter().all(|(_, file)| !file.is_standard_output()) {
        terminal::print_rendered(&options.format.render(&comparison, terminal.look())?)?;
    }
    Ok(if comparison.is_worse() {
        Verdict::Failed
    } else {
        Verdict::Passed
    })
}
