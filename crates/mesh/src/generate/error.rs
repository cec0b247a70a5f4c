//! Errors in specs.

use super::MAX_FACES;

/// Why a spec names no model. Each message says what to write instead.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// There is no family of this name.
    #[error("unknown model family `{name}`{}; there are {known}", suggest(.nearest.as_ref()))]
    UnknownFamily {
        /// What was asked for.
        name: String,
        /// The most similar name, if one is similar.
        nearest: Option<&'static str>,
        /// All names, separated by commas.
        known: String,
    },
    /// The family has no such key.
    #[error("`{family}` has no key `{key}`{}; it takes {known}", suggest(.nearest.as_ref()))]
    UnknownKey {
        /// The family's name.
        family: &'static str,
        /// What was asked for.
        key: String,
        /// The most similar key, if one is similar.
        nearest: Option<&'static str>,
        /// All keys, separated by commas.
        known: String,
    },
    /// A key stands without a value.
    #[error("`{piece}` in the spec of `{family}` is not of the form key=value")]
    NoValue {
        /// The family's name.
        family: &'static str,
        /// What stands there.
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
        /// What was given.
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
        /// What it is for.
        summary: &'static str,
    },
    /// Values that are right one by one do not go together.
    #[error("`{family}`: {why}")]
    Unfit {
        /// The family's name.
        family: &'static str,
        /// What does not fit, and how it would.
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

fn suggest(nearest: Option<&&'static str>) -> String {
    nearest.map_or_else(String::new, |name| format!(", did you mean `{name}`?"))
}

/// The name among `known` that a user most likely meant by `given`.
pub(super) fn nearest(
    given: &str,
    known: impl Iterator<Item = &'static str>,
) -> Option<&'static str> {
    // Names are short: a much longer word is no misspelling of one.
    if given.len() > 40 {
        return None;
    }
    let given = given.to_ascii_lowercase();
    known
        .map(|name| (strsim::jaro_winkler(&given, name), name))
        .filter(|(similarity, _)| *similarity > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn nearest_finds_misspellings_and_nothing_else() {
        let known = || ["sphere", "uvsphere", "torus", "tetrahedron"].into_iter();
        assert_eq!(nearest("shpere", known()), Some("sphere"));
        assert_eq!(nearest("Tours", known()), Some("torus"));
        assert_eq!(nearest("tetraeder", known()), Some("tetrahedron"));
        assert_eq!(nearest("xyz", known()), None);
        assert_eq!(nearest("", known()), None);
        assert_eq!(nearest(&"sphere".repeat(9), known()), None);
    }
}
