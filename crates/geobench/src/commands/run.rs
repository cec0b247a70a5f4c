//! `geobench run`.

use clap::{ArgGroup, Args};
use geobench_registry::MOST_THREADS;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use geobench_export::output::{OutputFile, check_files};
use geobench_harness::exec::goal::GoalSpec;
use geobench_harness::exec::limits::{DecompressionLimit, Limits, Timeout};
use geobench_harness::exec::{Listener, instructions, interrupt};
use geobench_harness::measure::conditions::{self, Snapshot};
use geobench_harness::measure::host;
use geobench_harness::plan::suite::{
    self, EmbeddedSuite, Library, ModelChoice, Plans, Settings, Suite, options::Whole,
};
use geobench_harness::plan::{self, Plan};
use geobench_harness::run::journal::{Journal, JournalHeader};
use geobench_harness::run::{self, Earlier};
use geobench_harness::schema::unfinished::Unfinished;
use geobench_harness::schema::{PlanRecord, ResultFile, SCHEMA, SessionRecord, Shard};
use geobench_harness::usage::read_text;
use geobench_report::table::{self, Look, ResultFormat};

use crate::args::{CsvOptions, FormatOption, MODELS_HELP, QuietOption};
use crate::git;
use crate::isolation::IsolationOptions;
use crate::points::FarOption;
use crate::progress::Progress;
use crate::reporter::Reporter;
use crate::result_store::{self, ResultStore};
use crate::terminal;
use crate::verdict::{self, Tally, Verdict};

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
#[command(group = ArgGroup::new("which_suite").args(["config", "suite"]))]
pub(crate) struct RunOptions {
    #[command(flatten, next_help_heading = "What runs")]
    pub(crate) suite_file: SuiteFileOption,

    /// Suite that is part of the program; `geobench suites` lists them
    #[arg(help_heading = "What runs", long, value_name = "NAME", value_parser = EmbeddedSuite::named)]
    pub(crate) suite: Option<EmbeddedSuite>,

    #[command(flatten)]
    pub(crate) scale: ScaleOptions,

    #[command(flatten)]
    pub(crate) settings: Settings,

    #[command(flatten, next_help_heading = "Sources and targets")]
    pub(crate) far: FarOption,

    /// Cells that run at the same time; more than 1 disturbs the times, and tables and files say so
    #[arg(
        help_heading = "Processes",
        long,
        value_name = "N",
        allow_negative_numbers = true,
        default_value = "1"
    )]
    pub(crate) jobs: Whole<1, { MOST_THREADS as u64 }>,

    #[command(flatten, next_help_heading = "Processes")]
    pub(crate) isolation: IsolationOptions,

    /// Count the instructions of one solve of each cell under Valgrind, which takes some fifty
    /// times as long as the solve (row `instructions`)
    #[arg(help_heading = "Output", long)]
    pub(crate) instructions: bool,

    #[command(flatten, next_help_heading = "Output")]
    pub(crate) format: FormatOption<ResultFormat>,

    /// Result file, by its ending: .json, .csv, .md, .tex, .bmf.json (Bencher) or .gab.json
    /// (github-action-benchmark); may be repeated
    #[arg(help_heading = "Output", short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,

    #[command(flatten, next_help_heading = "Output")]
    pub(crate) csv_rows: CsvOptions,

    /// Journal that notes every run as it ends; runs that it holds are not repeated, so the same
    /// command continues where it was interrupted
    #[arg(help_heading = "Parts and continuation", long, value_name = "FILE")]
    pub(crate) resume: Option<PathBuf>,

    /// Result file (.json) to add to; it keeps its cells and gets the others of this run, and the
    /// timed runs that a cell lacks
    #[arg(
        help_heading = "Parts and continuation",
        long,
        value_name = "FILE",
        conflicts_with = "shard"
    )]
    pub(crate) add_to: Option<PathBuf>,

    /// Run only part I of N of the plan, such as 2/3; every machine splits alike, and `geobench
    /// merge` joins the parts
    #[arg(help_heading = "Parts and continuation", long, value_name = "I/N")]
    pub(crate) shard: Option<Shard>,

    #[command(flatten, next_help_heading = "Output")]
    pub(crate) quiet: QuietOption,

    /// Show no progress bar
    #[arg(help_heading = "Output", long)]
    pub(crate) no_progress: bool,
}

