//! Comparison of distances with those of a reference.

use std::fmt;

use anyhow::ensure;
use geobench_mesh::Tolerance;

use crate::measure::number::{counted, shortest};

/// How distances differ from a reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    /// Largest absolute difference, in the units of the model. Infinite if only one side reaches
    /// some vertex, or if a distance is NaN.
    pub max_abs: f64,
    /// Largest relative difference. That of a and b is |a - b| / max(|a|, |b|), 0 if they are
    /// equal, and infinite where the absolute difference is.
    pub max_rel: f64,
    /// The least tolerance with which all vertices agree. Infinite where the absolute difference
    /// is, or if a source is not at 0.
    pub least_tolerance: f64,
    /// Mean relative error |found - expected| / expected, over the vertices whose reference
    /// distance is positive and finite. Infinite if the answer does not reach one of them; 0 if
    /// there are none.
    pub mean_rel: f64,
    /// Root mean square of the same errors.
    pub rms_rel: f64,
    /// Number of infinite distances in the answer, at vertices that were not compared, too.
    pub unreachable: usize,
    /// Number of vertices that were compared.
    pub compared: usize,
    /// Number of compared vertices that differ by more than is allowed.
    pub disagreeing: usize,
    /// Most by which a difference exceeds what is allowed; 0 if none does.
    pub excess: f64,
    /// The vertex whose difference is the largest multiple of what is allowed, if it exceeds that.
    pub worst: Option<Disagreement>,
}

/// A vertex at which two answers differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disagreement {
    /// Number of the vertex, from 0, in the file's order.
    pub vertex: usize,
    /// The distance found.
    pub found: f64,
    /// The distance of the reference.
    pub expected: f64,
}

impl Deviation {
    /// Whether every compared vertex agrees.
    pub const fn agrees(&self) -> bool {
        self.disagreeing == 0
    }
}

impl Disagreement {
    /// Describes the disagreement. `place` is the name of the vertex or point.
    pub fn at(&self, place: &str) -> String {
        let (abs, rel) = difference(self.found, self.expected);
        format!(
            "{place} is at {} instead of {} (difference {abs:.3e}, relative {rel:.3e})",
            shortest(self.found),
            shortest(self.expected)
        )
    }
}

impl fmt::Display for Disagreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.at(&format!("vertex {}", self.vertex)))
    }
}

/// Checks the number of distances.
///
/// # Errors
///
/// When there are not `expected` ones.
pub(crate) fn check_length(found: &[f64], expected: usize) -> anyhow::Result<()> {
    let found = found.len();
    ensure!(
        found == expected,
        "{} where the reference has {expected}",
        counted(found, "distance")
    );
    Ok(())
}

/// Compares `found` with `expected` at the vertices that `expected` has, by `rule`.
///
/// # Panics
///
/// If a vertex is not in `found`.
pub(crate) fn compare_some(
    found: &[f64],
    expected: impl IntoIterator<Item = (usize, f64)>,
    rule: &Tolerance,
) -> Deviation {
    let mut result = Deviation {
        max_abs: 0.0,
        max_rel: 0.0,
        least_tolerance: 0.0,
        mean_rel: 0.0,
        rms_rel: 0.0,
        // NaN counts as a wrong answer below, not as unreachable.
        unreachable: found.iter().filter(|d| **d == f64::INFINITY).count(),
        compared: 0,
        disagreeing: 0,
        excess: 0.0,
        worst: None,
    };
    let mut worst_multiple = 0.0;
    let (mut sum, mut squares, mut errors) = (0.0, 0.0, 0_usize);
    for (vertex, expected) in expected {
        let found = found[vertex];
        let (abs, rel) = difference(found, expected);
        result.compared += 1;
        result.max_abs = result.max_abs.max(abs);
        result.max_rel = result.max_rel.max(rel);
        let beyond_rounding = abs - rule.allowed(vertex, 0.0);
        if beyond_rounding > 0.0 {
            let needed = beyond_rounding / expected.min(f64::MAX);
            result.least_tolerance = result.least_tolerance.max(needed);
        }
        if expected > 0.0 && expected.is_finite() {
            let error = abs / expected;
            sum += error;
            squares += error * error;
            errors += 1;
        }
        if !rule.is_right(vertex, found, expected) {
            result.disagreeing += 1;
            let allowed = rule.allowed(vertex, expected);
            result.excess = result.excess.max(abs - allowed);
            let multiple = abs / allowed;
            if multiple > worst_multiple {
                worst_multiple = multiple;
                result.worst = Some(Disagreement {
                    vertex,
                    found,
                    expected,
                });
            }
        }
    }
    if errors > 0 {
        result.mean_rel = sum / errors as f64;
        result.rms_rel = (squares / errors as f64).sqrt();
    }
    result
}

