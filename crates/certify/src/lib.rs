//! Proofs that computed geodesic distances are correct.
//!
//! A [`Claim`] assigns each vertex its distance from the nearest source. Two proofs bound the error
//! of the distances, one in each direction. Both use interval arithmetic on the vertex positions,
//! so they hold whatever the rounding errors of the solver are.
//!
//! *Not too short.* A path of the claimed length exists. [`Claim::not_too_short`] checks that
//! consecutive points of the path share a face, and adds up the lengths of its segments.
//!
//! *Not too long.* Let d be a function on the points of all edges that is 0 at the sources. Suppose
//! that in every face d satisfies the Lipschitz condition `d(y) <= d(x) + |xy|` for all boundary
//! points x and y. Every path is a chain of segments inside faces, so d nowhere exceeds the
//! geodesic distance. [`Claim::not_too_long`] takes for d the lower envelope, on each edge, of the
//! solver's windows and of the distances along the edge from its ends. It checks all pairs of
//! envelope pieces of a face in closed form. It assumes nothing about the windows. Where they leave
//! a gap, it fills the gap (`repair`). Where they are too short, the proof fails.
//!
//! If the condition holds only up to a violation `e(f)` in face f, d is too long by at most the sum
//! of `e(f)` over the faces that a shortest path crosses. A shortest path crosses a face at most
//! once, so the total T of `e(f)` over all faces bounds the error. T is usually far too
//! pessimistic. Call `d(x) + |xy| - d(y)` the *detour* of the segment from x to y. If the last
//! segment of a shortest path to y has a detour above T, d(y) is not too long, because d(x) is too
//! long by at most T. Violations therefore add up only along chains of segments with a detour of at
//! most T. These chains follow the wavefront. The error bound of a vertex is the greatest sum of
//! violations along such a chain.
//!
//! A vertex much nearer to the source than others is not proven by this: a piece or a face that
//! leads from it to a far vertex links it to violations there. But if d(v) is too long, all points
//! of the shortest path to v have a geodesic distance below d(v), so d is below d(v) + T on it.
//! Beyond that, no violation matters: the proof of such vertices is repeated with the pieces cut
//! where d exceeds this level (`level`).
//!
//! The proof is attempted in plain doubles first. Their rounding counts as a violation in each
//! face, with a bound that holds for all operations of a comparison. Where it is not enough,
//! comparisons are made again in numbers of two doubles with their own bounds (`ball`): at once if
//! a violation is more than rounding, and everywhere if the sums for some vertex are.
//!
//! Nothing of this depends on how many faces an edge has or how they are oriented: a path is a
//! chain of segments inside faces on any surface of triangles.
//!
//! ```
//! use geobench_certify::{Claim, PathPoint};
//! use geobench_mesh::{Mesh, VertexId};
//!
//! // One triangle: distances from vertex 0 are lengths of edges, and there are no windows.
//! let positions = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
//! let mesh = Mesh::new(positions, vec![[0, 1, 2]])?;
//! let source = [VertexId::new(0)];
//! let claim = Claim::new(&mesh, &source, &[0.0, 3.0, 4.0])?;
//! let long = claim.not_too_long(|_| Vec::new());
//! let edge_to = |v| vec![PathPoint::Vertex(source[0]), PathPoint::Vertex(v)];
//! let short = claim.not_too_short(|v| Some(edge_to(v)));
//! assert!(long.relative < 1e-13 && short.relative < 1e-13);
//!
//! // Too long by a part in a thousand million.
//! let wrong = Claim::new(&mesh, &source, &[0.0, 3.0, 4.000_000_004])?;
//! assert!(wrong.not_too_long(|_| Vec::new()).relative > 0.9e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod ball;
mod boundary;
mod chains;
mod difference;
mod envelope;
mod face;
mod field;
mod interval;
mod jump;
mod length;
mod level;
mod repair;
mod shape;
mod side_pair;

use std::collections::HashSet;
use std::ops::Range;

use geobench_mesh::{FaceId, HalfEdgeId, Mesh, Tolerance, VertexId, threads, tolerance};

