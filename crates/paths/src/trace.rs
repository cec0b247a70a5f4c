//! Tracing of paths from a vertex back to its source.

use std::collections::{HashMap, HashSet};
use std::slice;

use geobench_mesh::vector::{cross_2d, dot, norm, sub};
use geobench_mesh::{HalfEdgeId, Mesh, VertexId};
use geobench_window::{Goal, Origin, Origins, SolveError, Solver, Sources};

use crate::lines::{LineDirection, PLACE, StraightLine, lines_to};
use crate::path::{Path, Point};
use crate::turn::{BEND, SideTurn};

/// Greatest angle between the straight line to an image and a vertex that the path passes. It
/// exceeds the error that unfolding adds to an image in faces of about one size.
const LINE_SLACK: f64 = 1e-12;

/// Greatest difference between the length of a path and its distance, relative to the distance of
/// the target.
const TOLERANCE: f64 = 5e-13;

/// Greatest part of [`TOLERANCE`] that a straight piece may take, if it is one that the solver
/// recorded: the rounding error of a distance.
const ROUNDING: f64 = 3e-14;

/// Factors of [`BEND`] with which a search is repeated, if rounding hides the vertices at which the
/// path is straight.
const MORE: [f64; 4] = [1.0, 1e3, 1e6, f64::INFINITY];

/// Length of a straight piece, or of its way across a face, as a fraction of the distance of the
/// target, up to which a path is checked for faces that it crosses twice.
const WANDERING: f64 = 1e-10;

/// Greatest number of straight pieces that a search tries for each factor but the last. Each is
/// followed once, but tried behind each piece that ends where it begins: beside the tip of a graded
/// cone, with four or five pieces to each of some hundred vertices, 2,200 times.
const MOST_TRIES: usize = 20_000;

/// Greatest number of vertices whose straight pieces are found for these tries. It takes most of
/// the time.
const MOST_SEARCHED: usize = 2_000;

/// Least height of a face over an edge, in units of the length of the edge, that the fast path
/// [`glide`](Paths::glide) accepts; the greatest is its inverse. Unfolding a thinner face moves
/// vertices too far.
const THIN: f64 = 1e-7;

/// Least length of an edge, as a fraction of the line up to it, that [`glide`](Paths::glide)
/// accepts. The ends of the edge err by ε of the line, so the faces beyond are turned by ε over
/// this fraction, 1e-11.
const SHORT: f64 = 1e-5;

/// Why a path cannot be traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// The vertex does not exist.
    #[error(
        "target vertex {vertex} does not exist: the mesh has {vertices} vertices, numbered from 0"
    )]
    NoSuchVertex {
        /// The vertex asked for.
        vertex: VertexId,
        /// Number of vertices of the mesh.
        vertices: usize,
    },
    /// The number of distances differs from the number of vertices.
    #[error("{distances} distances for {vertices} vertices; give one for each")]
    DistanceCount {
        /// Number of distances.
        distances: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A distance is negative or not a number.
    #[error("the distance of vertex {0} is negative or not a number")]
    NoDistance(VertexId),
    /// No straight line continues the path. This is a defect of the program.
    #[error("no straight line continues the path to vertex {target}; please report the mesh")]
    Lost {
        /// The vertex to which the path leads.
        target: VertexId,
    },
}

/// Why there is no path to return.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// The solver failed.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The path cannot be traced.
    #[error(transparent)]
    Trace(#[from] TraceError),
}

/// The shortest paths from the sources of a run to the vertices of its mesh, each from the nearest
/// source. See the [example](crate).
#[derive(Clone, Debug)]
pub struct Paths {
    mesh: Mesh,
    distances: Vec<f64>,
    origins: Origins,
    /// The record of every half-edge; empty if few paths are expected.
    entries: Vec<FaceEntry>,
}

/// The data of a half-edge that a path needs to enter its face. They form one record, because paths
/// access memory in random order.
#[derive(Clone, Copy, Debug)]
struct FaceEntry {
    /// The apex in the frame of the half-edge, in units of its length.
    apex: [f64; 2],
    tail: VertexId,
    twin: Option<HalfEdgeId>,
}

impl FaceEntry {
    fn new(mesh: &Mesh, h: HalfEdgeId, apex: [f64; 2]) -> Self {
        let l = mesh.length(h);
        Self {
            apex: apex.map(|x| x / l),
            tail: mesh.tail(h),
            twin: mesh.twin(h),
        }
    }
}

