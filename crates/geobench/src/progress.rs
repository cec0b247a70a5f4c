//! Progress of a benchmark and of commands that take long, on standard error if that is a terminal.

use std::collections::HashMap;
use std::fmt::Write;
use std::time::{Duration, Instant};

use geobench_export::escape::printable;
use geobench_harness::exec::{Pass, Step};
use geobench_harness::measure::number::counted;
use geobench_harness::schema::{Cell, Status};
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::terminal;

/// A row for the current model and source, and below it a bar over all runs. Drawing happens only
/// in calls, which come between runs, so it does not disturb timed runs. There is no drawing
/// thread, and child processes do not draw.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    /// Number of runs started or skipped.
    started: usize,
    /// Model and source of the current row.
    place: String,
    /// Labels and last results of the algorithms on this model and source.
    results: Vec<(String, String)>,
    /// Whether lines are written when a model begins and ends, where there is no bar.
    has_lines: bool,
    /// The models that have begun and not ended, with their times.
    begun: HashMap<String, Instant>,
}

impl Progress {
    /// Progress over `runs` runs. Nothing is shown unless `shown`. If standard error is no terminal
    /// that can redraw lines, as in the log of a job, it gets a line when a model begins and ends.
    pub(crate) fn new(runs: usize, shown: bool) -> Self {
        let mut progress = Self::on(target(shown), runs, ProgressState::eta);
        progress.has_lines = shown && progress.bar.is_hidden();
        progress
    }

    fn on(target: ProgressDrawTarget, runs: usize, eta: Eta) -> Self {
        Self {
            bar: bar(target, runs, eta),
            started: 0,
            place: String::new(),
            results: Vec::new(),
            has_lines: false,
            begun: HashMap::new(),
        }
    }

    /// Shows that a model is being loaded.
    pub(crate) fn loading(&mut self, model: &str) {
        self.draw(&format!("loading {model}"));
        if self.has_lines {
            terminal::notes_on(model, &["begins".to_owned()]);
            self.begun.insert(model.to_owned(), Instant::now());
        }
    }

    /// Says that a model has ended with these cells.
    pub(crate) fn ended(&mut self, model: &str, cells: &[Cell]) {
        let Some(begun) = self.begun.remove(model) else {
            return;
        };
        let failed = cells
            .iter()
            .filter(|cell| cell.status != Status::Ok)
            .count();
        let failed = match failed {
            0 => String::new(),
            failed => format!(", {failed} of them failed"),
        };
        let line = format!(
            "ends after {:.1} s: {}{failed}",
            begun.elapsed().as_secs_f64(),
            counted(cells.len(), "cell")
        );
        terminal::notes_on(model, &[line]);
    }

    /// Shows the run that is about to start.
    pub(crate) fn step(&mut self, step: &Step<'_>) {
        self.turn_to(step);
        let pass = match step.pass {
            Pass::Warmup => "warming up",
            Pass::Time => "timing",
            Pass::Count => "counting",
            Pass::Profile => "profiling",
        };
        let mut row = format!("{}: {pass} {}", self.place, step.algorithm.label());
        for (label, result) in &self.results {
            row.extend(["  ", label, " ", result]);
        }
        self.bar.set_position(self.started as u64);
        self.draw(&row);
        self.started += 1;
    }

    /// Stores the result of a run, which the next drawn row shows.
    pub(crate) fn ran(&mut self, step: &Step<'_>, outcome: Result<Option<f64>, Status>) {
        self.turn_to(step);
        let result = match outcome {
            Ok(Some(seconds)) if step.pass == Pass::Time => {
                format!(
                    "{:.2?}",
                    Duration::try_from_secs_f64(seconds).unwrap_or_default()
                )
            }
            Ok(_) => return,
            Err(status) => status.in_words(),
        };
        let label = step.algorithm.label();
        self.results.retain(|(known, _)| known != label);
        self.results.push((label.to_owned(), result));
    }

    /// Shows that the instructions of an algorithm are being counted.
    pub(crate) fn counting_instructions(&mut self, model: &str, algorithm: &str) {
        self.draw(&format!("{model}: counting instructions of {algorithm}"));
    }

