//! Progress of a run, on standard error if that is a terminal.

use std::io::{self, Stderr, Write};

use unicode_width::UnicodeWidthChar;

use super::terminal;
use crate::exec::{Pass, Step};
use crate::measure::statistics::median;
use crate::plan::{Plan, Reference};
use crate::registry::Selection;
use crate::schema::Status;
use crate::table::{Bar, bar_lines};

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

/// The algorithms of a plan and their runs so far on one model from one source.
#[derive(Debug, Default)]
pub(super) struct ProgressTable {
    rows: Vec<Row>,
    /// Timed runs of each algorithm.
    repeat: usize,
    /// Label of the algorithm to which ratios are shown.
    base: Option<String>,
    /// The model and source of the rows.
    place: Option<(String, u32)>,
}

#[derive(Debug, Default)]
struct Row {
    label: String,
    samples: Vec<f64>,
    failure: Option<Status>,
    current: bool,
}

impl ProgressTable {
    /// A table for a plan. The base of ratios is `ratios_to`, else `vtp`, the reference or the
    /// first algorithm.
    pub(super) fn new(plan: &Plan) -> Self {
        let labels: Vec<&str> = plan.algorithms.iter().map(Selection::label).collect();
        let reference = match &plan.reference {
            Reference::Algorithm(reference) => Some(reference.label()),
            Reference::None | Reference::Files(_) => None,
        };
        let wished = [plan.group.ratios_to.as_deref(), Some("vtp"), reference];
        let base = wished
            .into_iter()
            .flatten()
            .find(|name| labels.contains(name));
        Self {
            base: base.or(labels.first().copied()).map(str::to_owned),
            rows: labels
                .into_iter()
                .map(|label| Row {
                    label: label.to_owned(),
                    ..Row::default()
                })
                .collect(),
            repeat: plan.repeat,
            place: None,
        }
    }

    /// Number of lines.
    pub(super) const fn len(&self) -> usize {
        self.rows.len()
    }

    /// A run starts.
    pub(super) fn starts(&mut self, step: &Step<'_>) {
        self.turn_to(step);
        for row in &mut self.rows {
            row.current = row.label == step.algorithm.label();
        }
    }

    /// A run has ended.
    pub(super) fn ran(&mut self, step: &Step<'_>, outcome: Result<Option<f64>, Status>) {
        self.turn_to(step);
        let label = step.algorithm.label();
        let Some(row) = self.rows.iter_mut().find(|row| row.label == label) else {
            return;
        };
        row.current = false;
        match outcome {
            Ok(Some(seconds)) if step.pass == Pass::Time => row.samples.push(seconds),
            Ok(_) => {}
            Err(status) => row.failure = Some(status),
        }
    }

    /// Clears the rows of another model or source.
    fn turn_to(&mut self, step: &Step<'_>) {
        let place = (step.model, step.source.raw());
        if self
            .place
            .as_ref()
            .map(|(model, source)| (model.as_str(), *source))
            != Some(place)
        {
            self.place = Some((step.model.to_owned(), step.source.raw()));
            for row in &mut self.rows {
                row.samples.clear();
                row.failure = None;
            }
        }
    }

    /// A line for each algorithm, no wider than `width`.
    pub(super) fn lines(&self, width: usize) -> Vec<String> {
        let bars: Vec<Bar> = self
            .rows
            .iter()
            .map(|row| Bar {
                label: row.label.clone(),
                note: format!("{}/{}", row.samples.len(), self.repeat),
                seconds: median(&row.samples),
                failure: row.failure.map(Status::in_words),
                current: row.current,
            })
            .collect();
        bar_lines(&bars, self.base.as_deref(), width)
    }
}

/// Lines below the printed output that are redrawn in place on the terminal `out`.
///
/// Write errors are ignored; progress output is best-effort.
#[derive(Debug)]
pub(super) struct RedrawnLines<W> {
    out: W,
    /// Lines drawn. The cursor is at the end of the last one.
    drawn: usize,
}

impl<W: Write> RedrawnLines<W> {
    pub(super) const fn new(out: W) -> Self {
        Self { out, drawn: 0 }
    }

    /// Replaces the drawn lines. A line must be narrower than the terminal, else it breaks and its
    /// first half stays: see [`cut`].
    pub(super) fn draw(&mut self, lines: &[String]) {
        let text = format!("{}{}", self.way_back(), lines.join("\r\n"));
        self.drawn = lines.len();
        self.write(&text);
    }

    /// Removes the lines. The next output starts where they started.
    pub(super) fn clear(&mut self) {
        if self.drawn > 0 {
            self.draw(&[]);
        }
    }