impl RunOptions {
    /// The files that are read for `plans`, those of these options: the suite, the models, and what
    /// options and suite name.
    fn input_files(&self, plans: &Plans) -> Vec<PathBuf> {
        let mut files = plans.input_files();
        files.extend(self.suite_file.config.clone());
        files.extend(self.isolation.ext.iter().cloned());
        files.sort();
        files.dedup();
        files
    }

    /// Number of cells that run at the same time.
    pub(crate) const fn jobs(&self) -> usize {
        self.jobs.0 as usize
    }

    /// The settings of the options, with the points of the files of sources and targets.
    fn settings(&self) -> anyhow::Result<Settings> {
        let mut settings = self.settings.clone();
        settings.source.read_sources(read_text)?;
        settings.goal.target.read_targets(read_text)?;
        self.far.apply(&mut settings.source, &mut settings.goal);
        if let Some(check) = &mut settings.check {
            check.get_mut().resolve(Path::new("")).context("--check")?;
        }
        Ok(settings)
    }
}

/// The suite file of a run.
#[derive(Args, Debug)]
pub(crate) struct SuiteFileOption {
    /// Suite file with models, algorithms and settings in groups; options override it
    #[arg(long, value_name = "SUITE.toml")]
    pub(crate) config: Option<PathBuf>,
}

/// Which models of a suite.
#[derive(Args, Debug)]
pub(crate) struct ScaleOptions {
    /// Directory of models that replace the stand-ins of the suite with the same names
    #[arg(
        help_heading = "What runs",
        long = "models",
        value_name = "DIR",
        requires = "which_suite",
        conflicts_with = "models"
    )]
    pub(crate) library: Option<PathBuf>,

    /// Run the suite in the sizes of the paper, which takes hours and a large machine
    #[arg(help_heading = "What runs", long, requires = "which_suite")]
    pub(crate) full: bool,
}

pub(crate) fn run(options: &RunOptions, look: Look) -> anyhow::Result<Verdict> {
    let limits = &options.settings.limits;
    options.isolation.check(options.jobs(), limits)?;
    let all = possible_plans(options)?;
    let (format, outputs) = self::outputs(options)?;
    // A file that is no journal is refused as one, so that `--resume` replaces nothing.
    let read = options
        .input_files(&all)
        .into_iter()
        .chain(options.resume.clone());
    let add_to = options.add_to.as_deref();
    let store = add_to.or_else(|| result_store::stored_file(&outputs));
    let store = store.map(Unfinished::prepare).transpose()?;
    check_files(outputs.iter().map(|(_, file)| file).chain(&store), read)?;
    let Plans { plans, notes, .. } = all;
    if options.instructions {
        instructions::check_valgrind()?;
    }
    if !host::is_release_build() && !options.quiet.is_set {
        terminal::warning(
            "this is not a release build: its times mean little (cargo run --release)",
        );
    }
    if !options.quiet.is_set {
        terminal::warnings(&notes);
    }
    options.isolation.listen()?;
    let plan = plan::record(&plans, options.isolation.record(options.jobs()));
    let session = session(options, &plans);
    let mut journal = None;
    let mut sessions = vec![session.clone()];
    if let Some(path) = &options.resume {
        let opened = open_journal(path, &plan, &session, options.quiet.is_set)?;
        sessions = opened.sessions().to_vec();
        journal = Some(opened);
    }
    let runs = plans.iter().map(Plan::runs).fold(0, usize::saturating_add);
    let earlier = add_to
        .map(|path| result_store::earlier(path, &plans, &session.programs))
        .transpose()?;
    let past = earlier.as_ref().map(Earlier::new);
    let mut listener = Reporter {
        progress: Progress::new(runs, !options.quiet.is_set && !options.no_progress),
        format,
        look,
        instructions: options.instructions,
        goal: GoalSpec::default(),
        decompressed: DecompressionLimit::default(),
        quiet: options.quiet.is_set,
        store: ResultStore::new(
            empty(plan, session, sessions),
            outputs,
            options.add_to.clone(),
        ),
    };
    let before = Snapshot::take(Path::new("/"));
    let mut verdicts = Vec::new();
    for plan in &plans {
        if listener.interrupted() {
            break;
        }
        listener.begin(plan)?;
        let backend = options.isolation.backend(plan.limits, false)?;
        let outcome = run::run(
            plan,
            &backend,
            journal.as_mut(),
            past.as_ref(),
            &mut listener,
            options.jobs(),
        )?;
        listener.end(&plan.group)?;
        let checked = plan.reference.is_required();
        verdicts.push(Tally::of(checked, &outcome.cells));
    }
    let mut conditions = conditions::between(&before, &Snapshot::take(Path::new("/")));
    conditions
        .warnings
        .extend(table::disturbance(&listener.store.result));
    let doubts = conditions.warnings.clone();
    // A file without conditions is that of a run that has not ended.
    listener.store.result.conditions = Some(conditions).filter(|_| !interrupt::requested());
    let whole = listener.write_all()?;
    let Reporter {
        progress, store, ..
    } = listener;
    drop(progress);
    let result = store.result;
    if format == ResultFormat::Table {
        terminal::print_rendered(&table::footnote(&result, look))?;
    } else {
        terminal::print_rendered(&format.render(&whole)?)?;
    }
    if !options.quiet.is_set {
        for doubt in &doubts {
            terminal::warning(&format!("times may be disturbed: {doubt}"));
        }
    }
    let verdict = verdict::of_cells(&verdicts);
    if interrupt::requested() {
        return Ok(interrupted(result.cells.len(), &plans));
    }
    Ok(verdict)
}

