//! Proofs that a field of geodesic distances is right.
//!
//! A claim gives every vertex a distance from the nearest source. It is proven from two sides, in
//! interval arithmetic: what is stated is true of the positions in the mesh, whatever rounding the
//! solver had.
//!
//! *Not too short.* A path of that length exists: [`Claim::not_too_short`] checks that its points
//! lie on the surface, one face after another, and adds up its segments.
//!
//! *Not too long.* Let d be any function of the points of all edges that is 0 at the sources. If
//! in every face `d(y) <= d(x) + |xy|` for all points x and y of its boundary, then d is nowhere
//! above the distance, since every path is a chain of segments inside faces.
//! [`Claim::not_too_long`] takes the lower envelope of all windows of a solver, and of the ways
//! along the edge from its ends, for d, and checks all pairs of pieces of a face in closed form.
//! Nothing is assumed about the windows: wrong ones make the proof fail.
//!
//! If the inequality holds up to `e(f)` in face f, then d is too long by at most the sum of `e(f)`
//! over the faces that a shortest path crosses, each of which it crosses once. Let T be the sum
//! over all faces. Where a path goes from x to y and `d(x) + |xy|` exceeds `d(y)` by more than T,
//! d(y) is not too long, whatever came before. So only chains of pieces between which this is not
//! so add up, and these follow the wavefront: the bound of a vertex is the greatest sum along such
//! a chain.
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
//! let short = claim.not_too_short(|v| Some(vec![PathPoint::Vertex(source[0]), PathPoint::Vertex(v)]));
//! assert!(long.relative < 1e-13 && short.relative < 1e-13);
//!
//! // Too long by a part in a thousand million.
//! let wrong = Claim::new(&mesh, &source, &[0.0, 3.0, 4.000_000_004])?;
//! assert!(wrong.not_too_long(|_| Vec::new()).relative > 0.9e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod boundary;
mod chains;
mod difference;
mod envelope;
mod face;
mod field;
mod interval;
mod jump;
mod length;
mod shape;

use geobench_mesh::{FaceId, HalfEdgeId, Mesh, VertexId};

use boundary::windows_from_inside;
use chains::greatest_sums;
use envelope::{EnvelopeBuilder, EnvelopePiece, piece};
use face::{ChainLink, Checker, MOST_LINKS};
use field::{EdgeField, canonical};
use jump::jump;

pub use envelope::WindowData;
pub use length::PathPoint;

/// Distances of all vertices, claimed to be those from the nearest of some sources.
#[derive(Clone, Copy, Debug)]
pub struct Claim<'a> {
    mesh: &'a Mesh,
    sources: &'a [VertexId],
    distances: &'a [f64],
}

/// Why a claim cannot be looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ClaimError {
    /// The number of distances is not that of the vertices.
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
    /// A source is not a vertex, or none is given.
    #[error("no source is given, or one does not exist")]
    NoSource,
    /// A source is not at distance 0.
    #[error("source vertex {0} is not at distance 0")]
    SourceNotZero(VertexId),
}

/// How much the distances of a claim may be wrong in one direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bound {
    /// In units of the mesh, for all vertices, and for all points of edges that it rests on;
    /// infinite if a vertex has no proof at all.
    pub absolute: f64,
    /// As a fraction of the distance, for all vertices other than sources.
    pub relative: f64,
    /// Where the proof fails by more than rounding, worst first.
    pub failures: Vec<Failure>,
    /// Number of pieces of the envelopes of all edges; of points of all paths.
    pub pieces: usize,
}

