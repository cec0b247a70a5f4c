//! `geobench report`.

use std::path::Path;

use anyhow::bail;
use geobench_export::output::OutputFile;
use geobench_harness::schema::result_file;
use geobench_report::history::join;
use geobench_report::page::{self as report, Input, JoinedFrom, Options, PictureChoice};

use super::Verdict;
use super::args::ReportOptions;
use super::terminal;

pub(super) fn report(options: &ReportOptions) -> anyhow::Result<Verdict> {
    let files = options.files()?;
    let page = options
        .output
        .as_deref()
        .map(OutputFile::page)
        .transpose()?;
    let mut inputs = Vec::new();
    for path in &options.results {
        let result = result_file::read(path)?;
        if result.cells.is_empty() {
            bail!(
                "{}: it has no cells, so there is nothing to report",
                path.display()
            );
        }
        inputs.push(Input::new(path.clone(), result));
    }
    // Several files become one table if their models and goals agree.
    if let [first, _, ..] = &inputs[..] {
        let name = |input: &Input| input.path.display().to_string();
        let files = inputs.iter().map(|i| (name(i), i.result.clone())).collect();
        match join::beside(files) {
            Ok(joined) => {
                if !options.quiet {
                    terminal::warnings(&joined.notes);
                }
                inputs = vec![Input {
                    path: first.path.clone(),
                    result: joined.file,
                    joined: Some(JoinedFrom {
                        files: options.results.clone(),
                        differences: joined.notes,
                    }),
                }];
            }
            Err(error) if !options.quiet => terminal::warning(&format!(
                "the files are shown one after the other: {error:#}"
            )),
            Err(_) => {}
        }
    }
    let wanted = Options {
        ratio_to: options.ratio_to.clone(),
        picture: options.picture.clone().unwrap_or(PictureChoice::Any),
        decompressed: options.decompression.limit(),
        tables: options.papers.clone().unwrap_or_default(),
    };
    let report = report::build(&inputs, &wanted)?;
    let mut written = Vec::new();
    if let (Some(page), Some(path)) = (page, &options.output) {
        page.write(report::page(&report).as_bytes())?;
        written.push(path.display().to_string());
    }
    for (form, directory) in files {
        let paths = report::write_files(&report, form, directory)?;
        written.push(match paths.len() {
            1 => paths[0].display().to_string(),
            n => format!("{n} files in {}", directory.display()),
        });
    }
    if !options.quiet && options.output.as_deref() != Some(Path::new("-")) {
        terminal::print(&format!("{}\n", written.join("\n")))?;
    }
    Ok(Verdict::Passed)
}
