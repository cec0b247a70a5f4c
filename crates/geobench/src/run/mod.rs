//! Carries out a [`Plan`], model by model. `unit` runs the cells of one model and source.

pub mod agreement;
pub mod check;
#[cfg(feature = "command-line")]
pub mod cluster;
mod earlier;
pub mod journal;
mod labels;
pub mod merge;
#[cfg(test)]
pub(crate) mod mock;
mod reference_check;
#[cfg(test)]
mod tests;
mod unit;

use anyhow::bail;

use crate::UsageError;
use crate::exec::source::SourceSpec;
use crate::exec::{Backend, Listener, Pass, Session};
use crate::plan::Plan;
use crate::run::journal::{Journal, JournalLine, RunId};
use crate::run::unit::{Past, Unit};
use crate::schema::{Cell, ModelRecord, Status};

pub use self::earlier::Earlier;

/// Records of the models and cells of a benchmark.
#[derive(Clone, Debug, Default)]
pub struct Records {
    /// One for each model of the plan, or fewer after an interruption.
    pub models: Vec<ModelRecord>,
    /// One for each cell of the plan, or fewer after an interruption.
    pub cells: Vec<Cell>,
}

impl Records {
    /// Whether some cell has this status.
    pub fn has(&self, status: Status) -> bool {
        self.cells.iter().any(|cell| cell.status == status)
    }
}

/// Carries out `plan`, model by model. Runs in `journal` and in `earlier` are not repeated, and a
/// model with all runs in them is not loaded. After an interruption the records cover the finished
/// runs.
///
/// # Errors
///
/// Errors of the journal and the listener, and a model that differs from that of the journal or of
/// the earlier file.
/// Failures of runs are in the records of their cells.
pub fn run(
    plan: &Plan,
    backend: &mut dyn Backend,
    mut journal: Option<&mut Journal>,
    earlier: Option<&Earlier>,
    listener: &mut dyn Listener,
) -> anyhow::Result<Records> {
    let mut records = Records::default();
    for place in 0..plan.models.len() {
        if plan.units_of_model(place) == 0 || listener.interrupted() {
            continue;
        }
        let mut benchmark = Benchmark {
            plan,
            place,
            journal: journal.as_deref_mut(),
            earlier,
            listener: &mut *listener,
        };
        let (model, mut cells) = benchmark.run(backend)?;
        for cell in &mut cells {
            cell.shard = plan.shard_range.map(|shard_range| shard_range.shard.index);
            benchmark.count_instructions(&model, cell)?;
        }
        if listener.interrupted() && cells.is_empty() {
            break;
        }
        listener.model_done(&model, &cells)?;
        records.models.push(model);
        records.cells.append(&mut cells);
    }
    Ok(records)
}

/// One model of a plan.
struct Benchmark<'b> {
    plan: &'b Plan,
    /// Index of the model in the plan.
    place: usize,
    journal: Option<&'b mut Journal>,
    earlier: Option<&'b Earlier>,
    listener: &'b mut dyn Listener,
}

