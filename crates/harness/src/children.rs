//! The child processes that this process has started, told apart from orphans that Linux has handed
//! to it ([`crate::exec::isolate`]).

use std::io;
use std::process::{Child, Command};
use std::sync::{Mutex, MutexGuard};

use crate::lock::lock;

/// Ids of the children that were started and have not been waited for.
static STARTED: Mutex<Vec<u32>> = Mutex::new(Vec::new());

/// The ids of the children that were started and not waited for. No child is started meanwhile.
pub(crate) fn started() -> MutexGuard<'static, Vec<u32>> {
    lock(&STARTED)
}

/// A child of this process, until it is dropped, which must be after it has been waited for.
#[derive(Debug)]
pub(crate) struct KnownChild(u32);

/// Starts a child.
///
/// # Errors
///
/// If the process cannot be started.
pub(crate) fn spawn(command: &mut Command) -> io::Result<(Child, KnownChild)> {
    // The lock is held so that the child is not taken for an orphan before its id is recorded.
    let mut started = started();
    let child = command.spawn()?;
    started.push(child.id());
    let known = KnownChild(child.id());
    Ok((child, known))
}

impl KnownChild {
    /// The id of the process.
    pub(crate) const fn id(&self) -> u32 {
        self.0
    }
}

impl Drop for KnownChild {
    fn drop(&mut self) {
        started().retain(|child| *child != self.0);
    }
}
