//! What users write: errors in it, and TOML files.

pub(crate) mod document;

pub use document::DocumentError;

/// A value from the command line or a file is invalid. The message quotes it and names the
/// allowed values.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct UsageError(pub(crate) String);