use boundary::windows_from_inside;
use chains::greatest_sums;
use envelope::{EnvelopeBuilder, EnvelopePiece, GAP, piece};
use face::{Arithmetic, Checker, FaceChecks};
use field::{EdgeField, Envelopes};
use interval::lesser;
use jump::sum_of_jumps;
use level::below;
use repair::{REPAIR, repair};
use side_pair::ChainLink;

pub use envelope::WindowData;
pub use length::PathPoint;

/// Distances of all vertices, claimed to be the geodesic distances from the nearest of some
/// sources.
#[derive(Clone, Copy, Debug)]
pub struct Claim<'a> {
    mesh: &'a Mesh,
    sources: &'a [VertexId],
    distances: &'a [f64],
    /// See [`Claim::with_tolerance`].
    tolerance: f64,
}

/// Why a claim cannot be checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ClaimError {
    /// The number of distances differs from the number of vertices.
    #[error("{distances} distances for {vertices} vertices; give one for each")]
    Count {
        /// Number of distances.
        distances: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A distance is negative or not a number.
    #[error("the distance of vertex {0} is negative or not a number")]
    NoDistance(VertexId),
    /// There is no source, or a source is not a vertex of the mesh.
    #[error("no source is given, or one does not exist")]
    NoSource,
    /// A source is not at distance 0.
    #[error("source vertex {0} is not at distance 0")]
    SourceNotZero(VertexId),
    /// The mesh was made from lengths of edges.
    #[error("a mesh without positions cannot be certified, because rounded lengths prove nothing")]
    NoPositions,
}

/// Upper bound of the error of a claim's distances in one direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bound {
    /// Greatest error, in units of the mesh. It covers all vertices and, for
    /// [`Claim::not_too_long`], the points of all edges. Infinite if there is no proof for some
    /// vertex.
    pub absolute: f64,
    /// Greatest error as a fraction of the distance, over all vertices other than sources.
    pub relative: f64,
    /// Greatest error of each vertex. Infinite without a proof, 0 at sources and for infinite
    /// distances.
    pub errors: Vec<f64>,
    /// Places where the violation exceeds rounding, worst first.
    pub failures: Vec<ProofFailure>,
    /// Number of envelope pieces on all edges, for [`Claim::not_too_long`]; number of points of all
    /// paths, for [`Claim::not_too_short`].
    pub pieces: usize,
}

/// A place where the proof fails.
///
/// ```
/// use geobench_certify::{Claim, FailurePlace};
/// use geobench_mesh::{Mesh, VertexId};
///
/// let positions = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
/// let mesh = Mesh::new(positions, vec![[0, 1, 2]])?;
/// let source = [VertexId::new(0)];
/// // Vertex 2 is at 4, not at 5.
/// let bound = Claim::new(&mesh, &source, &[0.0, 3.0, 5.0])?.not_too_long(|_| Vec::new());
/// assert_eq!(bound.failures[0].place, FailurePlace::Vertex(VertexId::new(2)));
/// assert!((bound.failures[0].violation - 1.0).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProofFailure {
    /// The face or vertex.
    pub place: FailurePlace,
    /// For a face, the edge on which the distances are too long. `None` for a vertex, and for a
    /// face that has both finite and infinite corners.
    pub edge: Option<HalfEdgeId>,
    /// Amount of the violation, in units of the mesh. Infinite if only some corners of a face have
    /// a finite distance, or if a path is missing or leaves the surface.
    pub violation: f64,
}

/// A face or a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FailurePlace {
    /// A face with boundary points x and y for which `d(y) > d(x) + |xy|`.
    Face(FaceId),
    /// A vertex at which the distances on its edges disagree, or without a path of the claimed
    /// length.
    Vertex(VertexId),
}

/// A path on the surface.
#[derive(Clone, Copy)]
struct Walk {
    start: VertexId,
    /// An upper bound.
    length: f64,
    /// Number of its points.
    points: usize,
}

/// The violations of all faces and vertices, added up.
struct Sums {
    /// That of each face, and its side on which distances are too long.
    in_face: Vec<f64>,
    sides: Vec<Option<HalfEdgeId>>,
    /// The sum of all.
    total: f64,
    /// Bounds of how much the distances are too long: of all points of edges, and of each vertex.
    absolute: f64,
    errors: Vec<f64>,
}

