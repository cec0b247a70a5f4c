//! Executes a [`Plan`], model by model. A *cell* is one algorithm on one model from one source, or
//! from several together. A *unit* has the cells of one model and source; the module `unit`
//! executes it.

pub mod agreement;
pub mod answer_layout;
mod cell_runs;
pub mod check;
pub mod cluster;
mod context;
mod each;
mod earlier;
pub mod journal;
mod labels;
mod log;
pub mod merge;
#[cfg(any(test, feature = "mock"))]
pub mod mock;
mod order;
pub mod proof;
pub mod reference_check;
mod scale;
#[cfg(test)]
mod tests;
mod unit;

use std::collections::BTreeMap;
use std::sync::Mutex;

use anyhow::bail;
use geobench_registry::UsageError;
use rayon::ThreadPoolBuilder;

use crate::exec::source::SourceSpec;
use crate::exec::{Backend, Listener, Pass, Refusal, Session};
use crate::lock::lock;
use crate::plan::Plan;
use crate::run::each::each;
use crate::run::journal::{Journal, JournalLine, RunId};
use crate::run::log::RunLog;
use crate::run::unit::{RecordedRuns, Unit};
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

/// Executes `plan`, model by model. Runs in `journal` or `earlier` are not repeated, except the
/// warm-ups and the reference run before timed runs. A model whose runs are all known is not
/// loaded. After an interruption the records cover the finished models and cells.
///
/// With one job, the runs of a model and source are interleaved. With more, up to `jobs` cells run
/// concurrently, each from its first run to its last. The reference run of a model and source
/// precedes its cells. Records are in the order of the plan.
///
/// # Errors
///
/// If the journal cannot be written, the listener fails, the threads of the jobs cannot be started,
/// or a model differs from that of the journal or of the earlier file. Failures of runs are no
/// errors; they are in the records of their cells.
pub fn run(
    plan: &Plan,
    backend: &dyn Backend,
    journal: Option<&mut Journal>,
    earlier: Option<&Earlier>,
    listener: &mut dyn Listener,
    jobs: usize,
) -> anyhow::Result<Records> {
    let log = RunLog::new(journal, listener);
    let finished = Mutex::new(Finished::default());
    let run_model = |(number, model_index): (usize, usize)| -> anyhow::Result<()> {
        if log.interrupted() {
            return Ok(());
        }
        let benchmark = Benchmark {
            plan,
            model_index,
            backend,
            log: &log,
            earlier,
            is_parallel: jobs > 1,
        };
        let (mut model, mut cells) = benchmark.run()?;
        model.add_notes(plan.group.note_on_left_out(&model));
        for cell in &mut cells {
            cell.shard = plan.shard_range.map(|shard_range| shard_range.shard.index);
        }
        each(cells.iter_mut(), jobs > 1, |cell| {
            benchmark.count_instructions(&model, cell)
        })?;
        let mut finished = lock(&finished);
        finished.waiting.insert(number, (model, cells));
        finished.deliver(false, &log)
    };
    let with_units =
        (0..plan.models.len()).filter(|&model_index| plan.units_of_model(model_index) > 0);
    let models = with_units.enumerate();
    if jobs > 1 {
        // More threads than cells would have nothing to do.
        let cells = plan.cells().unwrap_or(usize::MAX).max(1);
        let pool = ThreadPoolBuilder::new()
            .num_threads(jobs.min(cells))
            .build()?;
        pool.install(|| each(models, true, run_model))?;
    } else {
        each(models, false, run_model)?;
    }
    let mut finished = std::mem::take(&mut *lock(&finished));
    finished.deliver(true, &log)?;
    Ok(finished.records)
}

/// Results of the finished models, put into the order of the plan.
#[derive(Default)]
struct Finished {
    records: Records,
    /// Finished models that wait for an earlier one, by their number.
    waiting: BTreeMap<usize, (ModelRecord, Vec<Cell>)>,
    /// Number of the next model to deliver.
    next: usize,
}

impl Finished {
    /// Moves waiting models to the records and reports them to the listener, in order. Stops at the
    /// first model that is not finished. With `is_last`, no more models will finish, and unfinished
    /// ones are skipped.
    fn deliver(&mut self, is_last: bool, log: &RunLog<'_>) -> anyhow::Result<()> {
        while let Some(first) = self.waiting.first_entry() {
            if !is_last && *first.key() != self.next {
                break;
            }
            let (model, mut cells) = first.remove();
            self.next += 1;
            if log.interrupted() && cells.is_empty() {
                continue;
            }
            log.listener().model_done(&model, &cells)?;
            self.records.models.push(model);
            self.records.cells.append(&mut cells);
        }
        Ok(())
    }
}

