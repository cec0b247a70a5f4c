//! Searches for meshes on which an algorithm is wrong.
//!
//! `cargo run --release -p geobench-oracle --example fuzz -- --seeds 0..10000 --algo all`
//!
//! Each seed makes a mesh ([`geobench_oracle::nasty`]), of the kinds that `--kinds` names. Every
//! algorithm of the registry solves it, with every value of its parameters that keeps it exact. The
//! oracle, in double-double, judges the distances. With its defaults, each algorithm also traces
//! paths, and solves the mesh after a change that must not change distances
//! ([`geobench_oracle::Transform`]). The certificate must not prove wrong distances. On the kinds
//! that are built, the windows of algorithms that take the nearest first are limited.
//!
//! Large meshes, on which the oracle gives up, are judged by the certificate, or, if it proves
//! nothing, by the distances on which most of the faster algorithms agree.
//!
//! A line names each kind of failure of a mesh. A failing mesh is made smaller and saved as a file
//! for `geobench verify` (`--out`). The exit status is 1 if anything failed.

use std::collections::{HashMap, HashSet};
use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use std::{env, io, thread};

use case::{Expected, FailureKind, Verdict};
use child::Judge;
use clap::{ArgGroup, Parser};
use files::AlgorithmFailure;
use items::{Item, Items, Kinds};
use minimise::Smallest;
use table::Table;

mod case;
mod child;
mod files;
mod items;
mod judge;
#[path = "../../../paths/tests/judged/path.rs"]
mod judged;
mod minimise;
mod slivers;
mod table;
mod variants;

/// Searches for meshes on which an algorithm is wrong.
#[derive(Parser)]
#[command(group(ArgGroup::new("meshes").args(["seeds", "slivers", "again"])))]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a switch of the command line"
)]
struct Options {
    /// Seeds of the meshes, from A up to but without B
    #[arg(long, value_name = "A..B", default_value = "0..1000", value_parser = seeds)]
    seeds: Range<u64>,

    /// Take the meshes and distances of shared/slivers instead
    #[arg(long)]
    slivers: bool,

    /// Take the meshes of these OBJ files, or folders of them, as --out saves them
    #[arg(long, value_name = "PATH", num_args = 1..)]
    again: Vec<PathBuf>,

    /// Kinds of meshes, each with all seeds, separated by commas: a name, or a set of kinds, which
    /// the seeds take in turn: general, built, large
    #[arg(long, alias = "kind", value_name = "LIST", default_value = "general",
        value_delimiter = ',', value_parser = items::kinds)]
    kinds: Vec<Kinds>,

    /// Algorithms by name, by family, or all; separated by commas. With parameters, as
    /// name{key=value,...}, the item means just that; else all variants that are exact. The item
    /// certificate proves the distances of mmp; all includes it
    #[arg(long, value_name = "LIST", default_value = "all")]
    algo: String,

    /// Do not add variants to what --algo names
    #[arg(long)]
    plain: bool,

    /// Save meshes on which something fails to this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Save at most so many meshes for each algorithm and way to fail
    #[arg(long, value_name = "N", default_value_t = 3)]
    most: usize,

    /// Make meshes smaller before they are saved; the default
    #[arg(long, overrides_with = "no_minimise")]
    minimise: bool,

    /// Save meshes as they are
    #[arg(long)]
    no_minimise: bool,

    /// Seconds of processor time after which a solve is taken to hang; for each thousand faces of
    /// large meshes
    #[arg(long, value_name = "S", default_value_t = 2.0)]
    limit: f64,

    /// Child processes to judge in [default: one for each processor]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,

    /// Print every failure
    #[arg(long)]
    verbose: bool,
}

fn seeds(text: &str) -> Result<Range<u64>, String> {
    let (start, end) = text.split_once("..").ok_or("write A..B")?;
    let number = |text: &str| {
        text.parse()
            .map_err(|_| format!("`{text}` is not a number"))
    };
    Ok(number(start)?..number(end)?)
}

fn main() -> ExitCode {
    if env::args().nth(1).as_deref() == Some(child::OPTION) {
        return match child::serve() {
            Ok(()) => ExitCode::SUCCESS,
            Err(_) => ExitCode::FAILURE,
        };
    }
    match run(&Options::parse()) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

/// The number of failures.
fn run(options: &Options) -> io::Result<usize> {
    let algorithms = variants::labels(&options.algo, options.plain).map_err(io::Error::other)?;
    let items = if options.slivers {
        Items::slivers()?
    } else if options.again.is_empty() {
        Items::Seeds(options.seeds.clone(), options.kinds.clone())
    } else {
        Items::files(&options.again)?
    };
    let jobs = match options.jobs {
        Some(jobs) => jobs.get(),
        None => thread::available_parallelism()?.get(),
    };
    let fuzzer = Fuzzer {
        options,
        table: Mutex::new(Table::new(&algorithms)),
        saved: Mutex::new(HashMap::new()),
        next: AtomicUsize::new(0),
        start: Instant::now(),
        algorithms,
        items,
    };
    thread::scope(|scope| {
        let threads: Vec<_> = (0..jobs).map(|_| scope.spawn(|| fuzzer.work())).collect();
        for thread in threads {
            thread.join().map_err(|_| died())??;
        }
        Ok::<_, io::Error>(())
    })?;
    let seconds = fuzzer.start.elapsed().as_secs_f64();
    let table = fuzzer.table.into_inner().map_err(|_| died())?;
    println!("{table}{} meshes in {seconds:.0} s", fuzzer.items.len());
    Ok(table.failures())
}

fn died() -> io::Error {
    io::Error::other("a thread died")
}

struct Fuzzer<'a> {
    options: &'a Options,
    algorithms: Vec<String>,
    items: Items,
    table: Mutex<Table>,
    /// Number of meshes saved for each algorithm, without its parameters, and kind of failure.
    saved: Mutex<HashMap<String, usize>>,
    next: AtomicUsize,
    start: Instant,
}