/// The violations of faces.
#[derive(Default)]
struct Violations {
    in_face: Vec<f64>,
    /// The side of each face on which distances are too long.
    sides: Vec<Option<HalfEdgeId>>,
    /// The links of all faces; `None` if there are too many.
    links: Option<Vec<ChainLink>>,
}

impl Violations {
    /// Replaces those of `faces`, in this order.
    fn replace(&mut self, faces: &[FaceId], new: Self) {
        let new_faces = new.in_face.into_iter().zip(new.sides);
        for (face, (violation, side)) in faces.iter().zip(new_faces) {
            self.in_face[face.index()] = violation;
            self.sides[face.index()] = side;
        }
        let mut is_new = vec![false; self.in_face.len()];
        for face in faces {
            is_new[face.index()] = true;
        }
        self.links = self.links.take().zip(new.links).map(|(mut links, more)| {
            links.retain(|link| !is_new[link.face.index()]);
            links.extend(more);
            links
        });
    }
}

/// Segments with a detour above this fraction of the greatest distance are left out of the chains.
/// The limit is raised if the sum of all violations exceeds it.
const CLEAR: f64 = 1e-8;

/// Levels for which a proof is repeated, and the least ratio between two. Each takes as long as the
/// faces below it.
const MOST_LEVELS: usize = 20;
const LEVEL_RATIO: f64 = 4.0;

/// A proof in plain doubles is enough if it bounds all errors by this fraction of the tolerance.
const ENOUGH: f64 = 0.25;

/// Parts of the work for each thread.
const PARTS: usize = 16;

/// A violation above this fraction of the local distances and lengths is a failure, not rounding.
const ROUNDING: f64 = 1e-13;

/// The same in a proof in plain doubles, which also repairs no smaller ones. It is far above their
/// error, and hundreds of them on a path are within a tenth of 1e-9.
const ROUGHLY: f64 = 1e-12;

impl<'a> Claim<'a> {
    /// Claims that `distances` are the geodesic distances from the nearest of `sources`: one for
    /// each vertex, infinite where unreachable.
    ///
    /// # Errors
    ///
    /// If the number of distances is not the number of vertices, a distance is negative or NaN, a
    /// source is missing, does not exist or is not at distance 0, or the mesh has no positions.
    pub fn new(
        mesh: &'a Mesh,
        sources: &'a [VertexId],
        distances: &'a [f64],
    ) -> Result<Self, ClaimError> {
        let vertices = mesh.vertex_count();
        if distances.len() != vertices {
            return Err(ClaimError::Count {
                distances: distances.len(),
                vertices,
            });
        }
        if let Some(v) = mesh
            .vertices()
            .find(|v| distances[v.index()].is_nan() || distances[v.index()] < 0.0)
        {
            return Err(ClaimError::NoDistance(v));
        }
        if sources.is_empty() || sources.iter().any(|s| s.index() >= vertices) {
            return Err(ClaimError::NoSource);
        }
        if let Some(&s) = sources.iter().find(|s| distances[s.index()] != 0.0) {
            return Err(ClaimError::SourceNotZero(s));
        }
        if mesh.positions().len() != vertices {
            return Err(ClaimError::NoPositions);
        }
        Ok(Self {
            mesh,
            sources,
            distances,
            tolerance: tolerance::RELATIVE,
        })
    }

    /// Sets the error that is to be excluded, as a fraction of each distance; 1e-9 by default. A
    /// proof in plain doubles is enough if it excludes a quarter of that; else the proof is
    /// repeated in numbers of two doubles.
    #[must_use]
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// Upper bound of the amount by which the distances are too long.
    ///
    /// `windows` returns the windows that enter the face of a half-edge, in the frame of that
    /// half-edge.
    ///
    /// Takes O(w²) time for each face that w windows enter. In a pool of `rayon`, all its threads
    /// share the work; the result is the same.
    pub fn not_too_long<W>(&self, windows: impl Fn(HalfEdgeId) -> W + Sync) -> Bound
    where
        W: IntoIterator<Item = WindowData>,
    {
        let mut field = self.edge_field(windows);
        let bound = self.prove(&mut field, Arithmetic::Double);
        if bound.relative <= ENOUGH * self.tolerance {
            return bound;
        }
        self.prove(&mut field, Arithmetic::TwoDoubles)
    }