/// Whether `earlier` holds every run of `plan`, so that [`run`] would time nothing.
pub fn is_known(plan: &Plan, earlier: &Earlier) -> bool {
    let recorded = RecordedRuns {
        journal: None,
        earlier: Some(earlier),
    };
    let mut with_units =
        (0..plan.models.len()).filter(|&model_index| plan.units_of_model(model_index) > 0);
    with_units.all(|model_index| known(plan, model_index, recorded, true).is_some())
}

/// The record and all cells of the model with index `model_index`, if every run of them is in
/// `recorded`.
fn known(
    plan: &Plan,
    model_index: usize,
    recorded: RecordedRuns<'_>,
    is_interleaved: bool,
) -> Option<(ModelRecord, Vec<Cell>)> {
    let model = &plan.models[model_index];
    let (found, file_sha256) = recorded.model(&model.name)?;
    // `Journal::open` has refused changed model files. Those of an earlier result file are compared
    // here. The record of a model generated from a file does not have the hash of that file, so the
    // model is loaded and compared.
    let hash = model.file_sha256();
    if file_sha256.is_some() && hash.is_some() && (model.spec().is_some() || hash != file_sha256) {
        return None;
    }
    let units: Vec<Unit<'_>> = sources(plan, model_index, found)
        .ok()?
        .into_iter()
        .map(|source| Unit::new(plan, found, source, recorded, is_interleaved))
        .collect();
    units.iter().all(Unit::is_complete).then(|| {
        let cells = units.into_iter().flat_map(Unit::cells).collect();
        (found.clone(), cells)
    })
}

/// The sources that this shard has in the model with index `model_index`.
fn sources(
    plan: &Plan,
    model_index: usize,
    model: &ModelRecord,
) -> Result<Vec<SourceSpec>, UsageError> {
    let all = plan.units_in(model)?.into_iter().enumerate();
    let mine = |&(number, _): &(usize, SourceSpec)| plan.has_unit(model_index, number);
    Ok(all.filter(mine).map(|(_, source)| source).collect())
}

/// One model of a plan.
#[derive(Clone, Copy)]
struct Benchmark<'b, 'l> {
    plan: &'b Plan,
    /// Index of the model in the plan.
    model_index: usize,
    backend: &'b dyn Backend,
    log: &'b RunLog<'l>,
    earlier: Option<&'b Earlier>,
    /// Whether several cells run at the same time.
    is_parallel: bool,
}

impl Benchmark<'_, '_> {
    fn run(&self) -> anyhow::Result<(ModelRecord, Vec<Cell>)> {
        let model = &self.plan.models[self.model_index];
        if let Some((known, cells)) = self.known() {
            let runs = self.plan.runs_of_model(self.model_index);
            self.log.listener().skipped(runs);
            return Ok((known, cells));
        }
        self.log.listener().loading(&model.name);
        match self.backend.open(model) {
            Ok(session) => self.run_loaded(session),
            // A signal may have caused the refusal, so it is not recorded.
            Err(_) if self.log.interrupted() => Ok((model.record(), Vec::new())),
            Err(refusal) => {
                let record = model.record();
                let cells = self.without_model(&record, &refusal);
                Ok((record, cells))
            }
        }
    }

    /// Adds the instruction count of a successful cell, from the journal or counted now.
    fn count_instructions(&self, model: &ModelRecord, cell: &mut Cell) -> anyhow::Result<()> {
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
        let known = |journal: &Journal| journal.instructions(&run).cloned();
        let mut found = self.log.journal().as_deref().and_then(known);
        if found.is_none() && !self.log.interrupted() {
            let counter = self.log.listener().instruction_counter(model, cell);
            match counter.map(|count| count(model, cell)) {
                Some(Ok(count)) => {
                    let line = JournalLine::Instructions {
                        id: run,
                        found: count.clone(),
                    };
                    self.log.keep(line)?;
                    found = Some(count);
                }
                Some(Err(error)) => self.log.listener().not_counted(cell, &error),
                None => {}
            }
        }
        if let Some(found) = found {
            cell.instructions = Some(found.count);
            cell.instructions_simd = found.simd;
        }
        Ok(())
    }

