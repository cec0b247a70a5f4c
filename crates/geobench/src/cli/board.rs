//! What is known of the algorithms on the model that is being worked on.

use crate::exec::{Purpose, Step};
use crate::measure::statistics::median;
use crate::plan::{Plan, Reference};
use crate::registry::Selection;
use crate::schema::Status;
use crate::table::{Bar, bar_lines};

/// The algorithms of a plan, with what their runs on one model from one source have shown so far.
#[derive(Debug, Default)]
pub(super) struct Board {
    rows: Vec<Row>,
    /// Timed runs of each.
    repeat: usize,
    /// Label of the algorithm to which ratios are shown.
    base: Option<String>,
    /// The model and the source that the rows are of.
    place: Option<(String, u32)>,
}

#[derive(Debug, Default)]
struct Row {
    label: String,
    samples: Vec<f64>,
    failure: Option<Status>,
    current: bool,
}

impl Board {
    /// A board for a plan whose ratios are to `ratios_to`, or to `vtp`, its reference or its first algorithm.
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

    /// How many lines it has.
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
            Ok(Some(seconds)) if step.purpose == Purpose::Time => row.samples.push(seconds),
            Ok(_) => {}
            Err(status) => row.failure = Some(status),
        }
    }

    /// Forgets what was shown of another model or source.
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

#[cfg(test)]
mod tests {
    use geobench_mesh::VertexId;

    use super::*;
    use crate::run::mock::plan;

    #[test]
    fn a_board_follows_the_runs_of_one_model_and_source() {
        let plan = plan(&["horse"], "mmp,ich,vtp", "0,1");
        let mut board = Board::new(&plan);
        let step = |place: usize, source: u32, purpose| Step {
            model: "horse",
            algorithm: &plan.algorithms[place],
            source: VertexId::new(source),
            purpose,
        };
        board.ran(&step(0, 0, Purpose::WarmUp), Ok(Some(9.0)));
        board.ran(&step(0, 0, Purpose::Time), Ok(Some(3.0)));
        board.ran(&step(2, 0, Purpose::Time), Ok(Some(1.0)));
        board.ran(&step(1, 0, Purpose::Time), Err(Status::OutOfMemory));
        board.starts(&step(2, 0, Purpose::Time));
        insta::assert_snapshot!(board.lines(60).join("\n"), @"
          mmp  1/5         3.00 s  3.00  ██████████████████████████
          ich  0/5  out of memory
        > vtp  1/5         1.00 s  1.00  ████████▋
        ");
        board.starts(&step(0, 1, Purpose::Time));
        insta::assert_snapshot!(board.lines(60).join("\n"), @"
        > mmp  0/5
          ich  0/5
          vtp  0/5
        ");
    }
}
