//! What a run shows while it runs: on standard error, and only if that is a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::runner::{Purpose, Step};

/// A progress bar that moves between runs. It has no clock of its own, so nothing is drawn while
/// a run is being timed.
#[derive(Debug)]
pub(super) struct Progress(ProgressBar);

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
        Self(bar)
    }

    /// Shows that a model is being loaded.
    pub(super) fn loading(&self, model: &str) {
        self.0.set_message(format!("loading {model}"));
        self.0.tick();
    }

    /// Shows the run that is about to start.
    pub(super) fn step(&self, step: &Step<'_>) {
        let purpose = match step.purpose {
            Purpose::WarmUp => "warming up",
            Purpose::Time => "timing",
            Purpose::Count => "counting",
            Purpose::Clock => "clocking phases",
        };
        self.0.set_message(format!(
            "{}: {purpose} {}",
            step.model,
            step.algorithm.label()
        ));
        self.0.inc(1);
        // The bar limits how often it draws; the last thing before a run must be drawn.
        self.0.tick();
    }

    /// Moves over runs that do not happen.
    pub(super) fn skip(&self, runs: usize) {
        self.0.inc(runs as u64);
    }

    /// Does `work`, which writes to the terminal, with the bar out of the way.
    pub(super) fn suspend<T>(&self, work: impl FnOnce() -> T) -> T {
        self.0.suspend(work)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
