//! Ctrl-C and `SIGTERM`: the first asks a run to stop and keep what is done, the second ends the
//! program at once.
//!
//! A terminal sends Ctrl-C to the processes of the foreground group. The cells' processes are not
//! in it ([`crate::exec::isolate`]), so that it reaches only the one that can keep their results.

use std::io;
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock, OnceLock};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{flag, low_level};

/// Exit status of a command that was interrupted: 128 and the number of `SIGINT`, as shells have
/// it.
pub const EXIT_STATUS: u8 = 130;

static REQUESTED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// Becomes readable with the first signal.
static WAKE: OnceLock<UnixStream> = OnceLock::new();

/// Takes both signals over, from now until the program ends.
///
/// # Errors
///
/// When the system has no room for a handler or a socket.
pub fn listen() -> io::Result<()> {
    let (wake, signalled) = UnixStream::pair()?;
    if WAKE.set(wake).is_err() {
        return Ok(());
    }
    for signal in [SIGINT, SIGTERM] {
        // In this order: what the first signal sets ends the program with the second.
        let status = i32::from(EXIT_STATUS);
        flag::register_conditional_shutdown(signal, status, Arc::clone(&REQUESTED))?;
        flag::register(signal, Arc::clone(&REQUESTED))?;
        low_level::pipe::register(signal, signalled.try_clone()?)?;
    }
    Ok(())
}

/// Whether somebody has asked to stop.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

/// What becomes readable when somebody asks to stop; nothing if nobody [listens](listen).
pub(crate) fn wake() -> Option<BorrowedFd<'static>> {
    WAKE.get().map(AsFd::as_fd)
}
