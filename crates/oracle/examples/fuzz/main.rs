//! Looks for meshes on which an algorithm is wrong.
//!
//! `cargo run --release -p geobench-oracle --example fuzz -- --slivers --algo all`

use std::num::NonZeroUsize;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use std::{env, io, thread};

use case::{Case, Expected, Verdict};
use child::Judge;
use clap::Parser;
use table::Table;

mod case;
mod child;
mod judge;
mod slivers;
mod table;
mod variants;

#[derive(Parser)]
struct Options {
    /// Algorithms by name, by family, or all; separated by commas. With parameters, as
    /// name{key=value,...}, the item means just that; else all variants that are exact
    #[arg(long, value_name = "LIST", default_value = "all")]
    algo: String,

    /// Do not add variants to what --algo names
    #[arg(long)]
    plain: bool,

    /// Judge by the meshes and distances of shared/slivers
    #[arg(long)]
    slivers: bool,

    /// Seconds after which a solve is taken to hang
    #[arg(long, value_name = "S", default_value_t = 5.0)]
    limit: f64,

    /// Child processes to judge in [default: one for each processor]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,

    /// Print every failure
    #[arg(long)]
    verbose: bool,
}

/// A case with a name.
struct Item {
    name: String,
    kind: String,
    case: Case,
    expected: Option<Expected>,
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

fn run(options: &Options) -> io::Result<usize> {
    let selected = variants::selected(&options.algo, options.plain).map_err(io::Error::other)?;
    let algorithms: Vec<String> = selected.iter().map(|s| s.label().to_owned()).collect();
    let items: Vec<Item> = slivers::read()?.into_iter().map(of_sliver).collect();
    let jobs = match options.jobs {
        Some(jobs) => jobs.get(),
        None => thread::available_parallelism()?.get(),
    };
    let table = Mutex::new(Table::new(&algorithms));
    let next = AtomicUsize::new(0);
    let work = || -> io::Result<()> {
        let mut judge = Judge::new(Duration::from_secs_f64(options.limit));
        while let Some(item) = items.get(next.fetch_add(1, Ordering::Relaxed)) {
            let judged = judge.judge(&item.case, item.expected.clone(), &algorithms)?;
            let mut table = table
                .lock()
                .map_err(|_| io::Error::other("a thread died"))?;
            match judged {
                Err(skip) => {
                    eprintln!("{}: skipped: {skip:?}", item.name);
                    table.skip(&item.kind, skip);
                }
                Ok(judged) => {
                    for (algorithm, verdict) in algorithms.iter().zip(&judged.verdicts) {
                        if let Verdict::Failed(failure) = verdict
                            && options.verbose
                        {
                            let (kind, text) = (failure.kind, &failure.text);
                            eprintln!("{}: {algorithm}: {kind}: {text}", item.name);
                        }
                    }
                    table.add(&item.kind, &judged.verdicts);
                }
            }
        }
        Ok(())
    };
    thread::scope(|scope| {
        let threads: Vec<_> = (0..jobs).map(|_| scope.spawn(work)).collect();
        for thread in threads {
            thread
                .join()
                .map_err(|_| io::Error::other("a thread died"))??;
        }
        Ok::<_, io::Error>(())
    })?;
    let table = table
        .into_inner()
        .map_err(|_| io::Error::other("a thread died"))?;
    print!("{table}");
    Ok(table.failures())
}

fn of_sliver(sliver: slivers::Sliver) -> Item {
    Item {
        name: sliver.name,
        kind: "sliver".to_owned(),
        case: Case {
            vertices: sliver.vertices,
            faces: sliver.faces,
            sources: sliver.source,
            bounded: true,
        },
        expected: Some(sliver.distances),
    }
}
