//! The result of a command, from which the exit status follows.

/// The result of a command that completed, from which the exit status follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// All work is done and every check passed.
    Passed,
    /// A check, a comparison or a cell failed. The others are reported.
    Failed,
    /// Some input could not be used. Results of the rest are reported.
    BadInput,
    /// A signal ended the command. Finished work is reported.
    Interrupted,
}

impl Verdict {
    /// The verdict of a command with one check.
    pub(crate) const fn of(has_passed: bool) -> Self {
        if has_passed {
            Self::Passed
        } else {
            Self::Failed
        }
    }
}