/// The records of all half-edges are computed in advance if there is more than one target for this
/// many half-edges.
const HALF_EDGES_PER_TARGET: usize = 64;

impl Paths {
    /// Runs `solver`, which is set up for `mesh`, until `goal` is reached, and records the origins
    /// of the shortest paths. `sources` are vertices of `mesh`, at least one.
    ///
    /// Takes the time of the run, and O(faces) more for a goal of many vertices.
    ///
    /// # Errors
    ///
    /// As [`Solver::trace`]: if a source or a target does not exist, if there is no source, or if
    /// the solver does not record origins.
    pub fn find(
        solver: &mut (impl Solver + ?Sized),
        mesh: &Mesh,
        sources: impl Sources,
        goal: &Goal,
    ) -> Result<Self, SolveError> {
        let (solution, origins) = solver.trace(&sources.into_vertices(), goal)?;
        let few = mesh.half_edge_count() / HALF_EDGES_PER_TARGET;
        let mut entries = Vec::new();
        if goal.vertices().is_none_or(|targets| targets.len() > few) {
            entries.reserve_exact(mesh.half_edge_count());
            for f in mesh.faces() {
                let apexes = mesh.apexes(f).into_iter().zip(0..);
                entries.extend(apexes.map(|(apex, k)| FaceEntry::new(mesh, f.half_edge(k), apex)));
            }
        }
        Ok(Self {
            entries,
            mesh: mesh.clone(),
            distances: solution.distances,
            origins,
        })
    }

    /// The shortest paths of a field with these exact `distances` of all vertices of `mesh`,
    /// without the origins that a solver records: every path is found by a search from its end,
    /// which takes longer. O(vertices), without the paths.
    ///
    /// # Errors
    ///
    /// [`TraceError::DistanceCount`] or [`TraceError::NoDistance`] if they cannot be distances.
    pub fn of_distances(mesh: &Mesh, distances: Vec<f64>) -> Result<Self, TraceError> {
        let vertices = mesh.vertex_count();
        if distances.len() != vertices {
            let distances = distances.len();
            return Err(TraceError::DistanceCount {
                distances,
                vertices,
            });
        }
        // A search for a path to a distance that is not a number would never end.
        if let Some(v) = distances.iter().position(|d| d.is_nan() || *d < 0.0) {
            return Err(TraceError::NoDistance(VertexId::new(v as u32)));
        }
        Ok(Self {
            mesh: mesh.clone(),
            origins: Origins::none(vertices),
            distances,
            entries: Vec::new(),
        })
    }

    /// For each vertex the source of its shortest path; `None` if no path leads there. The source
    /// of a source is itself. O(faces crossed by the last lines of all paths).
    pub fn roots(&self) -> Vec<Option<VertexId>> {
        self.along_lines(|v| v, |&root, _| root)
    }

    /// A value for each vertex with a path: `first` for those without a last line, the sources, and
    /// `next` of the value of the vertex from which the last line leads, and of this line, for
    /// others.
    pub(crate) fn along_lines<T: Clone>(
        &self,
        first: impl Fn(VertexId) -> T,
        next: impl Fn(&T, &Path) -> T,
    ) -> Vec<Option<T>> {
        let mut order: Vec<VertexId> = self.mesh.vertices().collect();
        order.retain(|v| self.distances[v.index()].is_finite());
        let distance = |v: &VertexId| self.distances[v.index()];
        order.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        let mut values: Vec<Option<T>> = vec![None; self.distances.len()];
        // A line may lead from a vertex at the same distance, up to rounding.
        let mut waiting = Vec::new();
        for v in order {
            waiting.push(v);
            while let Some(&last) = waiting.last() {
                if values[last.index()].is_some() {
                    waiting.pop();
                    continue;
                }
                let line = self.last_line(last);
                let from = line.and_then(|line| {
                    let from = line.vertices().next()?;
                    Some((from, line))
                });
                let from = from.filter(|(from, _)| *from != last && !waiting.contains(from));
                let value = match from {
                    None => first(last),
                    Some((from, line)) => {
                        let Some(value) = &values[from.index()] else {
                            waiting.push(from);
                            continue;
                        };
                        next(value, &line)
                    }
                };
                values[last.index()] = Some(value);
            }
        }
        self.mesh.fill_copies(&mut values);
        values
    }

    /// The distances of all vertices, in the order of the mesh. A distance is infinite if no path
    /// leads to the vertex or the goal of the run did not ask for it.
    pub fn distances(&self) -> &[f64] {
        &self.distances
    }

