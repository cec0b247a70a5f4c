//! Makes failing cases smaller.

use std::io;
use std::time::{Duration, Instant};

use crate::case::{Case, Expected, Failure, FailureKind, Verdict};
use crate::child::Judge;

/// Time limit of one case.
const PATIENCE: Duration = Duration::from_secs(20);

/// A failing case with its failure.
pub(crate) struct Smallest {
    pub(crate) case: Case,
    pub(crate) expected: Expected,
    pub(crate) failure: Failure,
}

/// The smallest case found on which `algorithm` fails as on `start`.
pub(crate) fn minimise(
    judge: &mut Judge,
    algorithm: &str,
    start: Smallest,
) -> io::Result<Smallest> {
    let mut search = Minimiser {
        judge,
        algorithm,
        smallest: start,
        end: Instant::now() + PATIENCE,
    };
    search.fewer_sources()?;
    search.fewer_faces()?;
    search.fewer_vertices()?;
    search.simpler_place()?;
    search.simpler_coordinates()?;
    Ok(search.smallest)
}

struct Minimiser<'a> {
    judge: &'a mut Judge,
    algorithm: &'a str,
    smallest: Smallest,
    end: Instant,
}

/// Wrong distances count as the same failure, whatever the error.
fn is_alike(a: FailureKind, b: FailureKind) -> bool {
    let wrong = [
        FailureKind::TooLong,
        FailureKind::TooShort,
        FailureKind::Lost,
    ];
    a == b || wrong.contains(&a) && wrong.contains(&b)
}

impl Minimiser<'_> {
    /// Accepts `case` if the algorithm fails on it as well.
    fn attempt(&mut self, case: Case) -> io::Result<bool> {
        if case.faces.is_empty() || case == self.smallest.case || Instant::now() > self.end {
            return Ok(false);
        }
        let algorithm = [self.algorithm.to_owned()];
        let Ok(judged) = self.judge.judge(&case, None, &algorithm)? else {
            return Ok(false);
        };
        match judged.verdicts.into_iter().next() {
            Some(Verdict::Failed(failure))
                if is_alike(failure.kind, self.smallest.failure.kind) =>
            {
                self.smallest = Smallest {
                    case,
                    expected: judged.expected,
                    failure,
                };
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    fn fewer_sources(&mut self) -> io::Result<()> {
        let case = self.smallest.case.clone();
        if case.sources.len() > 1 {
            for &source in &case.sources {
                let sources = vec![source];
                if self.attempt(Case {
                    sources,
                    ..case.clone()
                })? {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// Removes runs of faces, of decreasing length.
    fn fewer_faces(&mut self) -> io::Result<()> {
        let mut length = self.smallest.case.faces.len() / 2;
        while length > 0 {
            let mut at = 0;
            let mut removed = false;
            while at < self.smallest.case.faces.len() {
                let mut case = self.smallest.case.clone();
                let end = (at + length).min(case.faces.len());
                case.faces.drain(at..end);
                if self.attempt(case)? {
                    removed = true;
                } else {
                    at += length;
                }
            }
            // One face at a time, until none can be removed.
            if length > 1 || !removed {
                length /= 2;
            }
        }
        Ok(())
    }

    fn fewer_vertices(&mut self) -> io::Result<()> {
        let mut case = self.smallest.case.clone();
        let mut used = vec![false; case.vertices.len()];
        for &v in case.faces.as_flattened().iter().chain(&case.sources) {
            used[v as usize] = true;
        }
        let mut numbers = Vec::new();
        let mut vertices = Vec::new();
        for (&position, used) in case.vertices.iter().zip(used) {
            numbers.push(vertices.len() as u32);
            if used {
                vertices.push(position);
            }
        }
        case.vertices = vertices;
        for v in case
            .faces
            .as_flattened_mut()
            .iter_mut()
            .chain(&mut case.sources)
        {
            *v = numbers[*v as usize];
        }
        self.attempt(case)?;
        Ok(())
    }

    /// Moves the first vertex to the origin, and scales the mesh to a size of about 1.
    fn simpler_place(&mut self) -> io::Result<()> {
        let mut case = self.smallest.case.clone();
        let [first, ..] = case.vertices[..] else {
            return Ok(());
        };
        for position in &mut case.vertices {
            *position = [0, 1, 2].map(|i| position[i] - first[i]);
        }
        self.attempt(case)?;
        let mut case = self.smallest.case.clone();
        let size = case
            .vertices
            .as_flattened()
            .iter()
            .fold(0.0_f64, |a, x| a.max(x.abs()));
        let factor = 2.0_f64.powi(-(size.log2().floor() as i32));
        for x in case.vertices.as_flattened_mut() {
            *x *= factor;
        }
        self.attempt(case)?;
        Ok(())
    }

    /// Rounds coordinates to integers or to a few digits.
    fn simpler_coordinates(&mut self) -> io::Result<()> {
        for place in 0..3 * self.smallest.case.vertices.len() {
            let old = self.smallest.case.vertices.as_flattened()[place];
            let digits = [0, 1, 2, 4].map(|digits| format!("{old:.digits$e}").parse());
            let whole = [Ok(0.0), Ok(old.round())];
            for rounded in whole.into_iter().chain(digits).flatten() {
                if old.to_bits() == f64::to_bits(rounded) {
                    break;
                }
                let mut case = self.smallest.case.clone();
                case.vertices.as_flattened_mut()[place] = rounded;
                if self.attempt(case)? {
                    break;
                }
            }
        }
        Ok(())
    }
}
