//! The command `geobench`: exact geodesic distances on triangle meshes, and benchmarks of the
//! algorithms that find them.
//!
//! ```sh
//! geobench distance gen:sphere,subdiv=4 --source 0 -o d.csv    # one distance field
//! geobench run --algo mmp,vtp gen:torus,faces=5000             # times, counts, memory
//! geobench verify bunny.ply                                    # do all algorithms agree?
//! ```
//!
//! `docs/guide.md` describes every command. This crate is only the command line. The library is
//! `geodesics`.
//!
//! | part | crate or module |
//! |---|---|
//! | options and output of each command | `commands`, a file for each |
//! | sources, targets and pairs as users give them | `points` |
//! | child processes, limits and outside programs | `isolation` |
//! | progress, tables and warnings on the terminal | `progress`, `terminal` |
//! | plans, runs, measurements and the result file | `geobench_harness` |
//! | tables, documents, comparisons and histories | `geobench_report` |
//! | files of distances, paths, isolines and diagrams | `geobench_export` |
//!
//! This file dispatches to the commands and turns what they return into exit statuses: 0 done and
//! every check passed, 1 a check or a cell failed, 2 wrong usage or unreadable input, 130
//! interrupted. An error is a single line on standard error.

mod args;
mod commands;
#[cfg(test)]
mod docs;
mod examples;
mod git;
mod isolation;
mod points;
mod progress;
mod reporter;
mod result_store;
mod terminal;
mod verdict;

use std::alloc::System;
use std::env;
use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use geobench_harness::exec::model::standard_input;
use geobench_harness::exec::{interrupt, isolate};
use peakmem_alloc::{INSTRUMENTED_SYSTEM, PeakMemAlloc};

use commands::{
    algos, certify, claims, cluster, compare, corpus, distance, generate, info, init, isolines,
    merge, path, pool, record, remesh, report, run, shell, site, suites, trend, verify, voronoi,
};
use terminal::ColorChoice;
use verdict::Verdict;

/// Counts heap bytes, for the peak memory of algorithms; see `geobench_harness::measure::memory`.
#[global_allocator]
static ALLOCATOR: &PeakMemAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Heading of the options that every command has. Without it they stand among its own.
const EVERYWHERE: &str = "In every command";

/// Runs, checks and compares exact geodesic-distance algorithms on triangle meshes.
#[derive(Debug, Parser)]
#[command(
    name = "geobench",
    version,
    about,
    max_term_width = 100,
    arg_required_else_help = true
)]
#[command(
    after_help = "Exit status: 0 done and every check passed; 1 a check or a cell failed; 2 wrong usage or \
    unreadable input; 130 interrupted, with what was done until then."
)]
struct Arguments {
    /// When to use colour; auto: on a terminal, unless `NO_COLOR` is set
    #[arg(
        long,
        global = true,
        help_heading = EVERYWHERE,
        value_name = "WHEN",
        value_enum,
        default_value_t
    )]
    color: ColorChoice,

    /// Format of a model that is read from standard input (-): one of the endings of model files,
    /// such as ply or glb
    #[arg(long, global = true, help_heading = EVERYWHERE, value_name = "FORM")]
    input_format: Option<String>,

    /// Format of a file that is written to standard output (-): one of its endings, such as csv
    #[arg(long, global = true, help_heading = EVERYWHERE, value_name = "FORM")]
    output_format: Option<String>,

    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Benchmark algorithms on models and check every answer
    Run(Box<run::RunOptions>),
    /// Compare the answers of all algorithms with each other and with stored distances
    Verify(verify::VerifyOptions),
    /// Compare result files, or the newest commit of a history with earlier ones, and fail if
    /// something is worse
    Compare(compare::CompareOptions),
    /// Make tables, plots and a picture of result files: one page, or files to take into a paper
    Report(report::ReportOptions),
    /// Make a static site of results: a page for each program, model and paper
    Site(site::SiteOptions),
    /// Check models against the corpus, on which results are compared
    Corpus(corpus::CorpusOptions),
    /// Check the papers' claims against results
    Claims(claims::ClaimsOptions),
    /// Write the distances of all vertices from one or several sources
    Distance(Box<distance::DistanceOptions>),
    /// Trace shortest paths over the surface
    Path(path::PathOptions),
    /// Write the points at given distances: arcs of circles, as lines or as a picture
    Isolines(isolines::IsolinesOptions),
    /// Write the Voronoi diagram of several sources: cells, their borders, the dual triangulation
    Voronoi(voronoi::VoronoiOptions),
    /// Make a new mesh for a surface, with evenly spread vertices: the dual of a Voronoi diagram
    Remesh(remesh::RemeshingOptions),
    /// Prove distances right, or say where they are not
    Certify(certify::CertifyOptions),
    /// List the suites that are part of the program (`run --suite NAME`)
    Suites(suites::SuitesOptions),
    /// Write a generated model to a file
    Gen(generate::GenOptions),
    /// Show counts, defects, genus and anisotropy of models
    Info(info::InfoOptions),
    /// List the algorithms and which one to take, or all about some: paper, cost, use, parameters
    Algos(algos::AlgosOptions),
    /// Join the parts of a benchmark that was run with --shard, or different runs on one machine
    Merge(merge::MergeOptions),
    /// Run a benchmark on a cluster, as a job array of Slurm
    Cluster(cluster::ClusterOptions),
    /// Pool repeated runs into one result, e.g. alternating runs of two versions
    Pool(pool::PoolOptions),
    /// Add result files to a history: a directory with a small file for each commit, class of
    /// machine and suite
    Record(record::RecordOptions),
    /// Show how the figures of a history have changed, and since which commits
    Trend(trend::TrendOptions),
    /// Write a suite, a program table, a solver to be replaced and a workflow for GitHub, to track
    /// a solver of one's own
    Init(init::InitOptions),
    /// Print a script that lets a shell complete commands, options and values
    Completions(shell::CompletionsOptions),
    /// Print the manual page of the program or of a command
    Man(shell::ManOptions),
    /// Serve the parent process as the child for a model
    #[command(hide = true, name = isolate::COMMAND)]
    Cell {
        #[arg(allow_hyphen_values = true)]
        model: OsString,
        settings: String,
    },
}