    /// The shortest path to `target`; `None` if its distance is infinite. O(faces crossed).
    ///
    /// # Errors
    ///
    /// [`TraceError::NoSuchVertex`] if `target` does not exist. All other errors are defects of the
    /// program.
    pub fn to(&self, target: VertexId) -> Result<Option<Path>, TraceError> {
        let target = self.mesh.kept_vertex(target);
        let Some(&distance) = self.distances.get(target.index()) else {
            return Err(TraceError::NoSuchVertex {
                vertex: target,
                vertices: self.distances.len(),
            });
        };
        if distance.is_infinite() {
            return Ok(None);
        }
        let recorded = self.by_records(target);
        let lines = match recorded {
            Some(lines) if self.origins.are_along_edges() || self.is_shortest(&lines, target) => {
                Some(lines)
            }
            recorded => {
                let found = self.by_search(target);
                // Of an approximate algorithm, the path that it recorded may be as long as its
                // distance, and a shorter one be straight.
                let is_as_long = |lines: &Vec<StraightLine>| self.is_as_long(lines, target);
                let better = found.as_ref().is_some_and(is_as_long)
                    || !recorded.as_ref().is_some_and(is_as_long);
                if better { found.or(recorded) } else { recorded }
            }
        };
        let path = lines.map(|lines| self.path_of(target, &lines));
        path.map(Some).ok_or(TraceError::Lost { target })
    }

    /// The last straight line of a path to `target`, from the vertex where it begins: the one that
    /// the solver recorded, or one that a search finds if that leads nowhere. Unlike
    /// [`to`](Self::to), it is not verified. `None` for sources and where no path leads. O(faces
    /// crossed).
    ///
    /// # Panics
    ///
    /// If `target` does not exist.
    pub fn last_line(&self, target: VertexId) -> Option<Path> {
        let target = self.mesh.kept_vertex(target);
        let origin = self.origins.of(&self.mesh, target);
        let line = match (&origin, self.distances[target.index()]) {
            (Origin::None, _) => None,
            (_, distance) => self.recorded_line(target, target, &origin).or_else(|| {
                let slack = TOLERANCE * distance + PLACE * self.mesh.longest_edge();
                let lines = lines_to(&self.mesh, &self.distances, target, slack).into_iter();
                let lines = lines.filter(|line| self.distances[line.from.index()] < distance);
                lines.min_by(|a, b| a.excess.total_cmp(&b.excess))
            }),
        };
        Some(self.path_of(target, &[line?]))
    }

    /// The line to `v` on the path to `target` that the solver recorded as `origin`.
    fn recorded_line(
        &self,
        target: VertexId,
        v: VertexId,
        origin: &Origin,
    ) -> Option<StraightLine> {
        match *origin {
            Origin::None => None,
            Origin::Vertex(from) => {
                StraightLine::along_edge(&self.mesh, &self.distances, [v, from])
            }
            Origin::Window { h, image } => self.glide(target, v, h, image),
        }
    }

    /// The lines of the path to `target` that the solver recorded, from the target on; `None` if
    /// one of them leads nowhere.
    fn by_records(&self, target: VertexId) -> Option<Vec<StraightLine>> {
        let mut lines = Vec::new();
        let mut v = target;
        for _ in 0..self.distances.len() {
            let origin = self.origins.of(&self.mesh, v);
            if matches!(origin, Origin::None) {
                return Some(lines);
            }
            let line = self.recorded_line(target, v, &origin)?;
            v = line.from;
            lines.push(line);
        }
        None
    }

    /// Whether the path to `target` along `lines` is as long as its distance.
    fn is_as_long(&self, lines: &[StraightLine], target: VertexId) -> bool {
        let distance = self.distances[target.index()];
        let length: f64 = lines.iter().map(|line| line.length).sum();
        let points = lines.iter().map(|line| line.crossings.len() + 1);
        let rounding = PLACE * self.mesh.longest_edge() * points.sum::<usize>() as f64;
        (length - distance).abs() <= TOLERANCE * distance + rounding
    }

    /// Whether the path to `target` along `lines` is as long as its distance, straight at the
    /// vertices that it passes, and crosses no face twice.
    fn is_shortest(&self, lines: &[StraightLine], target: VertexId) -> bool {
        // Only among vertices at almost one distance, a path may wander about at no length.
        let short = WANDERING * self.distances[target.index()];
        self.is_as_long(lines, target)
            && (lines.iter().all(|line| line.length > short) || crosses_once(lines))
            && lines
                .windows(2)
                .all(|pair| self.is_straight(&pair[0], &pair[1], BEND))
    }

