//! Instructions of a solve, counted by Valgrind.
//!
//! Times on a shared machine vary by 10 % and more; the number of instructions hardly varies at all, and a
//! gate can hold it to a per cent or two. It is no time: it knows nothing of caches, branches and the
//! width of vectors. The program starts itself under callgrind, which counts only while it is inside
//! `counted_solve`, so that loading the model and setting the algorithm up do not dilute the
//! figure.
//!
//! What callgrind runs is its own processor, so the counts do not depend on this one's vector
//! instructions as far as Valgrind does not know them: version 3.19 has AVX2 and no AVX-512.

use std::fs;
use std::io;
use std::process::{Command, Stdio};

use anyhow::bail;
use geobench_mesh::VertexId;
use geobench_window::{Solution, SolveError, Solver};

use crate::model;
use crate::registry;

/// The hidden command that does one solve under callgrind.
pub const COMMAND: &str = "count-one-solve";

/// The function in which instructions are counted, as callgrind's patterns find it whether or not the
/// name is mangled.
const COUNTED: &str = "*instructions*counted_solve*";

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

/// Counts the instructions of one solve, the first after the set-up, in a process of its own; some fifty
/// times as slow as the solve itself.
///
/// # Errors
///
/// When Valgrind is missing or the process does not end well.
pub fn count(model: &str, algorithm: &str, source: u32) -> Result<u64, InstructionsError> {
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
        .stdin(Stdio::null())
        .output()
        .map_err(InstructionsError::NoValgrind)?;
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
    total(&text)
        .filter(|total| *total > 0)
        .ok_or(InstructionsError::Nothing)
}

/// The instructions in a file that callgrind wrote.
fn total(text: &str) -> Option<u64> {
    let line = |key| text.lines().find_map(|line: &str| line.strip_prefix(key));
    let totals = line("totals:").or_else(|| line("summary:"))?;
    totals.split_whitespace().next()?.parse().ok()
}

/// What [`COMMAND`] does: loads a model, sets an algorithm up and solves once.
///
/// # Errors
///
/// When one of the three does not exist.
pub fn solve_once(model: &str, algorithm: &str, source: u32) -> anyhow::Result<()> {
    let selection = registry::select_one(algorithm)?;
    let models = model::collect(&[model])?;
    let [model] = &models[..] else {
        bail!("{model}: {} models instead of one", models.len());
    };
    let loaded = model.load()?;
    let mut solver = selection.build(&loaded.mesh);
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

    #[test]
    fn one_solve_needs_all_three() {
        assert!(solve_once("gen:cube,n=1", "vtp", 0).is_ok());
        assert!(solve_once("gen:cube,n=1", "vtp", 999).is_err());
        assert!(solve_once("gen:cube,n=1", "vtq", 0).is_err());
        assert!(solve_once("no.obj", "vtp", 0).is_err());
    }
}