/// Absolute and relative difference. Both are infinite if only one side is infinite, or if one is
/// NaN.
fn difference(a: f64, b: f64) -> (f64, f64) {
    if a == b {
        return (0.0, 0.0);
    }
    let abs = (a - b).abs();
    if abs.is_finite() {
        (abs, abs / a.abs().max(b.abs()))
    } else {
        (f64::INFINITY, f64::INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INF: f64 = f64::INFINITY;

    /// By relative differences alone.
    fn compare(found: &[f64], expected: &[f64], tolerance: f64) -> Deviation {
        let rule = Tolerance::relative(tolerance);
        compare_some(found, expected.iter().copied().enumerate(), &rule)
    }

    #[test]
    fn equal_answers_agree_unreachable_vertices_included() {
        let result = compare(&[0.0, 1.0, INF], &[0.0, 1.0, INF], 0.0);
        assert!(result.agrees());
        assert_eq!((result.max_abs, result.max_rel), (0.0, 0.0));
        assert_eq!((result.unreachable, result.compared), (1, 3));
    }

    #[test]
    fn the_tolerance_is_relative_and_inclusive() {
        assert!(compare(&[1e6 + 1.0], &[1e6], 1e-6).agrees());
        assert!(!compare(&[1e-6 + 1e-9], &[1e-6], 1e-6).agrees());
        assert!(compare(&[1.0], &[2.0], 0.5).agrees());
    }

    #[test]
    fn rounding_of_the_field_is_no_disagreement() {
        let expected = [0.0, 1e-10, 1.0, 1.0, 1.0];
        let rule = Tolerance::of(&expected);
        let compare = |found: &[f64]| {
            let expected = expected.iter().copied().enumerate();
            compare_some(found, expected, &rule)
        };
        assert!(compare(&[1e-14, 1e-10 - 1e-14, 1.0, 1.0, 1.0]).agrees());
        let found = compare(&[0.0, 2e-10, 1.0 + 3e-9, 1.0, 1.0]);
        assert_eq!(found.disagreeing, 2);
        assert!((found.least_tolerance - 0.999).abs() < 1e-9);
        assert_eq!(
            compare(&[0.0, 1e-10 + 1e-14, 1.0, 1.0, 1.0]).least_tolerance,
            0.0
        );
        // 2e-9 against 1e-10, but 3 times against 1000 times what is allowed.
        assert_eq!(found.worst.unwrap().vertex, 1);
        assert!((found.excess - 2e-9).abs() < 1e-12);
    }

    #[test]
    fn errors_are_relative_to_the_reference_and_leave_sources_and_unreachable_vertices_out() {
        let result = compare(&[0.0, 1.3, 1.9, INF], &[0.0, 1.0, 2.0, INF], 1e-9);
        assert!((result.mean_rel - 0.175).abs() < 1e-15);
        assert!((result.rms_rel - (0.0925_f64 / 2.0).sqrt()).abs() < 1e-15);
        assert_eq!(compare(&[0.0], &[0.0], 0.0).rms_rel, 0.0);
        assert_eq!(compare(&[INF], &[1.0], 1.0).mean_rel, INF);
    }

    #[test]
    fn the_worst_vertex_is_named() {
        let result = compare(&[0.0, 1.1, 2.0, 3.0], &[0.0, 1.0, 1.0, 3.0], 1e-9);
        assert_eq!(result.disagreeing, 2);
        assert_eq!(
            result.worst.unwrap().to_string(),
            "vertex 2 is at 2 instead of 1 (difference 1.000e0, relative 5.000e-1)"
        );
    }

    #[test]
    fn infinite_against_finite_and_nan_are_wrong_at_any_tolerance() {
        for (found, expected) in [(INF, 1.0), (1.0, INF), (f64::NAN, 1.0), (f64::NAN, INF)] {
            let result = compare(&[found], &[expected], 1e9);
            assert!(!result.agrees(), "{found} {expected}");
            assert_eq!(result.max_abs, INF);
        }
        assert!(!compare(&[f64::NAN], &[f64::NAN], 1.0).agrees());
    }

    #[test]
    fn a_distance_at_a_source_must_be_zero() {
        assert!(!compare(&[1e-300], &[0.0], 1e-9).agrees());
    }

    #[test]
    fn different_numbers_of_vertices_cannot_be_compared() {
        assert_eq!(
            check_length(&[0.0], 2).unwrap_err().to_string(),
            "1 distance where the reference has 2"
        );
    }

    #[test]
    fn a_sample_is_compared_only_where_it_is() {
        let rule = Tolerance::relative(1e-9);
        let result = compare_some(&[0.0, 5.0, 2.0], [(0, 0.0), (2, 2.0)], &rule);
        assert!(result.agrees());
        assert_eq!(result.compared, 2);
    }
}
