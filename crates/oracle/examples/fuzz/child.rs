//! Judging in a child process, so that a hang, an abort or exhausted memory affects one answer
//! only.
//!
//! The child is this program with the option [`OPTION`]. It reads [`Request`]s and writes
//! [`Reply`]s, one per line.

use std::collections::HashMap;
use std::io::{self, BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};
use std::{env, fs};

use geobench_registry::select_one;
use rustix::process::{Resource, Rlimit, setrlimit};
use serde::{Deserialize, Serialize};

use crate::case::{Case, Expected, Failure, FailureKind, Limited, Reference, Skip, Verdict};
use crate::{judge, variants};

/// The option that makes the program a child.
pub(crate) const OPTION: &str = "--child";

/// Address space of a child.
const MOST_MEMORY: u64 = 4 << 30;

/// After this many hangs of an algorithm on one mesh, its other variants are skipped.
const MOST_HANGS: usize = 2;

/// Least time between two looks at the processor time of a child.
const SHORT: Duration = Duration::from_millis(50);

/// Waits take at most so many times the processor time that is allowed.
const BUSY: u32 = 150;

/// Time limit of the oracle.
const ORACLE_LIMIT: Duration = Duration::from_secs(20);

#[derive(Serialize, Deserialize)]
struct Request {
    case: Case,
    /// The known distances, if any.
    expected: Option<Expected>,
    /// Whether the windows of `mmp-fast` must be counted.
    count: bool,
    /// Number of windows of `mmp-fast`, if known.
    work: Option<u64>,
    /// Specs of the algorithms to judge, in order.
    algorithms: Vec<String>,
}

#[derive(Serialize, Deserialize)]
enum Reply {
    Skipped(Skip),
    Expected(Expected, Reference),
    Work(Option<u64>),
    Judged(Verdict),
}

/// The main loop of the child: answers requests until there are no more.
pub(crate) fn serve() -> io::Result<()> {
    let limit = Rlimit {
        current: Some(MOST_MEMORY),
        maximum: Some(MOST_MEMORY),
    };
    setrlimit(Resource::As, limit)?;
    std::panic::set_hook(Box::new(|_| {}));
    for line in io::stdin().lock().lines() {
        let request: Request = serde_json::from_str(&line?)?;
        answer(request)?;
    }
    Ok(())
}

fn answer(request: Request) -> io::Result<()> {
    let Request { case, .. } = request;
    let mesh = match judge::mesh(&case) {
        Ok(mesh) => mesh,
        Err(skip) => return send(&Reply::Skipped(skip)),
    };
    let (expected, reference) = match request.expected {
        Some(expected) => (expected, Reference::Oracle),
        None => match judge::expected(&case, &mesh) {
            Ok(found) => found,
            Err(skip) => return send(&Reply::Skipped(skip)),
        },
    };
    send(&Reply::Expected(expected.clone(), reference))?;
    let work = match request.work {
        None if request.count => judge::work_of_mmp(&case, &mesh),
        known => known,
    };
    send(&Reply::Work(work))?;
    for spec in &request.algorithms {
        if spec == variants::CERTIFICATE {
            let verdict = judge::judge_certificate(&case, &mesh, &expected);
            send(&Reply::Judged(verdict))?;
            continue;
        }
        let selection = select_one(spec).map_err(io::Error::other)?;
        let verdict = judge::judge(&selection, &case, &mesh, &expected, work);
        send(&Reply::Judged(verdict))?;
    }
    Ok(())
}

fn send(reply: &Reply) -> io::Result<()> {
    let mut out = io::stdout().lock();
    serde_json::to_writer(&mut out, reply)?;
    out.write_all(b"\n")?;
    out.flush()
}

/// The parent's side: starts a child when it is needed, and again after a crash.
pub(crate) struct Judge {
    /// Limit of the processor time of an algorithm, for each thousand faces of large meshes.
    limit: Duration,
    child: Option<Running>,
}

struct Running {
    process: Child,
    stdin: ChildStdin,
    replies: Receiver<Reply>,
}

/// The results of all algorithms on a case.
pub(crate) struct Judged {
    pub(crate) expected: Expected,
    pub(crate) reference: Reference,
    /// In the order of the request.
    pub(crate) verdicts: Vec<Verdict>,
}

impl Judge {
    pub(crate) fn new(limit: Duration) -> Self {
        Self { limit, child: None }
    }