impl Fuzzer<'_> {
    /// Judges cases until there are no more.
    fn work(&self) -> io::Result<()> {
        let mut judge = Judge::new(Duration::from_secs_f64(self.options.limit));
        loop {
            let place = self.next.fetch_add(1, Ordering::Relaxed);
            if place >= self.items.len() {
                return Ok(());
            }
            let item = self.items.get(place)?;
            match judge.judge(&item.case, item.expected.clone(), &self.algorithms)? {
                Err(skip) => {
                    if self.options.verbose {
                        eprintln!("{}: skipped: {skip:?}", item.name);
                    }
                    let mut table = self.table.lock().map_err(|_| died())?;
                    table.skip(&item.kind, skip);
                }
                Ok(judged) => {
                    {
                        let mut table = self.table.lock().map_err(|_| died())?;
                        table.add(&item.kind, &judged);
                    }
                    let failures = self.failures(&judged.verdicts);
                    self.print(&item.name, &failures);
                    if self.options.out.is_some() {
                        self.save(&mut judge, &item, &judged.expected, failures)?;
                    }
                }
            }
            let done = place + 1;
            if done.is_multiple_of(100) {
                let failures = self.table.lock().map_err(|_| died())?.failures();
                let (all, seconds) = (self.items.len(), self.start.elapsed().as_secs());
                eprintln!("{done} of {all} meshes, {failures} wrong answers, {seconds} s");
            }
        }
    }

    fn failures(&self, verdicts: &[Verdict]) -> Vec<AlgorithmFailure> {
        let answers = self.algorithms.iter().zip(verdicts);
        let failed = answers.filter_map(|(algorithm, verdict)| match verdict {
            Verdict::Failed(failure) => Some((algorithm.clone(), failure.clone())),
            _ => None,
        });
        failed.collect()
    }

    /// Prints the failures of a mesh: all, or the first of each kind.
    fn print(&self, name: &str, failures: &[AlgorithmFailure]) {
        for kind in FailureKind::ALL {
            let mut alike = failures.iter().filter(|(_, failure)| failure.kind == kind);
            if self.options.verbose {
                for (algorithm, failure) in alike {
                    println!("{name}: {algorithm}: {failure}");
                }
            } else if let Some((algorithm, failure)) = alike.next() {
                println!("{name}: {algorithm} and {} more: {failure}", alike.count());
            }
        }
    }

    /// Saves the mesh, made smaller for the first of the failing algorithms. If others do not fail
    /// on the smaller mesh, repeats this for the first of them, and so on.
    fn save(
        &self,
        judge: &mut Judge,
        item: &Item,
        expected: &Expected,
        mut failures: Vec<AlgorithmFailure>,
    ) -> io::Result<()> {
        let Some(folder) = &self.options.out else {
            return Ok(());
        };
        failures.retain(|failure| self.is_wanted(failure));
        while let Some((algorithm, failure)) = failures.first().cloned() {
            if !self.is_wanted(&(algorithm.clone(), failure.clone())) {
                failures.remove(0);
                continue;
            }
            let mut smallest = Smallest {
                case: item.case.clone(),
                expected: expected.clone(),
                failure,
            };
            if !self.options.no_minimise {
                smallest = minimise::minimise(judge, &algorithm, smallest)?;
            }
            let (case, right) = (&smallest.case, &smallest.expected);
            let all: Vec<String> = failures.iter().map(|(name, _)| name.clone()).collect();
            let mut failing = vec![(algorithm.clone(), smallest.failure.clone())];
            if let Ok(judged) = judge.judge(case, Some(right.clone()), &all[1..])? {
                for (name, verdict) in all[1..].iter().zip(judged.verdicts) {
                    if let Verdict::Failed(failure) = verdict {
                        failing.push((name.clone(), failure));
                    }
                }
            }
            let name = file_name(item, &algorithm);
            files::write(folder, &name, &item.name, case, right, &failing)?;
            failures.retain(|(name, _)| failing.iter().all(|(known, _)| known != name));
            let mut saved = self.saved.lock().map_err(|_| died())?;
            let ways: HashSet<String> = failing.iter().map(way_to_fail).collect();
            for way in ways {
                *saved.entry(way).or_default() += 1;
            }
        }
        Ok(())
    }

    /// Whether few meshes are saved on which the algorithm fails in this way.
    fn is_wanted(&self, failure: &AlgorithmFailure) -> bool {
        let saved = self.saved.lock();
        let count = saved.map_or(0, |saved| {
            saved.get(&way_to_fail(failure)).copied().unwrap_or(0)
        });
        count < self.options.most
    }
}

fn way_to_fail((algorithm, failure): &AlgorithmFailure) -> String {
    format!("{} {}", variants::name_of(algorithm), failure.kind)
}

/// A name without characters that are special in a shell.
fn file_name(item: &Item, algorithm: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    let base = item.name.rsplit('/').next().unwrap_or_default();
    let base = base
        .split(',')
        .next()
        .unwrap_or_default()
        .trim_end_matches(".obj");
    let name: String = format!("{base}-{algorithm}").chars().map(plain).collect();
    name.trim_end_matches('-').to_owned()
}
