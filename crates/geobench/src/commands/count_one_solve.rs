//! The hidden command that callgrind runs: one solve, whose instructions are counted.

use clap::Args;
use geobench_harness::exec::model;
use geobench_harness::exec::source::{Locator, SourceSpec};
use geobench_harness::measure::instructions;
use geobench_harness::plan::suite::options::{
    DecompressionOption, GoalOptions, SimdOption, WeldOption,
};

#[derive(Args, Debug)]
pub(crate) struct CountOneSolveOptions {
    model: String,
    algorithm: String,
    source: SourceSpec,
    #[command(flatten)]
    goal: GoalOptions,
    #[command(flatten)]
    simd: SimdOption,
    #[command(flatten)]
    decompression: DecompressionOption,
    #[command(flatten)]
    weld: WeldOption,
}

/// The hidden command that callgrind runs: one solve, whose instructions are counted.
pub(crate) fn count_one_solve(options: &CountOneSolveOptions) -> anyhow::Result<()> {
    let selection = instructions::announce(&options.algorithm, options.simd.simd)?;
    let model = model::only(&options.model)?.welded(options.weld.vertices());
    let (mesh, _) = model.mesh_within(options.decompression.limit())?;
    let sources = options.source.points(mesh.vertex_count())?;
    let goal = options.goal.spec();
    let targets = goal.points(mesh.vertex_count())?;
    let mut locator = Locator::new(&mesh);
    let points = sources.iter().chain(targets.iter().flatten());
    let points = points.map(|&point| locator.locate(point).map(|found| found.point));
    let refined = mesh.with_points(&points.collect::<Result<Vec<_>, _>>()?)?;
    let (from, to) = refined.vertices.split_at(sources.len());
    let goal = goal.of_solver(targets.is_some().then_some(to));
    instructions::solve_once(&selection, &refined.mesh, from, &goal)
}

#[cfg(test)]
mod tests {
    use clap::{Command, FromArgMatches};

    use super::*;

    /// Runs the hidden command that counts instructions, with these arguments.
    fn count(arguments: &str) -> anyhow::Result<()> {
        let command = CountOneSolveOptions::augment_args(Command::new("count"));
        let matches = command
            .no_binary_name(true)
            .try_get_matches_from(arguments.split(' '))?;
        count_one_solve(&CountOneSolveOptions::from_arg_matches(&matches)?)
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
