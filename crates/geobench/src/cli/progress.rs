//! What a run shows while it runs: on standard error, and only if that is a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::runner::{Purpose, Step};

/// A progress bar that moves between runs. It has no clock of its own, so nothing is drawn while
/// a run is being timed.
#[derive(Debug)]
pub(super) struct Progress {
    bar: ProgressBar,
    /// Runs that have started or will not happen.
    started: u64,
}

impl Progress {
    /// A bar over `runs` runs, or none unless `shown`.
    pub(super) fn new(runs: usize, shown: bool) -> Self {
        let target = if shown {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(runs as u64), target);
        if let Ok(style) = ProgressStyle::with_template("[{bar:30}] {pos}/{len} {wide_msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        Self { bar, started: 0 }
    }

    /// Shows that a model is being loaded.
    pub(super) fn loading(&self, model: &str) {
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
        self.bar
            .set_message(format!("{}: {purpose} {algorithm}", step.model));
        self.bar.set_position(self.started);
        // The bar limits how often it draws, but this may be what stands there for minutes.
        self.bar.force_draw();
        self.started += 1;
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

    /// Does `work`, which writes to the terminal, with the bar out of the way.
    pub(super) fn suspend<T>(&self, work: impl FnOnce() -> T) -> T {
        self.bar.suspend(work)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
