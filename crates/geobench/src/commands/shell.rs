//! `geobench completions` and `geobench man`, both generated from the clap definition.

use anyhow::bail;
use clap::{Args, Command};

use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(
    after_help = "For bash: geobench completions bash > ~/.local/share/bash-completion/completions/geobench"
)]
pub(crate) struct CompletionsOptions {
    /// The shell
    #[arg(value_name = "SHELL", value_enum)]
    pub(crate) shell: clap_complete::Shell,
}

#[derive(Args, Debug)]
#[command(after_help = "To read it: geobench man run | man -l -")]
pub(crate) struct ManOptions {
    /// The command; without one, the page of the program, which lists all commands
    #[arg(value_name = "COMMAND")]
    pub(crate) command: Option<String>,
}

const NAME: &str = "geobench";

/// `program` is the definition of the command line.
pub(crate) fn completions(
    options: &CompletionsOptions,
    mut program: Command,
) -> anyhow::Result<Verdict> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut program, NAME, &mut script);
    terminal::print_rendered(&String::from_utf8(script)?)?;
    Ok(Verdict::Passed)
}

/// `program` is the definition of the command line.
pub(crate) fn man(options: &ManOptions, mut program: Command) -> anyhow::Result<Verdict> {
    // `build` sets the names of the pages, such as `geobench-run`, and adds the global options to
    // each command.
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