    /// The proof with comparisons in this precision. Repairs `field`.
    fn prove(&self, field: &mut EdgeField<'_>, precision: Arithmetic) -> Bound {
        let finite = self.distances.iter().copied().filter(|d| d.is_finite());
        let farthest = finite.fold(0.0, f64::max);
        let clear = CLEAR * farthest;
        let all: Vec<FaceId> = self.mesh.faces().collect();
        let mut found = self.violations(field, &all, clear, precision);
        let leak = |f: &FaceId| found.in_face[f.index()] / self.scale(*f);
        let [most, rounding] = match precision {
            Arithmetic::Double => [ROUGHLY; 2],
            Arithmetic::TwoDoubles => [REPAIR, ROUNDING],
        };
        let is_leaky = |f: &FaceId| leak(f) > most;
        let mut leaky: Vec<FaceId> = all.iter().copied().filter(is_leaky).collect();
        leaky.sort_by(|a, b| leak(b).total_cmp(&leak(a)));
        let changed = repair(field, &leaky);
        if !changed.is_empty() {
            found.replace(&changed, self.violations(field, &changed, clear, precision));
        }
        let mut failures = Vec::new();
        let own = self.disagreements(field);
        for (v, (&violation, &d)) in self.mesh.vertices().zip(own.iter().zip(self.distances)) {
            if violation > rounding * d.max(self.longest_edge(v)) {
                failures.push(ProofFailure {
                    place: FailurePlace::Vertex(v),
                    edge: None,
                    violation,
                });
            }
        }
        let sums = self.sums(field, found, &own, clear, precision);
        for face in self.mesh.faces() {
            let violation = sums.in_face[face.index()];
            if violation > rounding * self.scale(face) {
                failures.push(ProofFailure {
                    place: FailurePlace::Face(face),
                    edge: sums.sides[face.index()],
                    violation,
                });
            }
        }
        failures.sort_by(|a, b| b.violation.total_cmp(&a.violation));
        let mut errors = sums.errors;
        for (error, &d) in errors.iter_mut().zip(self.distances) {
            // A source is at 0. A vertex at infinity whose faces do not fail has no path to a
            // source.
            if d == 0.0 || d.is_infinite() && sums.total.is_finite() {
                *error = 0.0;
            }
        }
        if sums.absolute.is_finite() && precision == Arithmetic::TwoDoubles {
            self.prove_by_level(field, &own, sums.absolute, &mut errors);
        }
        Bound {
            absolute: sums.absolute,
            relative: self.greatest_relative(&errors),
            errors,
            failures,
            pieces: field.ranges.iter().map(ExactSizeIterator::len).sum(),
        }
    }

    /// Adds up the violations `found` of all faces, with links of a detour up to `clear`, and those
    /// at vertices, `own`.
    fn sums(
        &self,
        field: &EdgeField<'_>,
        mut found: Violations,
        own: &[f64],
        mut clear: f64,
        precision: Arithmetic,
    ) -> Sums {
        // `clear` must be at least the total of all violations. Few claims need a second round.
        let total = loop {
            // The rounding error of a sum of n non-negative numbers is at most n ulps.
            let generous = 1.0 + (found.in_face.len() + own.len()) as f64 * f64::EPSILON;
            let total = found.in_face.iter().chain(own).sum::<f64>() * generous;
            if total <= clear || !total.is_finite() {
                break total;
            }
            clear = 2.0 * total;
            let all: Vec<FaceId> = self.mesh.faces().collect();
            found = self.violations(field, &all, clear, precision);
        };
        let Violations {
            in_face,
            sides,
            links,
        } = found;
        let (absolute, errors) = if total.is_finite() {
            self.add_up(field.pieces.len(), own.to_vec(), &in_face, links, total)
        } else {
            (f64::INFINITY, vec![f64::INFINITY; self.distances.len()])
        };
        Sums {
            in_face,
            sides,
            total,
            absolute,
            errors,
        }
    }