    /// Counts `runs` runs that are not executed.
    pub(crate) fn skip(&mut self, runs: usize) {
        self.started = self.started.saturating_add(runs);
        // Skipped runs take no time, so the estimate of the remaining time starts anew.
        self.bar.update(|state| state.set_pos(self.started as u64));
        self.bar.reset_eta();
    }

    /// Adds runs to the total that were not planned.
    pub(crate) fn more(&mut self, runs: usize) {
        self.bar.inc_length(runs as u64);
    }

    /// Clears row and bar while `work` writes to the terminal.
    pub(crate) fn suspend<T>(&mut self, work: impl FnOnce() -> T) -> T {
        self.bar.suspend(work)
    }

    /// Starts a new row if the step has another model or source.
    fn turn_to(&mut self, step: &Step<'_>) {
        let place = format!("{}, source {}", step.model, step.source.label());
        if self.place != place {
            self.place = place;
            self.results.clear();
        }
    }

    fn draw(&self, row: &str) {
        let bar = self.bar.clone().with_message(printable(row).into_owned());
        // indicatif limits its other drawing calls to about 20 per second, which could drop this
        // row.
        bar.force_draw();
    }
}

/// Where a bar is drawn: nowhere unless `shown` and on a terminal.
fn target(shown: bool) -> ProgressDrawTarget {
    if shown && terminal::standard_error_can_move() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    }
}

/// The estimate of the remaining time of a bar.
type Eta = fn(&ProgressState) -> Duration;

/// A bar over `length` steps, below a row with its message.
fn bar(target: ProgressDrawTarget, length: usize, eta: Eta) -> ProgressBar {
    let style = "{wide_msg}\n{elapsed_precise} [{wide_bar}] {pos}/{len}{left}";
    let style = ProgressStyle::with_template(style);
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    // indicatif reports 0 while the remaining time is unknown; nothing is shown then.
    let left = move |state: &ProgressState, out: &mut dyn Write| {
        let left = eta(state);
        if left.as_secs() > 0 {
            let _ = write!(out, ", {:#} left", HumanDuration(left));
        }
    };
    let bar = ProgressBar::with_draw_target(Some(length as u64), target);
    bar.set_style(style.progress_chars("=> ").with_key("left", left));
    bar
}

/// A bar over the tasks of a command that times nothing. A thread draws it, so that the elapsed
/// time goes on during a long task.
#[derive(Debug)]
pub(crate) struct TaskBar(ProgressBar);

impl TaskBar {
    /// A bar over `tasks` tasks, below `row`. Nothing is shown unless `shown` and on a terminal.
    pub(crate) fn new(row: &str, tasks: usize, shown: bool) -> Self {
        let bar = Self::on(target(shown), row, tasks, ProgressState::eta);
        bar.0.enable_steady_tick(Duration::from_millis(200));
        bar
    }

    fn on(target: ProgressDrawTarget, row: &str, tasks: usize, eta: Eta) -> Self {
        let bar = bar(target, tasks, eta);
        bar.set_message(printable(row).into_owned());
        Self(bar)
    }

    /// Counts a task that is done.
    pub(crate) fn done(&self) {
        self.0.inc(1);
    }

    /// Clears row and bar while `work` writes to the terminal.
    pub(crate) fn suspend<T>(&self, work: impl FnOnce() -> T) -> T {
        self.0.suspend(work)
    }
}

