//! Instruction counts of a solve, by Valgrind.
//!
//! Times on a shared machine vary by 10 % and more. Instruction counts vary so little that a gate
//! can limit them to one or two percent. They ignore caches, branch misses and SIMD width. The
//! program starts itself under callgrind as the child of a cell, which counts only inside
//! `counted_solve`: loading and set-up are excluded.
//!
//! Valgrind emulates a processor. Version 3.19 lacks AVX-512 and some encodings of AVX2 (the store
//! form of `vmovq` between two registers, `c5 79 d6 e9`, ends in SIGILL). A solve that fails so is
//! counted again with narrower instructions. The result names the instructions that it used.

use std::fs::{self, File};
use std::io::{self, Seek, Write};
use std::process::{Command, ExitStatus, Stdio};
use std::time::Duration;

use anyhow::{Context, anyhow, bail};
use geobench_export::temporary;
use geobench_mesh::io::ObjReader;
use geobench_window::simd::Instructions;

use crate::children;
use crate::exec::Pass;
use crate::exec::goal::GoalSpec;
use crate::exec::isolate::COMMAND;
use crate::exec::limits::DecompressionLimit;
use crate::exec::protocol::{ChildSettings, Reply, Request};
use crate::schema::{Cell, InstructionCount, ModelRecord};

/// Callgrind's pattern for the function whose instructions are counted. It matches mangled names.
const COUNTED: &str = "*in_process*counted_solve*";

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

/// Counts the instructions of the first solve of `cell` after set-up, in a child process. This
/// takes about fifty times as long as the solve. Uses instructions no wider than those of the cell,
/// and narrower ones if Valgrind does not support those. The child process ends as soon as
/// `is_stopped`.
///
/// # Errors
///
/// If Valgrind is missing, the child process fails or is stopped, or Valgrind does not support even
/// the narrowest instructions.
pub fn count(
    model: &ModelRecord,
    cell: &Cell,
    goal: &GoalSpec,
    decompressed: DecompressionLimit,
    is_stopped: fn() -> bool,
) -> anyhow::Result<InstructionCount> {
    let settings = ChildSettings {
        name: model.name.clone(),
        parent: std::process::id(),
        memory_limit: None,
        max_decompressed: decompressed.0,
        weld: model.weld,
        reader: ObjReader::default().name().to_owned(),
    };
    let simd = cell.simd.as_ref().and_then(|simd| simd.parse().ok());
    let mut widest = Some(simd.unwrap_or(Instructions::Avx512));
    while let Some(simd) = widest {
        let request = Request {
            algorithm: cell.algorithm.clone(),
            simd: simd.to_string(),
            source: cell.source.clone().context("a cell without a source")?,
            targets: goal.targets.as_ref().map(ToString::to_string),
            radius: goal.radius,
            pass: Pass::Time,
            solves: 1,
        };
        if let Some(found) = count_with(&model.path, &settings, &request, is_stopped)? {
            return Ok(found);
        }
        widest = simd.narrower();
    }
    bail!(
        "Valgrind does not know an instruction of the solve, not even with simd=scalar; use a newer \
         Valgrind"
    )
}

/// Counts once. `None` if Valgrind does not support an instruction.
fn count_with(
    model: &str,
    settings: &ChildSettings,
    request: &Request,
    is_stopped: fn() -> bool,
) -> anyhow::Result<Option<InstructionCount>> {
    let program = std::env::current_exe().context(FAILED)?;
    let counts = temporary::registered(tempfile::NamedTempFile::new).context(FAILED)?;
    let mut out_file = std::ffi::OsString::from("--callgrind-out-file=");
    out_file.push(counts.path());
    // A reply holds all distances, more than a pipe does.
    let (mut requests, mut replies) = (tempfile::tempfile()?, tempfile::tempfile()?);
    writeln!(requests, "{}", serde_json::json!(request))?;
    requests.rewind()?;
    let mut command = Command::new("valgrind");
    command
        .args(["--tool=callgrind", "--quiet"])
        .arg(format!("--toggle-collect={COUNTED}"))
        .arg(out_file)
        .arg(program)
        .args([COMMAND, model, &serde_json::json!(settings).to_string()])
        .stdin(requests)
        .stdout(replies.try_clone()?)
        .stderr(Stdio::piped());
    let (mut child, _known) =
        children::spawn(&mut command).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => anyhow!(NO_VALGRIND),
            _ => anyhow!("valgrind cannot be started: {error}"),
        })?;
    while child.try_wait().context(FAILED)?.is_none() {
        if is_stopped() {
            child.kill().context(FAILED)?;
            child.wait().context(FAILED)?;
            bail!("interrupted");
        }
        std::thread::sleep(POLL);
    }
    let output = child.wait_with_output().context(FAILED)?;
    if is_illegal(output.status) {
        return Ok(None);
    }
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let last = said.lines().rfind(|line| !line.trim().is_empty());
        let last = last.unwrap_or("no message");
        bail!("{FAILED}: {}: {last}", output.status);
    }
    let reply = last_reply(&mut replies)?;
    if let Some(problem) = reply.refused.or(reply.crashed) {
        bail!("{FAILED}: {problem}");
    }
    let text = fs::read_to_string(counts.path()).context(FAILED)?;
    let Some(count) = total(&text).filter(|total| *total > 0) else {
        bail!("callgrind counted nothing; a program without symbols (strip) cannot be counted");
    };
    let simd = reply.simd;
    Ok(Some(InstructionCount { count, simd }))
}

/// The reply to the last request.
fn last_reply(replies: &mut File) -> anyhow::Result<Reply> {
    replies.rewind()?;
    let text = io::read_to_string(replies)?;
    let line = text.lines().next_back().unwrap_or_default();
    Reply::parse(line.as_bytes()).map_err(|error| anyhow!("{FAILED}: {error:?}"))
}

/// Whether a process was killed by SIGILL.
fn is_illegal(status: ExitStatus) -> bool {
    use std::os::unix::process::ExitStatusExt;
    status.signal() == Some(rustix::process::Signal::ILL.as_raw())
}

/// The total count in an output file of callgrind.
fn total(text: &str) -> Option<u64> {
    let line = |key| text.lines().find_map(|line: &str| line.strip_prefix(key));
    let totals = line("totals:").or_else(|| line("summary:"))?;
    totals.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_total_is_read_from_the_output_of_callgrind() {
        let text = "# callgrind format\nversion: 1\nevents: Ir\nsummary: 77\n\nfn=(1)\n0 77\n\ntotals: 1234567\n";
        assert_eq!(total(text), Some(1_234_567));
        assert_eq!(total("events: Ir\nsummary: 77 3\n"), Some(77));
        assert_eq!(total("events: Ir\n"), None);
    }
}
