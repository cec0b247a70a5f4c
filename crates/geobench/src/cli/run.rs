//! `geobench run`.

use std::path::Path;
use std::time::SystemTime;

use anyhow::bail;

use super::Verdict;
use super::args::RunOptions;
use super::progress::Progress;
use super::terminal::{self, Terminal};
use crate::expected::Expected;
use crate::export::{self, Format};
use crate::in_process::InProcess;
use crate::output::OutputFile;
use crate::plan::{Plan, Reference};
use crate::record::{Cell, ModelRecord, ResultFile, SCHEMA, Status};
use crate::registry::{self, SelectError, Selection};
use crate::runner::{self, Listener, Step};
use crate::{host, model, suite};

pub(super) fn run(options: &RunOptions, terminal: Terminal) -> anyhow::Result<Verdict> {
    let plan = plan(options)?;
    let outputs = outputs(options)?;
    if !host::is_release_build() && !options.quiet {
        terminal::warning(
            "this is not a release build: its times mean little (cargo run --release)",
        );
    }
    let now = now();
    let mut listener = Reporter {
        progress: Progress::new(plan.runs(), !options.quiet && !options.no_progress),
        format: options.format,
        styled: terminal.styled,
        outputs,
        result: ResultFile {
            schema: SCHEMA.to_owned(),
            tool: host::tool(),
            host: host::host(),
            command: std::env::args_os()
                .map(|word| word.to_string_lossy().into_owned())
                .collect(),
            started: now.clone(),
            finished: now,
            models: Vec::new(),
            cells: Vec::new(),
        },
    };
    let outcome = runner::run(&plan, &mut InProcess, &mut listener)?;
    let Reporter {
        progress, result, ..
    } = listener;
    drop(progress);
    if options.format == Format::Table {
        terminal::print(&export::footnote(&result, terminal.styled))?;
    } else {
        terminal::print(&options.format.render(&result)?)?;
    }
    Ok(verdict(&plan, &outcome.cells))
}

/// What the cells make of the run: a wrong answer weighs more than an unusable input.
fn verdict(plan: &Plan, cells: &[Cell]) -> Verdict {
    let wanted = !matches!(plan.reference, Reference::None);
    let failed = |cell: &&Cell| match cell.status {
        Status::Ok => wanted && cell.check.reference.is_none(),
        Status::Refused => false,
        _ => true,
    };
    let count = cells.iter().filter(failed).count();
    if count > 0 {
        terminal::error(&format!(
            "{count} of {} cells failed or could not be checked",
            cells.len()
        ));
        Verdict::Failed
    } else if cells.iter().any(|cell| cell.status == Status::Refused) {
        Verdict::BadInput
    } else {
        Verdict::Passed
    }
}

/// The models that are named, or the built-in suite.
pub(super) fn models(arguments: &[String]) -> anyhow::Result<Vec<model::ModelRef>> {
    Ok(if arguments.is_empty() {
        model::collect(suite::MODELS)?
    } else {
        model::collect(arguments)?
    })
}

fn plan(options: &RunOptions) -> anyhow::Result<Plan> {
    let models = models(&options.models)?;
    let algorithms = options.algo.0.clone();
    let reference = reference(options.check.as_deref(), &algorithms)?;
    if let Reference::Files(Expected::File(path)) = &reference
        && (models.len() > 1 || options.source.count() > 1)
    {
        bail!(
            "{}: one file holds the distances from one source in one model, but more are asked for; use --check file",
            path.display()
        );
    }
    Ok(Plan {
        models,
        algorithms,
        sources: options.source.clone(),
        repeat: options.repeat as usize,
        warmup: options.warmup as usize,
        reference,
        tolerance: options.tolerance,
    })
}

/// What `--check` asks for; by default `mmp` if it runs, else the first algorithm.
fn reference(check: Option<&str>, algorithms: &[Selection]) -> anyhow::Result<Reference> {
    let Some(check) = check else {
        let usual = algorithms.iter().find(|a| a.label() == "mmp");
        return Ok(match usual.or(algorithms.first()) {
            Some(selection) => Reference::Algorithm(selection.clone()),
            None => Reference::None,
        });
    };
    if check.eq_ignore_ascii_case("none") {
        return Ok(Reference::None);
    }
    if check.eq_ignore_ascii_case("file") {
        return Ok(Reference::Files(Expected::BesideModels));
    }
    let path = Path::new(check);
    if path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("csv"))
    {
        if let Err(error) = std::fs::File::open(path) {
            bail!("--check {check}: {error}");
        }
        return Ok(Reference::Files(Expected::File(path.to_owned())));
    }
    match registry::select_one(check) {
        Ok(one) => Ok(Reference::Algorithm(one)),
        Err(error @ SelectError::Several { .. }) => bail!("--check: {error}"),
        Err(error) => bail!("--check: {error}; also `none`, `file` or a .csv file"),
    }
}

fn outputs(options: &RunOptions) -> anyhow::Result<Vec<(Format, OutputFile)>> {
    let mut outputs: Vec<(Format, OutputFile)> = Vec::new();
    for path in &options.output {
        let format = Format::of_path(path)?;
        let file = OutputFile::prepare(path)?;
        if outputs.iter().any(|(_, other)| other.path() == file.path()) {
            bail!("{}: given twice as output", path.display());
        }
        outputs.push((format, file));
    }
    Ok(outputs)
}

fn now() -> String {
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string()
}

/// Shows and stores what is done, model by model, so that an interrupted run loses little.
struct Reporter {
    progress: Progress,
    format: Format,
    styled: bool,
    outputs: Vec<(Format, OutputFile)>,
    result: ResultFile,
}

impl Listener for Reporter {
    fn loading(&mut self, model: &str) {
        self.progress.loading(model);
    }

    fn step(&mut self, step: &Step<'_>) {
        self.progress.step(step);
    }

    fn skipped(&mut self, runs: usize) {
        self.progress.skip(runs);
    }

    fn model_done(&mut self, model: &ModelRecord, cells: &[Cell]) -> anyhow::Result<()> {
        self.result.models.push(model.clone());
        self.result.cells.extend_from_slice(cells);
        self.result.finished = now();
        self.progress.suspend(|| {
            report_failures(cells, self.format);
            if self.format == Format::Table {
                terminal::print(&export::model_table(model, cells, self.styled))?;
            }
            anyhow::Ok(())
        })?;
        for (format, file) in &self.outputs {
            file.write(format.render(&self.result)?.as_bytes())?;
        }
        Ok(())
    }
}

/// Says on standard error why a model was refused, and what a reader of anything but tables does
/// not see at once.
fn report_failures(cells: &[Cell], format: Format) {
    let mut last_refusal = None;
    for cell in cells {
        let Some(message) = &cell.message else {
            continue;
        };
        match cell.status {
            Status::Refused if last_refusal != Some(message) => {
                terminal::error(message);
                last_refusal = Some(message);
            }
            Status::Refused => {}
            status if format != Format::Table => {
                let source = cell.source.unwrap_or(0);
                terminal::error(&format!(
                    "{}: {}, source {source}: {}: {message}",
                    cell.model,
                    cell.algorithm,
                    status.name()
                ));
            }
            _ => {}
        }
    }
}
