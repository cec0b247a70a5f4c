//! The result file itself.

use crate::schema::ResultFile;

/// The whole result, indented.
pub(super) fn render(result: &ResultFile) -> anyhow::Result<String> {
    Ok(serde_json::to_string_pretty(result)? + "\n")
}