    /// Moves the cursor to the start of the first line and clears the screen below.
    fn way_back(&self) -> String {
        match self.drawn {
            0 => String::new(),
            1 => "\r\x1b[J".to_owned(),
            drawn => format!("\r\x1b[{}A\x1b[J", drawn - 1),
        }
    }

    /// Writes `text` in one call.
    fn write(&mut self, text: &str) {
        let _ = self.out.write_all(text.as_bytes());
        let _ = self.out.flush();
    }
}

/// The start of `text` that fits on `columns`, with control characters replaced.
pub(super) fn cut(text: &str, columns: usize) -> String {
    let mut used = 0;
    text.chars()
        .map(|letter| {
            if letter.is_control() {
                '\u{fffd}'
            } else {
                letter
            }
        })
        .take_while(|letter| {
            used += letter.width().unwrap_or(0);
            used <= columns
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::num::NonZero;

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

    #[test]
    fn a_progress_table_follows_the_runs_of_one_model_and_source() {
        let plan = plan(&["horse"], "mmp,ich,vtp", "0,1");
        let mut progress_table = ProgressTable::new(&plan);
        let step = |place: usize, source: u32, pass| Step {
            model: "horse",
            algorithm: &plan.algorithms[place],
            source: VertexId::new(source),
            pass,
        };
        progress_table.ran(&step(0, 0, Pass::Warmup), Ok(Some(9.0)));
        progress_table.ran(&step(0, 0, Pass::Time), Ok(Some(3.0)));
        progress_table.ran(&step(2, 0, Pass::Time), Ok(Some(1.0)));
        progress_table.ran(&step(1, 0, Pass::Time), Err(Status::OutOfMemory));
        progress_table.starts(&step(2, 0, Pass::Time));
        insta::assert_snapshot!(progress_table.lines(60).join("\n"), @"
          mmp  1/5         3.00 s  3.00  ██████████████████████████
          ich  0/5  out of memory
        > vtp  1/5         1.00 s  1.00  ████████▋
        ");
        progress_table.starts(&step(0, 1, Pass::Time));
        insta::assert_snapshot!(progress_table.lines(60).join("\n"), @"
        > mmp  0/5
          ich  0/5
          vtp  0/5
        ");
    }

    /// What a terminal of 20 columns and 5 lines shows after `acts`.
    fn shown(acts: impl FnOnce(&mut RedrawnLines<&mut Vec<u8>>)) -> String {
        let mut bytes = Vec::new();
        acts(&mut RedrawnLines::new(&mut bytes));
        let size = |count| NonZero::new(count).unwrap();
        let mut terminal = vt100::Parser::new(size(5), size(20), 0);
        terminal.process(&bytes);
        terminal.screen().contents()
    }

    fn lines(text: &str) -> Vec<String> {
        text.lines().map(str::to_owned).collect()
    }

    #[test]
    fn lines_are_drawn_over_those_that_stand_there() {
        let text = shown(|live| {
            live.draw(&lines("first line\nsecond"));
            live.draw(&lines("one\ntwo\nthree"));
        });
        assert_eq!(text, "one\ntwo\nthree");
    }

    #[test]
    fn fewer_lines_leave_nothing_of_the_others() {
        let text = shown(|live| {
            live.draw(&lines("one\ntwo\nthree"));
            live.draw(&lines("1"));
        });
        assert_eq!(text, "1");
    }

    #[test]
    fn what_is_printed_meanwhile_stays_above() {
        let text = shown(|live| {
            for i in 0..2 {
                live.draw(&lines("table\nbar"));
                live.clear();
                live.write(&format!("printed {i}\r\n"));
            }
            live.draw(&lines("table\nbar"));
        });
        assert_eq!(text, "printed 0\nprinted 1\ntable\nbar");
    }

    #[test]
    fn lines_at_the_bottom_of_a_terminal_scroll_it_once() {
        let text = shown(|live| {
            live.write("a\r\nb\r\nc\r\nd\r\n");
            for _ in 0..5 {
                live.draw(&lines("table\nbar"));
            }
        });
        assert_eq!(text, "b\nc\nd\ntable\nbar");
    }

    #[test]
    fn nothing_is_cleared_where_nothing_stands() {
        let text = shown(|live| {
            live.write("printed");
            live.clear();
        });
        assert_eq!(text, "printed");
    }

    #[test]
    fn a_line_is_cut_by_columns_and_cannot_steer_the_terminal() {
        assert_eq!(cut("abc", 2), "ab");
        assert_eq!(cut("牛牛牛", 5), "牛牛");
        assert_eq!(cut("a\x1b[2Jb\n", 9), "a\u{fffd}[2Jb\u{fffd}");
    }
}
