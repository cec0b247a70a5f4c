//! What the cells of a unit share, and the identities of their runs.

use std::sync::Mutex;

use geobench_registry::Selection;

use crate::exec::source::SourceSpec;
use crate::exec::{Pass, Step};
use crate::plan::{Plan, Reference};
use crate::run::answer_layout::AnswerLayout;
use crate::run::context::Checks;
use crate::run::journal::{RunId, UnitId};
use crate::run::order::RunOrder;
use crate::run::proof::Decision;
use crate::run::reference_check::ReferenceCheck;
use crate::schema::ModelRecord;

/// The data shared by the cells of a unit.
pub(super) struct UnitPlan<'p> {
    pub(super) plan: &'p Plan,
    pub(super) model: &'p ModelRecord,
    /// The source, or several sources together.
    pub(super) source: SourceSpec,
    /// The reference for this model.
    pub(super) reference: Reference,
    pub(super) order: RunOrder,
    pub(super) is_interleaved: bool,
}

impl UnitPlan<'_> {
    /// The state of the checks before the first run.
    pub(super) fn checks(&self, decision: Option<Decision>) -> Checks {
        let vertices = self.model.vertex_count();
        Checks {
            reference: Mutex::new(ReferenceCheck {
                layout: AnswerLayout::new(&self.plan.goal, vertices),
                decision,
                ..ReferenceCheck::default()
            }),
            nearest: Mutex::default(),
        }
    }

    /// Whether [`Plan::runs_per_cell`] counts a run: not a timed run beyond the minimum, nor the
    /// warm-up of a reference without warm-ups.
    pub(super) fn is_planned(&self, pass: Pass, round: usize) -> bool {
        match pass {
            Pass::Warmup => round < self.plan.warmup,
            Pass::Time => round < self.plan.sampling.fewest(),
            Pass::Profile | Pass::Count => true,
        }
    }

    /// Position of the cell with index `index` in a round of timed runs. `None` for concurrent
    /// cells, which have no common rounds.
    pub(super) fn position(&self, round: usize, index: usize) -> Option<usize> {
        let position = self.order.position(round, index);
        position.filter(|_| self.is_interleaved)
    }

    /// A run of `algorithm`.
    pub(super) fn as_step<'s>(
        &'s self,
        algorithm: &'s Selection,
        pass: Pass,
        solves: usize,
    ) -> Step<'s> {
        Step {
            model: &self.model.name,
            algorithm,
            source: &self.source,
            goal: &self.plan.goal,
            pass,
            solves,
        }
    }

    /// The identity of the unit in a journal.
    pub(super) fn unit_id(&self) -> UnitId {
        UnitId {
            group: self.plan.group.name.clone(),
            model: self.model.name.clone(),
            source: self.source.label(),
        }
    }

    /// The identity of a run in a journal.
    pub(super) fn run_id(&self, algorithm: &Selection, pass: Pass, round: usize) -> RunId {
        RunId {
            group: self.plan.group.name.clone(),
            model: self.model.name.clone(),
            source: self.source.label(),
            algorithm: algorithm.label().to_owned(),
            pass,
            round,
        }
    }
}