/// The definition of the command line.
fn program() -> clap::Command {
    examples::add_to(Arguments::command())
}

/// Runs the command that the arguments of the process name, and returns its exit status.
fn main() -> ExitCode {
    report_panics_in_one_line();
    let (program, words) = (program(), env::args_os().collect::<Vec<_>>());
    if let Some(problem) = detached_value(&program, &words) {
        terminal::error(&problem);
        return ExitCode::from(2);
    }
    let arguments = program.try_get_matches_from(&words);
    match arguments.and_then(|found| Arguments::from_arg_matches(&found)) {
        Ok(Arguments {
            command: Command::Cell { model, settings },
            ..
        }) => cell(&model, &settings),
        Ok(arguments) => match unused_form(&arguments, &words) {
            Some(problem) => {
                terminal::error(&problem);
                ExitCode::from(2)
            }
            None => command(arguments),
        },
        Err(error) => usage(&error),
    }
}

/// The error for an option whose value may be left out, if a number follows it after a blank. The
/// value of such an option follows `=`. The number would be read as the name of a model.
fn detached_value(program: &clap::Command, words: &[OsString]) -> Option<String> {
    let mut commands = words.iter().skip(1);
    let command = commands.find_map(|word| program.find_subcommand(word))?;
    let may_lack_value = |option: &str| {
        let mut known = command.get_arguments();
        known.any(|known| known.get_long() == Some(option) && known.is_require_equals_set())
    };
    let mut pairs = words.windows(2).take_while(|pair| pair[0] != "--");
    pairs.find_map(|pair| {
        let (option, value) = (pair[0].to_str()?.strip_prefix("--")?, pair[1].to_str()?);
        let is_number = value.parse::<f64>().is_ok() && !Path::new(value).exists();
        (is_number && may_lack_value(option)).then(|| {
            format!("the value of --{option} follows `=` without a blank: write --{option}={value}")
        })
    })
}

/// The error for a format of standard input or output if no file is `-`. It would have no effect,
/// and a file would have another format than the one that was asked for.
fn unused_form(arguments: &Arguments, words: &[OsString]) -> Option<String> {
    let forms = [
        ("--input-format", &arguments.input_format),
        ("--output-format", &arguments.output_format),
    ];
    let (option, form) = forms
        .into_iter()
        .find_map(|(o, form)| Some((o, form.as_ref()?)))?;
    let is_standard = |word: &OsString| {
        let word = word.to_string_lossy();
        word == "-" || word == "-o-" || word.ends_with("=-")
    };
    (!words.iter().any(is_standard)).then(|| {
        format!(
            "{option} {form}: no file is `-`, and the ending of any other file names its format; \
             leave the option out, or write `-`"
        )
    })
}