    /// The unit of `model` and `source`, with the known runs.
    fn unit<'m>(
        &'m self,
        model: &'m ModelRecord,
        source: SourceSpec,
        journal: Option<&Journal>,
    ) -> Unit<'m> {
        let recorded = RecordedRuns {
            journal,
            earlier: self.earlier,
        };
        Unit::new(self.plan, model, source, recorded, !self.is_parallel)
    }

    /// The record and all cells of the model, if the journal or the earlier file has every run.
    fn known(&self) -> Option<(ModelRecord, Vec<Cell>)> {
        let journal = self.log.journal();
        let recorded = RecordedRuns {
            journal: journal.as_deref(),
            earlier: self.earlier,
        };
        known(self.plan, self.model_index, recorded, !self.is_parallel)
    }

    fn run_loaded(
        &self,
        mut session: Box<dyn Session + '_>,
    ) -> anyhow::Result<(ModelRecord, Vec<Cell>)> {
        let model = self.recorded(session.model())?;
        let sources = match sources(self.plan, self.model_index, &model) {
            Ok(sources) => sources,
            Err(error) => {
                let refusal = Refusal {
                    status: Status::Refused,
                    message: format!("{}: {error}", model.path),
                };
                let cells = self.without_model(&model, &refusal);
                return Ok((model, cells));
            }
        };
        let units = sources.len() as u128;
        let more = units.saturating_sub(self.plan.units_of_model(self.model_index));
        let more = usize::try_from(more).unwrap_or(usize::MAX);
        let more = more.saturating_mul(self.plan.runs_of_unit());
        self.log.listener().more(more);
        let mut cells = Vec::new();
        if self.is_parallel {
            let mut units: Vec<Unit<'_>> = {
                let journal = self.log.journal();
                let unit = |source| self.unit(&model, source, journal.as_deref());
                sources.into_iter().map(unit).collect()
            };
            let first = Mutex::new(Some(session));
            each(units.iter_mut(), true, |unit| {
                let first = lock(&first).take();
                unit.run_cells(
                    first,
                    self.backend,
                    &self.plan.models[self.model_index],
                    self.log,
                )
            })?;
            cells.extend(units.into_iter().flat_map(Unit::cells));
        } else {
            for source in sources {
                let mut unit = self.unit(&model, source, self.log.journal().as_deref());
                unit.run(&mut *session, self.log)?;
                cells.extend(unit.cells());
            }
        }
        Ok((model, cells))
    }

    /// The record of the loaded model. If the journal has a record of it, returns that one, else
    /// writes `found` to the journal.
    ///
    /// # Errors
    ///
    /// If the hash differs from that in the journal or the earlier file, or if the journal cannot
    /// be written.
    fn recorded(&self, found: &ModelRecord) -> anyhow::Result<ModelRecord> {
        let same = |known: &ModelRecord, whose: &str| {
            if known.sha256 == found.sha256 {
                return Ok(());
            }
            bail!(
                "{}: the model is not the one that {whose} of: its SHA-256 is {}, and was {}",
                found.path,
                found.sha256.as_deref().unwrap_or("not known"),
                known.sha256.as_deref().unwrap_or("not known"),
            );
        };
        let earlier = self.earlier.and_then(|earlier| earlier.model(&found.name));
        if let Some(earlier) = earlier.filter(|earlier| earlier.sha256.is_some()) {
            same(earlier, "the earlier results are")?;
        }
        let in_journal = |journal: &Journal| journal.model(&found.name).cloned();
        if let Some(known) = self.log.journal().as_deref().and_then(in_journal) {
            same(&known, "the journal holds results")?;
            return Ok(known);
        }
        self.log.keep(JournalLine::Model(found.clone()))?;
        Ok(found.clone())
    }

    /// The cells of a model that is unusable or lacks a requested source. Sources that depend on
    /// the mesh, such as random ones, are unknown then: all sources share one cell per algorithm.
    fn without_model(&self, model: &ModelRecord, refusal: &Refusal) -> Vec<Cell> {
        let plan = self.plan;
        let runs = plan.runs_of_model(self.model_index);
        self.log.listener().skipped(runs);
        let sources = if plan.sources_together {
            vec![Some(plan.sources.label())]
        } else {
            plan.sources.labels()
        };
        sources
            .iter()
            .enumerate()
            .filter(|&(number, source)| match source {
                Some(_) => plan.has_unit(self.model_index, number),
                None => plan.units_of_model(self.model_index) > 0,
            })
            .flat_map(|(_, source)| plan.algorithms_on(model).map(move |a| (source.clone(), a)))
            .map(|(source, algorithm)| Cell {
                group: plan.group.name.clone(),
                source,
                goal: plan.goal.label(),
                status: refusal.status,
                message: Some(refusal.message.clone()),
                threads: algorithm.threads(),
                approximate: algorithm.is_approximate(),
                simd: algorithm.simd(),
                ..Cell::new(&model.name, algorithm.label())
            })
            // What was measured before stands.
            .map(|cell| {
                let earlier = self.earlier.and_then(|earlier| earlier.of_id(&cell.id()));
                earlier.cloned().unwrap_or(cell)
            })
            .collect()
    }
}
