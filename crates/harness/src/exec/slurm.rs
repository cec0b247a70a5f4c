//! Slurm's commands: submission of jobs and their state.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Output};

use anyhow::{Context, bail};

/// A part that Slurm knows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QueuedPart {
    /// The state in Slurm's words, such as `RUNNING`.
    pub state: String,
    /// The node, or why the part waits.
    pub place: String,
}

/// Submits `script` with `options` and returns the number of its job.
///
/// # Errors
///
/// When Slurm's commands are missing or refuse the job, with what they say.
pub fn submit(script: &Path, options: &[String]) -> anyhow::Result<String> {
    let output = output(
        Command::new("sbatch")
            .arg("--parsable")
            .args(options)
            .arg(script),
    )?;
    if !output.status.success() {
        bail!(
            "sbatch refused {}: {}",
            script.display(),
            complaint(&output)
        );
    }
    let text = String::from_utf8_lossy(&output.stdout);
    // With several clusters: `job;cluster`.
    let job = text.trim().split(';').next().unwrap_or_default();
    if job.is_empty() || !job.bytes().all(|b| b.is_ascii_digit()) {
        bail!(
            "sbatch answers `{}`, which is no number of a job",
            text.trim()
        );
    }
    Ok(job.to_owned())
}

/// The parts of the array jobs `jobs` that wait or run.
///
/// # Errors
///
/// When Slurm's commands are missing or its controller does not answer.
pub fn queued(jobs: &[&str]) -> anyhow::Result<BTreeMap<u32, QueuedPart>> {
    if jobs.is_empty() {
        return Ok(BTreeMap::new());
    }
    let output = output(Command::new("squeue").args([
        "--noheader",
        "--array",
        "--states=all",
        "--format=%F|%K|%T|%R",
        &format!("--jobs={}", jobs.join(",")),
    ]))?;
    let complaint = complaint(&output);
    // A job that ended some minutes ago is forgotten.
    if !output.status.success() && !complaint.contains("Invalid job id") {
        bail!("squeue fails: {complaint}");
    }
    Ok(parse_queue(&String::from_utf8_lossy(&output.stdout), jobs))
}

/// Whether a part in this state will still run or be ended by Slurm.
fn is_alive(state: &str) -> bool {
    [
        "PENDING",
        "RUNNING",
        "CONFIGURING",
        "COMPLETING",
        "REQUEUED",
        "REQUEUE_HOLD",
        "REQUEUE_FED",
        "SUSPENDED",
        "STOPPED",
        "SIGNALING",
        "STAGE_OUT",
        "RESIZING",
    ]
    .contains(&state)
}

/// The parts in lines of `job|part|state|(reason) or node`.
fn parse_queue(text: &str, jobs: &[&str]) -> BTreeMap<u32, QueuedPart> {
    let lines = text.lines().filter_map(|line| {
        let mut fields = line.trim().splitn(4, '|');
        let (job, part, state) = (fields.next()?, fields.next()?, fields.next()?);
        let place = fields.next()?.to_owned();
        let part = part.parse().ok()?;
        (jobs.contains(&job) && is_alive(state)).then(|| {
            let state = state.to_owned();
            (part, QueuedPart { state, place })
        })
    });
    lines.collect()
}

/// Runs one of Slurm's commands.
fn output(command: &mut Command) -> anyhow::Result<Output> {
    let name = command.get_program().to_string_lossy().into_owned();
    command.output().map_err(|error| match error.kind() {
        ErrorKind::NotFound => anyhow::anyhow!(
            "{name}: not found; use a machine that submits to Slurm, or --no-submit for the scripts \
             alone"
        ),
        _ => anyhow::Error::new(error),
    })
    .with_context(|| format!("cannot run {name}"))
}

/// What a command wrote to standard error, in one line.
fn complaint(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr);
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    lines.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_that_wait_or_run_are_read() {
        let text = "12|3|RUNNING|n1\n12|4|PENDING|(Resources)\n12|5|COMPLETED|n2\n12|6|NODE_FAIL|n2\n\
                    13|N/A|PENDING|(Dependency)\n99|7|RUNNING|n3\n";
        let parts = parse_queue(text, &["12", "13"]);
        assert_eq!(parts.keys().copied().collect::<Vec<_>>(), [3, 4]);
        assert_eq!(parts[&3].place, "n1");
        assert_eq!(parts[&4].state, "PENDING");
    }
}
