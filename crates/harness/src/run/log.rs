//! Journal and listener of a benchmark.

use std::sync::{Mutex, MutexGuard};

use crate::exec::Listener;
use crate::lock::lock;
use crate::run::journal::{Journal, JournalLine};

/// Journal and listener, shared by concurrent cells.
pub(super) struct RunLog<'l> {
    journal: Mutex<Option<&'l mut Journal>>,
    listener: Mutex<&'l mut dyn Listener>,
}

impl<'l> RunLog<'l> {
    pub(super) fn new(journal: Option<&'l mut Journal>, listener: &'l mut dyn Listener) -> Self {
        Self {
            journal: Mutex::new(journal),
            listener: Mutex::new(listener),
        }
    }

    /// The journal, if there is one. Other cells wait until the guard is dropped.
    pub(super) fn journal(&self) -> MutexGuard<'_, Option<&'l mut Journal>> {
        lock(&self.journal)
    }

    /// The listener. Other cells wait until the guard is dropped.
    pub(super) fn listener(&self) -> MutexGuard<'_, &'l mut dyn Listener> {
        lock(&self.listener)
    }

    /// Whether a signal asks to stop.
    pub(super) fn interrupted(&self) -> bool {
        self.listener().interrupted()
    }

    /// Writes a line to the journal, if there is one.
    pub(super) fn keep(&self, line: JournalLine) -> anyhow::Result<()> {
        match &mut *self.journal() {
            Some(journal) => journal.keep(line),
            None => Ok(()),
        }
    }
}
