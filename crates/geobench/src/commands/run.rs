//! `geobench run`.

use clap::{ArgGroup, Args};
use geobench_registry::MOST_THREADS;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use anyhow::{Context, bail};
use geobench_export::output::{self, OutputFile, check_files};
use geobench_harness::exec::goal::GoalSpec;
use geobench_harness::exec::limits::{DecompressionLimit, Limits, Timeout};
use geobench_harness::exec::{InstructionCounter, Listener, Step, interrupt};
use geobench_harness::measure::conditions::{self, Snapshot};
use geobench_harness::measure::{host, instructions};
use geobench_harness::plan::suite::{
    self, EmbeddedSuite, Library, ModelChoice, Plans, Settings, Suite, options::Whole,
};
use geobench_harness::plan::{self, Plan};
use geobench_harness::run::journal::{Journal, JournalHeader};
use geobench_harness::run::{self, Earlier, agreement};
use geobench_harness::schema::{
    Cell, GroupRecord, ModelRecord, PlanRecord, ResultFile, SCHEMA, SessionRecord, Shard,
    SourceLabel, Status, result_file, unfinished::Unfinished,
};
use geobench_harness::usage::read_text;
use geobench_report::history::join::{self, Joined};
use geobench_report::table::{self, Look, ResultFormat};

