//! Distances with a proof of their error.

use geobench_certify::{
    Bound, Claim, ClaimError, FailurePlace, PathPoint, ProofFailure, WindowData,
};
use geobench_mesh::tolerance::RELATIVE;
use geobench_mesh::{HalfEdgeId, Mesh, Refined, Tolerance, TriangleSoup, VertexId};
use geobench_mmp::{Carrier, Mmp, mmp_from, windows_of};
use geobench_paths::{Path, PathPlace, Paths};
use geobench_window::queue::CalendarQueue;
use geobench_window::{Goal, SolveError, Sources};

/// Distances with a bound of their error, proven in interval arithmetic. The proof assumes nothing
/// about the solver.
///
/// ```
/// use geodesics::{Certificate, Distances, Judgement, Mesh};
///
/// let mesh = Mesh::generate("sphere,subdiv=2")?;
/// let proof = Certificate::of(&mesh, 0)?;
/// assert!(proof.relative() < 1e-9);
///
/// // Distances from elsewhere are right if they are close to the proven ones.
/// let distances = mesh.distances_from(0)?;
/// assert_eq!(proof.judge(7, distances[7], 1e-9), Judgement::Right);
/// assert!(matches!(proof.judge(7, 1.001 * distances[7], 1e-9), Judgement::Wrong(_)));
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
    /// The rule of which distances are right.
    rule: Tolerance,
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
        Self::within(mesh, sources, RELATIVE)
    }

    /// As [`of`](Self::of), for another [tolerance](Claim::with_tolerance) than 1e-9. The bounds
    /// for a small one are closer and take longer.
    ///
    /// # Errors
    ///
    /// As `of`.
    pub fn within(
        mesh: &Mesh,
        sources: impl Sources,
        tolerance: f64,
    ) -> Result<Self, CertificateError> {
        let sources = sources.into_vertices().into_iter();
        let sources: Vec<VertexId> = sources.map(|v| mesh.kept_vertex(v)).collect();
        match of_usual_size(mesh) {
            Some((scaled, factor)) => {
                let found = Self::prove(&scaled, &sources, tolerance)?;
                Ok(found.scaled(mesh, 1.0 / factor))
            }
            None => Self::prove(mesh, &sources, tolerance),
        }
    }

    fn prove(mesh: &Mesh, sources: &[VertexId], tolerance: f64) -> Result<Self, CertificateError> {
        let mut solver = mmp_from(mesh, Carrier::HalfEdge, CalendarQueue::new(mesh));
        let paths = Paths::find(&mut solver, mesh, sources, &Goal::everything())?;
        let mut distances = paths.distances().to_vec();
        for [copy, _] in mesh.copies() {
            // It is in no face. The proof of the vertex that stands for it is its own.
            distances[copy.index()] = f64::INFINITY;
        }
        let claim = Claim::new(mesh, sources, &distances)?.with_tolerance(tolerance);
        let mut too_long = claim.not_too_long(|h| window_data(&solver, h));
        drop(solver);
        let last = |v| paths.last_line(v).map(points);
        let whole = |v| paths.to(v).ok().flatten().map(points);
        let mut too_short = claim.not_too_short_by_lines(last, whole);
        mesh.fill_copies(&mut distances);
        mesh.fill_copies(&mut too_long.errors);
        mesh.fill_copies(&mut too_short.errors);
        let rule = Tolerance::on(mesh, &distances);
        Ok(Self {
            distances,
            too_long,
            too_short,
            rule,
        })
    }

    /// The same for `mesh`, which is larger by `factor`, a power of two.
    fn scaled(mut self, mesh: &Mesh, factor: f64) -> Self {
        let Self {
            distances,
            too_long,
            too_short,
            rule,
        } = &mut self;
        for d in distances.iter_mut() {
            *d *= factor;
        }
        mesh.fill_copies(distances);
        *rule = Tolerance::on(mesh, distances);
        for bound in [too_long, too_short] {
            bound.absolute *= factor;
            for error in &mut bound.errors {
                *error *= factor;
            }
            mesh.fill_copies(&mut bound.errors);
            for failure in &mut bound.failures {
                failure.violation *= factor;
            }
        }
        self
    }

    /// Upper bound of the error of a distance, in units of the mesh; infinite if nothing is proven.
    pub fn absolute(&self) -> f64 {
        self.greatest(|v| self.error(v, self.distances[v]))
    }

    /// The least tolerance with which all distances are proven right by the [rule](Tolerance):
    /// nearly the error as a fraction of the distance, less where a distance is far below the
    /// others. Infinite if nothing is proven.
    pub fn relative(&self) -> f64 {
        self.greatest(|v| self.relative_error(v, self.distances[v]))
    }

    fn greatest(&self, of: impl Fn(usize) -> f64) -> f64 {
        (0..self.distances.len()).map(of).fold(0.0, f64::max)
    }

    /// The least and the greatest length that the shortest path to a vertex can have.
    ///
    /// # Panics
    ///
    /// If the vertex does not exist.
    pub fn bounds(&self, v: usize) -> [f64; 2] {
        let d = self.distances[v];
        let [long, short] = [&self.too_long, &self.too_short].map(|bound| bound.errors[v]);
        if d.is_infinite() {
            // Without a path that was found. If the proof failed, there may be one.
            return [if long == 0.0 { d } else { 0.0 }, d];
        }
        let least = if long > 0.0 {
            (d - long).next_down().max(0.0)
        } else {
            d
        };
        let greatest = if short > 0.0 {
            (d + short).next_up()
        } else {
            d
        };
        [least, greatest]
    }

    /// Upper bound of the error of `given` as the distance of vertex `v`. Infinite for NaN, and
    /// where only one of both distances is infinite.
    ///
    /// # Panics
    ///
    /// If the vertex does not exist.
    pub fn error(&self, v: usize, given: f64) -> f64 {
        match self.bounds(v) {
            [least, greatest] if least == given && greatest == given => 0.0,
            [least, greatest] if given.is_finite() && greatest.is_finite() => {
                (given - least).max(greatest - given).next_up()
            }
            _ => f64::INFINITY,
        }
    }

    /// The error in the terms of the [rule](Tolerance): the least tolerance with which `given` is
    /// proven right.
    ///
    /// # Panics
    ///
    /// If the vertex does not exist.
    pub fn relative_error(&self, v: usize, given: f64) -> f64 {
        let (error, d, rounding) = (self.error(v, given), self.distances[v], self.rounding(v));
        if error == 0.0 || error.is_infinite() {
            return error;
        }
        let fraction = error / (d + rounding / RELATIVE);
        if fraction <= RELATIVE {
            fraction
        } else {
            (error - rounding) / d
        }
    }

    /// Judges `given` as the distance of vertex `v`. The [rule](Tolerance) of right distances
    /// allows the relative error `tolerance`. A tolerance below 1e-9 reduces the rounding that it
    /// allows, too.
    ///
    /// # Panics
    ///
    /// If the vertex does not exist.
    pub fn judge(&self, v: usize, given: f64, tolerance: f64) -> Judgement {
        if self.relative_error(v, given) <= tolerance {
            return Judgement::Right;
        }
        let [least, greatest] = self.bounds(v);
        let by = if given.is_nan() || given == f64::INFINITY && greatest.is_finite() {
            f64::INFINITY
        } else {
            match (given - greatest).max(least - given) {
                // Finite where no path leads.
                f64::INFINITY => f64::INFINITY,
                by => by.next_down(),
            }
        };
        let rounding = self.rounding(v) * (tolerance / RELATIVE).min(1.0);
        if by == f64::INFINITY || by > tolerance * self.distances[v] + rounding {
            Judgement::Wrong(by)
        } else {
            Judgement::Unproven(self.error(v, given))
        }
    }

    /// The rounding that the rule allows at a vertex.
    fn rounding(&self, v: usize) -> f64 {
        self.rule.allowed(v, 0.0)
    }
}

