//! The layout of the answers of a goal, for comparisons. An *answer* is the list of distances that
//! a run returns. A *place* is an index in it.

use std::collections::HashMap;

use geobench_mesh::Tolerance;

use crate::exec::goal::GoalSpec;
use crate::exec::point::PointSpec;
use crate::run::check::{self, Deviation, Disagreement};
use crate::schema::SourceLabel;

/// The layout of the answers of a goal: which vertex or point each distance belongs to, and the
/// radius beyond which distances are infinite.
#[derive(Clone, Debug, Default)]
pub struct AnswerLayout {
    /// The targets; `None` for all vertices.
    targets: Option<Vec<PointSpec>>,
    radius: Option<f64>,
}

impl AnswerLayout {
    /// The layout for a mesh of `vertices` vertices. If a target does not exist, answers are taken
    /// to be empty.
    pub fn new(goal: &GoalSpec, vertices: usize) -> Self {
        Self {
            targets: goal.points(vertices).unwrap_or(Some(Vec::new())),
            radius: goal.radius,
        }
    }

    /// Compares the answer `found` with `expected`, which has places and their distances.
    ///
    /// With a radius, distances beyond it are infinite. Rounding decides on which side of the
    /// radius a distance close to it lies. A place with one finite and one infinite distance is
    /// therefore skipped if the finite one is less than the radius by no more than `rule` allows.
    /// In an answer that may differ by any finite amount, every such place is skipped.
    ///
    /// # Panics
    ///
    /// If a place is not in `found`.
    pub fn compare(
        &self,
        found: &[f64],
        expected: impl IntoIterator<Item = (usize, f64)>,
        rule: &Tolerance,
        may_differ: bool,
    ) -> Deviation {
        let is_compared = |&(place, expected): &(usize, f64)| {
            let Some(radius) = self.radius else {
                return true;
            };
            let found = found[place];
            if found.is_finite() == expected.is_finite() || found.is_nan() {
                return true;
            }
            !may_differ && found.min(expected) < radius - rule.allowed(place, radius)
        };
        let expected = expected.into_iter().filter(is_compared);
        check::compare_some(found, expected, rule)
    }

    /// Whether the exact answer `found` agrees with the answer `expected`; see
    /// [`compare`](Self::compare). Answers of different lengths do not.
    pub fn agrees(&self, found: &[f64], expected: &[f64], rule: &Tolerance) -> bool {
        let places = expected.iter().copied().enumerate();
        found.len() == expected.len() && self.compare(found, places, rule, false).agrees()
    }

    /// Stored distances of vertices, converted to places of an answer and cut at the radius. Places
    /// without a stored distance are left out.
    pub fn of_stored(&self, stored: &[(usize, f64)]) -> Vec<(usize, f64)> {
        let cut = |d: f64| match self.radius {
            Some(radius) if d > radius => f64::INFINITY,
            _ => d,
        };
        let Some(targets) = &self.targets else {
            return stored.iter().map(|&(v, d)| (v, cut(d))).collect();
        };
        let stored: HashMap<usize, f64> = stored.iter().copied().collect();
        let find = |place| Some((place, cut(*stored.get(&self.vertex(place)?)?)));
        (0..targets.len()).filter_map(find).collect()
    }

    /// Number of distances of an answer, for a mesh of `vertices` vertices.
    pub fn count(&self, vertices: usize) -> usize {
        self.targets.as_ref().map_or(vertices, Vec::len)
    }

    /// The vertex at a place of an answer. `None` for a point that is not a vertex.
    pub fn vertex(&self, place: usize) -> Option<usize> {
        match &self.targets {
            None => Some(place),
            Some(targets) => match targets.get(place)?.label() {
                SourceLabel::Vertex(vertex) => Some(vertex as usize),
                SourceLabel::Other(_) => None,
            },
        }
    }

    /// What a place of an answer is called: `vertex` or `target`.
    pub const fn noun(&self) -> &'static str {
        match self.targets {
            None => "vertex",
            Some(_) => "target",
        }
    }

    /// Describes a disagreement. Its `vertex` is a place of an answer.
    pub fn describe(&self, worst: &Disagreement) -> String {
        let target = self.targets.as_ref();
        match (self.vertex(worst.vertex), target) {
            (None, Some(targets)) => match targets.get(worst.vertex) {
                Some(target) => worst.at(&format!("target {target}")),
                None => worst.to_string(),
            },
            (vertex, _) => Disagreement {
                vertex: vertex.unwrap_or(worst.vertex),
                ..*worst
            }
            .to_string(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn goal(targets: &str, radius: Option<f64>) -> GoalSpec {
        let targets = (!targets.is_empty()).then(|| targets.parse().unwrap());
        GoalSpec { targets, radius }
    }

    #[test]
    fn rounding_decides_at_the_radius_and_nowhere_else() {
        const INF: f64 = f64::INFINITY;
        let layout = AnswerLayout::new(&goal("", Some(2.0)), 3);
        let agrees = |found: f64, expected: f64, may_differ| {
            let expected = [(0, expected)];
            let rule = Tolerance::relative(1e-9);
            let found = layout.compare(&[found], expected, &rule, may_differ);
            found.agrees()
        };
        assert!(agrees(2.0, INF, false) && agrees(INF, 2.0, false));
        assert!(!agrees(1.9, INF, false) && !agrees(INF, 1.9, false));
        assert!(agrees(INF, 1.9, true));
        assert!(!agrees(f64::NAN, INF, false));
    }

    #[test]
    fn targets_are_compared_and_named_by_their_place() {
        let layout = AnswerLayout::new(&goal("2,edge:0-1,0.5", None), 3);
        assert_eq!((layout.count(3), layout.noun()), (2, "target"));
        assert_eq!(layout.of_stored(&[(0, 0.0), (2, 5.0)]), [(0, 5.0)]);
        let worst = |vertex| Disagreement {
            vertex,
            found: 1.0,
            expected: 2.0,
        };
        assert!(layout.describe(&worst(0)).starts_with("vertex 2 is at 1 "));
        let of_edge = layout.describe(&worst(1));
        assert!(of_edge.starts_with("target edge:0-1,0.5 is at 1 "));
        assert_eq!((layout.vertex(0), layout.vertex(1)), (Some(2), None));
    }
}
