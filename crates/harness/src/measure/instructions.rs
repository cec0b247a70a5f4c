//! Instruction counts of a solve, by Valgrind.
//!
//! Times on a shared machine vary by 10 % and more. Instruction counts vary so little that a gate
//! can limit them to one or two percent. They ignore caches, branch misses and SIMD width. The
//! program runs itself under callgrind, which counts only inside `counted_solve`: loading and
//! set-up are excluded.
//!
//! Valgrind emulates a processor. Version 3.19 lacks AVX-512 and some encodings of AVX2 (the store
//! form of `vmovq` between two registers, `c5 79 d6 e9`, ends in SIGILL). A solve that fails so is
//! counted again with narrower instructions. The result names the instructions that it used.

use std::fs;
use std::io;
use std::process::{Command, ExitStatus, Stdio};
use std::time::Duration;

use anyhow::{Context, anyhow, bail};
use geobench_export::temporary;
use geobench_mesh::{Mesh, VertexId};
use geobench_registry::{self as registry, Selection, SimdChoice};
use geobench_window::simd::Instructions;
use geobench_window::{Goal, Solution, SolveError, Solver};

use crate::children;
use crate::schema::InstructionCount;

/// The hidden subcommand that solves once under callgrind.
pub const COMMAND: &str = "count-one-solve";

/// Callgrind's pattern for the function whose instructions are counted. It matches mangled names.
const COUNTED: &str = "*instructions*counted_solve*";

/// Prefix of the line in which [`COMMAND`] prints the vector instructions that it uses.
const SIMD: &str = "simd: ";

/// Error context: Valgrind does not start.
const NO_VALGRIND: &str = "counting instructions needs valgrind on the path";

/// Error context: Valgrind started, but counting failed.
const FAILED: &str = "callgrind failed";

/// How often the child process is looked after.
const POLL: Duration = Duration::from_millis(10);

/// Checks that Valgrind is installed.
///
/// # Errors
///
/// If Valgrind cannot be started.
pub fn check_valgrind() -> anyhow::Result<()> {
    let status = Command::new("valgrind")
        .arg("--version")
        .stdout(Stdio::null())
        .status();
    status.map(drop).context(NO_VALGRIND)
}

/// Counts the instructions of the first solve after set-up, in a child process. This takes about
/// fifty times as long as the solve. `options` are further options of [`COMMAND`]. Uses
/// instructions no wider than `simd`, and narrower ones if Valgrind does not support those. The
/// child process ends as soon as `is_stopped`.
///
/// # Errors
///
/// If Valgrind is missing, the child process fails or is stopped, or Valgrind does not support even
/// the narrowest instructions.
pub fn count(
    model: &str,
    algorithm: &str,
    source: &str,
    options: &[String],
    simd: Option<Instructions>,
    is_stopped: fn() -> bool,
) -> anyhow::Result<InstructionCount> {
    let mut widest = simd;
    loop {
        match count_with(model, algorithm, source, options, widest, is_stopped)? {
            Attempt::Counted(found) => return Ok(found),
            Attempt::Illegal(used) => {
                widest = used.narrower();
                if widest.is_none() {
                    bail!(
                        "Valgrind does not know an instruction of the solve, not even with \
                         simd={used}; use a newer Valgrind"
                    );
                }
            }
        }
    }
}

/// The result of one attempt to count.
enum Attempt {
    Counted(InstructionCount),
    /// Valgrind does not support an instruction of this set.
    Illegal(Instructions),
}

