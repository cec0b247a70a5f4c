//! Plans, runs and result files for tests, over [`mock`](crate::exec::mock).

use geobench_registry::{self as registry, SimdChoice};
use geobench_window::simd::Instructions;

use super::{Records, run};
use crate::exec::Listener;
use crate::exec::goal::GoalSpec;
use crate::exec::limits::Limits;
use crate::exec::mock::MockBackend;
use crate::exec::model::ModelRef;
use crate::plan::sampling::Sampling;
use crate::plan::{Plan, Reference};
use crate::schema::{GroupRecord, Host, ResultFile, SCHEMA, Tool};

/// A plan for models that do not exist.
///
/// # Panics
///
/// When an algorithm or the sources cannot be parsed.
pub fn plan(models: &[&str], algorithms: &str, sources: &str) -> Plan {
    // Scalar instructions, so that snapshots do not depend on the machine.
    let simd = SimdChoice::AtMost(Instructions::Scalar);
    let algorithms = registry::select(algorithms).unwrap();
    let algorithms: Vec<_> = algorithms.into_iter().map(|a| a.with_simd(simd)).collect();
    Plan {
        group: GroupRecord::default(),
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
        sources_together: false,
        goal: GoalSpec::default(),
        sampling: Sampling::Fixed(6),
        warmup: 1,
        counts: true,
        tolerance: 1e-9,
        simd,
        seed: 1,
        shard_range: None,
        limits: Limits::USUAL,
    }
}

/// Ignores all progress.
pub(crate) struct NullListener;

impl Listener for NullListener {}

/// Executes `plan` with a mock backend.
///
/// # Panics
///
/// When the run ends with an error.
pub fn run_mock(plan: &Plan, backend: &MockBackend) -> Records {
    run(plan, backend, None, None, &mut NullListener, 1).unwrap()
}

/// A result file of these records.
pub fn result(records: Records) -> ResultFile {
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
            node: None,
        },
        command: vec!["geobench".into(), "run".into()],
        started: "2025-01-01T00:00:00Z".into(),
        finished: "2025-01-01T00:00:01Z".into(),
        isolation: None,
        groups: Vec::new(),
        models: records.models,
        cells: records.cells,
        pairing: None,
        conditions: None,
        plan: None,
        repository: None,
        algorithms: Vec::new(),
        sessions: Vec::new(),
    }
}