/// The verdict after a signal. Prints the number of finished cells.
fn interrupted(done: usize, plans: &[Plan]) -> Verdict {
    let all = cells(plans).map_or_else(String::new, |all| format!(" of {all}"));
    terminal::interrupted(&format!("interrupted: {done}{all} cells are done"));
    Verdict::Interrupted
}

/// Number of cells of all plans together. `None` if it depends on the models.
fn cells(plans: &[Plan]) -> Option<usize> {
    plans.iter().try_fold(0, |all: usize, plan| {
        Some(all.saturating_add(plan.cells()?))
    })
}

/// The plans of the suite file, with the settings of the options, which take precedence.
fn plans(options: &RunOptions) -> anyhow::Result<Plans> {
    let suite = match (&options.suite_file.config, options.suite) {
        (Some(config), _) => Some(Suite::read(config)?),
        (None, Some(suite)) => Some(suite.read()?),
        (None, None) => None,
    };
    let mut programs = options.isolation.programs()?;
    if let Some(suite) = &suite {
        programs = programs.or(&suite.programs);
    }
    let asked = options.settings()?;
    let library = options.scale.library.as_deref().map(Library::open);
    let scale = ModelChoice {
        full: options.scale.full,
        library: library.transpose().context("--models")?,
    };
    let mut plans = suite::plans(suite.as_ref(), &asked, &scale)?;
    for plan in &mut plans.plans {
        plan.find_programs(&programs)?;
    }
    Ok(plans)
}

/// The plans as they can be executed: without optional models that are missing, without limits that
/// cannot be enforced, and only the shard of this process. The notes tell what was changed.
///
/// # Errors
///
/// If a setting is invalid, or if there is nothing to run.
pub(crate) fn possible_plans(options: &RunOptions) -> anyhow::Result<Plans> {
    let Plans {
        mut plans,
        mut notes,
        point_files,
    } = plans(options)?;
    if plans.is_empty() {
        bail!("there is nothing to run: {}", notes.join("; "));
    }
    let algorithms = || plans.iter().flat_map(|plan| &plan.algorithms);
    let runs = |name: &str| algorithms().any(|algorithm| algorithm.label() == name);
    for base in plans.iter().filter_map(|p| p.group.ratios_to.as_deref()) {
        let problem = format!("no ratios to `{base}`, for it is not among the algorithms that run");
        if runs(base) || notes.contains(&problem) {
            continue;
        }
        if options.settings.ratios_to.is_some() {
            bail!("{problem}; name it in --algo");
        }
        // The suite requests ratios to an algorithm that the options leave out. That is no error.
        notes.push(problem);
    }
    notes.extend(options.isolation.crowding(algorithms(), options.jobs()));
    if !options.isolation.keeps_limits() {
        drop_limits(&mut plans, &mut notes);
    }
    if let Some(shard) = options.shard {
        plan::restrict(&mut plans, shard);
        if plans.iter().all(|plan| plan.runs() == 0) {
            notes.push(format!(
                "part {shard} has nothing to do: there are fewer pairs of model and source than parts"
            ));
        }
    }
    Ok(Plans {
        plans,
        notes,
        point_files,
    })
}

