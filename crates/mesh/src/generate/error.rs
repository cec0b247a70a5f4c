//! Errors in specs.

use super::MAX_FACES;

/// Why a spec is invalid. Each message says what to write instead.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// There is no family of this name.
    #[error("unknown model family `{name}`{hint}; there are {known}")]
    UnknownFamily {
        /// The name asked for.
        name: String,
        /// The most similar name as a question, if one is similar.
        hint: String,
        /// All names, separated by commas.
        known: String,
    },
    /// The family has no such key.
    #[error("`{family}` has no key `{key}`{hint}; it takes {known}")]
    UnknownKey {
        /// The family's name.
        family: &'static str,
        /// The key asked for.
        key: String,
        /// The most similar key as a question, if one is similar.
        hint: String,
        /// All keys, separated by commas.
        known: String,
    },
    /// A key stands without a value.
    #[error("`{piece}` in the spec of `{family}` is not of the form key=value")]
    NoValue {
        /// The family's name.
        family: &'static str,
        /// The piece of the spec.
        piece: String,
    },
    /// A key is set more than once, by itself or through a key that stands for several.
    #[error("`{key}` of `{family}` is set twice")]
    Repeated {
        /// The family's name.
        family: &'static str,
        /// The key.
        key: &'static str,
    },
    /// A value does not parse or lies out of its range.
    #[error("`{key}={value}` of `{family}` is not valid: {key} is {wanted}")]
    BadValue {
        /// The family's name.
        family: &'static str,
        /// The key.
        key: &'static str,
        /// The value given.
        value: String,
        /// The kind of value and its range in words.
        wanted: String,
    },
    /// A value that starts with a quotation mark does not end with one.
    #[error("the quoted value of `{key}` does not end with a quotation mark at a comma or the end")]
    OpenQuote {
        /// The key.
        key: String,
    },
    /// A key without a default is missing.
    #[error("`{family}` needs `{key}=...`: {summary}")]
    Missing {
        /// The family's name.
        family: &'static str,
        /// The key.
        key: &'static str,
        /// The meaning of the key.
        summary: &'static str,
    },
    /// Values are valid one by one, but not together.
    #[error("`{family}`: {why}")]
    Unfit {
        /// The family's name.
        family: &'static str,
        /// The reason, and how to fix it.
        why: String,
    },
    /// The model would be too large.
    #[error("the model would have {faces} faces, more than the limit of {MAX_FACES}")]
    TooManyFaces {
        /// Number of triangles asked for; `u64::MAX` also stands for anything larger.
        faces: u64,
    },
    /// The spec modifies a file, which only the caller can read.
    #[error("`gen:file` modifies the model in {path}, which must be loaded first")]
    NeedsFile {
        /// The file's path.
        path: String,
    },
}
