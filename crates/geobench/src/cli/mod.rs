//! The command line: dispatch to commands, exit statuses, and errors as single lines.

mod algos;
mod args;
mod certify;
mod claims;
mod cluster;
mod compare;
mod distance;
mod generate;
mod history;
mod info;
mod isolation;
mod isolines;
mod merge;
mod path;
mod points;
mod pool;
mod progress;
mod remesh;
mod report;
mod run;
mod shell;
mod terminal;
mod verify;
mod voronoi;

use std::ffi::OsStr;
use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind;

use args::{Arguments, Command, CountOneSolveOptions};
use geobench_harness::exec::goal::GoalSpec;
use geobench_harness::exec::model::standard_input;
use geobench_harness::exec::source::Locator;
use geobench_harness::exec::{interrupt, isolate, model};
use geobench_harness::measure::instructions;

/// The result of a command that completed, from which the exit status follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    /// All work is done and every check passed.
    Passed,
    /// A check, a comparison or a cell failed. The others are reported.
    Failed,
    /// Some input could not be used. Results of the rest are reported.
    BadInput,
    /// A signal ended the command. Finished work is reported.
    Interrupted,
}

impl Verdict {
    /// The verdict of a command with one check.
    const fn of(has_passed: bool) -> Self {
        if has_passed {
            Self::Passed
        } else {
            Self::Failed
        }
    }
}

/// Runs the command that the arguments of the process name, and returns its exit status. With the
/// arguments of a child, serves the parent process instead.
pub(crate) fn main() -> ExitCode {
    report_panics_in_one_line();
    match isolate::wanted(std::env::args_os()) {
        Some((model, settings)) => cell(&model, &settings),
        None => command(),
    }
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

/// Parses the arguments and runs a command for the user.
fn command() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return usage(&error),
    };
    isolate::adopt_orphans();
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
        Command::Claims(options) => claims::claims(&options, look),
        Command::Distance(options) => distance::distance(&options),
        Command::Path(options) => path::path(&options),
        Command::Isolines(options) => isolines::isolines(&options),
        Command::Voronoi(options) => voronoi::voronoi(&options),
        Command::Remesh(options) => remesh::remesh(&options),
        Command::Certify(options) => certify::certify(&options),
        Command::Gen(options) => generate::generate(&options),
        Command::Info(options) => info::info(&options),
        Command::Algos(options) => algos::algos(&options, look),
        Command::Merge(options) => merge::merge(&options),
        Command::Cluster(options) => cluster::cluster(&options, look),
        Command::Pool(options) => pool::pool(&options),
        Command::Record(options) => history::record(&options),
        Command::Trend(options) => history::trend(&options, look),
        Command::Completions(options) => shell::completions(&options),
        Command::Man(options) => shell::man(&options),
        Command::CountOneSolve(o) => count_one_solve(&o).map(|()| Verdict::Passed),
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

/// The hidden command that callgrind runs: one solve, whose instructions are counted.
fn count_one_solve(options: &CountOneSolveOptions) -> anyhow::Result<()> {
    let selection = instructions::announce(&options.algorithm, options.simd.as_deref())?;
    let mesh = model::only(&options.model)?.mesh_within(options.decompression.limit())?;
    let sources = options.source.points(mesh.vertex_count())?;
    let goal = GoalSpec {
        targets: options.target.clone(),
        radius: options.radius,
    };
    let targets = goal.points(mesh.vertex_count())?;
    let mut locator = Locator::new(&mesh);
    let points = sources.iter().chain(targets.iter().flatten());
    let points = points.map(|&point| locator.locate(point).map(|found| found.point));
    let refined = mesh.with_points(&points.collect::<Result<Vec<_>, _>>()?)?;
    let (from, to) = refined.vertices.split_at(sources.len());
    let goal = goal.of_solver(targets.is_some().then_some(to));
    instructions::solve_once(&selection, &refined.mesh, from, &goal)
}

/// Prints the help if it was requested, else the error as a single line. Returns the exit status.
fn usage(error: &clap::Error) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            // Write errors are ignored.
            let _ = error.print();
            ExitCode::SUCCESS
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let _ = error.print();
            ExitCode::from(2)
        }
        _ => {
            terminal::error(&format!("{}; see --help", in_one_line(error)));
            ExitCode::from(2)
        }
    }
}

/// The message of `error` without the usage that clap appends.
fn in_one_line(error: &clap::Error) -> String {
    let text = error.to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    let text = text.split("\nUsage:").next().unwrap_or(text);
    let text = text.split("\nFor more information").next().unwrap_or(text);
    let text = text.replace("\n\n  tip: ", "; ");
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ")
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

    /// Runs the hidden command that counts instructions, with these arguments.
    fn count(arguments: &str) -> anyhow::Result<()> {
        let line = ["geobench", instructions::COMMAND].into_iter();
        let arguments = Arguments::parse_from(line.chain(arguments.split(' ')));
        let Command::CountOneSolve(options) = arguments.command else {
            panic!("another command");
        };
        count_one_solve(&options)
    }

    #[test]
    fn one_solve_needs_all_three() {
        for right in [
            "gen:cube,n=1 vtp 0",
            "gen:cube,n=1 vtp 0 --simd scalar",
            "gen:cube,n=1 vtp 0 --target 7 --radius 0.5",
        ] {
            count(right).unwrap();
        }
        for wrong in [
            "gen:cube,n=1 vtp 999",
            "gen:cube,n=1 vtq 0",
            "gen:cube,n=1 vtp 0 --simd wide",
            "gen:cube,n=1 vtp 0 --target 999",
            "no.obj vtp 0",
        ] {
            assert!(count(wrong).is_err(), "{wrong}");
        }
    }
}
