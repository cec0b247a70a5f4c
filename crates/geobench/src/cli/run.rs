//! `geobench run`.

use std::path::Path;

use anyhow::{Context, bail};

use super::Verdict;
use super::args::RunOptions;
use super::progress::Progress;
use super::reporter::{Reporter, now};
use super::terminal::{self, Terminal};
use crate::exec::Listener;
use crate::exec::interrupt;
use crate::exec::isolate::Sharing;
use crate::exec::limits::{Limits, Timeout};
use crate::measure::conditions::{self, Snapshot};
use crate::measure::host;
use crate::measure::instructions;
use crate::plan::suite::{self, Library, Plans, Scale, Settings, Suite, WantedModel};
use crate::plan::{self, Plan, Reference};
use crate::run;
use crate::run::journal::{Header, Journal};
use crate::schema::{Cell, Host, PlanRecord, ResultFile, SCHEMA, SessionRecord, Status};
use crate::table::output::{self, OutputFile};
use crate::table::{self, Format};

pub(super) fn run(options: &RunOptions, terminal: Terminal) -> anyhow::Result<Verdict> {
    options.isolation.check()?;
    let Plans { plans, notes } = possible_plans(options)?;
    let outputs = output::results(&options.output)?;
    if options.extras.instructions {
        instructions::check_valgrind()?;
    }
    if !host::is_release_build() && !options.quiet {
        terminal::warning(
            "this is not a release build: its times mean little (cargo run --release)",
        );
    }
    if !options.quiet {
        for note in &notes {
            terminal::warning(note);
        }
    }
    interrupt::listen().context("cannot listen to signals")?;
    let plan = plan::record(&plans, options.isolation.record());
    let session = session(options);
    let mut journal = None;
    let mut sessions = vec![session.clone()];
    if let Some(path) = &options.resume {
        let opened = open_journal(path, &outputs, &plan, &session, options.quiet)?;
        sessions = opened.sessions().to_vec();
        journal = Some(opened);
    }
    let runs = plans.iter().map(Plan::runs).fold(0, usize::saturating_add);
    let mut listener = Reporter {
        progress: Progress::new(runs, !options.quiet && !options.no_progress),
        format: options.format,
        terminal,
        instructions: options.extras.instructions,
        quiet: options.quiet,
        outputs,
        result: ResultFile {
            schema: SCHEMA.to_owned(),
            tool: host::tool(),
            host: session.host,
            command: session.command,
            started: sessions[0].started.clone(),
            finished: session.started,
            isolation: Some(options.isolation.record()),
            groups: Vec::new(),
            models: Vec::new(),
            cells: Vec::new(),
            pairing: None,
            conditions: None,
            plan: Some(plan),
            sessions,
        },
    };
    let before = Snapshot::take(Path::new("/"));
    let mut verdicts = Vec::new();
    for plan in &plans {
        if listener.interrupted() {
            break;
        }
        listener.begin(plan)?;
        let mut backend = options.isolation.backend(plan.limits, Sharing::None)?;
        let outcome = run::run(plan, &mut *backend, journal.as_mut(), &mut listener)?;
        listener.end(&plan.group)?;
        let checked = !matches!(plan.reference, Reference::None);
        verdicts.push(Tally::of(checked, &outcome.cells));
    }
    let conditions = conditions::between(&before, &Snapshot::take(Path::new("/")));
    let doubts = conditions.warnings.clone();
    listener.result.conditions = Some(conditions);
    listener.store_all()?;
    let Reporter {
        progress, result, ..
    } = listener;
    drop(progress);
    if options.format == Format::Table {
        terminal::print_rendered(&table::footnote(&result, terminal.styled))?;
    } else {
        terminal::print_rendered(&options.format.render(&result)?)?;
    }
    if !options.quiet {
        for doubt in &doubts {
            terminal::warning(&format!("times may be disturbed: {doubt}"));
        }
    }
    let verdict = verdict(&verdicts);
    if interrupt::requested() {
        let (done, all) = (result.cells.len(), cells(&plans));
        terminal::error(&format!("interrupted: {done} of {all} cells are done"));
        return Ok(Verdict::Interrupted);
    }
    Ok(verdict)
}

/// Number of cells of all plans together, as far as it can be counted.
fn cells(plans: &[Plan]) -> usize {
    let cells = plans.iter().map(|plan| plan.runs() / plan.runs_per_cell());
    cells.fold(0, usize::saturating_add)
}

