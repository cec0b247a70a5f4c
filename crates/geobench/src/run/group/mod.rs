//! The cells of one model and one source.

mod entry;
mod yardstick;

use std::path::Path;

use geobench_mesh::VertexId;

use self::entry::{Entry, outcome};
use self::yardstick::{Answer, Yardstick};
use crate::exec::{Executor, Failure, Listener, Observation, Purpose, Step};
use crate::plan::{Plan, Reference};
use crate::registry::Selection;
use crate::run::agreement;
use crate::run::ledger::{Finding, Ledger, RunId};
use crate::run::order::Turns;
use crate::schema::{Cell, ModelRecord};

/// The cells of one model and one source, whose runs are interleaved so that a drifting machine
/// hurts all algorithms alike.
pub(crate) struct Group<'p> {
    plan: &'p Plan,
    model: &'p ModelRecord,
    source: VertexId,
    turns: Turns,
    /// One for each algorithm.
    entries: Vec<Entry<'p>>,
}

impl<'p> Group<'p> {
    /// The cells of `plan` in `model` from `source`, with the runs that `ledger` knows already.
    pub(crate) fn new(
        plan: &'p Plan,
        model: &'p ModelRecord,
        source: VertexId,
        ledger: &dyn Ledger,
    ) -> Self {
        let algorithms = &plan.algorithms;
        let mut group = Self {
            plan,
            model,
            source,
            turns: Turns::new(plan.seed, &model.name, source.raw(), algorithms.len()),
            entries: algorithms.iter().map(Entry::new).collect(),
        };
        // The reference has a first warm-up even if there are no others.
        let warmups = (0..plan.warmup.max(1)).map(|round| (Purpose::WarmUp, round));
        let times = (0..plan.repeat).map(|round| (Purpose::Time, round));
        let last = [(Purpose::Clock, 0), (Purpose::Count, 0)];
        for (purpose, round) in warmups.chain(times).chain(last) {
            for (place, algorithm) in algorithms.iter().enumerate() {
                let run = group.run_id(algorithm, purpose, round);
                if let Some(finding) = ledger.finding(&run) {
                    group.entries[place].add(purpose, round, finding.clone());
                }
            }
        }
        group
    }

    /// Whether there is nothing left to be done.
    pub(crate) fn is_complete(&self) -> bool {
        self.entries
            .iter()
            .all(|entry| entry.is_complete(self.plan))
    }

    /// Carries out every run of these cells that is still to be made.
    ///
    /// # Errors
    ///
    /// When what came of a run cannot be kept.
    pub(crate) fn run(
        &mut self,
        executor: &mut dyn Executor,
        ledger: &mut dyn Ledger,
        listener: &mut dyn Listener,
    ) -> anyhow::Result<()> {
        for entry in &self.entries {
            for (purpose, outcome) in entry.outcomes() {
                listener.ran(&self.as_step(entry.algorithm, purpose), outcome);
            }
        }
        if !self.is_complete() {
            let mut stage = Stage {
                executor,
                ledger,
                listener,
                yardstick: Yardstick::default(),
            };
            match self.make_runs(&mut stage) {
                Err(error) if error.is::<Interrupted>() => {}
                done => done?,
            }
        }
        let planned = self.plan.runs_per_cell();
        let skipped = self.entries.iter().map(|e| planned.saturating_sub(e.made));
        listener.skipped(skipped.sum());
        Ok(())
    }

    /// What became of the cells, of those that are done.
    pub(crate) fn cells(self) -> Vec<Cell> {
        let rounds: Vec<Vec<usize>> = (0..self.plan.repeat)
            .map(|round| self.turns.round(round))
            .collect();
        let ids: Vec<RunId> = self
            .entries
            .iter()
            .map(|entry| self.run_id(entry.algorithm, Purpose::Time, 0))
            .collect();
        let cells = self.entries.into_iter().zip(ids).enumerate();
        let mut cells: Vec<Cell> = cells
            .filter(|(_, (entry, _))| entry.is_complete(self.plan))
            .map(|(place, (entry, id))| {
                let places = rounds
                    .iter()
                    .filter_map(|round| round.iter().position(|&p| p == place))
                    .collect();
                entry.finish(id, places, self.plan.group.wavefront)
            })
            .collect();
        agreement::explain(&mut cells);
        cells
    }

    fn make_runs(&mut self, stage: &mut Stage<'_>) -> anyhow::Result<()> {
        self.restore_clusters(stage)?;
        let warmed = self.find_reference(stage)?;
        let all = 0..self.entries.len();
        for round in 0..self.plan.warmup {
            for place in all.clone() {
                // The reference has had its first warm-up.
                if round > 0 || warmed != Some(place) {
                    self.step(place, Purpose::WarmUp, round, stage)?;
                }
            }
        }
        for round in 0..self.plan.repeat {
            for place in self.turns.round(round) {
                self.step(place, Purpose::Time, round, stage)?;
            }
        }
        // What is kept for the counts leaves the heap in pieces, after which memory could not be measured.
        for purpose in [Purpose::Clock, Purpose::Count] {
            for place in all.clone() {
                self.step(place, purpose, 0, stage)?;
            }
        }
        Ok(())
    }