/// Counts once, with instructions no wider than `widest`.
fn count_with(
    model: &str,
    algorithm: &str,
    source: &str,
    options: &[String],
    widest: Option<Instructions>,
    is_stopped: fn() -> bool,
) -> anyhow::Result<Attempt> {
    let program = std::env::current_exe().context(FAILED)?;
    let counts = tempfile::NamedTempFile::new().context(FAILED)?;
    temporary::register(counts.path());
    let mut out_file = std::ffi::OsString::from("--callgrind-out-file=");
    out_file.push(counts.path());
    let mut command = Command::new("valgrind");
    command
        .args(["--tool=callgrind", "--quiet"])
        .arg(format!("--toggle-collect={COUNTED}"))
        .arg(out_file)
        .arg(program)
        .args([COMMAND, model, algorithm, source])
        .args(options)
        .args(widest.map(|widest| format!("--simd={widest}")))
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let (mut child, _known) =
        children::spawn(&mut command).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => anyhow!(NO_VALGRIND),
            _ => anyhow!("valgrind cannot be started: {error}"),
        })?;
    // The child writes a few lines, which the pipes hold until it has ended.
    while child.try_wait().context(FAILED)?.is_none() {
        if is_stopped() {
            child.kill().context(FAILED)?;
            child.wait().context(FAILED)?;
            bail!("interrupted");
        }
        std::thread::sleep(POLL);
    }
    let output = child.wait_with_output().context(FAILED)?;
    let said = String::from_utf8_lossy(&output.stdout);
    let used = said.lines().find_map(|line| line.strip_prefix(SIMD));
    let used = used.and_then(|name| name.parse().ok());
    if let (true, Some(used)) = (is_illegal(output.status), used) {
        return Ok(Attempt::Illegal(used));
    }
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let last = said.lines().rfind(|line| !line.trim().is_empty());
        let last = last.unwrap_or("no message");
        bail!("{FAILED}: {}: {last}", output.status);
    }
    let text = fs::read_to_string(counts.path()).context(FAILED)?;
    let Some(count) = total(&text).filter(|total| *total > 0) else {
        bail!("callgrind counted nothing");
    };
    Ok(Attempt::Counted(InstructionCount {
        count,
        simd: used.map(|used| used.to_string()),
    }))
}

/// Whether a process was killed by SIGILL.
#[cfg(unix)]
fn is_illegal(status: ExitStatus) -> bool {
    use std::os::unix::process::ExitStatusExt;
    status.signal() == Some(rustix::process::Signal::ILL.as_raw())
}

/// Whether a process was killed by SIGILL.
#[cfg(not(unix))]
fn is_illegal(_: ExitStatus) -> bool {
    false
}

/// The total count in an output file of callgrind.
fn total(text: &str) -> Option<u64> {
    let line = |key| text.lines().find_map(|line: &str| line.strip_prefix(key));
    let totals = line("totals:").or_else(|| line("summary:"))?;
    totals.split_whitespace().next()?.parse().ok()
}

/// Selects the algorithm of [`COMMAND`] with instructions no wider than `simd`, and prints the
/// instruction set that it uses.
///
/// # Errors
///
/// If the algorithm is unknown.
pub fn announce(algorithm: &str, simd: Option<SimdChoice>) -> anyhow::Result<Selection> {
    let mut selection = registry::select_one(algorithm)?;
    if let Some(SimdChoice::AtMost(widest)) = simd {
        selection = selection.at_most(widest);
    }
    println!("{SIMD}{}", selection.instructions());
    Ok(selection)
}

/// Sets up an algorithm for `mesh` and solves once.
///
/// # Errors
///
/// If a source does not exist, or the solver fails.
pub fn solve_once(
    selection: &Selection,
    mesh: &Mesh,
    sources: &[VertexId],
    goal: &Goal,
) -> anyhow::Result<()> {
    let mut solver = selection.build(mesh);
    let solution = counted_solve(&mut *solver, sources, goal)?;
    std::hint::black_box(solution);
    Ok(())
}

/// The solve that callgrind counts. Callgrind finds it by its name, so it must not be inlined or
/// recursive.
#[inline(never)]
fn counted_solve(
    solver: &mut dyn Solver,
    sources: &[VertexId],
    goal: &Goal,
) -> Result<Solution, SolveError> {
    std::hint::black_box(solver).solve_until(sources, goal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_total_is_found_in_what_callgrind_writes() {
        let text = "# callgrind format\nversion: 1\nevents: Ir\nsummary: 77\n\nfn=(1)\n0 77\n\ntotals: 1234567\n";
        assert_eq!(total(text), Some(1_234_567));
        assert_eq!(total("events: Ir\nsummary: 77 3\n"), Some(77));
        assert_eq!(total("events: Ir\n"), None);
    }
}