/// Removes limits of time and memory, which need process isolation. Adds a note for each group with
/// limits other than the default.
fn drop_limits(plans: &mut [Plan], notes: &mut Vec<String>) {
    for plan in plans {
        let Limits {
            timeout, memory, ..
        } = plan.limits;
        let wants_time = timeout.0.is_some() && timeout != Timeout::USUAL;
        if wants_time || memory.0.is_some() {
            let group = plan.group.name.as_deref().unwrap_or_default();
            notes.push(format!(
                "group `{group}`: without --isolate process nothing keeps its limits of time and memory"
            ));
        }
        plan.limits = Limits {
            decompressed: plan.limits.decompressed,
            ..Limits::default()
        };
    }
}

/// The format of standard output, and the files to write with their formats. An output `-` sets the
/// format of standard output. The file of `--add-to` is among the files.
fn outputs(
    options: &RunOptions,
) -> anyhow::Result<(ResultFormat, Vec<(ResultFormat, OutputFile)>)> {
    let mut format = options.csv_rows.of(options.format.chosen());
    let mut outputs = options.csv_rows.outputs(&options.output)?;
    outputs.retain(|(form, file)| {
        let to_file = !file.is_standard_output();
        if !to_file {
            format = *form;
        }
        to_file
    });
    if let Some(path) = &options.add_to {
        let file = OutputFile::prepare(path)?;
        if file.is_standard_output() {
            bail!("--add-to -: a result file grows; name one");
        }
        if !file.is_replaced() {
            bail!("--add-to {}: not a regular file", path.display());
        }
        outputs.push((ResultFormat::Json, file));
    }
    Ok((format, outputs))
}

/// A result file of `plan` without cells. `session`, that of this process, is the last of
/// `sessions`.
fn empty(plan: PlanRecord, session: SessionRecord, sessions: Vec<SessionRecord>) -> ResultFile {
    ResultFile {
        schema: SCHEMA.to_owned(),
        tool: host::tool(),
        host: session.host,
        command: session.command,
        started: sessions[0].started.clone(),
        finished: session.started,
        isolation: Some(plan.isolation.clone()),
        groups: Vec::new(),
        models: Vec::new(),
        cells: Vec::new(),
        pairing: None,
        conditions: None,
        plan: Some(plan),
        repository: git::repository(),
        algorithms: Vec::new(),
        sessions,
    }
}

/// The session record of this process.
fn session(options: &RunOptions, plans: &[Plan]) -> SessionRecord {
    SessionRecord {
        shard: options.shard,
        host: host::host(),
        command: std::env::args_os()
            .map(|word| word.to_string_lossy().into_owned())
            .collect(),
        started: host::now(),
        finished: None,
        tool: None,
        programs: plan::programs(plans),
    }
}

/// Opens the journal. Warns, unless `quiet`, if some of its sessions ran on another machine.
fn open_journal(
    path: &Path,
    plan: &PlanRecord,
    session: &SessionRecord,
    quiet: bool,
) -> anyhow::Result<Journal> {
    if path == Path::new("-") {
        bail!("--resume -: a journal is a file; name one");
    }
    let header = JournalHeader::new(host::tool(), plan.clone());
    let journal = Journal::open(path, &header, session)?;
    let elsewhere = |earlier: &SessionRecord| !session.host.is_same_machine(&earlier.host);
    if !quiet && journal.sessions().iter().any(elsewhere) {
        terminal::warning(&format!(
            "journal {}: some of its runs were made on another machine; their times do not compare with those of this one",
            path.display()
        ));
    }
    Ok(journal)
}
