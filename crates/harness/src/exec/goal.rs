//! Goals: the distances that a run computes, as specified by the user.

use std::fmt;

use geobench_mesh::VertexId;
use geobench_registry::UsageError;
use geobench_window::Goal;
use sha2::{Digest, Sha256};

use crate::exec::point::PointSpec;
use crate::exec::source::TargetSpec;
use crate::measure::number::shortest;

/// Maximum length of a list of targets in the name of a goal. A longer list is named by its
/// number of targets and a hash.
const LONGEST_NAME: usize = 60;

/// The goal of a run: the distances of some points, of everything within a radius, or of all
/// vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GoalSpec {
    /// The points; `None` for all vertices.
    pub targets: Option<TargetSpec>,
    /// The largest distance, in the units of the model; `None` for no limit.
    pub radius: Option<f64>,
}

impl GoalSpec {
    /// Whether the goal is the distances of all vertices.
    pub const fn is_everything(&self) -> bool {
        self.targets.is_none() && self.radius.is_none()
    }

    /// The targets in a mesh of `vertices` vertices, without duplicates; `None` for all vertices.
    ///
    /// # Errors
    ///
    /// If a vertex does not exist, or the mesh has fewer vertices than `random:N` asks for.
    pub fn points(&self, vertices: usize) -> Result<Option<Vec<PointSpec>>, UsageError> {
        let targets = self.targets.as_ref();
        targets
            .map(|targets| targets.different(vertices))
            .transpose()
    }

    /// The goal in the form of a solver; `targets` are the vertices of the target points.
    pub fn of_solver(&self, targets: Option<&[VertexId]>) -> Goal {
        let goal = match targets {
            Some(targets) => Goal::targets(targets.iter().copied()),
            None => Goal::everything(),
        };
        match self.radius {
            Some(radius) => goal.within(radius),
            None => goal,
        }
    }

    /// The name of the goal in cells; `None` for all vertices. Different goals have different
    /// names.
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
            Some(radius) => write!(f, "{before}within {}", shortest(radius)),
            None => Ok(()),
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
        assert_eq!(label("", Some(1e-300)).unwrap(), "within 1e-300");
        assert_eq!(label("17,3", Some(0.5)).unwrap(), "to 17,3 within 0.5");
        let many = |last: &str| {
            let all: Vec<String> = (0..100).map(|v| v.to_string()).collect();
            label(&(all.join(",") + "," + last), None).unwrap()
        };
        assert!(many("200").starts_with("to 101 targets #"));
        assert_ne!(many("200"), many("201"));
    }
}
