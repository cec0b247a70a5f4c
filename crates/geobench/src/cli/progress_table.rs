//! The progress table of the current model, and drawing it in place.

use std::io::Write;

use unicode_width::UnicodeWidthChar;

use crate::exec::{Pass, Step};
use crate::measure::statistics::median;
use crate::plan::{Plan, Reference};
use crate::registry::Selection;
use crate::schema::Status;
use crate::table::{Bar, bar_lines};

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
