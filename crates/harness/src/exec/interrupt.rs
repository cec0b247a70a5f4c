//! Ctrl-C and `SIGTERM`. The first signal stops a run and keeps its results so far. The second one
//! terminates the program at once.
//!
//! A terminal sends Ctrl-C to the foreground process group. Child processes have process groups of
//! their own ([`crate::exec::isolate`]), so only the parent, which holds the results, receives it.

use std::io::{self, Read};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock, OnceLock};
use std::thread;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{flag, low_level};

/// Exit status of an interrupted command: 128 plus the number of `SIGINT`, as in shells.
pub const EXIT_STATUS: u8 = 130;

static REQUESTED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// Becomes readable with the first signal.
static WAKE: OnceLock<UnixStream> = OnceLock::new();

/// Installs handlers for both signals. A thread, which sleeps until then, calls `told` with the
/// first signal.
///
/// # Errors
///
/// If a handler, a socket or a thread cannot be created.
pub fn listen(told: fn()) -> io::Result<()> {
    let (wake, signalled) = UnixStream::pair()?;
    if WAKE.set(wake).is_err() {
        return Ok(());
    }
    let (mut first, tells) = UnixStream::pair()?;
    let teller = thread::Builder::new().stack_size(1 << 16);
    teller.spawn(move || {
        if first.read_exact(&mut [0]).is_ok() {
            told();
        }
    })?;
    for signal in [SIGINT, SIGTERM] {
        // The order matters: the first signal sets the flag, with which the second one terminates.
        let status = i32::from(EXIT_STATUS);
        flag::register_conditional_shutdown(signal, status, Arc::clone(&REQUESTED))?;
        flag::register(signal, Arc::clone(&REQUESTED))?;
        low_level::pipe::register(signal, signalled.try_clone()?)?;
        low_level::pipe::register(signal, tells.try_clone()?)?;
    }
    Ok(())
}

/// Whether a signal has arrived.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

/// A descriptor that is readable after a signal; `None` before [`listen`].
pub(crate) fn wake() -> Option<BorrowedFd<'static>> {
    WAKE.get().map(AsFd::as_fd)
}