    /// Whether a path is straight at the vertex from which line `there` comes and where line `back`
    /// ends, up to `bend`: no shortcut exists on either side.
    fn is_straight(&self, there: &StraightLine, back: &StraightLine, bend: f64) -> bool {
        let ends = [there.directions[1], back.directions[0]];
        let turn = SideTurn::least(&self.mesh, there.from, ends);
        let lengths = [there.length, back.length];
        turn.is_straight(&self.mesh, there.from, lengths, bend)
    }

    /// The path along `lines`, which lead from `target` to a source.
    fn path_of(&self, target: VertexId, lines: &[StraightLine]) -> Path {
        let count = lines
            .iter()
            .map(|line| line.crossings.len() + 1)
            .sum::<usize>();
        let mut path = Path {
            length: 0.0,
            points: Vec::with_capacity(count + 1),
        };
        path.points.push(Point::at_vertex(&self.mesh, target));
        for line in lines {
            path.length += line.length;
            path.points.extend(&line.crossings);
            path.points.push(Point::at_vertex(&self.mesh, line.from));
        }
        path.points.reverse();
        path
    }

    /// The lines of a shortest path to `target`, found by a [search](lines_to) whatever the solver
    /// has recorded. Of several lines to a vertex, which differ by rounding alone, those are taken
    /// at which the path is straight.
    #[cold]
    fn by_search(&self, target: VertexId) -> Option<Vec<StraightLine>> {
        let mut known = HashMap::new();
        MORE.iter()
            .find_map(|factor| self.walk(target, factor * BEND, &mut known))
    }

    /// Follows lines back from `target`, depth first, to a source. Each line is taken once. `bend`
    /// is the greatest [bend](BEND) on the wrong side; if it is infinite, the length does not
    /// matter either. The lines to each vertex are added to `known`.
    fn walk(
        &self,
        target: VertexId,
        bend: f64,
        known: &mut HashMap<VertexId, Vec<StraightLine>>,
    ) -> Option<Vec<StraightLine>> {
        let rounding = PLACE * self.mesh.longest_edge();
        let most = TOLERANCE * self.distances[target.index()] + rounding;
        let mut passed = vec![Passed::new(target, 0.0)];
        let mut taken = HashSet::new();
        let mut crossed = HashSet::new();
        let mut tries = 0;
        while let Some(&Passed { v, next, excess }) = passed.last() {
            if self.distances[v.index()] == 0.0 {
                passed.pop();
                let lines = passed.iter().map(|p| known[&p.v][p.next - 1].clone());
                return Some(lines.collect());
            }
            known
                .entry(v)
                .or_insert_with(|| lines_to(&self.mesh, &self.distances, v, most));
            let Some(line) = known[&v].get(next) else {
                passed.pop();
                if let Some(before) = passed.last() {
                    for face in known[&before.v][before.next - 1].faces() {
                        crossed.remove(&face);
                    }
                }
                continue;
            };
            let last = passed.len() - 1;
            passed[last].next += 1;
            if passed.iter().any(|p| p.v == line.from) {
                continue;
            }
            let excess = excess + line.excess;
            if bend.is_finite() {
                tries += 1;
                if tries > MOST_TRIES || known.len() > MOST_SEARCHED {
                    return None;
                }
                let before = last.checked_sub(1).map(|i| passed[i]);
                let before = before.map(|p| &known[&p.v][p.next - 1]);
                let is_straight = before.is_none_or(|there| self.is_straight(there, line, bend));
                let crosses_twice = line.faces().any(|face| crossed.contains(&face));
                if excess > most || crosses_twice || !is_straight {
                    continue;
                }
            }
            if taken.insert((v, next)) {
                crossed.extend(line.faces());
                passed.push(Passed::new(line.from, excess));
            }
        }
        None
    }

    #[inline]
    fn entry(&self, h: HalfEdgeId) -> FaceEntry {
        let known = self.entries.get(h.index());
        known
            .copied()
            .unwrap_or_else(|| FaceEntry::new(&self.mesh, h, self.mesh.apex(h)))
    }

    #[inline]
    fn tail(&self, h: HalfEdgeId) -> VertexId {
        let known = self.entries.get(h.index());
        known.map_or_else(|| self.mesh.tail(h), |entry| entry.tail)
    }

