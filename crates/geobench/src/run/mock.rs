//! Plans, runs and result files for tests, over [`mock`](crate::exec::mock).

use super::ledger::NoLedger;
use super::{Outcome, run};
use crate::exec::Listener;
use crate::exec::limits::Limits;
use crate::exec::mock::Rehearsal;
use crate::exec::model::ModelRef;
use crate::plan::{Plan, Reference};
use crate::registry;
use crate::schema::{GroupRecord, Host, ResultFile, SCHEMA, Tool};

/// A plan over made-up models.
pub(crate) fn plan(models: &[&str], algorithms: &str, sources: &str) -> Plan {
    let algorithms = registry::select(algorithms).unwrap();
    Plan {
        group: GroupRecord::unnamed(),
        models: models.iter().map(|name| ModelRef::named(name)).collect(),
        reference: Reference::Algorithm(
            algorithms
                .iter()
                .find(|a| a.label() == "mmp")
                .unwrap_or(&algorithms[0])
                .clone(),
        ),
        algorithms,
        sources: sources.parse().unwrap(),
        repeat: 5,
        warmup: 1,
        tolerance: 1e-9,
        seed: 1,
        share: None,
        limits: Limits::USUAL,
    }
}

/// Listens to nothing.
pub(crate) struct Deaf;

impl Listener for Deaf {}

/// Carries out `plan` with `rehearsal`.
pub(crate) fn rehearse(plan: &Plan, rehearsal: &mut Rehearsal) -> Outcome {
    run(plan, rehearsal, &mut NoLedger, &mut Deaf).unwrap()
}

/// The result file of a made-up run.
pub(crate) fn result(outcome: Outcome) -> ResultFile {
    ResultFile {
        schema: SCHEMA.into(),
        tool: Tool {
            version: "1.2.3".into(),
            commit: None,
            rustc: Some("rustc 1.89.0".into()),
            rustflags: Some("-C opt-level=3".into()),
            profile: "release".into(),
            features: Vec::new(),
        },
        host: Host {
            cpu: None,
            cores: 2,
            memory_bytes: Some(1 << 34),
            os: "some system".into(),
            kernel: None,
            load_start: Some(0.5),
            simd: Some("avx2".into()),
        },
        command: vec!["geobench".into(), "run".into()],
        started: "2025-01-01T00:00:00Z".into(),
        finished: "2025-01-01T00:00:01Z".into(),
        isolation: None,
        groups: Vec::new(),
        models: outcome.models,
        cells: outcome.cells,
        pairing: None,
        conditions: None,
        plan: None,
        sessions: Vec::new(),
    }
}
