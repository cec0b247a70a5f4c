//! What a run is to find, as a user gives it.

use std::collections::HashMap;
use std::fmt;
use std::path::Path;

use anyhow::{anyhow, bail};
use geobench_mesh::VertexId;
use geobench_window::Goal;
use sha2::{Digest, Sha256};

use crate::UsageError;
use crate::exec::source::{PointSpec, TargetSpec};
use crate::run::check::{self, Deviation, Disagreement};
use crate::schema::SourceLabel;

/// Longest list of targets in the name of a goal; a longer one is named by its number of bytes and
/// a hash.
const LONGEST_NAME: usize = 60;

/// What a run is to find: the distances of some points, those up to a radius, or all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GoalSpec {
    /// The points; `None` for all vertices.
    pub targets: Option<TargetSpec>,
    /// The largest distance, in the units of the model; `None` for no limit.
    pub radius: Option<f64>,
}

impl GoalSpec {
    /// Whether a run finds the distances of all vertices.
    pub const fn is_everything(&self) -> bool {
        self.targets.is_none() && self.radius.is_none()
    }

    /// The different targets in a mesh of `vertices` vertices; `None` for all vertices.
    ///
    /// # Errors
    ///
    /// When the mesh lacks one of the vertices, or has fewer than `random:N`.
    pub fn points(&self, vertices: usize) -> Result<Option<Vec<PointSpec>>, UsageError> {
        let targets = self.targets.as_ref();
        targets
            .map(|targets| targets.different(vertices))
            .transpose()
    }

    /// This for a solver; `targets` are the vertices of its points.
    pub(crate) fn of_solver(&self, targets: Option<&[VertexId]>) -> Goal {
        let goal = match targets {
            Some(targets) => Goal::targets(targets.iter().copied()),
            None => Goal::everything(),
        };
        match self.radius {
            Some(radius) => goal.within(radius),
            None => goal,
        }
    }

    /// Its name in cells; `None` if it is everything. Cells of other goals have other names.
    pub fn label(&self) -> Option<String> {
        (!self.is_everything()).then(|| self.to_string())
    }
}

impl fmt::Display for GoalSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut before = "";
        if let Some(targets) = &self.targets {
            let text = targets.to_string();
            if text.len() <= LONGEST_NAME {
                write!(f, "to {text}")?;
            } else {
                let digest = Sha256::digest(text.as_bytes());
                let [a, b, c, d] = [digest[0], digest[1], digest[2], digest[3]];
                write!(f, "to {} targets ", targets.count())?;
                write!(f, "#{:08x}", u32::from_be_bytes([a, b, c, d]))?;
            }
            before = " ";
        }
        match self.radius {
            Some(radius) => write!(f, "{before}within {radius}"),
            None => Ok(()),
        }
    }
}

/// The targets in the text of the file `path`, one in a line, each with its line. Empty lines and
/// lines from `#` on do not count.
///
/// # Errors
///
/// Names the line that is not a target, or the file if there is none in it.
pub fn targets_in(path: &Path, text: &str) -> anyhow::Result<Vec<(TargetSpec, String)>> {
    let shown = path.display();
    let mut all = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let place = format!("{shown}, line {number}");
        let target = line.parse().map_err(|error| anyhow!("{place}: {error}"))?;
        all.push((target, place));
    }
    if all.is_empty() {
        bail!("{shown}: there is no target in it; write one in each line");
    }
    Ok(all)
}

/// What answers of a goal hold, for comparing them.
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
    fn every_goal_has_a_name_of_its_own() {
        let label = |targets: &str, radius| goal(targets, radius).label();
        assert_eq!(label("", None), None);
        assert_eq!(label("17", None).unwrap(), "to 17");
        assert_eq!(label("", Some(2.5)).unwrap(), "within 2.5");
        assert_eq!(label("17,3", Some(0.5)).unwrap(), "to 17,3 within 0.5");
        let many = |last: &str| {
            let all: Vec<String> = (0..100).map(|v| v.to_string()).collect();
            label(&(all.join(",") + "," + last), None).unwrap()
        };
        assert!(many("200").starts_with("to 101 targets #"));
        assert_ne!(many("200"), many("201"));
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

    #[test]
    fn a_line_that_is_no_target_is_named() {
        let read = |text: &str| targets_in(Path::new("t.txt"), text);
        let all = read("# a comment\n\n 17\nface:0,1,0,0\n").unwrap();
        assert_eq!(all[1].1, "t.txt, line 4");
        let error = read("1\nx\n").unwrap_err().to_string();
        assert!(error.starts_with("t.txt, line 2: `x` is not a target"));
        let error = read("# nothing\n").unwrap_err().to_string();
        assert!(error.starts_with("t.txt: there is no target in it"));
    }
}
