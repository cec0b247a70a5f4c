//! Distances with a proof of their error.

use geobench_certify::{Bound, Claim, ClaimError, Failure, FailurePlace, PathPoint, WindowData};
use geobench_mesh::{HalfEdgeId, Mesh, Refined, VertexId};
use geobench_mmp::{Mmp, mmp, windows_of};
use geobench_paths::{Path, PathPlace, Paths};
use geobench_window::{Goal, SolveError, Sources};

/// Distances with a bound of their error, proven in interval arithmetic. The proof assumes nothing
/// about the solver.
///
/// ```
/// use geodesics::{Certificate, Distances, Mesh};
///
/// let mesh = Mesh::generate("sphere,subdiv=2")?;
/// let proof = Certificate::of(&mesh, 0)?;
/// assert!(proof.relative() < 1e-9);
///
/// // Distances from elsewhere are as good as they are close to the proven ones.
/// let mut distances = mesh.distances_from(0)?;
/// assert!(proof.compare(distances.iter().copied().enumerate()).relative < 1e-9);
/// distances[7] *= 1.001;
/// let found = proof.compare(distances.iter().copied().enumerate());
/// assert_eq!(found.differences[0].0, 7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Certificate {
    /// The distance of every vertex from the nearest source, by MMP.
    pub distances: Vec<f64>,
    /// Upper bound of the amount by which a distance is too long.
    pub too_long: Bound,
    /// Upper bound of the amount by which a distance is too short.
    pub too_short: Bound,
}

/// Why there is no certificate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CertificateError {
    /// The run did not start.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The distances do not belong to the mesh.
    #[error(transparent)]
    Claim(#[from] ClaimError),
}

impl Certificate {
    /// Computes the distances of all vertices from the nearest of `sources`, and proves them.
    ///
    /// After a run of MMP that stores all windows, it takes O(w²) time for the w windows of a face.
    /// In a pool of `rayon`, all its threads share the work after that run.
    ///
    /// # Errors
    ///
    /// If there is no source, or one that is not on the mesh.
    pub fn of(mesh: &Mesh, sources: impl Sources) -> Result<Self, CertificateError> {
        let sources = sources.into_vertices();
        let mut solver: Mmp = mmp(mesh);
        let paths = Paths::find(&mut solver, mesh, &sources, &Goal::everything())?;
        let distances = paths.distances().to_vec();
        let claim = Claim::new(mesh, &sources, &distances)?;
        let too_long = claim.not_too_long(|h| window_data(&solver, h));
        drop(solver);
        let too_short = claim.not_too_short(|v| paths.to(v).ok().flatten().map(points));
        Ok(Self {
            distances,
            too_long,
            too_short,
        })
    }

    /// Upper bound of the error of a distance, in units of the mesh; infinite if nothing is proven.
    pub const fn absolute(&self) -> f64 {
        self.too_long.absolute.max(self.too_short.absolute)
    }

    /// Upper bound of the error as a fraction of the distance.
    pub const fn relative(&self) -> f64 {
        self.too_long.relative.max(self.too_short.relative)
    }

    /// Compares other distances, given with vertex numbers, with the proven ones. A distance that is
    /// finite where the proven one is infinite, or infinite where that is finite, or NaN, differs
    /// infinitely.
    ///
    /// # Panics
    ///
    /// If a vertex does not exist.
    pub fn compare(&self, given: impl IntoIterator<Item = (usize, f64)>) -> Comparison {
        let difference = |(v, d): (usize, f64)| {
            let proven = self.distances[v];
            let by = if d == proven {
                0.0
            } else if d.is_finite() && proven.is_finite() {
                (d - proven).abs()
            } else {
                f64::INFINITY
            };
            (v, by)
        };
        let mut differences: Vec<(usize, f64)> = given.into_iter().map(difference).collect();
        differences.sort_by(|a, b| b.1.total_cmp(&a.1));
        let relative = differences
            .iter()
            .map(|&(v, by)| self.fraction(v, by))
            .fold(0.0, f64::max);
        Comparison {
            absolute: differences.first().map_or(0.0, |d| d.1),
            relative,
            differences,
        }
    }

