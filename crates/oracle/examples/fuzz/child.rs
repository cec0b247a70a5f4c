//! Judging in a child process, so that a hang, an abort or exhausted memory affects one answer
//! only.
//!
//! The child is this program with the option [`OPTION`]. It reads [`Request`]s and writes
//! [`Reply`]s, one per line.

use std::collections::HashMap;
use std::env;
use std::io::{self, BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use geobench_registry::select_one;
use rustix::process::{Resource, Rlimit, setrlimit};
use serde::{Deserialize, Serialize};

use crate::case::{Case, Expected, Failure, FailureKind, Skip, Verdict};
use crate::{judge, variants};

/// The option that makes the program a child.
pub(crate) const OPTION: &str = "--child";

/// Address space of a child.
const MOST_MEMORY: u64 = 4 << 30;

/// After this many hangs of an algorithm on one mesh, its other variants are skipped.
const MOST_HANGS: usize = 2;

/// Time limit of the oracle.
const ORACLE_LIMIT: Duration = Duration::from_secs(20);

#[derive(Serialize, Deserialize)]
struct Request {
    case: Case,
    /// The known distances, if any.
    expected: Option<Expected>,
    /// Number of windows of `mmp-fast`, if known.
    work: Option<u64>,
    /// Specs of the algorithms to judge, in order.
    algorithms: Vec<String>,
}

#[derive(Serialize, Deserialize)]
enum Reply {
    Skipped(Skip),
    Expected(Expected),
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
    let expected = match request.expected {
        Some(expected) => expected,
        None => match judge::expected(&case, &mesh) {
            Ok(expected) => expected,
            Err(skip) => return send(&Reply::Skipped(skip)),
        },
    };
    send(&Reply::Expected(expected.clone()))?;
    let work = match request.work {
        None if case.bounded => judge::work_of_mmp(&case, &mesh),
        known => known,
    };
    send(&Reply::Work(work))?;
    for spec in &request.algorithms {
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
    /// Time limit of an algorithm.
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
        let mut work = None;
        let mut work_is_known = !case.bounded;
        let mut verdicts: Vec<Option<Verdict>> = vec![None; algorithms.len()];
        let patience = self.limit;
        loop {
            let waiting = waiting(algorithms, &mut verdicts);
            if waiting.is_empty() {
                break;
            }
            let request = Request {
                case: Case {
                    bounded: !work_is_known,
                    ..case.clone()
                },
                expected: expected.clone(),
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
                match child.replies.recv_timeout(limit) {
                    Ok(Reply::Skipped(skip)) => return Ok(Err(skip)),
                    Ok(Reply::Expected(found)) => {
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
                let selection = select_one(&algorithms[place]).map_err(io::Error::other)?;
                verdicts[place] = Some(match end {
                    RecvTimeoutError::Timeout if !variants::is_bounded(&selection) => {
                        Verdict::LeftOut
                    }
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
