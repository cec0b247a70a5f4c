//! Progress of a run, on standard error if that is a terminal.

use std::io::{self, Stderr};

use super::progress_table::{ProgressTable, RedrawnLines, cut};
use super::terminal;
use crate::exec::{Pass, Step};
use crate::plan::Plan;
use crate::schema::Status;

/// Lines of the terminal kept for earlier output.
const LINES_LEFT: usize = 4;

/// Width of the bar in characters.
const BAR: usize = 30;

/// A table of the current model, and a bar over all runs below it. They change between runs only,
/// so that nothing is drawn while a run is timed.
#[derive(Debug)]
pub(super) struct Progress {
    /// The terminal; `None` if progress is off.
    live: Option<RedrawnLines<Stderr>>,
    view: View,
}

/// The displayed state.
#[derive(Debug, Default)]
struct View {
    progress_table: ProgressTable,
    /// Whether the table is shown.
    table: bool,
    /// The current activity.
    message: String,
    /// Runs started or skipped, as displayed.
    position: usize,
    /// Runs started or skipped.
    started: usize,
    /// All runs.
    runs: usize,
}

impl Progress {
    /// Shows `runs` runs, or nothing unless `shown`.
    pub(super) fn new(runs: usize, shown: bool) -> Self {
        Self {
            live: (shown && terminal::standard_error_can_move())
                .then(|| RedrawnLines::new(io::stderr())),
            view: View {
                runs,
                ..View::default()
            },
        }
    }

    /// Starts a plan.
    pub(super) fn begin(&mut self, plan: &Plan) {
        self.clear_table();
        self.view.progress_table = ProgressTable::new(plan);
    }

    /// Shows that a model is being loaded.
    pub(super) fn loading(&mut self, model: &str) {
        self.view.table = false;
        self.view.message = format!("loading {model}");
        self.draw();
    }

    /// Shows the run that is about to start.
    pub(super) fn step(&mut self, step: &Step<'_>) {
        self.view.step(step);
        self.draw();
        self.view.started += 1;
    }

    /// Shows the result of a run.
    pub(super) fn ran(&mut self, step: &Step<'_>, outcome: Result<Option<f64>, Status>) {
        self.view.progress_table.ran(step, outcome);
    }

    /// Shows that the instructions of an algorithm are being counted.
    pub(super) fn counting_instructions(&mut self, model: &str, algorithm: &str) {
        self.view.message = format!("{model}: counting instructions of {algorithm}");
        self.draw();
    }

    /// Skips runs.
    pub(super) fn skip(&mut self, runs: usize) {
        self.view.started = self.view.started.saturating_add(runs);
    }

    /// Clears the display while `work` writes to the terminal.
    pub(super) fn suspend<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let Some(live) = &mut self.live else {
            return work();
        };
        live.clear();
        let done = work();
        self.draw();
        done
    }

    /// Removes the table; the final table is printed instead.
    pub(super) fn clear_table(&mut self) {
        self.view.table = false;
        self.draw();
    }

    fn draw(&mut self) {
        if let (Some(live), Some(size)) = (&mut self.live, terminal::size_of_standard_error()) {
            live.draw(&self.view.lines(size));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(live) = &mut self.live {
            live.clear();
        }
    }
}

impl View {
    fn step(&mut self, step: &Step<'_>) {
        let pass = match step.pass {
            Pass::Warmup => "warming up",
            Pass::Time => "timing",
            Pass::Count => "counting",
            Pass::Profile => "clocking phases of",
        };
        let algorithm = step.algorithm.label();
        self.message = format!("{}, source {}: {pass} {algorithm}", step.model, step.source);
        self.position = self.started;
        self.progress_table.starts(step);
        self.table = true;
    }

    /// The lines for a terminal of this size: the bar, and above it the table if there is room.
    fn lines(&self, [columns, lines]: [usize; 2]) -> Vec<String> {
        // The last column stays free, because some terminals break the line there.
        let columns = columns.saturating_sub(1);
        let table = self.table && self.progress_table.len() + LINES_LEFT <= lines;
        let mut texts = if table {
            self.progress_table.lines(columns)
        } else {
            Vec::new()
        };
        if !self.message.is_empty() {
            texts.push(self.bar());
        }
        texts.iter().map(|text| cut(text, columns)).collect()
    }

    fn bar(&self) -> String {
        let Self { position, runs, .. } = *self;
        let full = match BAR.saturating_mul(position).checked_div(runs) {
            Some(full) => full.min(BAR),
            None => BAR,
        };
        let tip = if (1..BAR).contains(&full) { ">" } else { "" };
        let done = "=".repeat(full - tip.len()) + tip;
        format!("[{done:BAR$}] {position}/{runs} {}", self.message)
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::VertexId;

    use super::*;
    use crate::run::mock::plan;

    fn view() -> View {
        let plan = plan(&["horse"], "mmp,vtp", "0");
        let mut view = View {
            progress_table: ProgressTable::new(&plan),
            runs: 40,
            started: 13,
            ..View::default()
        };
        let step = |place: usize, pass| Step {
            model: "horse",
            algorithm: &plan.algorithms[place],
            source: VertexId::new(0),
            pass,
        };
        view.progress_table.ran(&step(0, Pass::Time), Ok(Some(2.0)));
        view.step(&step(1, Pass::Time));
        view
    }

    #[test]
    fn the_table_stands_above_the_bar() {
        insta::assert_snapshot!(view().lines([80, 24]).join("\n"), @"
          mmp  1/5  2.00 s    ████████████████████████████████████████████████████████
        > vtp  0/5
        [========>                     ] 13/40 horse, source 0: timing vtp
        ");
    }

    #[test]
    fn a_low_terminal_has_the_bar_alone_and_a_narrow_one_less_of_it() {
        insta::assert_snapshot!(view().lines([50, 5]).join("\n"), @"[========>                     ] 13/40 horse, sou");
    }

    #[test]
    fn the_bar_begins_empty_and_ends_full() {
        let bar = |position, runs| {
            let view = View {
                position,
                runs,
                message: "horse".to_owned(),
                ..View::default()
            };
            view.bar()
        };
        let bars = [bar(0, 9), bar(1, 60), bar(59, 60), bar(60, 60), bar(0, 0)];
        insta::assert_snapshot!(bars.join("\n"), @"
        [                              ] 0/9 horse
        [                              ] 1/60 horse
        [============================> ] 59/60 horse
        [==============================] 60/60 horse
        [==============================] 0/0 horse
        ");
    }

    #[test]
    fn nothing_is_shown_before_there_is_something_to_say() {
        assert_eq!(View::default().lines([80, 24]), [""; 0]);
    }
}
