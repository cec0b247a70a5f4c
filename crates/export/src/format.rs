//! File formats, chosen by the ending of a file's name.

use std::fmt::Display;
use std::path::Path;
use std::sync::OnceLock;

/// The path that stands for standard input and output.
pub const STANDARD: &str = "-";

/// The format of output to `-`, by its file name extension. Set once, from the command line.
static STANDARD_OUTPUT_FORM: OnceLock<String> = OnceLock::new();

/// Sets the format of output to `-`. `ending` is a file name extension.
pub fn set_standard_output_form(ending: &str) {
    // The command line is parsed only once, so this cannot fail.
    let _ = STANDARD_OUTPUT_FORM.set(ending.trim_start_matches('.').to_lowercase());
}

/// The extension of a file name, without its dot. For `-`, the extension set for standard output.
pub fn ending_of(path: &Path) -> String {
    if path == Path::new(STANDARD) {
        return STANDARD_OUTPUT_FORM.get().cloned().unwrap_or_default();
    }
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let stem = path.file_stem().map(Path::new);
    match stem.and_then(Path::extension) {
        // `bmf.json` and `gab.json` are extensions of two words.
        Some(before)
            if before.eq_ignore_ascii_case("bmf") || before.eq_ignore_ascii_case("gab") =>
        {
            format!("{}.{ending}", before.to_string_lossy())
        }
        _ => ending.into_owned(),
    }
}

/// No format has the extension of a file name. The message names those that exist.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct UnknownEnding(String);

/// A file format that is recognised by the extension of the file name.
pub trait FileFormat: Copy + PartialEq + 'static {
    /// The contents of the files, for messages.
    const CONTENT: &'static str;
    /// At least two extensions, with their formats.
    const ENDINGS: &'static [(&'static str, Self)];

    /// The format for the extension of `path`, in any letter case.
    ///
    /// # Errors
    ///
    /// When no format has the extension.
    fn of_path(path: &Path) -> Result<Self, UnknownEnding> {
        let ending = ending_of(path);
        let mut forms = Self::ENDINGS.iter();
        if let Some((_, form)) = forms.find(|(name, _)| ending.eq_ignore_ascii_case(name)) {
            return Ok(*form);
        }
        let how = if path == Path::new(STANDARD) {
            "--output-format"
        } else {
            "the ending"
        };
        let names = Self::ENDINGS.iter().map(|(name, _)| format!(".{name}"));
        let names = names.collect::<Vec<_>>().join(", ");
        let (names, last) = names.rsplit_once(", ").unwrap_or_default();
        Err(UnknownEnding(format!(
            "{}: {how} says in which form to write {}; use {names} or {last}",
            path.display(),
            Self::CONTENT
        )))
    }

    /// Whether it is a picture, which [`Scene`](crate::picture::Scene) draws.
    fn is_picture(self) -> bool {
        let mut forms = Self::ENDINGS.iter();
        forms.any(|(ending, form)| *form == self && matches!(*ending, "svg" | "png"))
    }
}

/// The error for a mesh without positions, called `name`.
pub fn no_coordinates(name: impl Display) -> anyhow::Error {
    anyhow::anyhow!("{name}: the mesh has no coordinates to write")
}

/// `document` as pretty-printed JSON.
///
/// # Errors
///
/// When `document` has a map with keys that are no strings.
pub fn json_lines(document: &impl serde::Serialize) -> anyhow::Result<String> {
    Ok(serde_json::to_string_pretty(document)? + "\n")
}

/// `document` as one line of JSON.
pub(crate) fn json_line(document: &impl serde::Serialize) -> anyhow::Result<Vec<u8>> {
    let mut bytes = serde_json::to_vec(document)?;
    bytes.push(b'\n');
    Ok(bytes)
}
