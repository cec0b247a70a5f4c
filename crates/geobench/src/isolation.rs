//! Options that several commands share: process isolation, limits, and how models are read.

use std::path::PathBuf;
use std::thread;

use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use geobench_harness::exec::affinity::{self, CpuList};
use geobench_harness::exec::interrupt;
use geobench_harness::exec::isolate::Isolated;
use geobench_harness::exec::limits::{Limits, MemoryLimit, Timeout};
use geobench_harness::exec::model::{self, ModelRef};
use geobench_harness::plan::suite;
use geobench_harness::plan::suite::options::{
    DecompressionOption, LimitOptions, ReaderOption, WeldOption,
};
use geobench_harness::schema::IsolationRecord;
use geobench_mesh::Mesh;
use geobench_mesh::io::ReadOptions;
use geobench_registry::{Programs, Selection};

use crate::terminal;

#[derive(Args, Debug)]
pub(crate) struct IsolationOptions {
    /// Where cells run: each in a process of its own, so that a crash, an endless loop or too much
    /// memory costs one row only, or all in this process
    #[arg(long, value_name = "WHERE", value_enum, default_value_t)]
    isolate: Isolate,

    /// Processors that cells may run on, such as 3 or 0,4-7 [default: all]
    #[arg(long, value_name = "LIST", allow_negative_numbers = true)]
    cpu: Option<CpuList>,

    /// File with tables [ext.NAME] of outside programs, which become algorithms ext:NAME; a suite
    /// file may hold such tables too
    #[arg(long, value_name = "FILE")]
    pub(crate) ext: Vec<PathBuf>,
}

/// How a model is read.
#[derive(Args, Debug)]
pub(crate) struct ReadingOptions {
    #[command(flatten)]
    decompression: DecompressionOption,

    #[command(flatten)]
    weld: WeldOption,

    #[command(flatten)]
    reader: ReaderOption,
}

impl ReadingOptions {
    /// The only model that `argument` names.
    ///
    /// # Errors
    ///
    /// If there is none, or several.
    pub(crate) fn model(&self, argument: &str) -> anyhow::Result<ModelRef> {
        Ok(self.of(model::only(argument)?))
    }

    /// The models that `arguments` name.
    ///
    /// # Errors
    ///
    /// If an argument names none.
    pub(crate) fn models(&self, arguments: &[String]) -> anyhow::Result<Vec<ModelRef>> {
        let models = model::collect(arguments)?.into_iter();
        Ok(models.map(|model| self.of(model)).collect())
    }

    fn of(&self, model: ModelRef) -> ModelRef {
        let reader = self.reader.reader.unwrap_or_default();
        model.welded(self.weld.vertices()).read_by(reader)
    }

    /// The mesh of `model`. Unless `quiet`, prints what validation repairs and notes.
    ///
    /// # Errors
    ///
    /// If the model cannot be used.
    pub(crate) fn mesh(&self, model: &ModelRef, quiet: bool) -> anyhow::Result<Mesh> {
        let (mesh, report) = model.mesh_within(self)?;
        if !quiet {
            terminal::notes_on(&model.name, &report.notes());
        }
        Ok(mesh)
    }
}

impl From<&ReadingOptions> for ReadOptions {
    fn from(options: &ReadingOptions) -> Self {
        options.decompression.limit().into()
    }
}

/// Where cells run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Isolate {
    #[default]
    Process,
    None,
}

impl IsolationOptions {
    /// Listens to signals, and says what the first one does.
    ///
    /// # Errors
    ///
    /// If the system refuses.
    pub(crate) fn listen(&self) -> anyhow::Result<()> {
        let told = if self.isolate == Isolate::None {
            || terminal::notes(&["stopping after this run; again to stop at once".to_owned()])
        } else {
            || terminal::notes(&["stopping this run; again to stop at once".to_owned()])
        };
        interrupt::listen(told).context("cannot listen to signals")
    }

    /// Checks the options for consistency.
    ///
    /// # Errors
    ///
    /// If the isolation cannot enforce a given limit or separate concurrent jobs, or if this
    /// process may not run on the processors of `--cpu`.
    pub(crate) fn check(&self, jobs: usize, limits: &LimitOptions) -> anyhow::Result<()> {
        if self.isolate == Isolate::None && jobs > 1 {
            bail!(
                "--jobs needs --isolate process: within one process the memory of each cell could \
                 not be told from that of the others"
            );
        }
        let limit = match (limits.timeout, limits.memory_limit) {
            (Some(Timeout(Some(_))), _) => Some("--timeout"),
            (_, Some(MemoryLimit(Some(_)))) => Some("--memory-limit"),
            _ => None,
        };
        if let (Isolate::None, Some(limit)) = (self.isolate, limit) {
            bail!(
                "{limit} needs --isolate process: nothing can end a run in this very process \
                 without ending all others"
            );
        }
        if let Some(cpus) = &self.cpu {
            affinity::check(cpus).context("--cpu")?;
        }
        Ok(())
    }

    /// The external programs of the `--ext` files. If a name repeats, the first file takes
    /// precedence.
    pub(crate) fn programs(&self) -> anyhow::Result<Programs> {
        let mut programs = Programs::default();
        for path in &self.ext {
            programs = programs.or(&suite::read_programs(path)?);
        }
        Ok(programs)
    }

    /// Whether limits are enforced.
    pub(crate) fn keeps_limits(&self) -> bool {
        self.isolate == Isolate::Process
    }

    /// A warning if `jobs` concurrent cells of the algorithm with the most threads have more
    /// threads than there are processors.
    pub(crate) fn crowding<'a>(
        &self,
        algorithms: impl IntoIterator<Item = &'a Selection>,
        jobs: usize,
    ) -> Option<String> {
        let threads = algorithms.into_iter().map(Selection::threads).max()?;
        let threads = threads * jobs;
        let pinned = self.cpu.as_ref().map(|cpus| cpus.numbers().len());
        let (processors, whose) = match pinned {
            Some(pinned) => (pinned, "--cpu allows"),
            None => (
                thread::available_parallelism().map_or(1, usize::from),
                "this machine has",
            ),
        };
        (threads > processors).then(|| {
            format!(
                "{threads} threads take turns, since {whose} {processors} processor{}",
                if processors == 1 { "" } else { "s" }
            )
        })
    }

    /// The isolation as recorded in result files.
    pub(crate) fn record(&self, jobs: usize) -> IsolationRecord {
        IsolationRecord {
            process: self.isolate == Isolate::Process,
            cpus: self.cpu.as_ref().map(|cpus| cpus.numbers().to_vec()),
            jobs: (jobs > 1).then_some(jobs),
        }
    }

    /// The backend for these options. With `shared`, one child process serves all algorithms of
    /// this program. Without isolation, pins this process to the processors of `--cpu`.
    pub(crate) fn backend(&self, limits: Limits, shared: bool) -> anyhow::Result<Isolated> {
        let here = self.isolate == Isolate::None;
        if let (true, Some(cpus)) = (here, &self.cpu) {
            affinity::pin(cpus.numbers()).context("--cpu")?;
        }
        Ok(Isolated {
            limits,
            cpus: self.cpu.clone(),
            shared,
            here,
            ..Isolated::default()
        })
    }
}