/// Counts of the cells of a plan by result.
pub(super) struct Tally {
    cells: usize,
    failed: usize,
    refused: usize,
}

impl Tally {
    /// Counts cells. A cell that was to be checked and could not be has failed.
    pub(super) fn of<'c>(checked: bool, cells: impl IntoIterator<Item = &'c Cell>) -> Self {
        let mut tally = Self {
            cells: 0,
            failed: 0,
            refused: 0,
        };
        for cell in cells {
            tally.cells += 1;
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

/// The verdict on all cells: failures come before unusable input.
pub(super) fn verdict(tallies: &[Tally]) -> Verdict {
    let sum = |of: fn(&Tally) -> usize| tallies.iter().map(of).sum::<usize>();
    let failed = sum(|tally| tally.failed);
    if failed > 0 {
        terminal::error(&format!(
            "{failed} of {} cells failed or could not be checked",
            sum(|tally| tally.cells)
        ));
        Verdict::Failed
    } else if sum(|tally| tally.refused) > 0 {
        Verdict::BadInput
    } else {
        Verdict::Passed
    }
}

/// The plans of the suite file and the options.
fn plans(options: &RunOptions) -> anyhow::Result<Plans> {
    let suite = options.config.as_deref().map(Suite::read).transpose()?;
    let mut programs = options.isolation.programs()?;
    if let Some(suite) = &suite {
        programs = programs.or(&suite.programs);
    }
    let asked = Settings {
        models: (!options.models.is_empty())
            .then(|| options.models.iter().map(|m| WantedModel::new(m)).collect()),
        algorithms: options.algo.clone().map(|algorithms| algorithms.0),
        sources: options.source.clone(),
        repeat: options.repeat,
        warmup: options.warmup,
        tolerance: options.tolerance,
        seed: options.seed,
        threads: options.threads,
        timeout: options.isolation.timeout,
        memory_limit: options.isolation.memory_limit,
        max_decompressed: options.isolation.decompression.max_decompressed,
        reference: options
            .check
            .as_deref()
            .map(|check| Reference::parse(check, Path::new("")))
            .transpose()
            .context("--check")?,
        rows: options.rows.clone(),
        ratios_to: options.ratios_to.as_ref().map(|one| one.label().to_owned()),
        wavefront: options.extras.wavefront.then_some(true),
    };
    let scale = Scale {
        full: options.scale.full,
        library: options
            .scale
            .library
            .as_deref()
            .map(Library::open)
            .transpose()
            .context("--models")?,
    };
    let mut plans = suite::plans(suite.as_ref(), &asked, &scale)?;
    for plan in &mut plans.plans {
        plan.find_programs(&programs)?;
    }
    Ok(plans)
}

/// The plans, with notes on what is left out.
fn possible_plans(options: &RunOptions) -> anyhow::Result<Plans> {
    let Plans {
        mut plans,
        mut notes,
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
        if options.ratios_to.is_some() {
            bail!("{problem}; name it in --algo");
        }
        // The suite asks for ratios to an algorithm that the options leave out.
        notes.push(problem);
    }
    notes.extend(options.isolation.crowding(algorithms()));
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
    Ok(Plans { plans, notes })
}

/// Removes limits that this isolation cannot keep, with a note if the user asked for them.
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

/// The record of this process.
fn session(options: &RunOptions) -> SessionRecord {
    SessionRecord {
        shard: options.shard,
        host: host::host(),
        command: std::env::args_os()
            .map(|word| word.to_string_lossy().into_owned())
            .collect(),
        started: now(),
        finished: None,
    }
}

/// Opens the journal and prints how many runs it holds.
fn open_journal(
    path: &Path,
    outputs: &[(Format, OutputFile)],
    plan: &PlanRecord,
    session: &SessionRecord,
    quiet: bool,
) -> anyhow::Result<Journal> {
    if outputs
        .iter()
        .any(|(_, file)| file.path() == output::canonical(path))
    {
        bail!("{}: cannot be both journal and result file", path.display());
    }
    let header = Header::new(host::tool(), plan.clone());
    let journal = Journal::open(path, &header, session)?;
    let elsewhere = |earlier: &SessionRecord| {
        let machine = |host: &Host| (host.cpu.clone(), host.cores, host.memory_bytes);
        machine(&earlier.host) != machine(&session.host)
    };
    if !quiet && journal.sessions().iter().any(elsewhere) {
        terminal::warning(&format!(
            "journal {}: some of its runs were made on another machine; their times do not compare with those of this one",
            path.display()
        ));
    }
    Ok(journal)
}