/// A place where the proof fails.
///
/// ```
/// use geobench_certify::{Claim, Place};
/// use geobench_mesh::{Mesh, VertexId};
///
/// let positions = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
/// let mesh = Mesh::new(positions, vec![[0, 1, 2]])?;
/// let source = [VertexId::new(0)];
/// // Vertex 2 is at 4, not at 5.
/// let bound = Claim::new(&mesh, &source, &[0.0, 3.0, 5.0])?.not_too_long(|_| Vec::new());
/// assert_eq!(bound.failures[0].place, Place::Vertex(VertexId::new(2)));
/// assert!((bound.failures[0].violation - 1.0).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failure {
    /// The place.
    pub place: Place,
    /// In a face, the edge to whose points the distances are too long.
    pub edge: Option<HalfEdgeId>,
    /// By how much, in units of the mesh: infinite if a distance is finite on one side of an edge
    /// only, or a path is missing or leaves the surface.
    pub violation: f64,
}

/// A face or a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A face across which distances grow faster than the way.
    Face(FaceId),
    /// A vertex at which edges disagree, or to which no path of that length leads.
    Vertex(VertexId),
}

/// Ways longer than the distance by this fraction of the greatest distance are left out of sums,
/// as long as all violations together are less than that.
const CLEAR: f64 = 1e-8;

/// A violation above this fraction of the distances in the place is a failure, not rounding.
const ROUNDING: f64 = 1e-13;

