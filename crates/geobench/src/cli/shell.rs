//! `geobench completions` and `geobench man`, generated from the definition of `--help`.

use anyhow::bail;
use clap::CommandFactory;

use super::Verdict;
use super::args::{Arguments, CompletionsOptions, ManOptions};
use super::terminal;

const NAME: &str = "geobench";

pub(super) fn completions(options: &CompletionsOptions) -> anyhow::Result<Verdict> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut Arguments::command(), NAME, &mut script);
    terminal::print_rendered(&String::from_utf8(script)?)?;
    Ok(Verdict::Passed)
}

pub(super) fn man(options: &ManOptions) -> anyhow::Result<Verdict> {
    let mut program = Arguments::command();
    // Names commands `geobench-run` and adds the global options to each.
    program.build();
    let page = match &options.command {
        None => program,
        Some(name) => {
            let Some(command) = program.find_subcommand(name) else {
                bail!("there is no command `{name}`; see geobench --help");
            };
            command.clone()
        }
    };
    let mut roff = Vec::new();
    clap_mangen::Man::new(page).render(&mut roff)?;
    terminal::print_rendered(&String::from_utf8(roff)?)?;
    Ok(Verdict::Passed)
}