/// Serves the parent process as the child for `model`.
fn cell(model: &OsStr, settings: &str) -> ExitCode {
    match isolate::cell(model, settings) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            terminal::error(&error.to_string());
            ExitCode::from(2)
        }
    }
}

/// Runs a command for the user.
fn command(arguments: Arguments) -> ExitCode {
    isolate::adopt_orphans();
    // Without it a signal ends the program, too, and leaves its temporary files.
    let _ = interrupt::watch();
    let look = terminal::look(arguments.color);
    if let Some(form) = &arguments.input_format {
        standard_input::set_form(form);
    }
    if let Some(form) = &arguments.output_format {
        geobench_export::set_standard_output_form(form);
    }
    let done = match arguments.command {
        Command::Run(options) => run::run(&options, look),
        Command::Verify(options) => verify::verify(&options),
        Command::Compare(options) => compare::compare(&options, look),
        Command::Report(options) => report::report(&options),
        Command::Site(options) => site::site(&options),
        Command::Corpus(options) => corpus::corpus(&options),
        Command::Claims(options) => claims::claims(&options, look),
        Command::Distance(options) => distance::distance(&options),
        Command::Path(options) => path::path(&options),
        Command::Isolines(options) => isolines::isolines(&options),
        Command::Voronoi(options) => voronoi::voronoi(&options),
        Command::Remesh(options) => remesh::remesh(&options),
        Command::Certify(options) => certify::certify(&options),
        Command::Gen(options) => generate::generate(&options),
        Command::Info(options) => info::info(&options),
        Command::Suites(options) => suites::suites(&options, look),
        Command::Algos(options) => algos::algos(&options, look),
        Command::Merge(options) => merge::merge(&options),
        Command::Cluster(options) => cluster::cluster(&options, look),
        Command::Pool(options) => pool::pool(&options),
        Command::Record(options) => record::record(&options),
        Command::Trend(options) => trend::trend(&options, look),
        Command::Init(options) => init::init(&options),
        Command::Completions(options) => shell::completions(&options, program()),
        Command::Man(options) => shell::man(&options, program()),
        Command::Cell { .. } => Ok(Verdict::Passed), // Served above.
    };
    standard_input::remove();
    match done {
        Ok(Verdict::Passed) => ExitCode::SUCCESS,
        Ok(Verdict::Failed) => ExitCode::from(1),
        Ok(Verdict::BadInput) => ExitCode::from(2),
        Ok(Verdict::Interrupted) => ExitCode::from(interrupt::EXIT_STATUS),
        Err(error) => {
            terminal::error(&format!("{error:#}"));
            ExitCode::from(2)
        }
    }
}

/// Prints the help if it was requested, else the error as a single line. Returns the exit status.
fn usage(error: &clap::Error) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => match terminal::print_help(error) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                terminal::error(&format!("{error:#}"));
                ExitCode::from(2)
            }
        },
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            // It goes to standard error: there is no other place to report a write error.
            let _ = error.print();
            ExitCode::from(2)
        }
        _ => {
            terminal::error(&format!("{}; see --help", args::in_one_line(error)));
            ExitCode::from(2)
        }
    }
}

/// Installs a hook that reports a panic, which is a defect of this program, as a single line.
fn report_panics_in_one_line() {
    std::panic::set_hook(Box::new(|panic| {
        let text = panic.to_string();
        terminal::error(&format!(
            "{text}; this is a defect of geobench, please report it"
        ));
    }));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        program().debug_assert();
    }

    #[test]
    fn options_of_every_command_stand_apart_from_its_own() {
        let mut program = program();
        program.build();
        let command = program.find_subcommand_mut("compare").unwrap();
        let help = command.render_help().to_string();
        let (own, common) = help.split_once(EVERYWHERE).unwrap();
        assert!(own.contains("--against") && !own.contains("--input-format"));
        assert!(common.contains("--input-format"));
    }
}
