//! The layout of the answers of a goal, for comparing them.

use std::collections::HashMap;

use crate::exec::goal::GoalSpec;
use crate::exec::source::PointSpec;
use crate::run::check::{self, Deviation, Disagreement};
use crate::schema::SourceLabel;

/// The layout of the answers of a goal: which vertex or point each distance belongs to.
#[derive(Clone, Debug, Default)]
pub(crate) struct Asked {
    /// The targets; `None` for all vertices.
    targets: Option<Vec<PointSpec>>,
    radius: Option<f64>,
}

impl Asked {
    /// Of answers in a mesh of `vertices` vertices. Targets that do not exist have no answers.
    pub(crate) fn new(goal: &GoalSpec, vertices: usize) -> Self {
        Self {
            targets: goal.points(vertices).unwrap_or(Some(Vec::new())),
            radius: goal.radius,
        }
    }

    /// Compares an answer at some places.
    ///
    /// Where a distance lies within `tolerance` of the radius, rounding decides whether it is
    /// known; an approximate answer may know any more or less. Such a place is left out.
    pub(crate) fn compare(
        &self,
        found: &[f64],
        expected: impl IntoIterator<Item = (usize, f64)>,
        tolerance: f64,
        is_approximate: bool,
    ) -> Deviation {
        let is_compared = |&(place, expected): &(usize, f64)| {
            let Some(radius) = self.radius else {
                return true;
            };
            let found = found[place];
            if found.is_finite() == expected.is_finite() || found.is_nan() {
                return true;
            }
            !is_approximate && found.min(expected) < radius * (1.0 - tolerance)
        };
        let expected = expected.into_iter().filter(is_compared);
        check::compare_some(found, expected, tolerance)
    }

    /// The distances that are stored for vertices, as those of an answer.
    pub(crate) fn of_stored(&self, stored: &[(usize, f64)]) -> Vec<(usize, f64)> {
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

    /// Number of distances of an answer.
    pub(crate) fn count(&self, vertices: usize) -> usize {
        self.targets.as_ref().map_or(vertices, Vec::len)
    }

    /// The vertex at a place of an answer, if it is one.
    pub(crate) fn vertex(&self, place: usize) -> Option<usize> {
        match &self.targets {
            None => Some(place),
            Some(targets) => match targets.get(place)?.label() {
                SourceLabel::Vertex(vertex) => Some(vertex as usize),
                SourceLabel::Other(_) => None,
            },
        }
    }

    /// What an answer holds, in the plural.
    pub(crate) const fn noun(&self) -> &'static str {
        match self.targets {
            None => "vertices",
            Some(_) => "targets",
        }
    }

    /// A disagreement in words.
    pub(crate) fn describe(&self, worst: &Disagreement) -> String {
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
        let asked = Asked::new(&goal("", Some(2.0)), 3);
        let agrees = |found: f64, expected: f64, is_approximate| {
            let expected = [(0, expected)];
            let found = asked.compare(&[found], expected, 1e-9, is_approximate);
            found.agrees()
        };
        assert!(agrees(2.0, INF, false) && agrees(INF, 2.0, false));
        assert!(!agrees(1.9, INF, false) && !agrees(INF, 1.9, false));
        assert!(agrees(INF, 1.9, true));
        assert!(!agrees(f64::NAN, INF, false));
    }

    #[test]
    fn targets_are_compared_and_named_as_what_they_are() {
        let asked = Asked::new(&goal("2,edge:0-1,0.5", None), 3);
        assert_eq!((asked.count(3), asked.noun()), (2, "targets"));
        assert_eq!(asked.of_stored(&[(0, 0.0), (2, 5.0)]), [(0, 5.0)]);
        let worst = |vertex| Disagreement {
            vertex,
            found: 1.0,
            expected: 2.0,
        };
        assert!(asked.describe(&worst(0)).starts_with("vertex 2 is at 1 "));
        let of_edge = asked.describe(&worst(1));
        assert!(of_edge.starts_with("target edge:0-1,0.5 is at 1 "));
        assert_eq!((asked.vertex(0), asked.vertex(1)), (Some(2), None));
    }
}
