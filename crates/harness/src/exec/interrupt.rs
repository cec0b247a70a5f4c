//! Signals that end the program: Ctrl-C, `SIGTERM`, and those of a terminal that closes or quits.
//!
//! Each removes the temporary files and ends the program, unless the program was started to ignore
//! it (`nohup`). A run listens to the first two: the first signal stops it and keeps its results so
//! far, the second one ends the program at once.
//!
//! A terminal sends Ctrl-C to the foreground process group. Child processes have process groups of
//! their own ([`crate::exec::isolate`]), so only the parent, which holds the results, receives it.

use std::ffi::c_int;
use std::io::{self, Read};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, LazyLock, Mutex, OnceLock, PoisonError};
use std::time::Duration;
use std::{fs, thread};

use geobench_export::temporary;
use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
use signal_hook::{flag, low_level};

/// Exit status of an interrupted command: 128 plus the number of `SIGINT`, as in shells.
pub const EXIT_STATUS: u8 = 130;

/// The signals to which a run [listens](listen).
const STOP: [c_int; 2] = [SIGINT, SIGTERM];

/// Set by the first signal to a run that listens.
static REQUESTED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// Becomes readable with the first signal.
static WAKE: OnceLock<UnixStream> = OnceLock::new();

/// What tells the user about the first signal.
static TELL: OnceLock<fn()> = OnceLock::new();

/// Whether the user has been told.
static TOLD: (Mutex<bool>, Condvar) = (Mutex::new(false), Condvar::new());

/// Lets the signals that end the program remove its temporary files first. A thread sleeps until
/// one arrives.
///
/// # Errors
///
/// If a handler, a socket or a thread cannot be created.
pub fn watch() -> io::Result<()> {
    let last = Arc::new(AtomicUsize::new(0));
    let (mut arrived, arrives) = UnixStream::pair()?;
    for signal in [SIGINT, SIGTERM, SIGHUP, SIGQUIT] {
        if !is_ignored(signal) {
            let number = usize::try_from(signal).unwrap_or_default();
            flag::register_usize(signal, Arc::clone(&last), number)?;
            low_level::pipe::register(signal, arrives.try_clone()?)?;
        }
    }
    let watcher = thread::Builder::new().stack_size(1 << 16);
    watcher.spawn(move || {
        let mut is_first = true;
        while arrived.read_exact(&mut [0]).is_ok() {
            let signal = c_int::try_from(last.load(Ordering::SeqCst)).unwrap_or_default();
            match TELL.get().filter(|_| STOP.contains(&signal)) {
                // The user may stop reading what is told. A second signal ends the program then.
                Some(&tell) if is_first => drop(thread::spawn(move || {
                    tell();
                    *TOLD.0.lock().unwrap_or_else(PoisonError::into_inner) = true;
                    TOLD.1.notify_all();
                })),
                Some(_) => {
                    temporary::remove_all();
                    low_level::exit(EXIT_STATUS.into());
                }
                None => {
                    temporary::remove_all();
                    let _ = low_level::emulate_default_handler(signal);
                }
            }
            is_first = false;
        }
    })?;
    Ok(())
}

/// Whether the program was started to ignore this signal. Where that cannot be known, only the
/// signals of [`STOP`] are taken not to be ignored.
fn is_ignored(signal: c_int) -> bool {
    let ignored = fs::read_to_string("/proc/self/status")
        .ok()
        .and_then(|status| {
            let mask = status
                .lines()
                .find_map(|line| line.strip_prefix("SigIgn:"))?;
            u64::from_str_radix(mask.trim(), 16).ok()
        });
    match ignored {
        Some(mask) => mask >> (signal - 1) & 1 == 1,
        None => !STOP.contains(&signal),
    }
}

/// From now on the first `SIGINT` or `SIGTERM` only sets [`requested`], and calls `tell`.
///
/// # Errors
///
/// If a handler or a socket cannot be created.
pub fn listen(tell: fn()) -> io::Result<()> {
    let (wake, signalled) = UnixStream::pair()?;
    if WAKE.set(wake).is_err() {
        return Ok(());
    }
    for signal in STOP {
        if !is_ignored(signal) {
            flag::register(signal, Arc::clone(&REQUESTED))?;
            low_level::pipe::register(signal, signalled.try_clone()?)?;
        }
    }
    let _ = TELL.set(tell);
    Ok(())
}

/// Whether a signal has arrived.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

/// Waits until the user has been told about the first signal, for a program that is about to end.
pub fn wait_until_told() {
    let told = TOLD.0.lock().unwrap_or_else(PoisonError::into_inner);
    // The limit is for a program whose `watch` has failed.
    let _told = TOLD
        .1
        .wait_timeout_while(told, Duration::from_secs(5), |told| !*told);
}

/// A descriptor that is readable after a signal; `None` before [`listen`].
pub(crate) fn wake() -> Option<BorrowedFd<'static>> {
    WAKE.get().map(AsFd::as_fd)
}
