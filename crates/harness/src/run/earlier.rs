//! An earlier result file to which a benchmark adds cells (`--add-to`). Its runs are treated as if
//! they were in the journal.

use std::collections::HashMap;

use crate::exec::{Failure, Observation, Pass};
use crate::measure::memory::Peaks;
use crate::run::journal::{RunId, RunOutcome};
use crate::schema::{Cell, CellId, ModelRecord, ResultFile, Status};

/// Prefix of the message of a cell that could not be checked.
pub(super) const NOT_CHECKED: &str = "not checked: ";

/// Models and cells of an earlier result file.
#[derive(Clone, Debug, Default)]
pub struct Earlier {
    models: HashMap<String, ModelRecord>,
    cells: HashMap<CellId, Cell>,
}

impl Earlier {
    /// The models and cells of `file`.
    pub fn new(file: &ResultFile) -> Self {
        let models = file.models.iter().map(|m| (m.name.clone(), m.clone()));
        Self {
            models: models.collect(),
            cells: file.cells.iter().map(|c| (c.id(), c.clone())).collect(),
        }
    }

    /// The record of a model.
    pub(super) fn model(&self, name: &str) -> Option<&ModelRecord> {
        self.models.get(name)
    }

    /// The cell of this identity.
    pub(super) fn of_id(&self, id: &CellId) -> Option<&Cell> {
        self.cells.get(id)
    }

    /// The cell of a run, if the file has it with this number of threads.
    pub(super) fn cell(&self, run: &RunId, threads: usize) -> Option<&Cell> {
        self.cells.get(&(
            run.group.clone(),
            run.model.clone(),
            Some(run.source.clone()),
            run.algorithm.clone(),
            threads,
        ))
    }
}

/// The outcome of a run, reconstructed from the record of its `cell`. `None` if the cell lacks the
/// run.
pub(super) fn outcome(cell: &Cell, pass: Pass, round: usize) -> Option<RunOutcome> {
    let unchecked = cell
        .message
        .as_deref()
        .and_then(|message| message.strip_prefix(NOT_CHECKED))
        .map(str::to_owned);
    let of = |observation| RunOutcome {
        observation,
        check: cell.check.clone(),
        unchecked,
        failure: None,
        place: cell.time.places.get(round).copied(),
    };
    if cell.status != Status::Ok {
        // The record does not tell which run failed. The failure is attributed to the first
        // warm-up.
        return (pass == Pass::Warmup && round == 0).then(|| RunOutcome {
            check: cell.check.clone(),
            failure: Some(Failure::new(
                cell.status,
                cell.message.clone().unwrap_or_default(),
            )),
            ..RunOutcome::default()
        });
    }
    match pass {
        Pass::Warmup => (round == 0).then(|| {
            of(Observation {
                setup_seconds: cell.time.setup,
                seconds: cell.time.median,
                ..Observation::default()
            })
        }),
        Pass::Time => {
            let sample = *cell.time.samples.get(round)?;
            let seconds = cell.time.claimed.get(round).copied().unwrap_or(sample);
            let solves = cell.time.solves.get(round).copied();
            Some(of(Observation {
                seconds: Some(seconds),
                solves: solves.filter(|solves| *solves > 1),
                outside_seconds: cell.time.outside.get(round).copied(),
                ping_seconds: cell.time.ping.get(round).copied(),
                ..Observation::default()
            }))
        }
        Pass::Profile => Some(of(Observation {
            phases: Some(cell.phases),
            peaks: Peaks {
                heap: cell.memory.heap_peak_bytes,
                rss: cell.memory.rss_peak_bytes,
            },
            ..Observation::default()
        })),
        Pass::Count => Some(of(Observation {
            counters: Some(cell.counters.clone()),
            extraction_seconds: cell.time.extraction,
            wavefront: cell.wavefront.clone(),
            edge_excess: cell.check.edge_excess,
            ..Observation::default()
        })),
    }
}
