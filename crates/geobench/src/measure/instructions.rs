//! Instructions of a solve, counted by Valgrind.
//!
//! Times on a shared machine vary by 10 % and more; instruction counts vary so little that a gate
//! can hold them to one or two percent. Instruction counts ignore caches, branch misses and SIMD
//! width. The program starts itself under callgrind, which counts inside `counted_solve` only:
//! loading and set-up are excluded.
//!
//! Valgrind emulates a processor. Version 3.19 has AVX2 without some encodings (`vmovq` between two
//! registers in its store form, `c5 79 d6 e9`, ends in SIGILL), and no AVX-512. Such a solve is
//! counted again with narrower instructions; the count names them.

use std::fs;
use std::process::{Command, ExitStatus, Stdio};

use anyhow::{Context, bail};
use geobench_mesh::{Mesh, VertexId};
use geobench_window::simd::Instructions;
use geobench_window::{Goal, Solution, SolveError, Solver};

use crate::registry::{self, Selection};
use crate::schema::InstructionCount;

/// The hidden command that does one solve under callgrind.
pub const COMMAND: &str = "count-one-solve";

/// Callgrind's pattern of the function in which instructions are counted; mangled names match too.
const COUNTED: &str = "*instructions*counted_solve*";

/// Prefix of the line in which [`COMMAND`] prints the vector instructions that it uses.
const SIMD: &str = "simd: ";

/// Context of an error that Valgrind cannot be started.
const NO_VALGRIND: &str = "counting instructions needs valgrind on the path";

/// Context of an error of the call.
const FAILED: &str = "callgrind failed";

/// Checks that Valgrind is installed.
///
/// # Errors
///
/// When it cannot be started.
pub fn check_valgrind() -> anyhow::Result<()> {
    let status = Command::new("valgrind")
        .arg("--version")
        .stdout(Stdio::null())
        .status();
    status.map(drop).context(NO_VALGRIND)
}

/// Counts the instructions of the first solve after set-up, in a process of its own. Takes about
/// fifty times as long as the solve. Uses instructions no wider than `simd`, and falls back to
/// narrower vector instructions if Valgrind does not support one.
///
/// # Errors
///
/// When Valgrind is missing or the process does not end well.
pub fn count(
    model: &str,
    algorithm: &str,
    source: &str,
    goal: &[String],
    simd: Option<Instructions>,
) -> anyhow::Result<InstructionCount> {
    let mut widest = simd;
    loop {
        match count_with(model, algorithm, source, goal, widest)? {
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

/// The result of counting with one set of vector instructions.
enum Attempt {
    Counted(InstructionCount),
    /// Valgrind does not support one of these.
    Illegal(Instructions),
}

/// Counts with instructions no wider than `widest`.
fn count_with(
    model: &str,
    algorithm: &str,
    source: &str,
    goal: &[String],
    widest: Option<Instructions>,
) -> anyhow::Result<Attempt> {
    let program = std::env::current_exe().context(FAILED)?;
    let counts = tempfile::NamedTempFile::new().context(FAILED)?;
    let mut out_file = std::ffi::OsString::from("--callgrind-out-file=");
    out_file.push(counts.path());
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--quiet"])
        .arg(format!("--toggle-collect={COUNTED}"))
        .arg(out_file)
        .arg(program)
        .args([COMMAND, model, algorithm, source])
        .args(goal)
        .args(widest.map(|widest| format!("--simd={widest}")))
        .stdin(Stdio::null())
        .output()
        .context(NO_VALGRIND)?;
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

/// Whether a process ended by an illegal instruction.
#[cfg(unix)]
fn is_illegal(status: ExitStatus) -> bool {
    use std::os::unix::process::ExitStatusExt;
    status.signal() == Some(rustix::process::Signal::ILL.as_raw())
}

/// Whether a process ended by an illegal instruction.
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

/// Selects the algorithm of [`COMMAND`] with no wider instructions than `widest`, and prints the
/// instructions that it uses.
///
/// # Errors
///
/// When the algorithm or the instructions are unknown.
pub fn announce(algorithm: &str, widest: Option<&str>) -> anyhow::Result<Selection> {
    let mut selection = registry::select_one(algorithm)?;
    if let Some(name) = widest {
        let Ok(widest) = name.parse() else {
            bail!("--simd {name}: not one of avx512, avx2 and scalar");
        };
        selection = selection.at_most(widest);
    }
    println!("{SIMD}{}", selection.instructions());
    Ok(selection)
}

/// Sets an algorithm up for `mesh` and solves once.
///
/// # Errors
///
/// When the source does not exist.
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

/// The solve that callgrind counts, found by the name of this function: it must not be inlined or
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