    /// Lowers the errors of vertices that the [rule](Tolerance) does not allow, by the part of the
    /// field below a level. `absolute` bounds how much distances are too long anywhere.
    fn prove_by_level(
        &self,
        field: &EdgeField<'_>,
        own: &[f64],
        absolute: f64,
        errors: &mut [f64],
    ) {
        let rule = Tolerance::on(self.mesh, self.distances);
        let all: Vec<FaceId> = self.mesh.faces().collect();
        let finite = self.distances.iter().copied().filter(|d| d.is_finite());
        let farthest = finite.fold(0.0, f64::max);
        // Each level with a bound for the points up to it, highest first.
        let mut proven: Vec<[f64; 2]> = Vec::new();
        let mut next = f64::INFINITY;
        for _ in 0..MOST_LEVELS {
            let is_unproven =
                |v: usize, d: f64| d < next && errors[v] > rule.allowed(v, d) && d.is_finite();
            let unproven = self.distances.iter().copied().enumerate();
            let unproven = unproven.filter(|&(v, d)| is_unproven(v, d));
            let Some(level) = unproven.map(|(_, d)| d).reduce(f64::max) else {
                return;
            };
            next = level / LEVEL_RATIO;
            let too_long = proven.iter().fold(absolute, |most, &[known, bound]| {
                if (level + most) * (1.0 + 1e-15) <= known {
                    bound
                } else {
                    most
                }
            });
            let cut = (level + too_long) * (1.0 + 1e-15);
            if cut > farthest / 2.0 {
                continue;
            }
            let part = below(field, cut);
            // The distances at the ends of the edges of a vertex differ by its violation at most.
            let is_below = |(&own, &d): (&f64, &f64)| if d - own <= cut { own } else { 0.0 };
            let own: Vec<f64> = own.iter().zip(self.distances).map(is_below).collect();
            let clear = CLEAR * cut;
            let precision = Arithmetic::TwoDoubles;
            let found = self.violations(&part, &all, clear, precision);
            let sums = self.sums(&part, found, &own, clear, precision);
            for (v, error) in errors.iter_mut().enumerate() {
                if self.distances[v] <= level {
                    *error = error.min(sums.errors[v]);
                }
            }
            proven.push([level, sums.absolute]);
        }
    }

    /// The greatest of these errors of all vertices, as a fraction of the distance.
    fn greatest_relative(&self, errors: &[f64]) -> f64 {
        let fractions = errors.iter().zip(self.distances).map(|(&error, &d)| {
            if error > 0.0 {
                (error / d).next_up()
            } else {
                0.0
            }
        });
        fractions.fold(0.0, f64::max)
    }

    /// The greatest distance of a corner plus the length of an edge.
    fn scale(&self, face: FaceId) -> f64 {
        let corners = self.mesh.face_vertices(face);
        let distances = corners.map(|v| self.distances[v.index()]);
        let finite = distances.into_iter().filter(|d| d.is_finite());
        finite.fold(0.0, f64::max) + self.mesh.length(face.half_edge(0))
    }

    /// The violations of these faces. Leaves out links with a detour above `clear`.
    fn violations(
        &self,
        field: &EdgeField<'_>,
        faces: &[FaceId],
        clear: f64,
        precision: Arithmetic,
    ) -> Violations {
        let checks = FaceChecks::new(field, clear, precision);
        let ranges = threads::ranges(faces.len(), PARTS);
        let parts = threads::each(ranges, |range| {
            let mut checker = Checker::new(&checks);
            let found = faces[range]
                .iter()
                .map(|&f| self.violation(f, &mut checker));
            let (in_face, sides): (Vec<_>, Vec<_>) = found.unzip();
            (in_face, sides, checker.links)
        });
        let mut found = Violations::default();
        let mut links = Vec::new();
        for (in_part, sides_of_part, links_of_part) in parts {
            threads::append(&mut found.in_face, in_part);
            threads::append(&mut found.sides, sides_of_part);
            threads::append(&mut links, links_of_part);
        }
        found.links = Some(links).filter(|_| !checks.has_too_many_links());
        found
    }

