//! Certified distances, as a reference of checks. Selected by name only, since it is not an
//! algorithm of its own.

use geobench_mesh::tolerance::RELATIVE;
use geobench_mesh::{Mesh, VertexId};
use geobench_mmp::{Carrier, mmp_from};
use geobench_window::queue::CalendarQueue;
use geobench_window::{Counter, Goal, Observer, Solution, SolveError, Solver};
use geodesics::{Certificate, CertificateError};

use super::{Algorithm, Parameter, Selection, Value, Values};

const TOLERANCE: Parameter = Parameter::real(
    "tolerance",
    RELATIVE,
    0.0..=1.0,
    "the largest error that passes, as a fraction of each distance",
);

const GIVES: Parameter = Parameter::word(
    "gives",
    &["distances", BOUNDS[0], BOUNDS[1]],
    "distances that are all proven, or the least or the greatest that each can be by the proof",
);

const BOUNDS: [&str; 2] = ["least", "greatest"];

pub(crate) const CERTIFIED: &[Algorithm; 1] = &[Algorithm {
    name: CERTIFICATE,
    family: CERTIFICATE,
    queue: "calendar",
    paper: "Mitchell, Mount, Papadimitriou 1987, with proofs of our own",
    summary: "mmp, and a proof in interval arithmetic that its distances are right",
    departs: "as mmp",
    complexity: "time O(n^2 log n), space O(n^2)",
    keeps: "every window until the end",
    choose: "as the reference of checks where algorithms disagree",
    memory_counter: Counter::StoredWindows,
    ends_early: false,
    crosses_junctions: true,
    parameters: &[TOLERANCE, GIVES],
    build: |mesh, values| {
        Box::new(Certified {
            mesh: mesh.clone(),
            tolerance: values.real(&TOLERANCE),
            bound: BOUNDS
                .iter()
                .position(|&word| values.word(&GIVES) == Some(word)),
        })
    },
    ..Algorithm::EXACT
}];

/// The name of the algorithm that returns only distances that it has proven.
pub const CERTIFICATE: &str = "certificate";

/// The algorithm [`CERTIFICATE`] for a check that allows the relative error `tolerance`: it proves
/// no larger one, and at most [`RELATIVE`].
pub fn certificate(tolerance: f64) -> Selection {
    let [algorithm] = CERTIFIED;
    let value = Value::Real(tolerance.min(RELATIVE));
    let values = Values::default().with(algorithm.parameters, &TOLERANCE, value);
    Selection::new(algorithm, values)
}

/// The algorithms that return the least and the greatest distance that each vertex can have by the
/// proof, also if the distances cannot be certified.
pub fn proven_bounds() -> [Selection; 2] {
    let [algorithm] = CERTIFIED;
    BOUNDS.map(|word| {
        let values = Values::default().with(algorithm.parameters, &GIVES, Value::Word(word));
        Selection::new(algorithm, values)
    })
}

/// Solves by MMP, and fails if the distances cannot be certified and no bound of them is wanted.
struct Certified {
    mesh: Mesh,
    tolerance: f64,
    /// The bound that it returns, in place of distances.
    bound: Option<usize>,
}

impl Solver for Certified {
    fn run(
        &mut self,
        sources: &[VertexId],
        goal: &Goal,
        observer: Observer<'_>,
    ) -> Result<Solution, SolveError> {
        if !matches!(observer, Observer::Nothing) {
            let queue = CalendarQueue::new(&self.mesh);
            let mut mmp = mmp_from(&self.mesh, Carrier::HalfEdge, queue);
            mmp.run(sources, &Goal::everything(), observer)?;
        }
        let proof = Certificate::within(&self.mesh, sources, self.tolerance);
        let proof = proof.map_err(|error| match error {
            CertificateError::Solve(error) => error,
            _ => SolveError::not_certified(f64::INFINITY),
        })?;
        let distances = match self.bound {
            Some(bound) => (0..proof.distances.len())
                .map(|v| proof.bounds(v)[bound])
                .collect(),
            None if proof.relative() > self.tolerance => {
                return Err(SolveError::not_certified(proof.relative()));
            }
            None => proof.distances,
        };
        let mut solution = Solution::new(distances);
        goal.limit(&mut solution);
        Ok(solution)
    }
}