use crate::args::{CsvOptions, FormatOption, MODELS_HELP, QuietOption};
use crate::git;
use crate::isolation::IsolationOptions;
use crate::points::FarOption;
use crate::progress::Progress;
use crate::terminal;
use crate::verdict::Verdict;

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

    /// Count the instructions of one solve of each cell under Valgrind, which takes some fifty times
    /// as long as the solve (row `instructions`)
    #[arg(help_heading = "Output", long)]
    pub(crate) instructions: bool,

    #[command(flatten, next_help_heading = "Output")]
    pub(crate) format: FormatOption<ResultFormat>,

    /// Result file, by its ending: .json, .csv, .md or .tex; may be repeated
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
    pub(crate) fn input_files(&self, plans: &Plans) -> Vec<PathBuf> {
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

    /// The settings of the options, with the targets of the targets file.
    fn settings(&self) -> anyhow::Result<Settings> {
        let mut settings = self.settings.clone();
        settings.goal.read_targets(read_text)?;
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

/// The output beside which the results so far are stored: the first file of results, which the store
/// then completes for every command that reads it, else the first file.
fn stored_file(outputs: &[(ResultFormat, OutputFile)]) -> Option<&Path> {
    let files = || outputs.iter().filter(|(_, file)| file.is_replaced());
    let results = files().find(|(format, _)| *format == ResultFormat::Json);
    results
        .or_else(|| files().next())
        .map(|(_, file)| file.path())
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
    let store = stored_file(&outputs).filter(|_| options.add_to.is_none());
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
    let session = session(options);
    let mut journal = None;
    let mut sessions = vec![session.clone()];
    if let Some(path) = &options.resume {
        if path == Path::new("-") {
            bail!("--resume -: a journal is a file; name one");
        }
        let opened = open_journal(path, &plan, &session, options.quiet.is_set)?;
        sessions = opened.sessions().to_vec();
        journal = Some(opened);
    }
    let runs = plans.iter().map(Plan::runs).fold(0, usize::saturating_add);
    let add_to = options.add_to.as_deref();
    let earlier = add_to.map(|path| earlier(path, &plans)).transpose()?;
    let past = earlier.as_ref().map(Earlier::new);
    let mut listener = Reporter {
        add_to: options.add_to.clone(),
        progress: Progress::new(runs, !options.quiet.is_set && !options.no_progress),
        format,
        look,
        instructions: options.instructions,
        goal: GoalSpec::default(),
        decompressed: DecompressionLimit::default(),
        quiet: options.quiet.is_set,
        outputs,
        result: empty(plan, session, sessions),
        unfinished: None,
        write_due: WriteDue::default(),
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
        .extend(table::disturbance(&listener.result));
    let doubts = conditions.warnings.clone();
    // A file without conditions is that of a run that has not ended.
    listener.result.conditions = Some(conditions).filter(|_| !interrupt::requested());
    let whole = listener.store_all()?;
    let Reporter {
        progress, result, ..
    } = listener;
    drop(progress);
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
    let verdict = verdict(&verdicts);
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

/// Counts of the cells of a plan by result.
pub(crate) struct Tally {
    cells: usize,
    failed: usize,
    refused: usize,
    /// Whether a reference is proven wrong, which may have no cell.
    has_wrong_reference: bool,
}

impl Tally {
    /// Counts `cells` by result. If they are `checked`, a cell without a comparison counts as
    /// failed.
    pub(crate) fn of<'c>(checked: bool, cells: impl IntoIterator<Item = &'c Cell>) -> Self {
        let mut tally = Self {
            cells: 0,
            failed: 0,
            refused: 0,
            has_wrong_reference: false,
        };
        for cell in cells {
            tally.cells += 1;
            tally.has_wrong_reference |= cell.check.replaced.is_some();
            match cell.status {
                Status::Ok => {
                    tally.failed += usize::from(checked && cell.check.reference.is_none());
                }
                Status::Refused => tally.refused += 1,
                _ => tally.failed += 1,
            }
        }
        tally
    }
}

/// The verdict on all cells. Failed cells take precedence over refused models. Prints the number of
/// failed cells.
pub(crate) fn verdict(tallies: &[Tally]) -> Verdict {
    let sum = |of: fn(&Tally) -> usize| tallies.iter().map(of).sum::<usize>();
    let failed = sum(|tally| tally.failed);
    if failed > 0 {
        terminal::error(&format!(
            "{failed} of {} cells failed or could not be checked",
            sum(|tally| tally.cells)
        ));
        Verdict::Failed
    } else if tallies.iter().any(|tally| tally.has_wrong_reference) {
        terminal::error("a reference is proven wrong");
        Verdict::Failed
    } else if sum(|tally| tally.refused) > 0 {
        Verdict::BadInput
    } else {
        Verdict::Passed
    }
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
        targets_files,
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
        targets_files,
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
fn session(options: &RunOptions) -> SessionRecord {
    SessionRecord {
        shard: options.shard,
        host: host::host(),
        command: std::env::args_os()
            .map(|word| word.to_string_lossy().into_owned())
            .collect(),
        started: now(),
        finished: None,
        tool: None,
    }
}

/// Reads the file of `--add-to`.
///
/// # Errors
///
/// If the file cannot be read, or if results of `plans` cannot be combined with it: it is from
/// another machine and times would be added, it is a part of a benchmark, or it has other goals or
/// vector instructions.
fn earlier(path: &Path, plans: &[Plan]) -> anyhow::Result<ResultFile> {
    let name = path.display().to_string();
    let file = result_file::read(path)?;
    let here = host::host();
    let times_nothing = || {
        let known = Earlier::new(&file);
        plans.iter().all(|plan| run::is_known(plan, &known))
    };
    if !here.is_same_machine(&file.host) && !times_nothing() {
        bail!(
            "{name}: from another machine, so that times added here would not compare: {} and not {}",
            file.host.in_words(),
            here.in_words()
        );
    }
    if file.plan.as_ref().is_some_and(|plan| plan.shard.is_some()) {
        bail!("{name}: a part of a benchmark; join the parts with `geobench merge` first");
    }
    for plan in plans {
        let of_group = |cell: &&Cell| cell.group == plan.group.name;
        let goal = plan.goal.label();
        let mut cells = file.cells.iter().filter(of_group);
        if let Some(cell) = cells.find(|cell| cell.goal != goal) {
            let word = |goal: Option<String>| goal.unwrap_or_else(|| "to all vertices".to_owned());
            bail!(
                "{name}: its runs are {}, and this one {}; give the same --target and --radius or \
                 name another file",
                word(cell.goal.clone()),
                word(goal)
            );
        }
        for algorithm in &plan.algorithms {
            let label = algorithm.label();
            let of_same = |cell: &&Cell| cell.group == plan.group.name && cell.algorithm == label;
            let found = file
                .cells
                .iter()
                .filter(of_same)
                .find(|cell| cell.simd.is_some());
            if let Some(cell) = found.filter(|cell| cell.simd != algorithm.simd()) {
                let [there, here] = [cell.simd.clone(), algorithm.simd()];
                let word = |simd: Option<String>| simd.unwrap_or_else(|| "no choice of".to_owned());
                bail!(
                    "{name}: its cells of {label} have {} instructions, and this run {}; give the \
                     same --simd or name another file",
                    word(there),
                    word(here)
                );
            }
        }
    }
    Ok(file)
}

/// Opens the journal. Warns, unless `quiet`, if some of its sessions ran on another machine.
fn open_journal(
    path: &Path,
    plan: &PlanRecord,
    session: &SessionRecord,
    quiet: bool,
) -> anyhow::Result<Journal> {
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

/// Shows progress, and prints and stores the results of each finished model, so that a killed run
/// loses only unfinished models.
pub(crate) struct Reporter {
    pub(crate) progress: Progress,
    pub(crate) format: ResultFormat,
    pub(crate) look: Look,
    /// Whether to count instructions.
    pub(crate) instructions: bool,
    /// The goal of the runs of the current group.
    pub(crate) goal: GoalSpec,
    /// The limit of decompression of the current group.
    pub(crate) decompressed: DecompressionLimit,
    /// Whether to suppress the warnings about successful cells and about the earlier file.
    pub(crate) quiet: bool,
    pub(crate) outputs: Vec<(ResultFormat, OutputFile)>,
    pub(crate) result: ResultFile,
    /// The file of `--add-to`. Other processes may add to it meanwhile.
    pub(crate) add_to: Option<PathBuf>,
    /// The models that have ended, for when this process is killed.
    unfinished: Option<Unfinished>,
    write_due: WriteDue,
}

/// When the results so far are written to the output files: each time that they have grown by a
/// quarter, so that all writes together take linear time, and at least once a minute, unless a write
/// itself takes long.
#[derive(Debug, Default)]
struct WriteDue {
    /// Number of cells at the last write, and its end and duration.
    last: Option<(usize, Instant, Duration)>,
}

impl WriteDue {
    const MOST_AGE: Duration = Duration::from_secs(60);

    /// Whether results with this number of cells are to be written now.
    fn now(&self, cells: usize) -> bool {
        self.last.is_none_or(|(known, end, took)| {
            4 * cells >= 5 * known || end.elapsed() >= Self::MOST_AGE.max(100 * took)
        })
    }

    /// Notes a write that began at `start`.
    fn done(&mut self, cells: usize, start: Instant) {
        self.last = Some((cells, Instant::now(), start.elapsed()));
    }
}

impl Reporter {
    /// Starts the group of `plan`: adds its record and prints its heading.
    pub(crate) fn begin(&mut self, plan: &Plan) -> anyhow::Result<()> {
        let Limits {
            timeout,
            memory,
            decompressed,
        } = plan.limits;
        self.decompressed = decompressed;
        self.goal.clone_from(&plan.goal);
        self.result.groups.push(GroupRecord {
            timeout: timeout.0.map(|time| time.as_secs_f64()),
            memory_limit: memory.0,
            ..plan.group.clone()
        });
        // A shard may have no cells of a group.
        if plan.runs() == 0 {
            return Ok(());
        }
        let look = self.look;
        self.show(&table::group_heading(&plan.group, look))
    }

    /// Ends a group: prints its table of ratios.
    pub(crate) fn end(&mut self, group: &GroupRecord) -> anyhow::Result<()> {
        let look = self.look;
        self.show(&table::ratio_table(group, &self.result, look))?;
        self.show(&table::matrix_table(group, &self.result, look))
    }

    /// Prints text of a table above the progress, if the format of standard output is a table.
    fn show(&mut self, text: &str) -> anyhow::Result<()> {
        if self.format == ResultFormat::Table && !text.is_empty() {
            self.progress.suspend(|| terminal::print_rendered(text))?;
        }
        Ok(())
    }

    /// Puts a model that has ended into the store, and writes the results so far to all regular
    /// files if that is due. A failed write causes a warning only, because `store_all` writes again.
    fn store(&mut self, model: &ModelRecord, cells: &[Cell]) -> anyhow::Result<()> {
        self.note_time();
        if self.unfinished.is_none()
            // Other processes extend the file of `--add-to` as well.
            && self.add_to.is_none()
            && let Some(path) = stored_file(&self.outputs)
        {
            self.unfinished = Unfinished::create(path, &self.result).ok();
        }
        let store = self.unfinished.as_mut();
        let stored = store.map(|store| store.add(&self.result.groups, model, cells));
        let is_stored = matches!(stored, Some(Ok(())));
        if is_stored && !self.write_due.now(self.result.cells.len()) {
            return Ok(());
        }
        let start = Instant::now();
        let warn = |progress: &mut Progress, error: &anyhow::Error| {
            let text = format!("{error:#}; it will be tried again");
            progress.suspend(|| terminal::warning(&text));
        };
        let (whole, _lock) = match self.whole() {
            Ok((joined, lock)) => (joined.file, lock),
            Err(error) => {
                warn(&mut self.progress, &error);
                return Ok(());
            }
        };
        for (format, file) in self.outputs.iter().filter(|(_, file)| file.is_replaced()) {
            if let Err(error) = file.write(format.render(&whole)?.as_bytes()) {
                warn(&mut self.progress, &error);
            }
        }
        self.write_due.done(self.result.cells.len(), start);
        Ok(())
    }

    /// Writes the final results, with those of the file of `--add-to`, to all files, and returns
    /// them.
    ///
    /// # Errors
    ///
    /// If one of them cannot be written, or that of `--add-to` not read. The results are then saved
    /// in a temporary file, which the error names.
    pub(crate) fn store_all(&mut self) -> anyhow::Result<ResultFile> {
        self.note_time();
        let mut failed = Vec::new();
        let (Joined { file: whole, notes }, _lock) = match self.whole() {
            Ok(whole) => whole,
            Err(error) => {
                let rescued = rescue(&ResultFormat::Json.render(&self.result)?);
                bail!("{error:#}; {rescued}");
            }
        };
        if !self.quiet {
            self.progress.suspend(|| terminal::warnings(&notes));
        }
        for (format, file) in &self.outputs {
            if let Err(error) = file.write(format.render(&whole)?.as_bytes()) {
                failed.push(format!("{error:#}"));
            }
        }
        if failed.is_empty() {
            if let Some(store) = self.unfinished.take() {
                store.remove();
            }
            return Ok(whole);
        }
        let rescued = rescue(&ResultFormat::Json.render(&whole)?);
        bail!("{}; {rescued}", failed.join("; "));
    }

    /// The results so far, together with those that the file of `--add-to` has now. While the lock
    /// is kept, no other process adds to that file.
    fn whole(&self) -> anyhow::Result<(Joined, Option<File>)> {
        let new = self.result.clone();
        let Some(path) = &self.add_to else {
            let notes = Vec::new();
            return Ok((Joined { file: new, notes }, None));
        };
        let name = path.display().to_string();
        let lock = output::lock(path).with_context(|| format!("{name}: cannot be locked"))?;
        let mut file = result_file::read(path)?;
        // Each write after the first finds what this run has written before.
        let is_own = |session: &SessionRecord| {
            let mut of_new = new.sessions.iter();
            of_new.any(|own| (&own.started, &own.command) == (&session.started, &session.command))
        };
        file.sessions.retain(|session| !is_own(session));
        let joined = join::extend((&name, file), ("this run", new))?;
        Ok((joined, Some(lock)))
    }

    /// Sets the end time of the results and of this session to now.
    fn note_time(&mut self) {
        self.result.finished = now();
        if let Some(session) = self.result.sessions.last_mut() {
            session.finished = Some(self.result.finished.clone());
        }
    }
}

impl Listener for Reporter {
    fn loading(&mut self, model: &str) {
        self.progress.loading(model);
    }

    fn step(&mut self, step: &Step<'_>) {
        self.progress.step(step);
    }

    fn ran(&mut self, step: &Step<'_>, outcome: Result<Option<f64>, Status>) {
        self.progress.ran(step, outcome);
    }

    fn instruction_counter(
        &mut self,
        model: &ModelRecord,
        cell: &Cell,
    ) -> Option<InstructionCounter> {
        // Valgrind cannot separate the solve of an external program from the rest of its work.
        if !self.instructions || cell.algorithm.starts_with("ext:") {
            return None;
        }
        self.progress
            .counting_instructions(&model.name, &cell.algorithm);
        let source = cell.source.as_ref()?.to_string();
        let simd = cell.simd.as_ref().and_then(|simd| simd.parse().ok());
        let mut options = self.goal.options();
        if let Some(bytes) = self.decompressed.0 {
            options.push(format!("--max-decompressed={bytes}"));
        }
        if let Some(tolerance) = model.weld {
            options.push(format!("--weld={tolerance:?}"));
        }
        Some(Box::new(move |model, cell| {
            let (path, algorithm) = (&model.path, &cell.algorithm);
            let is_stopped = interrupt::requested;
            instructions::count(path, algorithm, &source, &options, simd, is_stopped)
        }))
    }

    fn not_counted(&mut self, cell: &Cell, error: &anyhow::Error) {
        let source = cell.source.as_ref().map(SourceLabel::to_string);
        let text = format!(
            "{}: {}, source {}: instructions are not counted: {error:#}",
            cell.model,
            cell.algorithm,
            source.unwrap_or_default()
        );
        self.progress.suspend(|| terminal::warning(&text));
    }

    fn more(&mut self, runs: usize) {
        self.progress.more(runs);
    }

    fn skipped(&mut self, runs: usize) {
        self.progress.skip(runs);
    }

    fn model_done(&mut self, model: &ModelRecord, cells: &[Cell]) -> anyhow::Result<()> {
        if self.result.models.iter().all(|m| m.name != model.name) {
            self.result.models.push(model.clone());
            if !self.quiet {
                let notes = || terminal::notes_on(&model.name, &model.notes);
                self.progress.suspend(notes);
            }
        }
        self.result.cells.extend_from_slice(cells);
        // Whatever happens to standard output, the files have the cells.
        self.store(model, cells)?;
        self.progress.ended(&model.name, cells);
        self.progress.suspend(|| {
            remark(cells, self.format, self.quiet);
            for summary in agreement::summaries(cells) {
                terminal::error(&summary);
            }
            if let (ResultFormat::Table, Some(group)) = (self.format, self.result.groups.last()) {
                let look = self.look;
                let mut text = table::model_table(group, model, cells, look);
                // The last column stays free, because some terminals wrap a line that fills it.
                let width = look.width.map(|width| width.saturating_sub(1));
                text += &width.map_or_else(String::new, |width| {
                    table::model_bars(group, model, cells, width)
                });
                terminal::print_rendered(&text)?;
            }
            Ok(())
        })
    }

    fn interrupted(&self) -> bool {
        interrupt::requested()
    }
}

/// Prints the messages of cells to standard error: each refusal once, failures, and, unless
/// `quiet`, messages of successful cells. For tables only refusals and where positions were found
/// are printed.
fn remark(cells: &[Cell], format: ResultFormat, quiet: bool) {
    let mut refusals = Vec::new();
    let mut last_place = None;
    let is_position = |cell: &Cell| match &cell.source {
        Some(SourceLabel::Other(text)) => text.contains("at:") || text.contains("far:"),
        _ => false,
    };
    for cell in cells {
        let Some(message) = &cell.message else {
            continue;
        };
        match cell.status {
            Status::Refused if !refusals.contains(&message) => {
                terminal::error(message);
                refusals.push(message);
            }
            Status::Refused => {}
            Status::Ok if format == ResultFormat::Table && !quiet && is_position(cell) => {
                let place = Some((&cell.model, message));
                if last_place != place {
                    terminal::notes_on(&cell.model, std::slice::from_ref(message));
                    last_place = place;
                }
            }
            // Tables have these messages in their notes.
            _ if format == ResultFormat::Table => {}
            status => {
                let source = cell.source.clone().unwrap_or(SourceLabel::Vertex(0));
                let place = format!("{}: {}, source {source}", cell.model, cell.algorithm);
                match status {
                    Status::Ok if quiet => {}
                    Status::Ok => terminal::warning(&format!("{place}: {message}")),
                    _ => terminal::error(&format!("{place}: {}: {message}", status.name())),
                }
            }
        }
    }
}

/// Saves results in a temporary file after writing them elsewhere has failed. Returns a message
/// with the path, or with the error.
fn rescue(json: &str) -> String {
    let save = || -> std::io::Result<std::path::PathBuf> {
        let mut file = tempfile::Builder::new()
            .prefix("geobench-")
            .suffix(".json")
            .tempfile()?;
        file.write_all(json.as_bytes())?;
        Ok(file.keep()?.1)
    };
    match save() {
        Ok(path) => format!("the results are in {}", path.display()),
        Err(error) => format!("nor could the results be saved as a temporary file: {error}"),
    }
}

/// The current time, RFC 3339 in UTC; the first second of 1970 if the clock is before it.
pub(crate) fn now() -> String {
    let now = SystemTime::now().max(SystemTime::UNIX_EPOCH);
    humantime::format_rfc3339_seconds(now).to_string()
}
