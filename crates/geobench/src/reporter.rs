//! What `geobench run` shows while it runs.

use geobench_harness::exec::goal::GoalSpec;
use geobench_harness::exec::limits::{DecompressionLimit, Limits};
use geobench_harness::exec::{InstructionCounter, Listener, Step, instructions, interrupt};
use geobench_harness::plan::Plan;
use geobench_harness::run::agreement;
use geobench_harness::schema::{Cell, GroupRecord, ModelRecord, ResultFile, SourceLabel, Status};
use geobench_report::table::{self, Look, ResultFormat};

use crate::progress::Progress;
use crate::result_store::ResultStore;
use crate::terminal;

/// Shows progress, and prints and stores the results of each finished model.
pub(crate) struct Reporter {
    pub(crate) progress: Progress,
    pub(crate) format: ResultFormat,
    pub(crate) look: Look,
    /// Whether to count instructions.
    pub(crate) instructions: bool,
    /// The goal of the runs of the current group.
    pub(crate) goal: GoalSpec,
    /// The limit of decompression of the current group.
    pub(crate) decompressed: DecompressionLimit,
    /// Whether to suppress the warnings about successful cells and about the earlier file.
    pub(crate) quiet: bool,
    pub(crate) store: ResultStore,
}

impl Reporter {
    /// Starts the group of `plan`: adds its record and prints its heading.
    pub(crate) fn begin(&mut self, plan: &Plan) -> anyhow::Result<()> {
        let Limits {
            timeout,
            memory,
            decompressed,
        } = plan.limits;
        self.decompressed = decompressed;
        self.goal.clone_from(&plan.goal);
        self.store.result.groups.push(GroupRecord {
            timeout: timeout.0.map(|time| time.as_secs_f64()),
            memory_limit: memory.0,
            ..plan.group.clone()
        });
        // A shard may have no cells of a group.
        if plan.runs() == 0 {
            return Ok(());
        }
        let look = self.look;
        self.show(&table::group_heading(&plan.group, look))
    }

    /// Ends a group: prints its table of ratios.
    pub(crate) fn end(&mut self, group: &GroupRecord) -> anyhow::Result<()> {
        let look = self.look;
        self.show(&table::ratio_table(group, &self.store.result, look))?;
        self.show(&table::matrix_table(group, &self.store.result, look))
    }

    /// Prints text of a table above the progress, if the format of standard output is a table.
    fn show(&mut self, text: &str) -> anyhow::Result<()> {
        if self.format == ResultFormat::Table && !text.is_empty() {
            self.progress.suspend(|| terminal::print_rendered(text))?;
        }
        Ok(())
    }

    /// Writes the final results to all files, and returns them.
    ///
    /// # Errors
    ///
    /// As [`ResultStore::write_all`].
    pub(crate) fn write_all(&mut self) -> anyhow::Result<ResultFile> {
        let joined = self.store.write_all()?;
        if !self.quiet {
            self.progress.suspend(|| terminal::warnings(&joined.notes));
        }
        Ok(joined.file)
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

    fn instruction_counter(
        &mut self,
        model: &ModelRecord,
        cell: &Cell,
    ) -> Option<InstructionCounter> {
        // Valgrind cannot separate the solve of an external program from the rest of its work.
        if !self.instructions || cell.algorithm.starts_with("ext:") {
            return None;
        }
        self.progress
            .counting_instructions(&model.name, &cell.algorithm);
        let (goal, decompressed) = (self.goal.clone(), self.decompressed);
        Some(Box::new(move |model, cell| {
            instructions::count(model, cell, &goal, decompressed, interrupt::requested)
        }))
    }

    fn not_counted(&mut self, cell: &Cell, error: &anyhow::Error) {
        let source = cell.source.as_ref().map(SourceLabel::to_string);
        let text = format!(
            "{}: {}, source {}: instructions are not counted: {error:#}",
            cell.model,
            cell.algorithm,
            source.unwrap_or_default()
        );
        self.progress.suspend(|| terminal::warning(&text));
    }

    fn more(&mut self, runs: usize) {
        self.progress.more(runs);
    }

    fn skipped(&mut self, runs: usize) {
        self.progress.skip(runs);
    }

    fn model_done(&mut self, model: &ModelRecord, cells: &[Cell]) -> anyhow::Result<()> {
        let new = self.store.result.add_model(model);
        if !self.quiet {
            self.progress
                .suspend(|| terminal::notes_on(&model.name, &new));
        }
        // Whatever happens to standard output, the files have the cells.
        for error in self.store.add(model, cells)? {
            let text = format!("{error:#}; it will be tried again");
            self.progress.suspend(|| terminal::warning(&text));
        }
        self.progress.ended(&model.name, cells);
        self.progress.suspend(|| {
            remark(cells, self.format, self.quiet);
            for summary in agreement::summaries(cells) {
                terminal::error(&summary);
            }
            if let (ResultFormat::Table, Some(group)) =
                (self.format, self.store.result.groups.last())
            {
                let look = self.look;
                let mut text = table::model_table(group, model, cells, look);
                // The last column stays free, because some terminals wrap a line that fills it.
                let width = look.width.map(|width| width.saturating_sub(1));
                text += &width.map_or_else(String::new, |width| {
                    table::model_bars(group, model, cells, width)
                });
                terminal::print_rendered(&text)?;
            }
            Ok(())
        })
    }

    fn interrupted(&self) -> bool {
        interrupt::requested()
    }
}

/// Prints the messages of cells to standard error: each refusal once, failures, and, unless
/// `quiet`, messages of successful cells. For tables only refusals and where positions were found
/// are printed.
fn remark(cells: &[Cell], format: ResultFormat, quiet: bool) {
    let mut refusals = Vec::new();
    let mut last_place = None;
    let is_position = |cell: &Cell| match &cell.source {
        Some(SourceLabel::Other(text)) => text.contains("at:") || text.contains("far:"),
        _ => false,
    };
    for cell in cells {
        let Some(message) = &cell.message else {
            continue;
        };
        match cell.status {
            Status::Refused if !refusals.contains(&message) => {
                terminal::error(message);
                refusals.push(message);
            }
            Status::Refused => {}
            Status::Ok if format == ResultFormat::Table && !quiet && is_position(cell) => {
                let place = Some((&cell.model, message));
                if last_place != place {
                    terminal::notes_on(&cell.model, std::slice::from_ref(message));
                    last_place = place;
                }
            }
            // Tables have these messages in their notes.
            _ if format == ResultFormat::Table => {}
            status => {
                let source = cell.source.clone().unwrap_or(SourceLabel::Vertex(0));
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
