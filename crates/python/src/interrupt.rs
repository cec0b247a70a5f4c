//! Long calls: without the lock of the interpreter, and ended by Ctrl-C.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use geodesic::Stop;
use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;

/// How often a long call looks for signals.
const PERIOD: Duration = Duration::from_millis(20);

/// How long a call that was interrupted waits for its work to end. Most of it ends within
/// milliseconds; what does not goes on in its thread until it sees that it is to stop, or to its end
/// if it takes no [`Stop`].
const GRACE: Duration = Duration::from_millis(500);

/// Calls with fewer faces than this, times the number of sources, take milliseconds. They are
/// carried out in the calling thread.
pub(crate) const SHORT: usize = 2_000;

/// The result of `work`, which runs in a thread of its own while this one looks for signals. Ctrl-C
/// sets `stop` and raises `KeyboardInterrupt`.
pub(crate) fn long<T: Send + 'static>(
    py: Python<'_>,
    stop: &Stop,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, mut receiver) = mpsc::channel();
    thread::Builder::new()
        .name("geobench".to_owned())
        .spawn(move || {
            // After an interruption the caller has gone.
            let _ = sender.send(catch_unwind(AssertUnwindSafe(work)));
        })
        .map_err(|error| PyOSError::new_err(format!("no thread for the solver: {error}")))?;
    let mut wait = |time: Duration| {
        // A receiver cannot be shared, so it goes there and back.
        let there = std::mem::replace(&mut receiver, mpsc::channel().1);
        let (back, result) = py.detach(move || {
            let result = there.recv_timeout(time);
            (there, result)
        });
        receiver = back;
        result
    };
    loop {
        match wait(PERIOD) {
            Ok(result) => return result.map_err(panicked),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the solver left no result"));
            }
        }
        if let Err(interrupt) = py.check_signals() {
            stop.set();
            let _ = wait(GRACE);
            return Err(interrupt);
        }
    }
}

/// The result of `work` on so many faces, times the number of sources.
pub(crate) fn call<T: Send + 'static>(
    py: Python<'_>,
    faces: usize,
    stop: &Stop,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    if faces > SHORT {
        return long(py, stop, work);
    }
    py.detach(|| catch_unwind(AssertUnwindSafe(work)))
        .map_err(panicked)
}

fn panicked(panic: Box<dyn Any + Send>) -> PyErr {
    let message = panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("no message");
    PyRuntimeError::new_err(format!(
        "the algorithm panicked: {message}; please report the mesh"
    ))
}
