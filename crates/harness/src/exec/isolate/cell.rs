//! The side of the child process: answers requests until standard input ends.

use std::ffi::OsStr;
use std::io::{self, BufRead, Write};
use std::sync::Mutex;

use geobench_mesh::Weld;
use geobench_registry as registry;
use sha2::{Digest, Sha256};

use super::system;
use crate::exec::goal::GoalSpec;
use crate::exec::in_process::InProcess;
use crate::exec::limits::DecompressionLimit;
use crate::exec::model::ModelRef;
use crate::exec::protocol::{ChildSettings, Reply, Request};
use crate::exec::source::SourceSpec;
use crate::exec::{Failure, Session, Step};
use crate::lock::lock;
use crate::schema::Status;

/// Location of the last panic.
static PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Answers requests from standard input on standard output. The arguments are the model and
/// `ChildSettings`.
///
/// # Errors
///
/// If a request is malformed or a reply cannot be written.
pub fn cell(model: &OsStr, settings: &str) -> io::Result<()> {
    std::panic::set_hook(Box::new(|panic| {
        let mut place = lock(&PANIC);
        *place = panic.location().map(ToString::to_string);
    }));
    let settings: ChildSettings = serde_json::from_str(settings)?;
    let data_limit = settings.memory_limit.map(|bytes| bytes.saturating_mul(2));
    if !system::become_child(settings.parent, data_limit) {
        return Ok(());
    }
    system::raise_oom_score(true);
    let refuse = |message| {
        answer(&Reply {
            refused: Some(message),
            ..Reply::default()
        })
    };
    let weld = settings.weld.map(Weld::within).transpose();
    let weld = weld.map_err(io::Error::other)?;
    let reader = settings.reader.parse().map_err(io::Error::other)?;
    let model = match ModelRef::named_by(model, settings.name, weld, reader) {
        Ok(model) => model,
        Err(error) => return refuse(error.to_string()),
    };
    let limit = DecompressionLimit(settings.max_decompressed);
    let session = match InProcess::open(&model, limit) {
        Ok(session) => session,
        Err(refusal) => return refuse(refusal.message),
    };
    answer(&Reply {
        ready: true,
        model: Some(Box::new(session.model().clone())),
        ..Reply::default()
    })?;
    serve(&model.name, session)
}

/// Executes the requested runs until standard input ends.
fn serve(model: &str, mut session: InProcess) -> io::Result<()> {
    let mut sent = None;
    let mut requests = io::stdin().lock().lines();
    loop {
        system::raise_oom_score(false);
        let Some(line) = requests.next() else {
            return Ok(());
        };
        let request: Request = serde_json::from_str(&line?)?;
        system::raise_oom_score(true);
        let algorithm = registry::select_one(&request.algorithm).map_err(io::Error::other)?;
        let algorithm = algorithm.at_most(request.simd.parse().map_err(io::Error::other)?);
        let targets = request.targets.as_deref().map(str::parse).transpose();
        let goal = GoalSpec {
            targets: targets.map_err(io::Error::other)?,
            radius: request.radius,
        };
        let step = Step {
            model,
            algorithm: &algorithm,
            source: &SourceSpec::from(&request.source),
            goal: &goal,
            pass: request.pass,
            solves: request.solves,
        };
        answer(&match session.execute(&step) {
            Ok(observation) => {
                let digest = Some(digest(&observation.distances));
                let mut reply = Reply {
                    simd: Some(algorithm.instructions().to_string()),
                    ..Reply::from(observation)
                };
                if sent == digest {
                    reply.distances = None;
                }
                sent = digest;
                reply
            }
            Err(Failure {
                status: Status::Crashed,
                message,
            }) => Reply {
                crashed: Some(with_place_of_panic(message)),
                ..Reply::default()
            },
            Err(Failure { message, .. }) => Reply {
                refused: Some(message),
                ..Reply::default()
            },
        })?;
    }
}

fn answer(reply: &Reply) -> io::Result<()> {
    let mut line = serde_json::to_vec(reply)?;
    line.push(b'\n');
    let mut stdout = io::stdout().lock();
    stdout.write_all(&line)?;
    stdout.flush()
}

fn digest(distances: &[f64]) -> [u8; 32] {
    let mut hasher = Sha256::new();
    for distance in distances {
        hasher.update(distance.to_le_bytes());
    }
    hasher.finalize().into()
}

/// Adds the location of the last panic to the message. A crash that this process itself reports is
/// always a panic.
fn with_place_of_panic(message: String) -> String {
    let mut place = lock(&PANIC);
    match place.take() {
        Some(place) => format!("{message} ({place})"),
        None => message,
    }
}
