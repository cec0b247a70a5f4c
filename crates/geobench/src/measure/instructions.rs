//! Instructions of a solve, counted by Valgrind.
//!
//! Times on a shared machine vary by 10 % and more; the number of instructions hardly varies at
//! all, and a gate can hold it to a per cent or two. It is no time: it knows nothing of caches,
//! branches and the width of vectors. The program starts itself under callgrind, which counts only
//! while it is inside `counted_solve`, so that loading the model and setting the algorithm up do
//! not dilute the figure.
//!
//! Valgrind emulates a processor of its own. Version 3.19 has AVX2 and no AVX-512, and it does not
//! know every encoding of AVX2: `vmovq` between two registers in the form that stores (`c5 79 d6
//! e9`) ends a solve with SIGILL. Such a solve is counted again with narrower instructions, and the
//! count says with which it was made.

use std::fs;
use std::io;
use std::process::{Command, ExitStatus, Stdio};

use anyhow::bail;
use geobench_mesh::{Mesh, VertexId};
use geobench_vtp::Instructions;
use geobench_window::{Solution, SolveError, Solver};

use crate::registry::{self, Selection};
use crate::schema::InstructionCount;

/// The hidden command that does one solve under callgrind.
pub const COMMAND: &str = "count-one-solve";

/// The function in which instructions are counted, as callgrind's patterns find it whether or not
/// the name is mangled.
const COUNTED: &str = "*instructions*counted_solve*";

/// What the line starts with in which [`COMMAND`] says which instructions it uses.
const SIMD: &str = "simd: ";

/// Why instructions could not be counted.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InstructionsError {
    /// There is no Valgrind.
    #[error("counting instructions needs valgrind on the path: {0}")]
    NoValgrind(io::Error),
    /// It did not end well.
    #[error("callgrind failed: {0}")]
    Failed(String),
    /// It does not know an instruction of the program, whatever the solver uses.
    #[error(
        "Valgrind does not know an instruction of the solve, not even with simd={0}; use a newer Valgrind"
    )]
    Unknown(Instructions),
    /// It said nothing of instructions.
    #[error("callgrind counted nothing")]
    Nothing,
}

/// Makes sure that there is a Valgrind.
///
/// # Errors
///
/// When it cannot be started.
pub fn check_valgrind() -> Result<(), InstructionsError> {
    let status = Command::new("valgrind")
        .arg("--version")
        .stdout(Stdio::null())
        .status();
    status.map(drop).map_err(InstructionsError::NoValgrind)
}

/// Counts the instructions of one solve, the first after the set-up, in a process of its own; some
/// fifty times as slow as the solve itself. Where Valgrind does not know an instruction, narrower
/// ones are used.
///
/// # Errors
///
/// When Valgrind is missing or the process does not end well.
pub fn count(
    model: &str,
    algorithm: &str,
    source: u32,
) -> Result<InstructionCount, InstructionsError> {
    let mut widest = None;
    loop {
        match count_with(model, algorithm, source, widest)? {
            Attempt::Counted(found) => return Ok(found),
            Attempt::Illegal(used) => {
                let narrower =
                    registry::next_narrower(used).ok_or(InstructionsError::Unknown(used))?;
                widest = Some(narrower);
            }
        }
    }
}

/// What came of counting with some instructions.
enum Attempt {
    Counted(InstructionCount),
    /// Valgrind does not know one of these.
    Illegal(Instructions),
}

/// Counts with instructions no wider than `widest`.
fn count_with(
    model: &str,
    algorithm: &str,
    source: u32,
    widest: Option<Instructions>,
) -> Result<Attempt, InstructionsError> {
    let failed = |error: io::Error| InstructionsError::Failed(error.to_string());
    let program = std::env::current_exe().map_err(failed)?;
    let counts = tempfile::NamedTempFile::new().map_err(failed)?;
    let mut out_file = std::ffi::OsString::from("--callgrind-out-file=");
    out_file.push(counts.path());
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--quiet"])
        .arg(format!("--toggle-collect={COUNTED}"))
        .arg(out_file)
        .arg(program)
        .args([COMMAND, model, algorithm, &source.to_string()])
        .args(widest.map(|widest| format!("--simd={widest}")))
        .stdin(Stdio::null())
        .output()
        .map_err(InstructionsError::NoValgrind)?;
    let said = String::from_utf8_lossy(&output.stdout);
    let used = said.lines().find_map(|line| line.strip_prefix(SIMD));
    let used = used.and_then(registry::instructions_named);
    if let (true, Some(used)) = (is_illegal(output.status), used) {
        return Ok(Attempt::Illegal(used));
    }
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let last = said.lines().rfind(|line| !line.trim().is_empty());
        return Err(InstructionsError::Failed(format!(
            "{}: {}",
            output.status,
            last.unwrap_or("no message")
        )));
    }
    let text = fs::read_to_string(counts.path()).map_err(failed)?;
    let count = total(&text)
        .filter(|total| *total > 0)
        .ok_or(InstructionsError::Nothing)?;
    Ok(Attempt::Counted(InstructionCount {
        count,
        simd: used.map(|used| used.to_string()),
    }))
}

/// Whether a process ended because of an instruction that its processor does not know.
#[cfg(unix)]
fn is_illegal(status: ExitStatus) -> bool {
    use std::os::unix::process::ExitStatusExt;
    status.signal() == Some(rustix::process::Signal::ILL.as_raw())
}

/// Whether a process ended because of an instruction that its processor does not know.
#[cfg(not(unix))]
fn is_illegal(_: ExitStatus) -> bool {
    false
}

/// The instructions in a file that callgrind wrote.
fn total(text: &str) -> Option<u64> {
    let line = |key| text.lines().find_map(|line: &str| line.strip_prefix(key));
    let totals = line("totals:").or_else(|| line("summary:"))?;
    totals.split_whitespace().next()?.parse().ok()
}

/// The algorithm of [`COMMAND`], with no wider instructions than `widest`; says on standard output
/// which it uses.
///
/// # Errors
///
/// When there is no such algorithm, or `widest` names no instructions.
pub fn announce(algorithm: &str, widest: Option<&str>) -> anyhow::Result<Selection> {
    let mut selection = registry::select_one(algorithm)?;
    if let Some(name) = widest {
        let Some(widest) = registry::instructions_named(name) else {
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
pub fn solve_once(selection: &Selection, mesh: &Mesh, source: u32) -> anyhow::Result<()> {
    let mut solver = selection.build(mesh);
    let solution = counted_solve(&mut *solver, VertexId::new(source))?;
    std::hint::black_box(solution);
    Ok(())
}

/// The solve that is counted: callgrind knows it by its name, so it must stay a function of its
/// own and must not call itself.
#[inline(never)]
fn counted_solve(solver: &mut dyn Solver, source: VertexId) -> Result<Solution, SolveError> {
    std::hint::black_box(solver).solve(&[source])
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
