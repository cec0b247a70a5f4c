//! Errors of users.

/// A value from the command line or a file is invalid. The message quotes it and says what is
/// allowed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct UsageError(pub(crate) String);