    /// The violation of a face, and its side with the violation.
    fn violation(&self, face: FaceId, checker: &mut Checker<'_>) -> (f64, Option<HalfEdgeId>) {
        let corners = self.mesh.face_vertices(face);
        match corners.map(|v| self.distances[v.index()].is_finite()) {
            [false, false, false] => (0.0, None),
            [true, true, true] => {
                let (violation, side) = checker.violation(face);
                (violation, Some(side))
            }
            _ => (f64::INFINITY, None),
        }
    }

    /// Upper bound of the amount by which the distances are too short.
    ///
    /// `path` returns a path from a source to a vertex, or from a vertex with a smaller distance.
    /// It is called for each vertex with a finite distance that is not a source. Without a path the
    /// bound is infinite.
    ///
    /// Takes O(n) time for n points of all paths together. In a pool of `rayon`, all its threads
    /// share the work.
    pub fn not_too_short(&self, path: impl Fn(VertexId) -> Option<Vec<PathPoint>> + Sync) -> Bound {
        self.not_too_short_by_lines(path, |_| None)
    }

    /// As [`not_too_short`](Self::not_too_short), with the last straight line of each path, which
    /// begins at a vertex where the path bends. The path to that vertex is not traced again, so
    /// long paths with many bends take no more time than their last lines.
    ///
    /// `path` is called where the lines prove less than rounding allows. It returns a path as in
    /// `not_too_short`.
    pub fn not_too_short_by_lines(
        &self,
        line: impl Fn(VertexId) -> Option<Vec<PathPoint>> + Sync,
        path: impl Fn(VertexId) -> Option<Vec<PathPoint>>,
    ) -> Bound {
        let sources: HashSet<VertexId> = self.sources.iter().copied().collect();
        let ranges = threads::ranges(self.mesh.vertex_count(), PARTS);
        let needs_path =
            |v: &VertexId| self.distances[v.index()].is_finite() && !sources.contains(v);
        let lines = threads::each(ranges, |range| {
            let vertices = range.map(|v| VertexId::new(v as u32));
            let of = |v| needs_path(&v).then(|| line(v).map(|points| self.walk(&points, v)));
            vertices.map(|v| of(v).flatten()).collect::<Vec<_>>()
        });
        let lines: Vec<Option<Walk>> = lines.into_iter().flatten().collect();
        let mut order: Vec<VertexId> = self.mesh.vertices().filter(needs_path).collect();
        order.sort_by(|a, b| self.distances[a.index()].total_cmp(&self.distances[b.index()]));
        // Upper bounds of the geodesic distances of the vertices so far.
        let mut greatest = vec![f64::INFINITY; self.mesh.vertex_count()];
        for source in &sources {
            greatest[source.index()] = 0.0;
        }
        let mut bound = Bound {
            errors: vec![0.0; greatest.len()],
            ..Bound::default()
        };
        let rule = Tolerance::on(self.mesh, self.distances);
        let is_right = |v: VertexId, length: f64| {
            let d = self.distances[v.index()];
            length - d <= rule.allowed(v.index(), d) / 2.0
        };
        // Much less than the rule allows, because errors add up from line to line.
        let of_line = rule
            .clone()
            .with_relative(10.0 * ROUNDING)
            .with_rounding(1e-2 * ROUNDING);
        for v in order {
            let d = self.distances[v.index()];
            let to = |walk: &Walk| (greatest[walk.start.index()] + walk.length).next_up();
            // A path may be as much too long as its first part, and rounding.
            let most = |walk: &Walk| {
                let start = walk.start.index();
                d + (greatest[start] - self.distances[start]).max(0.0)
                    + of_line.allowed(v.index(), d)
            };
            let mut length = f64::INFINITY;
            if let Some(walk) = lines[v.index()] {
                bound.pieces += walk.points;
                length = to(&walk);
                if length > most(&walk) && length.is_finite() {
                    length = lesser(length, to(&self.shorter(&walk, line(v))));
                }
            }
            if !is_right(v, length)
                && let Some(points) = path(v)
            {
                let walk = self.walk(&points, v);
                length = lesser(length, to(&walk));
                if !is_right(v, length) {
                    length = lesser(length, to(&self.shorter(&walk, Some(points))));
                }
            }
            let length = if length.is_nan() {
                f64::INFINITY
            } else {
                length
            };
            greatest[v.index()] = length;
            let excess = (length - d).next_up().max(0.0);
            bound.errors[v.index()] = excess;
            if excess > ROUNDING * 10.0 * d {
                bound.failures.push(ProofFailure {
                    place: FailurePlace::Vertex(v),
                    edge: None,
                    violation: excess,
                });
            }
        }
        bound.absolute = bound.errors.iter().copied().fold(0.0, f64::max);
        bound.relative = self.greatest_relative(&bound.errors);
        let worst_first = |a: &ProofFailure, b: &ProofFailure| b.violation.total_cmp(&a.violation);
        bound.failures.sort_by(worst_first);
        bound
    }

