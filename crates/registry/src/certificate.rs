//! Certified distances, as a reference of checks. Selected by name only, since it is not an
//! algorithm of its own.

use geobench_mesh::{Mesh, VertexId};
use geobench_mmp::mmp;
use geobench_window::{Counter, Goal, Observer, Solution, SolveError, Solver};
use geodesics::{Certificate, CertificateError};

use super::{Algorithm, Parameter};

const TOLERANCE: Parameter = Parameter::real(
    "tolerance",
    1e-9,
    0.0..=1.0,
    "the largest error that passes, as a fraction of each distance",
);

pub(crate) const CERTIFIED: &[Algorithm] = &[Algorithm {
    name: "certificate",
    family: "certificate",
    paper: "Mitchell, Mount, Papadimitriou 1987, with proofs of our own",
    summary: "mmp, and a proof in interval arithmetic that its distances are right",
    departs: "as mmp",
    complexity: "time O(n^2 log n), space O(n^2)",
    keeps: "every window until the end",
    choose: "as the reference of checks where algorithms disagree",
    memory_counter: Counter::StoredWindows,
    ends_early: false,
    parameters: &[TOLERANCE],
    build: |mesh, values| {
        Box::new(Certified {
            mesh: mesh.clone(),
            tolerance: values.real(&TOLERANCE),
        })
    },
    ..Algorithm::EXACT
}];

/// Solves by MMP, and fails if the distances cannot be certified.
struct Certified {
    mesh: Mesh,
    tolerance: f64,
}

impl Solver for Certified {
    fn run(
        &mut self,
        sources: &[VertexId],
        goal: &Goal,
        observer: Observer<'_>,
    ) -> Result<Solution, SolveError> {
        if !matches!(observer, Observer::Nothing) {
            mmp(&self.mesh).run(sources, &Goal::everything(), observer)?;
        }
        let proof = Certificate::of(&self.mesh, sources).map_err(|error| match error {
            CertificateError::Solve(error) => error,
            _ => SolveError::not_certified(f64::INFINITY),
        })?;
        if proof.relative() > self.tolerance {
            return Err(SolveError::not_certified(proof.relative()));
        }
        let mut solution = Solution::new(proof.distances);
        goal.limit(&mut solution);
        Ok(solution)
    }
}
