//! Standard output and standard error.

use std::io::{self, IsTerminal, Write};

use anyhow::Context;
use clap::ValueEnum;
use geobench_export::escape::{for_terminal, printable};
use geobench_export::output::{unless_reader_ended, write_standard_output};
use geobench_harness::exec::interrupt;
use geobench_report::table::Look;
use terminal_size::{Width, terminal_size_of};

/// When to use colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ColorChoice {
    #[default]
    Auto,
    Always,
    Never,
}

/// Style and width of tables on standard output.
pub(crate) fn look(color: ColorChoice) -> Look {
    let styled = match color {
        ColorChoice::Always => true,
        ColorChoice::Never => false,
        // https://no-color.org: no colour if `NO_COLOR` is set and not empty.
        ColorChoice::Auto => {
            io::stdout().is_terminal()
                && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
                && !is_dumb()
        }
    };
    let width = terminal_size_of(io::stdout()).map(|(Width(width), _)| usize::from(width));
    Look { styled, width }
}

/// Whether standard error is a terminal that can redraw lines.
pub(crate) fn standard_error_can_move() -> bool {
    io::stderr().is_terminal() && !is_dumb()
}

/// Whether the terminal cannot move the cursor, by the variable `TERM`.
fn is_dumb() -> bool {
    std::env::var_os("TERM").is_some_and(|term| term == "dumb")
}

/// Writes `text` to standard output in one call. Control characters are escaped.
///
/// If the reader of standard output has ended, as `head` does, the text is dropped: the command
/// goes on, and its result decides about the exit status.
///
/// # Errors
///
/// If standard output is full.
pub(crate) fn print(text: &str) -> anyhow::Result<()> {
    write_out(&for_terminal(text, false))
}

/// Writes rendered text to standard output in one call: a table, or text that programs read. On a
/// terminal, control characters other than those of colours are escaped. Elsewhere the text is
/// unchanged.
///
/// # Errors
///
/// As [`print()`].
pub(crate) fn print_rendered(text: &str) -> anyhow::Result<()> {
    if io::stdout().is_terminal() {
        write_out(&for_terminal(text, true))
    } else {
        write_out(text)
    }
}

/// Prints the help or the version that clap has made in place of arguments.
///
/// # Errors
///
/// As [`print()`].
pub(crate) fn print_help(help: &clap::Error) -> anyhow::Result<()> {
    let printed = help.print().and_then(|()| io::stdout().flush());
    unless_reader_ended(printed).context(UNWRITABLE)
}

const UNWRITABLE: &str = "standard output: cannot be written";

fn write_out(text: &str) -> anyhow::Result<()> {
    write_standard_output(text.as_bytes()).context(UNWRITABLE)
}

/// Writes an error to standard error as a single line.
pub(crate) fn error(message: &str) {
    note("error", message);
}

/// As [`error`], for a command that a signal has stopped: after what was said about the signal.
pub(crate) fn interrupted(message: &str) {
    interrupt::wait_until_told();
    error(message);
}

/// Writes a warning to standard error as a single line.
pub(crate) fn warning(message: &str) {
    note("warning", message);
}

/// Writes a warning for each of `messages`.
pub(crate) fn warnings(messages: &[String]) {
    for message in messages {
        warning(message);
    }
}

/// Writes a note for each of `messages` to standard error.
pub(crate) fn notes(messages: &[String]) {
    for message in messages {
        note("note", message);
    }
}

/// Writes a note on a model for each of `messages` to standard error.
pub(crate) fn notes_on(model: &str, messages: &[String]) {
    for message in messages {
        note("note", &format!("{model}: {message}"));
    }
}

/// Maximum number of characters of a message. Longer ones quote a file or a program at length.
const MOST_CHARACTERS: usize = 2000;

fn note(kind: &str, message: &str) {
    let cut = message.char_indices().nth(MOST_CHARACTERS);
    let (message, more) = match cut {
        Some((end, _)) => (&message[..end], "..."),
        None => (message, ""),
    };
    let message = printable(message);
    // Write errors are ignored: there is no other place to report them.
    let _ = writeln!(io::stderr(), "geobench: {kind}: {message}{more}");
}