    /// The vertices of a comparison whose difference is above a fraction of the proven distance,
    /// with the differences, largest first.
    pub fn wrong<'a>(
        &'a self,
        compared: &'a Comparison,
        tolerance: f64,
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        let differences = compared.differences.iter().copied();
        differences.filter(move |&(v, by)| self.fraction(v, by) > tolerance)
    }

    /// A difference as a fraction of the proven distance of a vertex; never NaN.
    fn fraction(&self, v: usize, by: f64) -> f64 {
        if by == 0.0 || by.is_infinite() {
            by
        } else {
            by / self.distances[v]
        }
    }
}

/// The place of a failed proof on a refined mesh, converted to the original mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OriginalFailure {
    /// The face or vertex. An added vertex is converted to its face.
    pub place: FailurePlace,
    /// The edge of the face, if it is an edge of the original mesh.
    pub edge: Option<[VertexId; 2]>,
    /// The amount of the failure, in units of the mesh; infinite if there is no bound.
    pub violation: f64,
}

impl OriginalFailure {
    /// Converts the failure of a proof on `refined`, which was made from `mesh`.
    ///
    /// ```
    /// use geodesics::certify::{Claim, FailurePlace};
    /// use geodesics::{Mesh, OriginalFailure};
    ///
    /// let mesh = Mesh::generate("grid,n=1")?;
    /// let middle = mesh.point_in_face(1.into(), [0.25, 0.25, 0.5])?;
    /// let refined = mesh.with_points(&[middle])?;
    /// // No distance of the added vertex is right but 0.
    /// let mut distances = vec![1.5; 5];
    /// distances[0] = 0.0;
    /// let source = [0.into()];
    /// let claim = Claim::new(&refined.mesh, &source, &distances)?;
    /// let failures = claim.not_too_short(|_| None).failures;
    /// let found: Vec<FailurePlace> = failures
    ///     .iter()
    ///     .map(|failure| OriginalFailure::new(failure, &refined, &mesh).place)
    ///     .collect();
    /// assert!(found.contains(&FailurePlace::Face(1.into())));
    /// assert!(found.contains(&FailurePlace::Vertex(3.into())));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    ///
    /// If the refined mesh has no such place.
    pub fn new(failure: &Failure, refined: &Refined, mesh: &Mesh) -> Self {
        let is_original = |v: VertexId| v.index() < mesh.vertex_count();
        let in_face = |h: &HalfEdgeId| FailurePlace::Face(refined.parent(h.face()));
        let place = match failure.place {
            FailurePlace::Face(face) => FailurePlace::Face(refined.parent(face)),
            FailurePlace::Vertex(v) if is_original(v) => FailurePlace::Vertex(v),
            FailurePlace::Vertex(v) => refined
                .mesh
                .outgoing(v)
                .first()
                .map_or(FailurePlace::Vertex(v), in_face),
        };
        let ends = |h| [refined.mesh.tail(h), refined.mesh.head(h)];
        let edge = failure.edge.map(ends);
        Self {
            place,
            edge: edge.filter(|ends| ends.iter().all(|&v| is_original(v))),
            violation: failure.violation,
        }
    }
}

/// The differences of distances from the proven ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The greatest difference, in units of the mesh. Infinite where only one of both distances is
    /// infinite.
    pub absolute: f64,
    /// The greatest difference as a fraction of the proven distance.
    pub relative: f64,
    /// Vertices and differences, largest first.
    pub differences: Vec<(usize, f64)>,
}

fn window_data(solver: &Mmp, h: HalfEdgeId) -> impl Iterator<Item = WindowData> {
    windows_of(solver, h).map(|w| WindowData {
        interval: [w.b0, w.b1],
        image: w.source(),
        sigma: w.sigma,
    })
}

fn points(path: Path) -> Vec<PathPoint> {
    let point = |place: PathPlace| match place {
        PathPlace::Vertex(v) => Some(PathPoint::Vertex(v)),
        PathPlace::Edge { ends, t } => Some(PathPoint::Edge(ends, t)),
        // A path between vertices has no vertices inside faces.
        PathPlace::Face => None,
    };
    let places = path.points.into_iter();
    places.filter_map(|p| point(p.place)).collect()
}