impl<'a> Claim<'a> {
    /// The claim that `distances`, one for each vertex and infinite where unreachable, are those
    /// from the nearest of `sources`.
    ///
    /// # Errors
    ///
    /// When the numbers do not match the mesh, a distance is negative or not a number, or a source
    /// is missing or not at distance 0.
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
        Ok(Self {
            mesh,
            sources,
            distances,
        })
    }

    /// How much too long the distances may be, by the windows that enter the face of each
    /// half-edge.
    ///
    /// O(w²) for the w windows of a face.
    pub fn not_too_long<W>(&self, windows: impl Fn(HalfEdgeId) -> W) -> Bound
    where
        W: IntoIterator<Item = WindowData>,
    {
        let field = self.edge_field(windows);
        let mut failures = Vec::new();
        let own: Vec<f64> = self
            .mesh
            .vertices()
            .map(|v| {
                let d = self.distances[v.index()];
                if !d.is_finite() {
                    return 0.0;
                }
                let violation = self.disagreement(&field, v);
                if violation > ROUNDING * d.max(self.longest_edge(v)) {
                    failures.push(Failure {
                        place: Place::Vertex(v),
                        edge: None,
                        violation,
                    });
                }
                violation
            })
            .collect();
        let finite = self.distances.iter().copied().filter(|d| d.is_finite());
        let farthest = finite.fold(0.0, f64::max);
        let mut clear = CLEAR * farthest;
        // What adds up, all together: few fields need the second turn.
        let (in_face, sides, ways, total) = loop {
            let (in_face, sides, ways) = self.violations(&field, clear);
            // A sum of n numbers that are not negative is right to n ulps.
            let generous = 1.0 + (in_face.len() + own.len()) as f64 * f64::EPSILON;
            let total = in_face.iter().chain(&own).sum::<f64>() * generous;
            if total <= clear || !total.is_finite() {
                break (in_face, sides, ways, total);
            }
            clear = 2.0 * total;
        };
        for face in self.mesh.faces() {
            let violation = in_face[face.index()];
            let corners = self.mesh.face_vertices(face);
            let distances = corners.map(|v| self.distances[v.index()]);
            let scale = distances.into_iter().fold(0.0, f64::max);
            if violation > ROUNDING * (scale + self.mesh.length(face.half_edge(0))) {
                failures.push(Failure {
                    place: Place::Face(face),
                    edge: sides[face.index()],
                    violation,
                });
            }
        }
        failures.sort_by(|a, b| b.violation.total_cmp(&a.violation));
        let (absolute, relative) = if total.is_finite() {
            self.add_up(&field, own, &in_face, ways, total)
        } else {
            (f64::INFINITY, f64::INFINITY)
        };
        Bound {
            absolute,
            relative,
            failures,
            pieces: field.pieces.len(),
        }
    }

    /// What each face may add to a distance, on which side, and the ways across that are too long by
    /// less than `clear`.
    fn violations(
        &self,
        field: &EdgeField<'_>,
        clear: f64,
    ) -> (Vec<f64>, Vec<Option<HalfEdgeId>>, Vec<ChainLink>) {
        let mut checker = Checker::new(field, clear);
        let found = self.mesh.faces().map(|face| {
            let corners = self.mesh.face_vertices(face);
            match corners.map(|v| self.distances[v.index()].is_finite()) {
                [false, false, false] => (0.0, None),
                [true, true, true] => {
                    let (violation, side) = checker.violation(face);
                    (violation, Some(side))
                }
                _ => (f64::INFINITY, None),
            }
        });
        let (in_face, sides) = found.unzip();
        (in_face, sides, checker.links)
    }

    /// How much too short the distances may be, by a path from a source to every vertex with a
    /// finite distance.
    ///
    /// O(points of all paths).
    pub fn not_too_short(&self, mut path: impl FnMut(VertexId) -> Option<Vec<PathPoint>>) -> Bound {
        let mut bound = Bound::default();
        for v in self.mesh.vertices() {
            let d = self.distances[v.index()];
            if !d.is_finite() || self.sources.contains(&v) {
                continue;
            }
            let points = path(v).unwrap_or_default();
            bound.pieces += points.len();
            let length = length::greatest_length(self.mesh, &points, self.sources, v);
            let excess = length.map_or(f64::INFINITY, |l| (l - d).next_up().max(0.0));
            bound.absolute = bound.absolute.max(excess);
            bound.relative = bound
                .relative
                .max(if excess > 0.0 { excess / d } else { 0.0 });
            if excess > ROUNDING * 10.0 * d {
                bound.failures.push(Failure {
                    place: Place::Vertex(v),
                    edge: None,
                    violation: excess,
                });
            }
        }
        let worst_first = |a: &Failure, b: &Failure| b.violation.total_cmp(&a.violation);
        bound.failures.sort_by(worst_first);
        bound
    }

    fn edge_field<W>(&self, windows: impl Fn(HalfEdgeId) -> W) -> EdgeField<'a>
    where
        W: IntoIterator<Item = WindowData>,
    {
        let mesh = self.mesh;
        let mut starts = Vec::with_capacity(mesh.half_edge_count() + 1);
        let mut pieces: Vec<EnvelopePiece> = Vec::new();
        let mut jumps = vec![0.0; mesh.half_edge_count()];
        let mut all: Vec<EnvelopePiece> = Vec::new();
        let mut builder = EnvelopeBuilder::default();
        for h in mesh.half_edges() {
            starts.push(pieces.len());
            let ends = [mesh.tail(h), mesh.head(h)].map(|v| self.distances[v.index()]);
            if canonical(mesh, h) != h || !ends.iter().all(|d| d.is_finite()) {
                continue;
            }
            let length = mesh.length(h);
            let of = |h: HalfEdgeId, turned| {
                let windows = windows(h).into_iter();
                windows.map(move |window| piece(&window, length, turned))
            };
            all.clear();
            all.extend(of(h, false));
            if let Some(twin) = mesh.twin(h) {
                all.extend(of(twin, true));
            } else {
                let opposite = self.distances[mesh.apex_vertex(h).index()];
                let inside = windows_from_inside(mesh, h, opposite, &windows);
                all.extend(inside.iter().map(|window| piece(window, length, false)));
            }
            // The margin of rounded arithmetic needs this. Without a window a proof fails, or holds.
            all.retain(|p| p.sigma >= 0.0 && p.image.iter().all(|x| x.is_finite()));
            all.extend(
                [(0.0, ends[0]), (length, ends[1])].map(|(x, sigma)| EnvelopePiece {
                    from: 0.0,
                    to: length,
                    image: [x, 0.0],
                    sigma,
                }),
            );
            let first = pieces.len();
            builder.lower_envelope(&all, length, &mut pieces);
            let pairs = pieces[first..].windows(2);
            let sum = pairs.fold(0.0, |sum: f64, pair| {
                (sum + jump(&pair[0], &pair[1], pair[0].to)).next_up()
            });
            jumps[h.index()] = sum;
        }
        starts.push(pieces.len());
        EdgeField {
            mesh,
            starts,
            pieces,
            jumps,
        }
    }

    /// How far the distances of `v` on its edges, and its own, are apart.
    fn disagreement(&self, field: &EdgeField<'_>, v: VertexId) -> f64 {
        let mut range = [self.distances[v.index()]; 2];
        for &h in self.mesh.outgoing(v) {
            for (h, at_tail) in [(h, true), (h.prev(), false)] {
                let turned = canonical(self.mesh, h) != h;
                if let Some(d) = field.at_end(h, at_tail != turned) {
                    range = [range[0].min(d.lo), range[1].max(d.hi)];
                }
            }
        }
        if range[0] == range[1] {
            return 0.0; // An isolated vertex.
        }
        (range[1] - range[0]).next_up()
    }

    fn longest_edge(&self, v: VertexId) -> f64 {
        let lengths = self.mesh.neighbours(v).map(|(_, length)| length);
        lengths.fold(0.0, f64::max)
    }

    /// By how much the distance of a point of an edge may be too long, and that of a vertex as a
    /// fraction of it.
    fn add_up(
        &self,
        field: &EdgeField<'_>,
        own: Vec<f64>,
        in_face: &[f64],
        mut ways: Vec<ChainLink>,
        total: f64,
    ) -> (f64, f64) {
        if ways.len() > MOST_LINKS {
            return (total, self.add_up_by_distance(&own, in_face, total));
        }
        ways.retain(|way| f64::from(way.excess) >= -total);
        let pieces = field.pieces.len();
        // A path may pass all faces around a vertex in its neighbourhood.
        let mut losses = vec![0.0; pieces];
        losses.extend(own);
        for face in self.mesh.faces() {
            for v in self.mesh.face_vertices(face) {
                losses[pieces + v.index()] += in_face[face.index()];
            }
        }
        let generous = 1.0 + (in_face.len() + losses.len()) as f64 * f64::EPSILON;
        let sums = greatest_sums(&losses, &ways, in_face);
        let greatest = sums.iter().copied().fold(0.0, f64::max);
        let absolute = (greatest * generous).min(total);
        let mut relative = 0.0_f64;
        for (sum, &distance) in sums[pieces..].iter().zip(self.distances) {
            if distance > 0.0 && distance.is_finite() {
                relative = relative.max((sum * generous).min(total) / distance);
            }
        }
        (absolute, relative.next_up())
    }

    /// By how much the distance of a vertex may be too long as a fraction of it, if its path may pass
    /// everything that is not farther than it.
    fn add_up_by_distance(&self, own: &[f64], in_face: &[f64], total: f64) -> f64 {
        // Distances are known up to the total, and fall by at most its longest edge within a face.
        let of_faces = self.mesh.faces().map(|face| {
            let corners = self.mesh.face_vertices(face);
            let least = corners.map(|v| self.distances[v.index()]);
            let least = least.into_iter().fold(f64::INFINITY, f64::min);
            let edges = [0, 1, 2].map(|k| self.mesh.length(face.half_edge(k)));
            let from = least - edges.into_iter().fold(0.0, f64::max);
            (from, in_face[face.index()])
        });
        let of_vertices = self.distances.iter().copied().zip(own.iter().copied());
        let mut losses: Vec<(f64, f64)> = of_faces.chain(of_vertices).collect();
        losses.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut order: Vec<f64> = self.distances.to_vec();
        order.retain(|d| d.is_finite() && *d > 0.0);
        order.sort_by(f64::total_cmp);
        let generous = 1.0 + losses.len() as f64 * f64::EPSILON;
        let mut losses = losses.into_iter().peekable();
        let (mut relative, mut lost) = (0.0_f64, 0.0);
        for d in order {
            while let Some((_, loss)) = losses.next_if(|(from, _)| *from <= d + 2.0 * total) {
                lost += loss;
            }
            relative = relative.max(lost * generous / d);
        }
        relative.next_up()
    }
}
