//! `geobench compare`.

use anyhow::bail;

use super::args::CompareOptions;
use super::terminal::{self, Terminal};
use super::{Verdict, history};
use crate::history::compare::{self as comparing, Several};
use crate::schema::{ResultFile, result_file};
use crate::table::output;
use crate::table::{ComparisonFormat, Look};

pub(super) fn compare(options: &CompareOptions, terminal: Terminal) -> anyhow::Result<Verdict> {
    if let Some(range) = &options.against {
        return history::against(options, range, terminal);
    }
    let outputs = output::prepare(&options.output, ComparisonFormat::of_path)?;
    let mut paths = options.files.clone();
    if let Some(baseline) = &options.baseline {
        // Named among the files or beside them.
        paths.retain(|path| path != baseline);
        paths.insert(0, baseline.clone());
    }
    if paths.len() < 2 {
        bail!("{}: give two or more files to compare", paths[0].display());
    }
    let files = paths
        .iter()
        .map(|path| Ok((path.display().to_string(), result_file::read(path)?)))
        .collect::<anyhow::Result<Vec<(String, ResultFile)>>>()?;
    let (name, first) = &files[0];
    let render: Box<dyn Fn(ComparisonFormat, Look) -> anyhow::Result<String>>;
    let is_worse;
    if let [(new_name, new)] = &files[1..] {
        let comparison = comparing::compare((name, first), (new_name, new), &options.fail_on)?;
        is_worse = comparison.is_worse();
        render = Box::new(move |format, look| format.render(&comparison, look));
    } else {
        let several = Several::new((name, first), &files[1..], &options.fail_on)?;
        is_worse = several.is_worse();
        render = Box::new(move |format, look| format.render_several(&several, look));
    }
    for (format, file) in &outputs {
        file.write(render(*format, Look::default())?.as_bytes())?;
    }
    if outputs.iter().all(|(_, file)| !file.is_standard_output()) {
        terminal::print_rendered(&render(options.format, terminal.look())?)?;
    }
    Ok(if is_worse {
        Verdict::Failed
    } else {
        Verdict::Passed
    })
}
