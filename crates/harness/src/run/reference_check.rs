//! The reference answer for one model and source, and the comparison of answers with it.

use geobench_mesh::Tolerance;
use geobench_registry::{self as registry, CERTIFICATE, Selection};

use crate::exec::{Failure, Observation, Session, Step};
use crate::measure::number::counted;
use crate::run::agreement::{self, Clusters};
use crate::run::answer_layout::AnswerLayout;
use crate::run::check::{self, Deviation};
use crate::run::proof::{BOUNDS, Decision, RevisedGroup};
use crate::run::scale::FieldScale;
use crate::schema::{Check, Status};

/// The reference answer, or why there is none.
#[derive(Debug, Default)]
pub struct ReferenceCheck {
    /// The reference answer.
    pub answer: Option<Answer>,
    /// Why there is no reference answer although one was requested.
    pub unchecked: Option<String>,
    /// Clusters of the answers that differ from the reference.
    pub clusters: Clusters,
    /// Layout of the answers.
    pub layout: AnswerLayout,
    /// The scale of the reference.
    pub(crate) scale: FieldScale,
    /// What a proof has decided, once answers differed.
    pub(crate) decision: Option<Decision>,
    /// Proven bounds, if no distances are proven, and the reference is within the bounds.
    pub(crate) bounds: Option<Answer>,
}

/// What makes an answer of greatest possible distances one of bounds.
#[derive(Clone, Debug)]
pub struct ProvenBounds {
    /// The least possible distances.
    pub least: Vec<f64>,
    /// Why there are no proven distances.
    pub why: String,
}

/// A reference answer and its name.
#[derive(Debug)]
pub struct Answer {
    /// Name of the algorithm or path of the file.
    pub name: String,
    /// Places in the answer and their distances. A file may lack some places.
    pub distances: Vec<(usize, f64)>,
    /// Number of distances that an answer must have.
    pub vertices: usize,
    /// Vertices and distances of a file, of all that it has. `None` for an algorithm.
    pub stored: Option<Vec<(usize, f64)>>,
    /// Set if the distances are the greatest possible ones, by a proof.
    pub bounds: Option<ProvenBounds>,
}

impl Answer {
    /// The answer of an algorithm.
    pub fn of(name: &str, distances: &[f64]) -> Self {
        Self {
            name: name.to_owned(),
            vertices: distances.len(),
            distances: distances.iter().copied().enumerate().collect(),
            stored: None,
            bounds: None,
        }
    }

    /// The distances that a proof has found; bounds of them if they cannot be proven to
    /// `tolerance`; or why there are none. `execute` runs an algorithm.
    ///
    /// # Errors
    ///
    /// Those of `execute`.
    pub fn proven<E>(
        tolerance: f64,
        mut execute: impl FnMut(&Selection) -> Result<Result<Observation, Failure>, E>,
    ) -> Result<Result<Self, String>, E> {
        let why = match execute(&registry::certificate(tolerance))? {
            Ok(found) => return Ok(Ok(Self::of(CERTIFICATE, &found.distances))),
            Err(failure) if failure.status == Status::Refused => failure.message,
            Err(failure) => return Ok(Err(failure.message)),
        };
        let [least, greatest] = registry::proven_bounds();
        Ok(match (execute(&least)?, execute(&greatest)?) {
            (Ok(least), Ok(greatest)) => Ok(Self {
                bounds: Some(ProvenBounds {
                    least: least.distances,
                    why,
                }),
                ..Self::of(BOUNDS, &greatest.distances)
            }),
            (Err(failure), _) | (_, Err(failure)) => Err(failure.message),
        })
    }

    /// Places and distances that `found` is compared with: those of the answer. Within bounds, they
    /// are the nearest to `found`.
    fn expected<'a>(&'a self, found: &'a [f64]) -> impl Iterator<Item = (usize, f64)> + 'a {
        let nearest = move |&(place, distance): &(usize, f64)| match &self.bounds {
            Some(bounds) => (place, found[place].max(bounds.least[place]).min(distance)),
            None => (place, distance),
        };
        self.distances.iter().map(nearest)
    }

    /// All distances of the answer in their order, with those of `other` where it has none.
    pub(crate) fn completed_by(&self, other: &Self) -> Vec<f64> {
        let mut found = vec![f64::INFINITY; self.vertices];
        for &(place, distance) in other.distances.iter().chain(&self.distances) {
            found[place] = distance;
        }
        found
    }
}

impl ReferenceCheck {
    /// Without a reference answer so far, for answers of this layout.
    pub fn new(layout: AnswerLayout) -> Self {
        Self {
            layout,
            ..Self::default()
        }
    }

    /// Whether `distances` differ from the reference answer.
    pub fn differs(&self, distances: &[f64], tolerance: f64) -> bool {
        let answer = self.answer.as_ref();
        answer.is_some_and(|answer| self.differs_from(answer, distances, tolerance))
    }

    fn differs_from(&self, answer: &Answer, distances: &[f64], tolerance: f64) -> bool {
        if distances.len() != answer.vertices {
            return false;
        }
        let rule = self.scale.rule(tolerance);
        let expected = answer.expected(distances);
        !(self.layout.compare(distances, expected, &rule, false)).agrees()
    }

    /// Whether the reference is a proof of bounds. Answers within them need not agree.
    fn has_bounds(&self) -> bool {
        (self.answer.as_ref()).is_some_and(|answer| answer.bounds.is_some())
    }

    /// For an answer that differs from the reference: whether bounds prove it wrong; `None` if not.
    fn refuted(&self, distances: &[f64], tolerance: f64) -> Option<bool> {
        let is_outside = |bounds| self.differs_from(bounds, distances, tolerance);
        (self.has_bounds() || self.bounds.as_ref().is_some_and(is_outside)).then_some(false)
    }

