//! What a run shows while it runs: on standard error, and only if that is a terminal.

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::board::Board;
use super::terminal;
use crate::plan::Plan;
use crate::record::Status;
use crate::runner::{Purpose, Step};

/// Lines of the terminal that are left to what was printed before.
const LINES_LEFT: usize = 4;

/// A live table of the model that is being worked on, and a bar over all runs below it. They have no clock of
/// their own and change between runs, so that nothing is drawn while a run is being timed.
#[derive(Debug)]
pub(super) struct Progress {
    all: MultiProgress,
    bar: ProgressBar,
    board: Board,
    lines: Vec<ProgressBar>,
    shown: bool,
    /// Runs that have started or will not happen.
    started: u64,
}

impl Progress {
    /// Shows `runs` runs, or nothing unless `shown`.
    pub(super) fn new(runs: usize, shown: bool) -> Self {
        let target = if shown {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let all = MultiProgress::with_draw_target(target);
        let bar = all.add(ProgressBar::new(runs as u64));
        if let Ok(style) = ProgressStyle::with_template("[{bar:30}] {pos}/{len} {wide_msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        Self {
            all,
            bar,
            board: Board::default(),
            lines: Vec::new(),
            shown,
            started: 0,
        }
    }

    /// The runs of a plan follow.
    pub(super) fn begin(&mut self, plan: &Plan) {
        self.clear_table();
        self.board = Board::new(plan);
    }

    /// Shows that a model is being loaded.
    pub(super) fn loading(&mut self, model: &str) {
        self.clear_table();
        self.bar.set_message(format!("loading {model}"));
        self.bar.force_draw();
    }

    /// Shows the run that is about to start.
    pub(super) fn step(&mut self, step: &Step<'_>) {
        let purpose = match step.purpose {
            Purpose::WarmUp => "warming up",
            Purpose::Time => "timing",
            Purpose::Count => "counting",
            Purpose::Clock => "clocking phases of",
        };
        let algorithm = step.algorithm.label();
        self.bar.set_message(format!(
            "{}, source {}: {purpose} {algorithm}",
            step.model, step.source
        ));
        self.bar.set_position(self.started);
        self.board.starts(step);
        self.draw_table();
        // The bar limits how often it draws, but this may be what stands there for minutes.
        self.bar.force_draw();
        self.started += 1;
    }

    /// Shows what came of a run.
    pub(super) fn ran(&mut self, step: &Step<'_>, outcome: Result<Option<f64>, Status>) {
        self.board.ran(step, outcome);
    }

    /// Shows that the instructions of an algorithm are being counted.
    pub(super) fn counting_instructions(&self, model: &str, algorithm: &str) {
        self.bar
            .set_message(format!("{model}: counting instructions of {algorithm}"));
        self.bar.force_draw();
    }

    /// Moves over runs that do not happen.
    pub(super) fn skip(&mut self, runs: usize) {
        self.started = self.started.saturating_add(runs as u64);
    }

    /// Does `work`, which writes to the terminal, with everything out of the way.
    pub(super) fn suspend<T>(&self, work: impl FnOnce() -> T) -> T {
        self.all.suspend(work)
    }

    /// Takes the table away: what is known for good is printed instead.
    pub(super) fn clear_table(&mut self) {
        for line in self.lines.drain(..) {
            line.finish_and_clear();
            self.all.remove(&line);
        }
    }

    /// Draws the table, if the terminal is high enough for it.
    fn draw_table(&mut self) {
        let size = terminal::size_of_standard_error().filter(|_| self.shown);
        let fits = |[_, height]: &[usize; 2]| self.board.len() + LINES_LEFT <= *height;
        let Some([width, _]) = size.filter(fits) else {
            self.clear_table();
            return;
        };
        while self.lines.len() < self.board.len() {
            let line = self.all.insert_before(&self.bar, ProgressBar::no_length());
            if let Ok(style) = ProgressStyle::with_template("{msg}") {
                line.set_style(style);
            }
            self.lines.push(line);
        }
        // The last column stays free: some terminals would begin a new line.
        let texts = self.board.lines(width.saturating_sub(1));
        for (line, text) in self.lines.iter().zip(texts) {
            line.set_message(text);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.clear_table();
        self.bar.finish_and_clear();
    }
}