    /// Follows the line from `v`, the apex of `h`, to `image` in one frame, whose x-axis is the
    /// line. The faces on the way are unfolded into this frame. The line ends at the first vertex
    /// that it meets. `None` if it meets none, or the search must decide: beside slivers, the error
    /// of an image may exceed that of its distance.
    #[inline]
    fn glide(
        &self,
        target: VertexId,
        v: VertexId,
        h: HalfEdgeId,
        image: [f64; 2],
    ) -> Option<StraightLine> {
        let distance = self.distances[v.index()];
        let start = self.mesh.apex(h);
        let to_image = sub(image, start);
        let length = norm(to_image);
        let along = to_image.map(|x| x / length);
        let turned = |p: [f64; 2]| {
            let [x, y] = sub(p, start);
            [along[0] * x + along[1] * y, along[0] * y - along[1] * x]
        };
        let excess = |at: [f64; 2], v: VertexId| norm(at) + self.distances[v.index()] - distance;
        let meets = |at: [f64; 2], v: VertexId| {
            at[1].abs() <= LINE_SLACK * at[0]
                && self.distances[v.index()] < distance
                && excess(at, v).abs() <= ROUNDING * self.distances[target.index()]
        };
        // The right and the left end of the current edge: position and vertex.
        let mut right = (turned([0.0; 2]), self.tail(h));
        let mut left = (turned([self.mesh.length(h), 0.0]), self.tail(h.next()));
        for (at, from) in [right, left] {
            if meets(at, from) {
                return StraightLine::along_edge(&self.mesh, &self.distances, [v, from]);
            }
        }
        if !(right.0[1] < 0.0 && left.0[1] > 0.0) {
            return None;
        }
        let at_end = LineDirection::new(h.prev(), right.0, [1.0, 0.0]);
        let mut crossings = Vec::new();
        // Around a tip smaller than the rounding of distances, a line may wind at no length.
        let short = WANDERING * self.distances[target.index()];
        let (mut wanders, mut reached) = (false, 0.0);
        let mut out = h;
        for _ in 0..self.mesh.face_count() {
            let (a, b) = (right.0, left.0);
            let t = a[1] / (a[1] - b[1]);
            // The abscissa of the crossing. Beyond the image, the line has missed the vertex of the
            // image.
            let x = a[0] + t * (b[0] - a[0]);
            if x.is_nan() || x > (1.0 + LINE_SLACK) * length {
                return None;
            }
            crossings.push(Point::on_edge(out, [right.1, left.1], t));
            wanders |= x - reached <= short;
            reached = x;
            let g = self.entry(out).twin?;
            let [along, across] = self.entry(g).apex;
            if !(across > THIN && across < 1.0 / THIN) {
                return None;
            }
            let edge = sub(a, b);
            if norm(edge) < SHORT * x {
                return None;
            }
            let apex = [
                b[0] + along * edge[0] - across * edge[1],
                b[1] + along * edge[1] + across * edge[0],
            ];
            let from = self.tail(g.prev());
            if meets(apex, from) {
                let back = apex.map(|x| -x);
                let to = [dot(edge, back), cross_2d(edge, back)];
                let at_from = LineDirection::new(g.prev(), [-along, -across], to);
                let line = StraightLine {
                    from,
                    length: norm(apex),
                    excess: excess(apex, from),
                    directions: [at_end, at_from],
                    crossings,
                };
                return (!wanders || crosses_once(slice::from_ref(&line))).then_some(line);
            }
            if apex[1] > 0.0 {
                left = (apex, from);
                out = g.next();
            } else if apex[1] < 0.0 {
                right = (apex, from);
                out = g.prev();
            } else {
                return None;
            }
        }
        None
    }
}

/// Whether no face is crossed twice.
fn crosses_once(lines: &[StraightLine]) -> bool {
    let mut crossed = HashSet::new();
    let mut faces = lines.iter().flat_map(StraightLine::faces);
    faces.all(|face| crossed.insert(face))
}

/// A vertex that a path passes, during a search.
#[derive(Clone, Copy)]
struct Passed {
    v: VertexId,
    /// The number of the line to `v` that is tried next.
    next: usize,
    /// By how much the path from here to the target exceeds the distance.
    excess: f64,
}

impl Passed {
    const fn new(v: VertexId, excess: f64) -> Self {
        Self { v, next: 0, excess }
    }
}
