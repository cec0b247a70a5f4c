//! The child's side: answers requests until standard input ends.

use std::ffi::OsStr;
use std::io::{self, BufRead, Write};
use std::sync::{Mutex, PoisonError};

use geobench_mesh::VertexId;
use sha2::{Digest, Sha256};

use super::system;
use crate::exec::affinity;
use crate::exec::in_process::InProcess;
use crate::exec::limits::DecompressionLimit;
use crate::exec::model::ModelRef;
use crate::exec::protocol::{Reply, Request};
use crate::exec::{Backend, Failure, Observation, Pass, Session, Step};
use crate::measure::memory;
use crate::registry;
use crate::schema::Status;

/// Location of the last panic.
static PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Serves requests about `model` over standard input and output.
///
/// # Errors
///
/// When a request is not understood or a reply cannot be written.
pub(crate) fn cell(model: &OsStr) -> io::Result<()> {
    system::die_with_parent();
    system::name_this_process();
    system::disable_core_dumps();
    std::panic::set_hook(Box::new(|panic| {
        let mut place = PANIC.lock().unwrap_or_else(PoisonError::into_inner);
        *place = panic.location().map(ToString::to_string);
    }));
    let mut requests = io::stdin().lock().lines();
    let Some(Request::Load {
        name,
        parent,
        cpus,
        memory_limit,
        max_decompressed,
    }) = next(&mut requests)?
    else {
        return Ok(());
    };
    if !system::is_parent(parent) {
        return Ok(());
    }
    if let Some(bytes) = memory_limit {
        system::limit_data(bytes.saturating_mul(2));
    }
    if !cpus.is_empty() {
        affinity::pin(&cpus)?;
    }
    system::raise_oom_score(true);
    let model = match ModelRef::named_by(model, name) {
        Ok(model) => model,
        Err(error) => return answer(&Reply::Refused(error.to_string())),
    };
    let mut done = Ok(());
    let mut backend = InProcess {
        decompressed: DecompressionLimit(max_decompressed),
    };
    let loaded = backend.with_model(&model, &mut |record, session| {
        memory::give_back_clean_pages();
        done = answer(&Reply::Loaded(Box::new(record.clone())))
            .and_then(|()| serve(&mut requests, &record.name, session));
    });
    match loaded {
        Ok(()) => done,
        Err(refusal) => answer(&Reply::Refused(refusal.message)),
    }
}

/// Carries out the requested runs.
fn serve(
    requests: &mut impl Iterator<Item = io::Result<String>>,
    model: &str,
    session: &mut dyn Session,
) -> io::Result<()> {
    let mut sent = None;
    loop {
        system::raise_oom_score(false);
        let Some(request) = next(requests)? else {
            return Ok(());
        };
        system::raise_oom_score(true);
        let Request::Run {
            algorithm,
            source,
            pass,
        } = request
        else {
            return Err(io::ErrorKind::InvalidInput.into());
        };
        let algorithm = registry::select_one(&algorithm).map_err(io::Error::other)?;
        let step = Step {
            model,
            algorithm: &algorithm,
            source: VertexId::new(source),
            pass,
        };
        if pass == Pass::Profile {
            // Pages that the run needs come back, and count.
            memory::give_back_clean_pages();
        }
        let reply = match session.execute(&step) {
            Ok(observation) => {
                let digest = Some(digest(&observation.distances));
                if sent == digest {
                    Reply::RanAgain(Box::new(Observation {
                        distances: Vec::new(),
                        ..observation
                    }))
                } else {
                    sent = digest;
                    Reply::Ran(Box::new(observation))
                }
            }
            Err(failure) => Reply::Failed(with_place_of_panic(failure)),
        };
        answer(&reply)?;
    }
}

/// The next request; `None` if the parent has closed its end.
fn next(requests: &mut impl Iterator<Item = io::Result<String>>) -> io::Result<Option<Request>> {
    match requests.next() {
        Some(line) => Ok(Some(serde_json::from_str(&line?)?)),
        None => Ok(None),
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

/// A crash reported by this process itself is a panic.
fn with_place_of_panic(failure: Failure) -> Failure {
    let place = PANIC
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .take()
        .filter(|_| failure.status == Status::Crashed);
    match place {
        Some(place) => Failure {
            message: format!("{} ({place})", failure.message),
            ..failure
        },
        None => failure,
    }
}