    /// Judges `algorithms` by the `known` distances, or by those of the oracle.
    pub(crate) fn judge(
        &mut self,
        case: &Case,
        known: Option<Expected>,
        algorithms: &[String],
    ) -> io::Result<Result<Judged, Skip>> {
        let mut expected = known;
        let mut reference = Reference::Oracle;
        let mut work = None;
        let mut work_is_known = case.limited == Limited::None;
        let mut verdicts: Vec<Option<Verdict>> = vec![None; algorithms.len()];
        let patience = self.limit.mul_f64((case.faces.len() as f64 / 1e3).max(1.0));
        loop {
            let waiting = waiting(algorithms, &mut verdicts);
            if waiting.is_empty() {
                break;
            }
            let request = Request {
                case: case.clone(),
                expected: expected.clone(),
                count: !work_is_known,
                work,
                algorithms: waiting.iter().map(|&i| algorithms[i].clone()).collect(),
            };
            let child = self.request(&request)?;
            let mut in_oracle = expected.is_none();
            // A second hang is unlikely to be caused by a slow machine.
            let hangs = verdicts.iter().flatten().filter(|v| v.is_hang()).count();
            let patience = if hangs < 2 { patience } else { patience / 4 };
            let mut waiting = waiting.into_iter().peekable();
            let end = loop {
                if waiting.peek().is_none() {
                    break None;
                }
                let limit = if in_oracle { ORACLE_LIMIT } else { patience };
                match child.receive(limit) {
                    Ok(Reply::Skipped(skip)) => return Ok(Err(skip)),
                    Ok(Reply::Expected(found, by)) => {
                        if expected.is_none() {
                            reference = by;
                        }
                        expected = Some(found);
                        in_oracle = false;
                    }
                    Ok(Reply::Work(windows)) => {
                        work = windows;
                        work_is_known = true;
                    }
                    Ok(Reply::Judged(verdict)) => {
                        if let Some(place) = waiting.next() {
                            verdicts[place] = Some(verdict);
                        }
                    }
                    Err(end) => break Some(end),
                }
            };
            let Some(end) = end else { continue };
            let status = self.stop()?;
            if expected.is_none() {
                return Ok(Err(Skip::GaveUp));
            }
            if work_is_known && let Some(place) = waiting.next() {
                let must_end = match select_one(&algorithms[place]) {
                    Ok(selection) => variants::must_end(&selection),
                    Err(_) => true, // The certificate.
                };
                verdicts[place] = Some(match end {
                    RecvTimeoutError::Timeout if !must_end => Verdict::LeftOut,
                    RecvTimeoutError::Timeout => Verdict::Failed(Failure {
                        kind: FailureKind::Hang,
                        text: format!("not done after {} s", patience.as_secs_f64()),
                    }),
                    RecvTimeoutError::Disconnected => Verdict::Failed(Failure {
                        kind: FailureKind::Panic,
                        text: format!("the process died: {status}"),
                    }),
                });
            }
            // `mmp-fast` hung while its windows were counted. Its own turn will report that.
            work_is_known = true;
        }
        let Some(expected) = expected else {
            return Ok(Err(Skip::GaveUp));
        };
        Ok(Ok(Judged {
            expected,
            reference,
            verdicts: verdicts.into_iter().flatten().collect(),
        }))
    }

    fn request(&mut self, request: &Request) -> io::Result<&mut Running> {
        let mut child = match self.child.take() {
            Some(child) => child,
            None => Running::start()?,
        };
        serde_json::to_writer(&mut child.stdin, request)?;
        child.stdin.write_all(b"\n")?;
        child.stdin.flush()?;
        Ok(self.child.insert(child))
    }

    fn stop(&mut self) -> io::Result<String> {
        let Some(mut child) = self.child.take() else {
            return Ok(String::new());
        };
        child.process.kill()?;
        Ok(child.process.wait()?.to_string())
    }
}

/// The indices of the algorithms without a verdict, without those whose other variants hang.
fn waiting(algorithms: &[String], verdicts: &mut [Option<Verdict>]) -> Vec<usize> {
    let mut hangs: HashMap<&str, usize> = HashMap::new();
    for (label, verdict) in algorithms.iter().zip(verdicts.iter()) {
        if verdict.as_ref().is_some_and(Verdict::is_hang) {
            *hangs.entry(variants::name_of(label)).or_default() += 1;
        }
    }
    let mut waiting = Vec::new();
    for (place, label) in algorithms.iter().enumerate() {
        let hung = hangs.get(variants::name_of(label)).copied().unwrap_or(0);
        match &mut verdicts[place] {
            Some(_) => {}
            verdict if hung >= MOST_HANGS => *verdict = Some(Verdict::LeftOut),
            None => waiting.push(place),
        }
    }
    waiting
}

impl Drop for Judge {
    fn drop(&mut self) {
        let _ = self.stop();
    }
}

impl Running {
    /// The next reply, if it comes within `limit` of processor time.
    fn receive(&self, limit: Duration) -> Result<Reply, RecvTimeoutError> {
        let start = (Instant::now(), self.processor_time());
        let mut used = Duration::ZERO;
        loop {
            match self
                .replies
                .recv_timeout(limit.saturating_sub(used).max(SHORT))
            {
                Err(RecvTimeoutError::Timeout) => {}
                received => return received,
            }
            let elapsed = start.0.elapsed();
            used = match (start.1, self.processor_time()) {
                (Some(before), Some(now)) => now.saturating_sub(before),
                _ => elapsed,
            };
            if used >= limit || elapsed > BUSY * limit {
                return Err(RecvTimeoutError::Timeout);
            }
        }
    }

    /// The processor time of the child so far; `None` where the system does not have `/proc`.
    fn processor_time(&self) -> Option<Duration> {
        const TICKS_PER_SECOND: f64 = 100.0;
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.process.id())).ok()?;
        // The name of the program, in brackets, may have spaces. The times are fields 14 and 15.
        let (_, fields) = stat.rsplit_once(')')?;
        let ticks = fields
            .split_whitespace()
            .skip(11)
            .take(2)
            .map(str::parse::<f64>);
        let ticks: f64 = ticks.collect::<Result<Vec<_>, _>>().ok()?.iter().sum();
        Some(Duration::from_secs_f64(ticks / TICKS_PER_SECOND))
    }

    fn start() -> io::Result<Self> {
        let mut process = Command::new(env::current_exe()?)
            .arg(OPTION)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        let (Some(stdin), Some(stdout)) = (process.stdin.take(), process.stdout.take()) else {
            return Err(io::Error::other("the child has no pipes"));
        };
        let (sender, replies) = channel();
        thread::spawn(move || {
            for line in BufReader::new(stdout).lines() {
                let reply = line.ok().and_then(|line| serde_json::from_str(&line).ok());
                if reply.is_none_or(|reply| sender.send(reply).is_err()) {
                    return;
                }
            }
        });
        Ok(Self {
            process,
            stdin,
            replies,
        })
    }
}
