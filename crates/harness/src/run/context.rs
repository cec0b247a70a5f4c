//! The session, the log and the checks that the runs of a unit share.

use std::sync::{Mutex, MutexGuard};

use crate::exec::{Failure, Observation, Session, Step};
use crate::lock::lock;
use crate::run::labels::NearestSources;
use crate::run::log::RunLog;
use crate::run::reference_check::ReferenceCheck;

/// The environment of the runs.
pub(super) struct RunContext<'s, 'l> {
    pub(super) session: &'s mut dyn Session,
    pub(super) log: &'s RunLog<'l>,
    pub(super) checks: &'s Checks,
}

/// The state of the checks, shared by concurrent cells.
pub(super) struct Checks {
    /// The reference, and the answers that differ from it.
    pub(super) reference: Mutex<ReferenceCheck>,
    pub(super) nearest: Mutex<Nearest>,
}

/// The nearest sources of every vertex.
#[derive(Default)]
pub(super) enum Nearest {
    /// No run has returned labels yet.
    #[default]
    NotSought,
    /// Labels are not checked.
    Unknown,
    Known(NearestSources),
}

/// A signal stopped the runs.
#[derive(Debug, thiserror::Error)]
#[error("interrupted")]
pub(super) struct Interrupted;

/// Turns [`Interrupted`] into success, because an interruption is not an error.
pub(super) fn stopped_or(done: anyhow::Result<()>) -> anyhow::Result<()> {
    match done {
        Err(error) if error.is::<Interrupted>() => Ok(()),
        done => done,
    }
}

impl<'s> RunContext<'s, '_> {
    pub(super) fn check(&self) -> MutexGuard<'s, ReferenceCheck> {
        lock(&self.checks.reference)
    }

    /// Executes a run.
    ///
    /// # Errors
    ///
    /// The outer error: a signal arrived before the run, or a signal arrived and the run failed.
    /// The inner result is that of the run.
    pub(super) fn execute(
        &mut self,
        step: &Step<'_>,
    ) -> Result<Result<Observation, Failure>, Interrupted> {
        if self.log.interrupted() {
            return Err(Interrupted);
        }
        self.log.listener().step(step);
        let done = self.session.execute(step);
        if done.is_err() && self.log.interrupted() {
            return Err(Interrupted);
        }
        Ok(done)
    }

    /// Executes a run that no cell counts.
    ///
    /// # Errors
    ///
    /// As [`execute`](Self::execute).
    pub(super) fn execute_unplanned(
        &mut self,
        step: &Step<'_>,
    ) -> Result<Result<Observation, Failure>, Interrupted> {
        self.log.listener().more(1);
        self.execute(step)
    }
}
