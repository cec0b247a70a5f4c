//! `geobench report`.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::{Args, ValueEnum};
use geobench_export::output::{OutputFile, check_files};
use geobench_harness::exec::model::ModelRef;
use geobench_harness::schema::result_file;
use geobench_mesh::generate::Spec;
use geobench_report::history::join;
use geobench_report::page::{
    self as report, Form, Input, JoinedFrom, Options, PictureChoice, Tables,
};

use crate::args::QuietOption;
use crate::terminal;
use crate::verdict::Verdict;
use geobench_harness::plan::suite::options::DecompressionOption;

#[derive(Args, Debug)]
pub(crate) struct ReportOptions {
    /// Result files (.json)
    #[arg(value_name = "RESULT", required = true)]
    results: Vec<PathBuf>,

    /// Page to write: one self-contained HTML file
    #[arg(short, long, value_name = "FILE", required_unless_present = "format")]
    output: Option<PathBuf>,

    /// Files to write into a directory: html (the page), svg (every plot), csv (every table and the
    /// numbers behind every plot) or tex (every table for LaTeX, every plot as a drawing that LaTeX
    /// includes); may be repeated
    #[arg(long, num_args = 2, value_names = ["FORMAT", "DIR"])]
    format: Vec<String>,

    /// Algorithm to which all are compared [default: that of the suite, else vtp, else the
    /// reference of the checks]
    #[arg(long, value_name = "ALGO")]
    ratio_to: Option<String>,

    /// Model of the result to draw coloured by distance from a vertex, or none [default: the first
    /// one that can be loaded again and is the same, from its first source]
    #[arg(long, value_name = "MODEL[:SOURCE]")]
    picture: Option<PictureChoice>,

    /// Tables of the papers to compare ratios with, such as 000-table-1, separated by commas, or
    /// none [default: that of the suite that the result was made with]
    #[arg(long, value_name = "LIST")]
    papers: Option<Tables>,

    #[command(flatten)]
    decompression: DecompressionOption,

    #[command(flatten)]
    quiet: QuietOption,
}

impl ReportOptions {
    /// The requested forms of report files, each with its directory.
    pub(crate) fn files(&self) -> anyhow::Result<Vec<(Form, &Path)>> {
        let pairs = self.format.chunks_exact(2);
        pairs
            .map(|pair| match Form::from_str(&pair[0], true) {
                Ok(form) => Ok((form, Path::new(&pair[1]))),
                Err(_) => anyhow::bail!("--format {}: use html, svg, csv or tex", pair[0]),
            })
            .collect()
    }
}

pub(crate) fn report(options: &ReportOptions) -> anyhow::Result<Verdict> {
    let files = options.files()?;
    let page = options
        .output
        .as_deref()
        .map(OutputFile::page)
        .transpose()?;
    check_files(&page, &options.results)?;
    let mut inputs = Vec::new();
    let mut read = options.results.clone();
    for path in &options.results {
        let result = result_file::read(path)?;
        if result.cells.is_empty() {
            bail!(
                "{}: it has no cells, so there is nothing to report",
                path.display()
            );
        }
        // Pictures are of models.
        let models = result.models.iter();
        read.extend(models.filter_map(|model| source_file(&model.path)));
        inputs.push(Input::new(path.clone(), result));
    }
    check_files(&page, &read)?;
    // Several files become one table if their models and goals agree.
    if let [first, _, ..] = &inputs[..] {
        let name = |input: &Input| input.path.display().to_string();
        let files = inputs.iter().map(|i| (name(i), i.result.clone())).collect();
        match join::beside(files) {
            Ok(joined) => {
                if !options.quiet.is_set {
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
            Err(error) if !options.quiet.is_set => terminal::warning(&format!(
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
        let paths = report::write_files(&report, form, directory, &read)?;
        written.push(match paths.len() {
            1 => paths[0].display().to_string(),
            n => format!("{n} files in {}", directory.display()),
        });
    }
    if !options.quiet.is_set && options.output.as_deref() != Some(Path::new("-")) {
        terminal::print(&format!("{}\n", written.join("\n")))?;
    }
    Ok(Verdict::Passed)
}

/// The file behind a model of a result.
fn source_file(model: &str) -> Option<PathBuf> {
    if Spec::is_spec(model) {
        let model = ModelRef::generated(model).ok()?;
        return model.source_file().map(Path::to_owned);
    }
    Some(model).filter(|path| *path != "-").map(PathBuf::from)
}