    /// A path of which the points on edges are moved to where it is shorter.
    fn shorter(&self, walk: &Walk, points: Option<Vec<PathPoint>>) -> Walk {
        let points = points.filter(|_| walk.length.is_finite());
        let length = points.map(|points| length::least_length(self.mesh, &points));
        Walk {
            length: length.unwrap_or(f64::INFINITY),
            ..*walk
        }
    }

    /// A path to `target` through these points. Its length is infinite if it is none.
    fn walk(&self, points: &[PathPoint], target: VertexId) -> Walk {
        let found = length::greatest_length(self.mesh, points, target);
        let (start, length) = found.unwrap_or((target, f64::INFINITY));
        Walk {
            start,
            length,
            points: points.len(),
        }
    }

    /// The lower envelopes of the windows of all edges.
    fn edge_field<W>(&self, windows: impl Fn(HalfEdgeId) -> W + Sync) -> EdgeField<'a>
    where
        W: IntoIterator<Item = WindowData>,
    {
        let ranges = threads::ranges(self.mesh.half_edge_count(), PARTS);
        let parts = threads::each(ranges, |range| self.envelopes(range, &windows));
        EdgeField::new(self.mesh, parts)
    }

    /// The lower envelopes of the windows of a range of half-edges.
    fn envelopes<W>(&self, half_edges: Range<usize>, windows: impl Fn(HalfEdgeId) -> W) -> Envelopes
    where
        W: IntoIterator<Item = WindowData>,
    {
        let mesh = self.mesh;
        let mut found = Envelopes::default();
        let mut all: Vec<EnvelopePiece> = Vec::new();
        let mut builder = EnvelopeBuilder::default();
        for h in half_edges.map(|h| HalfEdgeId::new(h as u32)) {
            let ends = [mesh.tail(h), mesh.head(h)].map(|v| self.distances[v.index()]);
            if mesh.edge_of(h) != h || !ends.iter().all(|d| d.is_finite()) {
                found.half_edges.push((0, 0.0));
                continue;
            }
            let length = mesh.length(h);
            let of = |h: HalfEdgeId, turned| {
                let windows = windows(h).into_iter();
                windows.map(move |window| piece(&window, length, turned))
            };
            all.clear();
            for side in mesh.along_edge(h) {
                all.extend(of(side, mesh.tail(side) != mesh.tail(h)));
            }
            if mesh.is_boundary_edge(h) {
                let opposite = self.distances[mesh.apex_vertex(h).index()];
                let inside = windows_from_inside(mesh, h, opposite, &windows);
                all.extend(inside.iter().map(|window| piece(window, length, false)));
            }
            // `face::MARGIN` relies on these conditions. Dropping a window is safe: it can only
            // make the proof fail.
            all.retain(|p| p.sigma >= 0.0 && p.image.iter().all(|x| x.is_finite()));
            all.extend(
                [(0.0, ends[0]), (length, ends[1])].map(|(x, sigma)| EnvelopePiece {
                    from: 0.0,
                    to: length,
                    image: [x, 0.0],
                    sigma,
                }),
            );
            let first = found.pieces.len();
            builder.lower_envelope(&all, length, GAP, &mut found.pieces);
            let pieces = &found.pieces[first..];
            found.half_edges.push((pieces.len(), sum_of_jumps(pieces)));
        }
        found
    }