impl Drop for TaskBar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::VertexId;
    use indicatif::{InMemoryTerm, TermLike};

    use super::*;
    use geobench_harness::exec::source::SourceSpec;
    use geobench_harness::plan::Plan;
    use geobench_harness::run::mock::plan;

    /// An estimate would depend on the turns of this thread.
    const NO_ETA: Eta = |_| Duration::ZERO;

    /// Progress over 40 runs on an in-memory terminal with this number of columns.
    fn progress(columns: u16) -> (InMemoryTerm, Progress) {
        let terminal = InMemoryTerm::new(8, columns);
        let target = ProgressDrawTarget::term_like(Box::new(terminal.clone()));
        (terminal, Progress::on(target, 40, NO_ETA))
    }

    /// The contents of the terminal, with the elapsed time replaced by zero.
    fn shown(terminal: &InMemoryTerm) -> String {
        let contents = terminal.contents();
        let lines = contents.lines().map(|line| match line.strip_prefix("00:") {
            Some(rest) => format!("00:00:00{}", &rest["00:00".len()..]),
            None => line.to_owned(),
        });
        lines.collect::<Vec<_>>().join("\n")
    }

    fn source(vertex: u32) -> SourceSpec {
        VertexId::new(vertex).into()
    }

    fn step<'a>(plan: &'a Plan, place: usize, source: &'a SourceSpec, pass: Pass) -> Step<'a> {
        Step {
            model: "horse",
            algorithm: &plan.algorithms[place],
            source,
            goal: &plan.goal,
            pass,
            solves: 1,
        }
    }

    #[test]
    fn the_row_stands_above_the_bar_and_follows_the_runs_of_one_model_and_source() {
        let plan = plan(&["horse"], "mmp,ich,vtp", "0,1");
        let (terminal, mut progress) = progress(72);
        progress.skip(12);
        progress.ran(&step(&plan, 0, &source(0), Pass::Warmup), Ok(Some(9.0)));
        progress.ran(&step(&plan, 0, &source(0), Pass::Time), Ok(Some(3.0)));
        progress.ran(
            &step(&plan, 1, &source(0), Pass::Time),
            Err(Status::OutOfMemory),
        );
        progress.step(&step(&plan, 2, &source(0), Pass::Time));
        insta::assert_snapshot!(shown(&terminal), @r"
        horse, source 0: timing vtp  mmp 3.00s  ich out of memory
        00:00:00 [================>                                      ] 12/40
        ");
        progress.step(&step(&plan, 0, &source(1), Pass::Warmup));
        let shown = shown(&terminal);
        assert!(
            shown.starts_with("horse, source 1: warming up mmp\n"),
            "{shown}"
        );
    }

    #[test]
    fn a_narrow_terminal_has_two_lines_too() {
        let plan = plan(&["horse"], "mmp", "0");
        let (terminal, mut progress) = progress(50);
        progress.ran(&step(&plan, 0, &source(0), Pass::Time), Ok(Some(3.0)));
        progress.step(&step(&plan, 0, &source(0), Pass::Profile));
        insta::assert_snapshot!(shown(&terminal), @r"
        horse, source 0: profiling mmp  mmp 3.00s
        00:00:00 [                                  ] 0/40
        ");
    }

    #[test]
    fn nothing_is_shown_before_there_is_something_to_say() {
        let (terminal, _progress) = progress(80);
        assert_eq!(terminal.contents(), "");
    }

    #[test]
    fn printed_lines_stay_above_the_bar_which_is_cleared() {
        let (terminal, mut progress) = progress(80);
        for i in 0..2 {
            progress.loading("horse");
            let printed = || terminal.write_line(&format!("printed {i}"));
            progress.suspend(printed).unwrap();
        }
        let shown = shown(&terminal);
        assert!(
            shown.starts_with("printed 0\nprinted 1\nloading horse\n00:00:00 ["),
            "{shown}"
        );
        drop(progress);
        assert_eq!(terminal.contents(), "printed 0\nprinted 1");
    }

    #[test]
    fn tasks_of_other_commands_are_counted() {
        let terminal = InMemoryTerm::new(8, 60);
        let target = ProgressDrawTarget::term_like(Box::new(terminal.clone()));
        let bar = TaskBar::on(target, "horse: distances by vtp-fast", 3, NO_ETA);
        bar.done();
        bar.0.force_draw();
        insta::assert_snapshot!(shown(&terminal), @r"
        horse: distances by vtp-fast
        00:00:00 [===============>                             ] 1/3
        ");
        bar.suspend(|| terminal.write_line("printed")).unwrap();
        drop(bar);
        assert_eq!(terminal.contents(), "printed");
    }

    #[test]
    fn names_cannot_steer_the_terminal() {
        let (terminal, mut progress) = progress(80);
        progress.loading("a\x1b[2Jb\n");
        let shown = terminal.contents();
        assert!(shown.starts_with("loading a\\x1b[2Jb\n"), "{shown}");
    }

    #[test]
    fn nothing_is_drawn_between_calls() {
        let (terminal, mut progress) = progress(80);
        progress.loading("horse");
        terminal.moves_since_last_check();
        std::thread::sleep(Duration::from_millis(300));
        assert_eq!(terminal.moves_since_last_check(), "");
    }
}
