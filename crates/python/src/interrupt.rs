//! Long calls, which release the lock of the interpreter and end on Ctrl-C.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use geodesics::Stop;
use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;

/// Interval at which a long call checks for signals.
const PERIOD: Duration = Duration::from_millis(20);

/// How long an interrupted call waits for its work to end. Most work ends within milliseconds.
/// Other work continues in its thread after the call: until it checks its [`Stop`], or to its end
/// if it has none.
const GRACE: Duration = Duration::from_millis(500);

/// A call takes milliseconds if its number of faces times its number of sources is at most this. It
/// then runs in the calling thread.
pub(crate) const SHORT: usize = 2_000;

/// Runs `work` in a new thread, while this thread checks for signals. Returns its result. Ctrl-C
/// sets `stop` and raises `KeyboardInterrupt`. A panic of `work` becomes a `RuntimeError`.
pub(crate) fn long<T: Send + 'static>(
    py: Python<'_>,
    stop: &Stop,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, mut receiver) = mpsc::channel();
    thread::Builder::new()
        .name("geodesics".to_owned())
        .spawn(move || {
            // Sending fails if the caller was interrupted and no longer waits.
            let _ = sender.send(catch_unwind(AssertUnwindSafe(work)));
        })
        .map_err(|error| PyOSError::new_err(format!("no thread for the solver: {error}")))?;
    let mut wait = |time: Duration| {
        // A shared reference could not be sent, since a `Receiver` is not `Sync`.
        let receiver = &mut receiver;
        py.detach(move || receiver.recv_timeout(time))
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

/// Runs `work` and returns its result. `faces` is the number of faces times the number of sources;
/// if it exceeds [`SHORT`], the call can be interrupted as in [`long`].
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
