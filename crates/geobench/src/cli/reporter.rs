//! Shows and stores results while a benchmark runs, model by model.

use std::io::Write;
use std::time::SystemTime;

use anyhow::bail;

use super::progress::Progress;
use super::terminal::{self, Terminal};
use crate::exec::interrupt;
use crate::exec::limits::Limits;
use crate::exec::{Listener, Step};
use crate::measure::instructions;
use crate::plan::Plan;
use crate::run::agreement;
use crate::schema::{Cell, GroupRecord, InstructionCount, ModelRecord, ResultFile, Status};
use crate::table::output::OutputFile;
use crate::table::{self, Format};

/// Shows and stores the results of each finished model, so that an interrupted run loses little.
pub(super) struct Reporter {
    pub(super) progress: Progress,
    pub(super) format: Format,
    pub(super) terminal: Terminal,
    /// Whether to count instructions.
    pub(super) instructions: bool,
    /// Whether to print failures only.
    pub(super) quiet: bool,
    pub(super) outputs: Vec<(Format, OutputFile)>,
    pub(super) result: ResultFile,
}

impl Reporter {
    /// A group begins.
    pub(super) fn begin(&mut self, plan: &Plan) -> anyhow::Result<()> {
        let Limits {
            timeout, memory, ..
        } = plan.limits;
        self.result.groups.push(GroupRecord {
            timeout: timeout.0.map(|time| time.as_secs_f64()),
            memory_limit: memory.0,
            ..plan.group.clone()
        });
        self.progress.begin(plan);
        // A shard may have no cell of a group.
        if plan.runs() == 0 {
            return Ok(());
        }
        self.show(&table::group_heading(&plan.group))
    }

    /// A group is done.
    pub(super) fn end(&mut self, group: &GroupRecord) -> anyhow::Result<()> {
        self.show(&table::ratio_table(
            group,
            &self.result.cells,
            self.terminal.look(),
        ))
    }

    /// Prints a part of the tables, if the format is a table.
    fn show(&mut self, text: &str) -> anyhow::Result<()> {
        if self.format == Format::Table && !text.is_empty() {
            self.progress.suspend(|| terminal::print_rendered(text))?;
        }
        Ok(())
    }

    /// Writes the results so far to all regular files. A failed write is retried at the end and
    /// does not stop the run.
    fn store(&mut self) -> anyhow::Result<()> {
        self.note_time();
        for (format, file) in self.outputs.iter().filter(|(_, file)| file.is_replaced()) {
            if let Err(error) = file.write(format.render(&self.result)?.as_bytes()) {
                let text = format!("{error:#}; it will be tried again");
                self.progress.suspend(|| terminal::warning(&text));
            }
        }
        Ok(())
    }

    /// Writes the final results to all files, and to a temporary file if one cannot be written.
    pub(super) fn store_all(&mut self) -> anyhow::Result<()> {
        self.note_time();
        let mut failed = Vec::new();
        for (format, file) in &self.outputs {
            if let Err(error) = file.write(format.render(&self.result)?.as_bytes()) {
                failed.push(format!("{error:#}"));
            }
        }
        if failed.is_empty() {
            return Ok(());
        }
        let rescued = rescue(&Format::Json.render(&self.result)?);
        bail!("{}; {rescued}", failed.join("; "));
    }

    fn note_time(&mut self) {
        self.result.finished = now();
        if let Some(session) = self.result.sessions.last_mut() {
            session.finished = Some(self.result.finished.clone());
        }
    }
}

impl Listener for Reporter {
    fn loading(&mut self, model: &str) {
        self.progress.loading(model);
    }

    fn step(&mut self, step: &Step<'_>) {
        self.progress.step(step);
    }

    fn ran(&mut self, step: &Step<'_>, outcome: Result<Option<f64>, Status>) {
        self.progress.ran(step, outcome);
    }

    fn count_instructions(&mut self, model: &ModelRecord, cell: &Cell) -> Option<InstructionCount> {
        // The solve of an outside program cannot be told from the rest of it.
        if cell.algorithm.starts_with("ext:") {
            return None;
        }
        if !self.instructions {
            return None;
        }
        self.progress
            .counting_instructions(&model.name, &cell.algorithm);
        let source = cell.source?;
        match instructions::count(&model.path, &cell.algorithm, source) {
            Ok(count) => Some(count),
            Err(error) => {
                let text = format!(
                    "{}: {}, source {source}: instructions are not counted: {error}",
                    model.name, cell.algorithm
                );
                self.progress.suspend(|| terminal::warning(&text));
                None
            }
        }
    }

    fn skipped(&mut self, runs: usize) {
        self.progress.skip(runs);
    }

    fn model_done(&mut self, model: &ModelRecord, cells: &[Cell]) -> anyhow::Result<()> {
        if self.result.models.iter().all(|m| m.name != model.name) {
            self.result.models.push(model.clone());
        }
        self.result.cells.extend_from_slice(cells);
        self.progress.clear_table();
        self.progress.suspend(|| {
            remark(cells, self.format, self.quiet);
            for summary in agreement::summaries(cells) {
                terminal::error(&summary);
            }
            if let (Format::Table, Some(group)) = (self.format, self.result.groups.last()) {
                let look = self.terminal.look();
                let mut text = table::model_table(group, model, cells, look);
                // The last column stays free, as in the progress table.
                let width = look.width.map(|width| width.saturating_sub(1));
                text +=
                    &width.map_or_else(String::new, |width| table::model_bars(group, cells, width));
                terminal::print_rendered(&text)?;
            }
            anyhow::Ok(())
        })?;
        self.store()
    }

    fn interrupted(&self) -> bool {
        interrupt::requested()
    }
}

/// Prints to standard error why a model was refused and, for formats other than tables, which cells
/// failed and, unless `quiet`, the messages of the others.
fn remark(cells: &[Cell], format: Format, quiet: bool) {
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
            // Tables show it in their notes.
            _ if format == Format::Table => {}
            status => {
                let source = cell.source.unwrap_or(0);
                let place = format!("{}: {}, source {source}", cell.model, cell.algorithm);
                match status {
                    Status::Ok if quiet => {}
                    Status::Ok => terminal::warning(&format!("{place}: {message}")),
                    _ => terminal::error(&format!("{place}: {}: {message}", status.name())),
                }
            }
        }
    }
}

/// Saves results that could not be written to a temporary file, and returns a message with its
/// path.
fn rescue(json: &str) -> String {
    let save = || -> std::io::Result<std::path::PathBuf> {
        let mut file = tempfile::Builder::new()
            .prefix("geobench-")
            .suffix(".json")
            .tempfile()?;
        file.write_all(json.as_bytes())?;
        Ok(file.keep()?.1)
    };
    match save() {
        Ok(path) => format!("the results are in {}", path.display()),
        Err(error) => format!("nor could the results be saved as a temporary file: {error}"),
    }
}

/// The current time, RFC 3339 in UTC.
pub(super) fn now() -> String {
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string()
}
