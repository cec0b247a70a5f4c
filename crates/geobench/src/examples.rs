//! Two examples for the help of each command.

use clap::Command;

/// A command, and two of its uses: what each does, and its arguments.
type Examples = (&'static str, [(&'static str, &'static str); 2]);

#[rustfmt::skip]
const EXAMPLES: &[Examples] = &[
    ("run", [
        ("two algorithms on a model, with a result file", "run --algo mmp,vtp -o horse.json horse.obj"),
        ("a suite of the program, on a directory of models", "run --suite 000-table-1 my-models/"),
    ]),
    ("verify", [
        ("all exact algorithms, from ten vertices", "verify --source random:10 horse.obj"),
        ("two algorithms on generated models", "verify --algo vtp,ich gen:torus,faces=2000 gen:holes"),
    ]),
    ("compare", [
        ("fail if a time is 10 % worse, or a count differs", "compare --fail-on time=10%,propagated=0 old.json new.json"),
        ("the newest commit of a history with earlier ones", "compare history/ --against main~20..main~1"),
    ]),
    ("report", [
        ("a page of tables and plots", "report horse.json -o report.html"),
        ("every plot as a file, with ratios to mmp", "report --format svg figures --ratio-to mmp horse.json"),
    ]),
    ("site", [
        ("pages of all records in a directory", "site results/ -o site"),
        ("the same with the trends of a history", "site results/ --history history/ -o site"),
    ]),
    ("corpus", [
        ("which models of the corpus a directory holds", "corpus check models/"),
        ("the same as JSON", "corpus check models/ --format json"),
    ]),
    ("claims", [
        ("what results say of the papers' claims", "claims table-1.json table-2.json"),
        ("the same as JSON", "claims table-1.json --format json -o claims.json"),
    ]),
    ("distance", [
        ("distances from a vertex, as a mesh with colours", "distance horse.obj --source 0 -o field.ply"),
        ("a matrix from ten vertices to a hundred others", "distance horse.obj --source random:10 --target random:100,seed=2 --each --matrix -o d.npy"),
    ]),
    ("path", [
        ("the shortest path between two vertices", "path horse.obj --source 0 --target 4000"),
        ("a picture of paths from a point in a face", "path horse.obj --source face:12,0.2,0.3,0.5 --target random:5 -o paths.svg"),
    ]),
    ("isolines", [
        ("a line at each tenth of a unit", "isolines horse.obj --source 0 --every 0.1 -o lines.svg"),
        ("three lines, as exact arcs", "isolines horse.obj --source 0 --levels 0.1,0.2,0.5 -o lines.json"),
    ]),
    ("voronoi", [
        ("the cells of 30 vertices", "voronoi horse.obj --source random:30 -o cells.json"),
        ("a picture of them, and their dual", "voronoi horse.obj --source random:30 -o cells.svg --dual dual.obj"),
    ]),
    ("remesh", [
        ("a mesh of a thousand vertices", "remesh horse.obj --sites 1000 -o coarse.obj"),
        ("the same from a generated model", "remesh gen:torus,faces=20000 --sites 500 -o torus.ply"),
    ]),
    ("certify", [
        ("prove the distances of `mmp`", "certify horse.obj --source 0"),
        ("prove distances of a file, or find where they are wrong", "certify horse.obj --source 0 --distances d.csv --format json"),
    ]),
    ("gen", [
        ("a torus with bumps", "gen torus,faces=50000,bump=0.1,seed=7 -o torus.obj"),
        ("a terrain, as binary PLY", "gen terrain,n=300,seed=1 -o terrain.ply"),
    ]),
    ("info", [
        ("counts and defects of a model", "info horse.obj"),
        ("the same of all models in a directory, as JSON", "info models/ --format json"),
    ]),
    ("algos", [
        ("all algorithms", "algos"),
        ("all about one: paper, cost, parameters", "algos fwp-mmp"),
    ]),
    ("merge", [
        ("the parts of a run with --shard", "merge part1.json part2.json -o all.json"),
        ("different runs on one machine, as a table", "merge monday.json tuesday.json -o both.md"),
    ]),
    ("cluster", [
        ("a suite as ten jobs of Slurm", "cluster --config suite.toml --shards 10 -o runs"),
        ("which jobs are done", "cluster --status -o runs"),
    ]),
    ("pool", [
        ("rounds of one benchmark", "pool round1.json round2.json round3.json -o all.json"),
        ("rounds whose samples are paired with another version's", "pool new1.json new2.json -o new.json"),
    ]),
    ("record", [
        ("add a result to a history", "record result.json --into history"),
        ("add the result of a commit that git here does not know", "record result.json --into history --commit 1234abc --date 2025-03-04"),
    ]),
    ("trend", [
        ("a page of how figures have changed", "trend history -o trend.html"),
        ("the changes as JSON", "trend history --format json"),
    ]),
    ("init", [
        ("the files, in the current directory", "init"),
        ("which files these are", "init --list"),
    ]),
    ("suites", [
        ("the names of all suites", "suites"),
        ("the same as JSON", "suites --format json"),
    ]),
    ("completions", [
        ("for bash", "completions bash"),
        ("for zsh", "completions zsh"),
    ]),
    ("man", [
        ("the page of the program", "man"),
        ("the page of a command", "man run"),
    ]),
];

/// `program` with the examples in the help of its commands.
pub(crate) fn add_to(mut program: Command) -> Command {
    for (name, uses) in EXAMPLES {
        program = program.mut_subcommand(name, |command| {
            let more = command.get_after_help().map(ToString::to_string);
            let uses =
                uses.map(|(does, arguments)| format!("  geobench {arguments}\n      {does}\n"));
            let help = format!("Examples:\n{}\n{}", uses.concat(), more.unwrap_or_default());
            command.after_help(help.trim_end().to_owned())
        });
    }
    program
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_examples_that_it_takes() {
        let program = crate::program();
        for command in program.get_subcommands().filter(|c| !c.is_hide_set()) {
            let name = command.get_name();
            let uses = EXAMPLES.iter().find(|(known, _)| *known == name);
            let (_, uses) = uses.unwrap_or_else(|| panic!("{name} has no examples"));
            for (_, arguments) in uses {
                assert_eq!(arguments.split(' ').next(), Some(name));
                let words = ["geobench"].into_iter().chain(arguments.split(' '));
                let parsed = crate::program().try_get_matches_from(words);
                assert!(parsed.is_ok(), "{arguments}: {}", parsed.unwrap_err());
            }
        }
    }
}
