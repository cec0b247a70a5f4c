//! The reference answer for one model and source, and the comparison of answers with it.

use geobench_registry::Selection;

use crate::exec::Failure;
use crate::run::agreement::{self, Clusters};
use crate::run::answer_layout::AnswerLayout;
use crate::run::check::{self, Deviation};
use crate::schema::{Check, Status};

/// The reference answer, or why there is none.
#[derive(Debug, Default)]
pub(super) struct ReferenceCheck {
    /// The reference answer.
    pub(super) answer: Option<Answer>,
    /// Why there is no reference answer although one was requested.
    pub(super) unchecked: Option<String>,
    /// Clusters of the answers that differ from the reference.
    pub(super) clusters: Clusters,
    /// Layout of the answers.
    pub(super) layout: AnswerLayout,
}

/// A reference answer and its name.
#[derive(Debug)]
pub(super) struct Answer {
    pub(super) name: String,
    /// Places in the answer and their distances. A file may lack some places.
    pub(super) distances: Vec<(usize, f64)>,
    /// Number of distances that an answer must have.
    pub(super) vertices: usize,
}

impl Answer {
    /// The answer of an algorithm.
    pub(super) fn of(name: &str, distances: &[f64]) -> Self {
        Self {
            name: name.to_owned(),
            vertices: distances.len(),
            distances: distances.iter().copied().enumerate().collect(),
        }
    }
}

impl ReferenceCheck {
    /// Compares an answer of `algorithm` with the reference. Returns the comparison, and a failure
    /// if the answer differs by more than `tolerance`, or than the proven bound of the algorithm if
    /// that is larger. Approximate answers are not put into clusters.
    pub(super) fn judge(
        &mut self,
        distances: &[f64],
        algorithm: &Selection,
        tolerance: f64,
    ) -> (Check, Option<Failure>) {
        let tolerance = algorithm.tolerance(tolerance);
        let (mut check, failure) = self.compare(distances, tolerance, algorithm.may_differ());
        let is_wanted = self.answer.is_some() || self.unchecked.is_some();
        if is_wanted && !algorithm.is_approximate() {
            check.cluster = Some(match (&self.answer, &failure) {
                (Some(_), None) => agreement::REFERENCE,
                _ => self.clusters.assign(distances, tolerance, &self.layout),
            });
        }
        (check, failure)
    }

    fn compare(
        &self,
        distances: &[f64],
        tolerance: f64,
        may_differ: bool,
    ) -> (Check, Option<Failure>) {
        let wrong = |message: String| Failure::new(Status::Wrong, message);
        let comparison = match &self.answer {
            Some(answer) => {
                if let Err(error) = check::check_length(distances, answer.vertices) {
                    return (Check::default(), Some(wrong(error.to_string())));
                }
                let expected = answer.distances.iter().copied();
                (self.layout).compare(distances, expected, tolerance, may_differ)
            }
            // Without a reference, only NaN is wrong. It is compared with itself and never agrees.
            None => check::compare_some(
                distances,
                distances
                    .iter()
                    .copied()
                    .enumerate()
                    .filter(|(_, d)| d.is_nan()),
                tolerance,
            ),
        };
        let name = self.answer.as_ref().map(|answer| answer.name.as_str());
        let failure = comparison.worst.map(|worst| {
            wrong(format!(
                "differs from {}: {}; {} of {} {} differ by more than {tolerance:e} relative",
                name.unwrap_or("no reference"),
                self.layout.describe(&worst),
                comparison.disagreeing,
                comparison.compared,
                self.layout.noun()
            ))
        });
        let mut check = record(name, &comparison);
        let worst = check.worst_vertex.and(comparison.worst);
        let vertex = worst.and_then(|worst| self.layout.vertex(worst.vertex));
        check.worst_vertex = vertex.map(|vertex| vertex as u64);
        (check, failure)
    }
}

fn record(reference: Option<&str>, comparison: &Deviation) -> Check {
    let finite = |x: f64| Some(x).filter(|x| reference.is_some() && x.is_finite());
    Check {
        reference: reference.map(str::to_owned),
        max_abs: finite(comparison.max_abs),
        max_rel: finite(comparison.max_rel),
        unreachable: Some(comparison.unreachable as u64),
        compared: reference.map(|_| comparison.compared as u64),
        worst_vertex: reference
            .and(comparison.worst)
            .map(|worst| worst.vertex as u64),
        mean_rel: finite(comparison.mean_rel),
        rms_rel: finite(comparison.rms_rel),
        ..Check::default()
    }
}
