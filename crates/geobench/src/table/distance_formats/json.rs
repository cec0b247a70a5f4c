//! A distance field as JSON.

use serde::Serialize;

use super::DistanceField;

#[derive(Serialize)]
struct Document<'a> {
    model: &'a str,
    algorithm: &'a str,
    sources: &'a [u32],
    vertices: usize,
    /// How many of the distances are null because no path leads there.
    unreachable: usize,
    distances: Vec<Option<f64>>,
}

/// One object with a `null` for each vertex that no path reaches, since JSON has no infinity.
pub(super) fn render(field: &DistanceField<'_>) -> anyhow::Result<Vec<u8>> {
    let distances: Vec<Option<f64>> = field
        .distances
        .iter()
        .map(|d| d.is_finite().then_some(*d))
        .collect();
    let document = Document {
        model: field.model,
        algorithm: field.algorithm,
        sources: field.sources,
        vertices: distances.len(),
        unreachable: distances.iter().filter(|d| d.is_none()).count(),
        distances,
    };
    let mut bytes = serde_json::to_vec(&document)?;
    bytes.push(b'\n');
    Ok(bytes)
}
