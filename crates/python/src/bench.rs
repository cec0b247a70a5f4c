//! Benchmarks that run in the Python process.

use std::path::Path;

use geobench_harness::exec::Listener;
use geobench_harness::exec::goal::GoalSpec;
use geobench_harness::exec::in_process::ThisProcess;
use geobench_harness::exec::limits::Limits;
use geobench_harness::exec::model::{self, ModelRef};
use geobench_harness::exec::source::SourceSpec;
use geobench_harness::measure::conditions::{self, Snapshot};
use geobench_harness::measure::host;
use geobench_harness::plan::sampling::Sampling;
use geobench_harness::plan::{self, Plan, Reference};
use geobench_harness::run;
use geobench_harness::schema::{
    GroupRecord, IsolationRecord, Precision, ResultFile, SCHEMA, SessionRecord,
};
use geobench_registry::{self as registry, SimdChoice};
use geodesics::Stop;
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::algorithm::check_threads;
use crate::arrays;
use crate::interrupt;
use crate::mesh::PyMesh;
use crate::points::warn_user;

/// Ends a benchmark between two runs once the [`Stop`] is set.
struct UntilStopped(Stop);

impl Listener for UntilStopped {
    fn interrupted(&self) -> bool {
        self.0.is_set()
    }
}

fn models(values: &[Bound<'_, PyAny>]) -> PyResult<Vec<ModelRef>> {
    let mut models: Vec<ModelRef> = Vec::new();
    for value in values {
        if let Ok(mesh) = value.cast::<PyMesh>() {
            let mesh = mesh.get();
            let same = |name: &str| models.iter().any(|model| model.name == name);
            let mut name = mesh.name.clone();
            let mut number = 1;
            while same(&name) {
                number += 1;
                name = format!("{} #{number}", mesh.name);
            }
            models.push(ModelRef::in_memory(&name, &mesh.surface.mesh));
            continue;
        }
        let text: String = value.str()?.extract()?;
        if value.hasattr("__fspath__")? || value.is_instance_of::<pyo3::types::PyString>() {
            let found = model::collect(&[text]);
            let found = found.map_err(|error| PyValueError::new_err(format!("models: {error}")))?;
            models.extend(found);
        } else {
            return Err(PyTypeError::new_err(format!(
                "models: {text} is no model; give a Mesh, a file or `gen:NAME,...`"
            )));
        }
    }
    let mut names: Vec<&str> = models.iter().map(|model| model.name.as_str()).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(PyValueError::new_err(format!(
            "models: two have the name {}; give one of them another with Mesh(..., name=)",
            pair[0]
        ))),
        None if models.is_empty() => Err(PyValueError::new_err("models: none is given")),
        None => Ok(models),
    }
}

/// Runs a benchmark and returns its result file as JSON text.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "they are those of `run`, by name"
)]
pub(crate) fn run_to_json(
    py: Python<'_>,
    algorithms: &str,
    models: Vec<Bound<'_, PyAny>>,
    sources: &str,
    sources_together: bool,
    repeat: Option<i64>,
    warmup: i64,
    check: Option<&str>,
    tolerance: f64,
    threads: i64,
    simd: &str,
    command: Vec<String>,
) -> PyResult<String> {
    let wrong = |name: &str, error: &dyn std::fmt::Display| {
        PyValueError::new_err(format!("{name}: {error}"))
    };
    let simd: SimdChoice = simd.parse().map_err(|error| wrong("simd", &error))?;
    let selected = registry::select(algorithms).map_err(|error| wrong("algorithms", &error))?;
    if let Some(outside) = selected.iter().find(|a| a.outside_name().is_some()) {
        return Err(PyValueError::new_err(format!(
            "algorithms: {} is an outside program; those take part in the command `geobench run`",
            outside.label()
        )));
    }
    let repeat = repeat.map(|repeat| arrays::count(repeat, "repeat", 1));
    let repeat = repeat.transpose()?;
    let warmup = arrays::count(warmup, "warmup", 0)?;
    let threads = check_threads(threads)?;
    if !tolerance.is_finite() || tolerance < 0.0 {
        return Err(PyValueError::new_err(format!(
            "tolerance: {tolerance} is no error that could be allowed"
        )));
    }
    let selected = selected.into_iter();
    let selected: Vec<_> = selected
        .map(|a| a.with_threads(threads).with_simd_in_table(simd))
        .collect();
    let reference = match check {
        None => Reference::usual(&selected),
        Some(check) => check.parse().map_err(|error| wrong("check", &error))?,
    };
    let sources: SourceSpec = sources.parse().map_err(|error| wrong("sources", &error))?;
    let (sources, notes) = sources.distinct();
    warn_user(py, "sources", &notes)?;
    let plan = Plan {
        group: GroupRecord {
            left_out_at_junctions: plan::left_out_at_junctions(&selected),
            ..GroupRecord::default()
        },
        models: self::models(&models)?,
        algorithms: selected,
        sources,
        sources_together,
        goal: GoalSpec::default(),
        sampling: repeat.map_or(Sampling::UntilPrecise(Precision::USUAL), Sampling::Fixed),
        warmup,
        counts: true,
        reference,
        tolerance,
        seed: 1,
        simd,
        shard_range: None,
        limits: Limits::default(),
    };
    plan.check_reference()
        .map_err(|error| wrong("check", &error))?;
    let stop = Stop::default();
    let listener = UntilStopped(stop.clone());
    let result = interrupt::long(py, &stop, move || result(&plan, command, listener))?;
    result.map_err(|error| PyRuntimeError::new_err(format!("{error:#}")))
}

fn result(plan: &Plan, command: Vec<String>, mut listener: UntilStopped) -> anyhow::Result<String> {
    let isolation = IsolationRecord {
        process: false,
        cpus: None,
        jobs: None,
    };
    let record = plan::record(std::slice::from_ref(plan), isolation.clone());
    let (host, started) = (host::host(), host::now());
    let before = Snapshot::take(Path::new("/"));
    let records = run::run(plan, &ThisProcess, None, None, &mut listener, 1)?;
    let finished = host::now();
    let file = ResultFile {
        schema: SCHEMA.to_owned(),
        tool: host::tool(),
        host: host.clone(),
        command: command.clone(),
        started: started.clone(),
        finished: finished.clone(),
        isolation: Some(isolation),
        groups: vec![plan.group.clone()],
        models: records.models,
        cells: records.cells,
        pairing: None,
        conditions: Some(conditions::between(
            &before,
            &Snapshot::take(Path::new("/")),
        )),
        plan: Some(record),
        repository: None,
        algorithms: Vec::new(),
        sessions: vec![SessionRecord {
            shard: None,
            host,
            command,
            started,
            finished: Some(finished),
            tool: None,
            programs: Vec::new(),
        }],
    };
    Ok(serde_json::to_string(&file)?)
}
