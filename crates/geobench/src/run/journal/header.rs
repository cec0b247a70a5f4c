//! The first line of a journal.

use serde::{Deserialize, Serialize};

use crate::exec::Purpose;
use crate::run::ledger::RunId;
use crate::schema::difference;
use crate::schema::plan_record::PlanRecord;
use crate::schema::{SCHEMA, Tool};

/// Which run a journal belongs to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Always the schema of result files.
    journal: String,
    /// The program that measures.
    tool: Tool,
    /// What is to be run, the hashes of the models' files included.
    plan: PlanRecord,
}

impl Header {
    /// The first line of a journal of `tool` running `plan`.
    pub fn new(tool: Tool, plan: PlanRecord) -> Self {
        Self {
            journal: SCHEMA.to_owned(),
            tool,
            plan,
        }
    }

    /// The line itself.
    pub(super) fn line(&self) -> String {
        let mut line = serde_json::to_string(self).unwrap_or_default();
        line.push('\n');
        line
    }

    /// What is different in the run that `now` describes, with both values.
    pub(super) fn difference(&self, now: &Self) -> Option<String> {
        let value = |header| serde_json::to_value(header).unwrap_or_default();
        let found = difference::first(&value(self), &value(now))?;
        Some(format!(
            "`{}` is {} there and {} now",
            found.place, found.left, found.right
        ))
    }

    /// Makes sure that a run is one of the plan.
    pub(super) fn check(&self, run: &RunId) -> Result<(), String> {
        let group = self.plan.groups.iter().find(|g| g.name == run.group);
        let Some(group) = group else {
            return Err(format!(
                "there is no group `{}` in the plan",
                run.group.as_deref().unwrap_or_default()
            ));
        };
        if group.models.iter().all(|model| model.name != run.model) {
            return Err(format!("there is no model `{}` in the plan", run.model));
        }
        let is_reference = group.reference == run.algorithm && run.purpose == Purpose::WarmUp;
        if !is_reference && group.algorithms.iter().all(|a| a.label != run.algorithm) {
            return Err(format!(
                "there is no algorithm `{}` in the plan",
                run.algorithm
            ));
        }
        let rounds = match run.purpose {
            Purpose::WarmUp => group.warmup.max(1),
            Purpose::Time => group.repeat,
            Purpose::Count | Purpose::Clock => 1,
        };
        if run.round >= rounds {
            return Err(format!("there is no round {} in the plan", run.round));
        }
        Ok(())
    }
}