/// A mesh whose longest or shortest edge is more than this number of powers of two from 1 is
/// [scaled](of_usual_size).
const UNUSUAL: f64 = 100.0;

/// `mesh` with edges around a length of 1, and the power of two by which it is scaled; `None` if
/// its edges are neither very long nor very short. Faces and half-edges have the same numbers.
///
/// Where two distances along an edge meet is found from sixth powers of lengths. They overflow, or
/// lose their last digits, where edges are near the limits of a mesh.
fn of_usual_size(mesh: &Mesh) -> Option<(Mesh, f64)> {
    let shortest = mesh.half_edges().map(|h| mesh.length(h)).reduce(f64::min)?;
    let ends = [shortest, mesh.longest_edge()].map(f64::log2);
    if ends.iter().all(|end| end.abs() <= UNUSUAL) {
        return None;
    }
    #[expect(
        clippy::cast_possible_truncation,
        reason = "lengths are from 1e-60 to 1e60"
    )]
    let factor = 2f64.powi(-f64::midpoint(ends[0], ends[1]).round() as i32);
    let positions = mesh.positions().iter();
    let positions: Vec<[f64; 3]> = positions.map(|p| p.map(|x| x * factor)).collect();
    let restored = positions.iter().map(|p| p.map(|x| x / factor));
    if !restored.eq(mesh.positions().iter().copied()) {
        return None;
    }
    let corners = mesh.faces().map(|f| mesh.face_vertices(f));
    let faces = corners.map(|corners| corners.map(VertexId::raw)).collect();
    let (scaled, _) = Mesh::from_soup(TriangleSoup::new(positions, faces)).ok()?;
    (scaled.face_count() == mesh.face_count()).then_some((scaled, factor))
}

/// What a proof says about the distance of a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Judgement {
    /// It is proven right.
    Right,
    /// It is proven wrong by at least this amount: there is a shorter path, or none is so short.
    /// Infinite for NaN, and where only one of both distances is infinite.
    Wrong(f64),
    /// Neither is proven. An error of this amount is not excluded.
    Unproven(f64),
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
    pub fn new(failure: &ProofFailure, refined: &Refined, mesh: &Mesh) -> Self {
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

fn window_data(solver: &Mmp<CalendarQueue>, h: HalfEdgeId) -> impl Iterator<Item = WindowData> {
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