    /// Finds the answer that all others must agree with. If this takes a run of an algorithm that
    /// is measured too, the place of that one is returned: the run counts as its warm-up.
    fn find_reference(&mut self, stage: &mut Stage<'_>) -> anyhow::Result<Option<usize>> {
        let reference = match &self.plan.reference {
            Reference::None => return Ok(None),
            Reference::Files(files) => {
                let vertices = self.model.vertices.unwrap_or(0) as usize;
                match files.find(Path::new(&self.model.path), self.source.raw(), vertices) {
                    Ok(field) => {
                        stage.yardstick.answer = Some(Answer {
                            name: field.path.display().to_string(),
                            distances: field.distances,
                            vertices,
                        });
                    }
                    Err(error) => stage.yardstick.unchecked = Some(error.to_string()),
                }
                return Ok(None);
            }
            Reference::Algorithm(reference) => reference,
        };
        let run = self.run_id(reference, Purpose::WarmUp, 0);
        let failed = |failure: &Failure| {
            let label = reference.label();
            Some(format!("the reference {label} failed: {}", failure.message))
        };
        let known = stage.ledger.finding(&run);
        if let Some(failure) = known.and_then(|finding| finding.failure.as_ref()) {
            // It is not tried again.
            stage.yardstick.unchecked = failed(failure);
            return Ok(None);
        }
        let place = self
            .entries
            .iter()
            .position(|e| e.algorithm.label() == reference.label());
        let done = stage.execute(&self.as_step(reference, Purpose::WarmUp))?;
        match &done {
            Ok(observation) => {
                stage.yardstick.answer =
                    Some(Answer::of(reference.label(), &observation.distances));
            }
            Err(failure) => stage.yardstick.unchecked = failed(failure),
        }
        match place {
            Some(place) if self.entries[place].lacks(self.plan, Purpose::WarmUp, 0) => {
                self.take_in(place, Purpose::WarmUp, 0, done, stage)?;
            }
            // It stands for no cell; that it fails is kept, so that it is not tried again.
            None => {
                let finding = self.judge(reference, done, &mut stage.yardstick);
                stage.ledger.keep(run, &finding)?;
            }
            // Its cell is done but for the counts, whatever became of the answer now.
            Some(_) => {}
        }
        Ok(place)
    }

    /// Asks again for the answers that differed from the reference before an interruption, so that
    /// those to come can be compared with them.
    fn restore_clusters(&self, stage: &mut Stage<'_>) -> anyhow::Result<()> {
        let mut restored = Vec::new();
        for entry in &self.entries {
            let Some(cluster) = entry.odd_cluster() else {
                continue;
            };
            if !restored.contains(&cluster) {
                restored.push(cluster);
                let done = stage.execute(&self.as_step(entry.algorithm, Purpose::WarmUp))?;
                let answer = done.ok().map(|observation| observation.distances);
                stage.yardstick.clusters.restore(cluster, answer);
            }
        }
        Ok(())
    }

    /// Makes a run, unless it has been made or its cell has failed.
    fn step(
        &mut self,
        place: usize,
        purpose: Purpose,
        round: usize,
        stage: &mut Stage<'_>,
    ) -> anyhow::Result<()> {
        let entry = &self.entries[place];
        if !entry.lacks(self.plan, purpose, round) {
            return Ok(());
        }
        let done = stage.execute(&self.as_step(entry.algorithm, purpose))?;
        self.take_in(place, purpose, round, done, stage)
    }

    /// Checks what a run delivered, keeps it and adds it to its cell.
    fn take_in(
        &mut self,
        place: usize,
        purpose: Purpose,
        round: usize,
        done: Result<Observation, Failure>,
        stage: &mut Stage<'_>,
    ) -> anyhow::Result<()> {
        let run = self.run_id(self.entries[place].algorithm, purpose, round);
        let algorithm = self.entries[place].algorithm;
        let finding = self.judge(algorithm, done, &mut stage.yardstick);
        stage.ledger.keep(run, &finding)?;
        let step = self.as_step(algorithm, purpose);
        stage.listener.ran(&step, outcome(&finding));
        let entry = &mut self.entries[place];
        entry.made += 1;
        entry.add(purpose, round, finding);
        Ok(())
    }

    fn judge(
        &self,
        algorithm: &Selection,
        done: Result<Observation, Failure>,
        yardstick: &mut Yardstick,
    ) -> Finding {
        match done {
            Ok(mut observation) => {
                let distances = std::mem::take(&mut observation.distances);
                let is_approximate = algorithm.is_approximate();
                let (check, failure) =
                    yardstick.judge(&distances, self.plan.tolerance, is_approximate);
                // An approximation may differ, but not without bounds.
                let failure = failure.filter(|_| !is_approximate || check.max_rel.is_none());
                Finding {
                    observation,
                    check,
                    unchecked: yardstick.unchecked.clone(),
                    failure,
                }
            }
            Err(failure) => Finding {
                failure: Some(failure),
                ..Finding::default()
            },
        }
    }

    fn as_step<'s>(&'s self, algorithm: &'s Selection, purpose: Purpose) -> Step<'s> {
        Step {
            model: &self.model.name,
            algorithm,
            source: self.source,
            purpose,
        }
    }

    fn run_id(&self, algorithm: &Selection, purpose: Purpose, round: usize) -> RunId {
        RunId {
            group: self.plan.group.name.clone(),
            model: self.model.name.clone(),
            source: self.source.raw(),
            algorithm: algorithm.label().to_owned(),
            purpose,
            round,
        }
    }
}

/// What takes part in making a run.
struct Stage<'s> {
    executor: &'s mut dyn Executor,
    ledger: &'s mut dyn Ledger,
    listener: &'s mut dyn Listener,
    yardstick: Yardstick,
}

/// Somebody asked to stop.
#[derive(Debug, thiserror::Error)]
#[error("interrupted")]
struct Interrupted;

impl Stage<'_> {
    /// Makes a run, unless somebody asks to stop before it is done.
    fn execute(&mut self, step: &Step<'_>) -> Result<Result<Observation, Failure>, Interrupted> {
        if self.listener.interrupted() {
            return Err(Interrupted);
        }
        self.listener.step(step);
        let done = self.executor.execute(step);
        if done.is_err() && self.listener.interrupted() {
            return Err(Interrupted);
        }
        Ok(done)
    }
}