impl Benchmark<'_> {
    fn run(&mut self, backend: &mut dyn Backend) -> anyhow::Result<(ModelRecord, Vec<Cell>)> {
        let model = &self.plan.models[self.place];
        if let Some((known, cells)) = self.known() {
            self.listener.skipped(self.plan.runs_of_model(self.place));
            return Ok((known, cells));
        }
        self.listener.loading(&model.name);
        match backend.open(model) {
            Ok(mut session) => self.run_loaded(&mut *session),
            // The interruption may have caused the refusal.
            Err(_) if self.listener.interrupted() => Ok((model.record(), Vec::new())),
            Err(refusal) => {
                let record = model.record();
                let cells = self.refused(&refusal.message);
                Ok((record, cells))
            }
        }
    }

    /// Adds the instructions of a cell, from the journal or counted now.
    fn count_instructions(&mut self, model: &ModelRecord, cell: &mut Cell) -> anyhow::Result<()> {
        let (Status::Ok, Some(source), None) =
            (cell.status, cell.source.clone(), cell.instructions)
        else {
            return Ok(());
        };
        let run = RunId {
            group: cell.group.clone(),
            model: cell.model.clone(),
            source,
            algorithm: cell.algorithm.clone(),
            pass: Pass::Count,
            round: 0,
        };
        let mut found = self
            .journal
            .as_deref()
            .and_then(|journal| journal.instructions(&run).cloned());
        if found.is_none() && !self.listener.interrupted() {
            found = self.listener.count_instructions(model, cell);
            if let (Some(found), Some(journal)) = (&found, &mut self.journal) {
                let found = found.clone();
                journal.keep(JournalLine::Instructions { id: run, found })?;
            }
        }
        if let Some(found) = found {
            cell.instructions = Some(found.count);
            cell.instructions_simd = found.simd;
        }
        Ok(())
    }

    /// The runs that are done.
    fn past(&self) -> Past<'_> {
        Past {
            journal: self.journal.as_deref(),
            earlier: self.earlier,
        }
    }

    /// All cells of the model, if the journal or the earlier file knows every run of them.
    fn known(&self) -> Option<(ModelRecord, Vec<Cell>)> {
        let model = &self.plan.models[self.place];
        let past = self.past();
        let (found, file_sha256) = past.model(&model.name)?;
        // A journal refuses changed files when it is opened.
        if file_sha256.is_some() && model.file_sha256() != file_sha256 && model.spec().is_none() {
            return None;
        }
        let model = found;
        let units: Vec<Unit<'_>> = self
            .sources(model)
            .ok()?
            .into_iter()
            .map(|source| Unit::new(self.plan, model, source, past))
            .collect();
        units.iter().all(Unit::is_complete).then(|| {
            let cells = units.into_iter().flat_map(Unit::cells).collect();
            (model.clone(), cells)
        })
    }

    fn run_loaded(
        &mut self,
        session: &mut dyn Session,
    ) -> anyhow::Result<(ModelRecord, Vec<Cell>)> {
        let found = session.model();
        let is_changed =
            |earlier: &&ModelRecord| earlier.sha256.is_some() && earlier.sha256 != found.sha256;
        let earlier = self.earlier.and_then(|earlier| earlier.model(&found.name));
        if let Some(earlier) = earlier.filter(is_changed) {
            bail!(
                "{}: the model is not the one that the earlier results are of: its SHA-256 is {}, \
                 and was {}",
                found.path,
                found.sha256.as_deref().unwrap_or("not known"),
                earlier.sha256.as_deref().unwrap_or("not known"),
            );
        }
        let model = match self.journal.as_deref().and_then(|j| j.model(&found.name)) {
            Some(known) if known.sha256 != found.sha256 => bail!(
                "{}: the model is not the one that the journal holds results of: its SHA-256 is {}, \
                 and was {}",
                found.path,
                found.sha256.as_deref().unwrap_or("not known"),
                known.sha256.as_deref().unwrap_or("not known"),
            ),
            Some(known) => known.clone(),
            None => {
                if let Some(journal) = &mut self.journal {
                    journal.keep(JournalLine::Model(found.clone()))?;
                }
                found.clone()
            }
        };
        let mut cells = Vec::new();
        match self.sources(&model) {
            Ok(sources) => {
                let units = sources.len() as u128;
                let more = units.saturating_sub(self.plan.units_of_model(self.place));
                let more = usize::try_from(more).unwrap_or(usize::MAX);
                self.listener
                    .more(more.saturating_mul(self.plan.runs_of_unit()));
                for source in sources {
                    let mut unit = Unit::new(self.plan, &model, source, self.past());
                    unit.run(session, self.journal.as_deref_mut(), self.listener)?;
                    cells.extend(unit.cells());
                }
            }
            Err(error) => cells = self.refused(&format!("{}: {error}", model.path)),
        }
        Ok((model, cells))
    }

    /// The sources of this shard.
    fn sources(&self, model: &ModelRecord) -> Result<Vec<SourceSpec>, UsageError> {
        let vertices = model.vertices.unwrap_or(0) as usize;
        let all = self.plan.units_in(vertices)?.into_iter().enumerate();
        let mine = |&(number, _): &(usize, SourceSpec)| self.plan.has_unit(self.place, number);
        Ok(all.filter(mine).map(|(_, source)| source).collect())
    }

    /// The cells of a model that cannot be used or lacks a source. Random sources are then unknown
    /// and have one cell together.
    fn refused(&mut self, message: &str) -> Vec<Cell> {
        let plan = self.plan;
        self.listener.skipped(plan.runs_of_model(self.place));
        let sources = if plan.sources_together {
            vec![Some(plan.sources.label())]
        } else {
            plan.sources.labels()
        };
        sources
            .iter()
            .enumerate()
            .filter(|&(number, _)| plan.has_unit(self.place, number))
            .flat_map(|(_, source)| plan.algorithms.iter().map(move |a| (source.clone(), a)))
            .map(|(source, algorithm)| Cell {
                group: plan.group.name.clone(),
                source,
                status: Status::Refused,
                message: Some(message.to_owned()),
                threads: algorithm.threads(),
                simd: algorithm.simd(),
                ..Cell::new(&plan.models[self.place].name, algorithm.label())
            })
            .collect()
    }
}
