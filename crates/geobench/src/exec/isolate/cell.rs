//! The child's side: takes orders until there are no more.

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
use crate::exec::protocol::{Order, Reply};
use crate::exec::{Executor, Failure, Observation, Purpose, Step, Workplace};
use crate::measure::memory;
use crate::registry;
use crate::schema::Status;

/// Where the last panic came about.
static PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Works on `model` as the parent at the other end of standard input and output wants.
///
/// # Errors
///
/// When it is not understood or cannot answer.
pub(crate) fn cell(model: &OsStr) -> io::Result<()> {
    system::die_with_parent();
    system::call_this_process_a_cell();
    system::no_core_files();
    std::panic::set_hook(Box::new(|panic| {
        let mut place = PANIC.lock().unwrap_or_else(PoisonError::into_inner);
        *place = panic.location().map(ToString::to_string);
    }));
    let mut orders = io::stdin().lock().lines();
    let Some(Order::Load {
        name,
        parent,
        cpus,
        memory_limit,
        max_decompressed,
    }) = next(&mut orders)?
    else {
        return Ok(());
    };
    if !system::is_parent(parent) {
        return Ok(());
    }
    if let Some(bytes) = memory_limit {
        system::bound_data(bytes.saturating_mul(2));
    }
    if !cpus.is_empty() {
        affinity::pin(&cpus)?;
    }
    system::volunteer_when_memory_is_out(true);
    let model = match ModelRef::named_by(model, name) {
        Ok(model) => model,
        Err(error) => return answer(&Reply::Refused(error.to_string())),
    };
    let mut done = Ok(());
    let mut backend = InProcess {
        decompressed: DecompressionLimit(max_decompressed),
    };
    let loaded = backend.with_model(&model, &mut |record, executor| {
        memory::give_back_clean_pages();
        done = answer(&Reply::Loaded(Box::new(record.clone())))
            .and_then(|()| obey(&mut orders, &record.name, executor));
    });
    match loaded {
        Ok(()) => done,
        Err(refusal) => answer(&Reply::Refused(refusal.message)),
    }
}

/// Carries out runs until no more are asked for.
fn obey(
    orders: &mut impl Iterator<Item = io::Result<String>>,
    model: &str,
    executor: &mut dyn Executor,
) -> io::Result<()> {
    let mut sent = None;
    loop {
        system::volunteer_when_memory_is_out(false);
        let Some(order) = next(orders)? else {
            return Ok(());
        };
        system::volunteer_when_memory_is_out(true);
        let Order::Run {
            algorithm,
            source,
            purpose,
        } = order
        else {
            return Err(io::ErrorKind::InvalidInput.into());
        };
        let algorithm = registry::select_one(&algorithm).map_err(io::Error::other)?;
        let step = Step {
            model,
            algorithm: &algorithm,
            source: VertexId::new(source),
            purpose,
        };
        if purpose == Purpose::Clock {
            // What the run needs of it comes back, and counts.
            memory::give_back_clean_pages();
        }
        let reply = match executor.execute(&step) {
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

/// The next order; nothing if the parent has closed its end.
fn next(orders: &mut impl Iterator<Item = io::Result<String>>) -> io::Result<Option<Order>> {
    match orders.next() {
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

/// A crash of which this process knows is a panic.
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