    /// For each vertex, the difference between the greatest and the least of its distances: its own
    /// and those at the ends of the envelopes of its edges. 0 without edges that have distances.
    fn disagreements(&self, field: &EdgeField<'_>) -> Vec<f64> {
        let mut ranges: Vec<[f64; 2]> = self.distances.iter().map(|&d| [d; 2]).collect();
        let edges = self.mesh.half_edges();
        for h in edges.filter(|&h| self.mesh.edge_of(h) == h) {
            for (v, d) in [self.mesh.tail(h), self.mesh.head(h)]
                .into_iter()
                .zip(field.at_ends(h).into_iter().flatten())
            {
                let [least, greatest] = &mut ranges[v.index()];
                *least = least.min(d.lo);
                *greatest = greatest.max(d.hi);
            }
        }
        let widths = ranges.into_iter().map(|[least, greatest]| {
            if least == greatest {
                return 0.0;
            }
            (greatest - least).next_up()
        });
        widths.collect()
    }

    fn longest_edge(&self, v: VertexId) -> f64 {
        let lengths = self.mesh.neighbours(v).map(|(_, length)| length);
        lengths.fold(0.0, f64::max)
    }

    /// Upper bounds of how much the distances are too long: the greatest of vertices and points of
    /// edges, and that of each vertex. `own` holds the violations at vertices, `in_face` those in
    /// faces, `total` their sum; `pieces` is the number of nodes that are pieces.
    fn add_up(
        &self,
        pieces: usize,
        own: Vec<f64>,
        in_face: &[f64],
        links: Option<Vec<ChainLink>>,
        total: f64,
    ) -> (f64, Vec<f64>) {
        let Some(mut links) = links else {
            return (total, self.add_up_by_distance(&own, in_face, total));
        };
        links.retain(|link| f64::from(link.excess) >= -total);
        // Inside the neighbourhood of a vertex, a path may cross all faces around the vertex.
        let mut losses = own;
        for face in self.mesh.faces() {
            for v in self.mesh.face_vertices(face) {
                losses[v.index()] += in_face[face.index()];
            }
        }
        losses.resize(losses.len() + pieces, 0.0);
        let generous = 1.0 + (in_face.len() + losses.len()) as f64 * f64::EPSILON;
        let sums = greatest_sums(&losses, &links, in_face);
        let bounds = sums.iter().map(|sum| (sum * generous).min(total));
        let greatest = bounds.clone().fold(0.0, f64::max);
        (greatest, bounds.take(self.distances.len()).collect())
    }

    /// Upper bounds of how much the distance of each vertex is too long. Adds up all violations
    /// that are not farther from the source than the vertex. It needs no links.
    fn add_up_by_distance(&self, own: &[f64], in_face: &[f64], total: f64) -> Vec<f64> {
        // Distances are known up to `total`. Inside a face they fall below the least corner
        // distance by at most the longest edge.
        let of_faces = self.mesh.faces().map(|face| {
            let corners = self.mesh.face_vertices(face);
            let least = corners.map(|v| self.distances[v.index()]);
            let least = least.into_iter().fold(f64::INFINITY, f64::min);
            let edges = self.mesh.side_lengths(face);
            let from = least - edges.into_iter().fold(0.0, f64::max);
            (from, in_face[face.index()])
        });
        let of_vertices = self.distances.iter().copied().zip(own.iter().copied());
        let mut losses: Vec<(f64, f64)> = of_faces.chain(of_vertices).collect();
        losses.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut order: Vec<usize> = (0..self.distances.len()).collect();
        order.sort_by(|&a, &b| self.distances[a].total_cmp(&self.distances[b]));
        let generous = 1.0 + losses.len() as f64 * f64::EPSILON;
        let mut losses = losses.into_iter().peekable();
        let (mut errors, mut lost) = (vec![0.0; order.len()], 0.0);
        for v in order {
            let d = self.distances[v];
            while let Some((_, loss)) = losses.next_if(|(from, _)| *from <= d + 2.0 * total) {
                lost += loss;
            }
            errors[v] = lost * generous;
        }
        errors
    }
}