    /// Whether `distances`, the answer of `algorithm`, differ from the reference; or, without an
    /// answer of the reference, from all others so far.
    pub(crate) fn is_disputed(
        &self,
        distances: &[f64],
        algorithm: &Selection,
        tolerance: f64,
    ) -> bool {
        if self.answer.is_some() || self.unchecked.is_none() || algorithm.is_approximate() {
            return self.differs(distances, tolerance);
        }
        self.clusters.next() > 1 && self.known_cluster(distances, tolerance).is_none()
    }

    /// Finds the scale of the reference, unless it is known or `distances` agree without it. `step`
    /// is a run of the reference.
    pub fn find_scale(
        &mut self,
        distances: &[f64],
        tolerance: f64,
        session: &mut dyn Session,
        step: &Step<'_>,
    ) {
        let Some(answer) = self.answer.as_ref() else {
            return;
        };
        if !matches!(self.scale, FieldScale::NotSought) || !self.differs(distances, tolerance) {
            return;
        }
        let field = match &answer.stored {
            None if step.goal.is_everything() => Some(answer.distances.clone()),
            stored => stored.clone(),
        };
        self.scale = FieldScale::find(session, step, field);
    }

    /// Compares an answer of `algorithm` with the reference. Returns the comparison, and a failure
    /// if the answer differs by more than `tolerance` and rounding allow, or than the proven bound
    /// of the algorithm if that is larger. Approximate answers are not put into clusters.
    pub fn judge(
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
                (Some(_), None) if !self.has_bounds() => agreement::REFERENCE,
                _ => self.cluster_of_differing(distances, tolerance),
            });
            if failure.is_some() {
                check.proven = self.refuted(distances, tolerance);
            }
        }
        (check, failure)
    }

    /// The cluster of an answer that differs from the reference.
    pub fn cluster_of_differing(&mut self, distances: &[f64], tolerance: f64) -> u32 {
        let known = self.known_cluster(distances, tolerance);
        known.unwrap_or_else(|| self.clusters.add(distances))
    }

    /// The first answer of a cluster.
    pub fn first(&self, cluster: u32) -> Option<Vec<f64>> {
        match cluster {
            agreement::REFERENCE => {
                let distances = self.answer.as_ref()?.distances.iter();
                Some(distances.map(|&(_, d)| d).collect())
            }
            other => self.clusters.first(other).cloned(),
        }
    }

    /// The cluster other than that of the reference that an answer agrees with. Without an answer
    /// of the reference, the first answer of a cluster has its place in the rule.
    fn known_cluster(&self, distances: &[f64], tolerance: f64) -> Option<u32> {
        self.clusters.find(|first| {
            let rule = match &self.answer {
                Some(_) => self.scale.rule(tolerance),
                None => Tolerance::of(first).with_relative(tolerance),
            };
            self.layout.agrees(distances, first, &rule)
        })
    }

    /// Compares the answers so far with the reference, which has taken the place of `refuted`.
    /// Numbers the clusters anew.
    pub(crate) fn revise(
        &mut self,
        refuted: Option<Vec<f64>>,
        tolerance: f64,
    ) -> Vec<RevisedGroup> {
        let mut before = vec![refuted];
        before.extend(std::mem::take(&mut self.clusters).into_first());
        let mut groups = Vec::new();
        for (number, found) in (0..).zip(before) {
            let Some(found) = found else { continue };
            let (mut check, failure) = self.compare(&found, tolerance, false);
            check.cluster = Some(match failure {
                None if !self.has_bounds() => agreement::REFERENCE,
                _ => self.cluster_of_differing(&found, tolerance),
            });
            if failure.is_some() {
                check.proven = self.refuted(&found, tolerance);
            }
            groups.push(RevisedGroup {
                before: number,
                check,
                failure,
            });
        }
        groups
    }

    /// Compares `distances` with the reference. Without one, only NaN is wrong.
    ///
    /// # Errors
    ///
    /// If the numbers of distances differ.
    pub fn deviation(
        &self,
        distances: &[f64],
        tolerance: f64,
        may_differ: bool,
    ) -> anyhow::Result<Deviation> {
        let Some(answer) = &self.answer else {
            // NaN is compared with itself and never agrees.
            let places = distances.iter().copied().enumerate();
            let expected = places.filter(|(_, d)| d.is_nan());
            let rule = Tolerance::relative(tolerance);
            return Ok(check::compare_some(distances, expected, &rule));
        };
        check::check_length(distances, answer.vertices)?;
        let expected = answer.expected(distances);
        let rule = self.scale.rule(tolerance);
        Ok((self.layout).compare(distances, expected, &rule, may_differ))
    }

    fn compare(
        &self,
        distances: &[f64],
        tolerance: f64,
        may_differ: bool,
    ) -> (Check, Option<Failure>) {
        let wrong = |message: String| Failure::new(Status::Wrong, message);
        let comparison = match self.deviation(distances, tolerance, may_differ) {
            Ok(comparison) => comparison,
            Err(error) => return (Check::default(), Some(wrong(error.to_string()))),
        };
        let name = self.answer.as_ref().map(|answer| answer.name.as_str());
        let failure = comparison.worst.map(|worst| {
            wrong(format!(
                "differs from {}: {}; {} of {} differ by more than {tolerance:e} relative and \
                 rounding{}",
                name.unwrap_or("no reference"),
                self.layout.describe(&worst),
                comparison.disagreeing,
                counted(comparison.compared, self.layout.noun()),
                self.scale.remark()
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
        least_tolerance: finite(comparison.least_tolerance),
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
