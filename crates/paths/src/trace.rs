//! Tracing of paths from a vertex back to its source.

use geobench_mesh::{FaceId, HalfEdgeId, Mesh, VertexId};
use geobench_window::{Goal, Origin, Origins, SolveError, Solver, Sources};

use crate::path::{Path, PathPlace, Point};

/// Greatest distance of a vertex from the straight line to an image at which the path may pass
/// through the vertex, as a fraction of the length of the line. It exceeds the error that unfolding
/// adds to the image.
const LINE_SLACK: f64 = 1e-11;

/// Greatest difference between the length of a path and its distance, relative to the distance of
/// the target.
const TOLERANCE: f64 = 5e-13;

/// The tolerance of the first attempts, in place of [`TOLERANCE`]: the rounding error of a
/// distance. A vertex beside the line that makes the path longer than this is passed only if no
/// other vertex continues the path.
const ROUNDING: f64 = 3e-14;

/// Least height of a face over an edge, in units of the length of the edge, that the fast path
/// [`glide`](Paths::glide) accepts; the greatest is its inverse. Unfolding a thinner face moves
/// vertices too far.
const THIN: f64 = 1e-7;

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
    /// The line to the image ends in a face, and no vertex near it continues the path. This is a
    /// defect of the program.
    #[error(
        "the path to vertex {target} ends in face {face}, where no vertex continues it; please report the mesh"
    )]
    Lost {
        /// The vertex to which the path leads.
        target: VertexId,
        /// The face in which the line ends.
        face: FaceId,
    },
    /// The path crosses more edges than the mesh has faces, or passes more vertices than the mesh
    /// has. This is a defect of the program.
    #[error(
        "the path to vertex {target} crosses more edges than there are faces; please report the mesh"
    )]
    Endless {
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
    /// of the shortest paths.
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
        let Some(&distance) = self.distances.get(target.index()) else {
            return Err(TraceError::NoSuchVertex {
                vertex: target,
                vertices: self.distances.len(),
            });
        };
        if distance.is_infinite() {
            return Ok(None);
        }
        let mut path = Path {
            length: 0.0,
            points: vec![Point::at_vertex(&self.mesh, target)],
        };
        let mut v = target;
        for passed in 1..=self.distances.len() {
            // A shortest path enters each face at most once, so it crosses fewer edges than there
            // are faces. A step along an edge adds a point and enters no face, if the faces of the
            // edge have no area. There is at most one such step for each vertex passed.
            if path.points.len() > self.mesh.face_count() + passed {
                return Err(TraceError::Endless { target });
            }
            v = match self.origins.of(&self.mesh, v) {
                Origin::None => {
                    path.points.reverse();
                    return Ok(Some(path));
                }
                Origin::Vertex(from) => {
                    let edges = self.mesh.neighbours(v).filter(|&(u, _)| u == from);
                    path.length += edges.map(|(_, l)| l).fold(f64::INFINITY, f64::min);
                    path.points.push(Point::at_vertex(&self.mesh, from));
                    from
                }
                Origin::Window { h, image } => self.follow(target, v, h, image, &mut path)?,
            };
        }
        Err(TraceError::Endless { target })
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

    /// Follows the straight line from `v`, the apex of `h`, to `image`, in the frame of `h`. The
    /// line ends at the vertex of which `image` is the image, or at a vertex before it. Appends the
    /// points on the way to `path` and returns that vertex.
    ///
    /// Beside slivers, the error of an image may exceed the error of its distance. The line then
    /// misses its vertex. So the attempts are, in this order: [`glide`](Self::glide), a plain
    /// [walk](Self::walk), a careful walk that notes the vertices it comes near, and a careful walk
    /// that aims at a vertex noted. The walks are repeated with a greater tolerance if they all
    /// fail.
    fn follow(
        &self,
        target: VertexId,
        v: VertexId,
        h: HalfEdgeId,
        image: [f64; 2],
        path: &mut Path,
    ) -> Result<VertexId, TraceError> {
        let (points, length) = (path.points.len(), path.length);
        if let Some(found) = self.glide(target, v, h, image, path) {
            return Ok(found);
        }
        let mut lost = h.face();
        for tolerance in [ROUNDING, TOLERANCE] {
            let tolerance = tolerance * self.distances[target.index()];
            let mut aim = image;
            for is_careful in [false, true, true] {
                path.points.truncate(points);
                path.length = length;
                let mut line = self.line(v, h, aim, tolerance);
                line.is_careful = is_careful;
                match self.walk(h, &mut line, path) {
                    Ok(found) => return Ok(found),
                    Err(face) => lost = face,
                }
                if let Some(found) = line.turn(self, path) {
                    return Ok(found);
                }
                match line.aim {
                    Some(nearer) => aim = nearer,
                    None if is_careful => break,
                    None => {}
                }
            }
        }
        Err(TraceError::Lost { target, face: lost })
    }

    /// Follows the line from `v`, the apex of `h`, to `image` in one frame, whose x-axis is the
    /// line. The faces on the way are unfolded into this frame. This fast path suffices except
    /// beside slivers. Returns the vertex at which the line ends; `None` if that is in doubt.
    #[inline]
    fn glide(
        &self,
        target: VertexId,
        v: VertexId,
        h: HalfEdgeId,
        image: [f64; 2],
        path: &mut Path,
    ) -> Option<VertexId> {
        let distance = self.distances[v.index()];
        let start = self.mesh.apex(h);
        let to_image = sub(image, start);
        let length = norm(to_image);
        let slack = LINE_SLACK * length;
        let along = to_image.map(|x| x / length);
        let turned = |p: [f64; 2]| {
            let [x, y] = sub(p, start);
            [along[0] * x + along[1] * y, along[0] * y - along[1] * x]
        };
        let meets = |at: [f64; 2], v: VertexId| {
            let known = self.distances[v.index()];
            let excess = norm(at) + known - distance;
            known < distance
                && at[0] >= 0.0
                && excess.abs() <= ROUNDING * self.distances[target.index()]
        };
        // The right and the left end of the current edge: position and vertex.
        let mut right = (turned([0.0; 2]), self.tail(h));
        let mut left = (turned([self.mesh.length(h), 0.0]), self.tail(h.next()));
        for (at, v) in [right, left] {
            if at[1].abs() <= slack && meets(at, v) {
                path.length += norm(at);
                path.points.push(Point::at_vertex(&self.mesh, v));
                return Some(v);
            }
        }
        if !(right.0[1] < 0.0 && left.0[1] > 0.0) {
            return None;
        }
        let mut out = h;
        for _ in 0..self.mesh.face_count() {
            let (a, b) = (right.0, left.0);
            let t = a[1] / (a[1] - b[1]);
            // The abscissa of the crossing. Beyond the image, the line has missed the vertex of the
            // image.
            let x = a[0] + t * (b[0] - a[0]);
            if x.is_nan() || x > length + slack {
                return None;
            }
            path.points.push(on_edge(out, [right.1, left.1], t));
            let g = self.entry(out).twin?;
            let [along, across] = self.entry(g).apex;
            if !(across > THIN && across < 1.0 / THIN) {
                return None;
            }
            let edge = sub(a, b);
            let apex = [
                b[0] + along * edge[0] - across * edge[1],
                b[1] + along * edge[1] + across * edge[0],
            ];
            let corner = self.tail(g.prev());
            if apex[1].abs() <= slack && meets(apex, corner) {
                path.length += norm(apex);
                path.points.push(Point::at_vertex(&self.mesh, corner));
                return Some(corner);
            }
            if apex[1] > 0.0 {
                left = (apex, corner);
                out = g.next();
            } else if apex[1] < 0.0 {
                right = (apex, corner);
                out = g.prev();
            } else {
                return None;
            }
        }
        None
    }

    /// The line from `v`, the apex of `h`, to `image`, for a path that may be too long by
    /// `tolerance`.
    fn line(&self, v: VertexId, h: HalfEdgeId, image: [f64; 2], tolerance: f64) -> ImageRay {
        let apex = self.mesh.apex(h);
        let length = norm(sub(image, apex));
        let distance = self.distances[v.index()];
        ImageRay {
            start: [apex; 2],
            goal: image,
            here: apex,
            image,
            distance,
            sigma: distance - length,
            slack: LINE_SLACK * length,
            tolerance,
            longest: 0.0,
            best: None,
            aim: None,
            off: f64::INFINITY,
            is_careful: false,
        }
    }

    /// Considers the vertices of the faces beyond `h`; `line` is in the frame of `h`. If these
    /// faces have no area, a vertex at which the path bends may lie on `h`.
    fn consider_behind(&self, h: HalfEdgeId, line: &mut ImageRay) {
        // Half-edges that lie on `h`, each with the abscissas of its tail and head.
        let mut ahead = vec![(h, [0.0, self.mesh.length(h)])];
        for _ in 0..self.mesh.face_count() {
            let Some((e, [from, to])) = ahead.pop() else {
                return;
            };
            let Some(g) = self.mesh.twin(e) else {
                continue;
            };
            let [x, y] = self.mesh.apex(g);
            let at = to + (from - to) * (x / self.mesh.length(g));
            line.consider([at, -y], self.mesh.apex_vertex(g), self);
            if y <= line.slack {
                ahead.extend([(g.next(), [from, at]), (g.prev(), [at, to])]);
            }
        }
    }

    /// Follows `line` from the apex of `h` to the vertex at which it ends, or to the first vertex
    /// that it passes. If there is no such vertex, returns the face in which the line ends.
    fn walk(
        &self,
        h: HalfEdgeId,
        line: &mut ImageRay,
        path: &mut Path,
    ) -> Result<VertexId, FaceId> {
        let mesh = &self.mesh;
        let (apex, l) = (mesh.apex(h), mesh.length(h));
        line.enter(l, apex);
        let ends = [([0.0; 2], mesh.tail(h)), ([l, 0.0], mesh.head(h))];
        for (corner, end) in ends {
            if line.meets(corner, end, self, path) {
                return Ok(line.go(corner, end, self, path));
            }
        }
        let [px, py] = line.image;
        let s = apex[0] + (px - apex[0]) * (apex[1] / (apex[1] - py));
        if line.is_careful {
            self.consider_behind(h, line);
        }
        // The negation also catches NaN.
        if !(s >= -line.slack && s <= l + line.slack) {
            return Err(h.face());
        }
        let s = s.clamp(0.0, l);
        line.advance([s, 0.0], path);
        path.points
            .push(on_edge(h, [mesh.tail(h), mesh.head(h)], s / l));
        // The half-edge to be crossed next. `line` is in its frame.
        let mut out = h;
        for _ in 0..mesh.face_count() {
            let Some(g) = mesh.twin(out) else {
                return Err(out.face());
            };
            let (apex, l) = (mesh.apex(g), mesh.length(g));
            line.transform(|[x, y]| [l - x, -y]);
            line.enter(l, apex);
            let corner = mesh.apex_vertex(g);
            if line.meets(apex, corner, self, path) {
                return Ok(line.go(apex, corner, self, path));
            }
            let to_image = sub(line.image, line.here);
            let left = if square(to_image) > line.slack * line.slack {
                cross(to_image, sub(apex, line.here)) <= 0.0
            } else {
                // The image is on this edge: it is a corner of another face, which has no area.
                line.here[0] < apex[0]
            };
            // The exit, beyond which the image lies: its start, the difference in x to its end, and
            // its half-edge.
            let (from, along, exit) = if left {
                ([0.0; 2], apex[0], g.prev())
            } else {
                // The difference in x between the apex and the head of `g`. Beside the short side
                // of a needle, `l - apex[0]` would cancel: both are long.
                let exit = g.next();
                (apex, mesh.apex(exit)[0] / l * mesh.length(exit), exit)
            };
            let size = mesh.length(exit);
            let up = if left { apex[1] } else { -apex[1] };
            let unit = [along, up].map(|x| x / size);
            let before = cross(unit, sub(line.here, from)).min(0.0);
            let behind = cross(unit, sub(line.image, from));
            if behind.is_nan() || behind < -line.slack {
                return Err(g.face());
            }
            let share = (before / (before - behind.max(0.0))).clamp(0.0, 1.0);
            // NaN: the current point and the image are both on the exit.
            let share = if share.is_nan() { 0.0 } else { share };
            line.advance([0, 1].map(|k| line.here[k] + share * to_image[k]), path);
            // To the frame of the exit, whose head is `from`. The image is below the exit.
            line.transform(|p| {
                let [x, y] = sub(p, from);
                let [x, y] = [unit[0] * x + unit[1] * y, unit[0] * y - unit[1] * x];
                [size - x, -y]
            });
            line.here = [line.here[0].clamp(0.0, size), 0.0];
            let ends = [mesh.tail(exit), mesh.head(exit)];
            path.points.push(on_edge(exit, ends, line.here[0] / size));
            out = exit;
        }
        Err(out.face())
    }
}

/// The point at fraction `t` of `h`, from `ends[0]` to `ends[1]`.
#[inline]
fn on_edge(h: HalfEdgeId, ends: [VertexId; 2], t: f64) -> Point {
    let barycentric = match h.corner() {
        0 => [1.0 - t, t, 0.0],
        1 => [0.0, 1.0 - t, t],
        _ => [t, 0.0, 1.0 - t],
    };
    Point {
        place: PathPlace::Edge { ends, t },
        face: Some(h.face()),
        barycentric,
    }
}

/// A line to an image, during a walk. Coordinates are in the frame of the current face, unless
/// noted.
struct ImageRay {
    /// Its start: in the frame of its first half-edge, and in the current frame.
    start: [[f64; 2]; 2],
    /// The image, in the frame of the first half-edge.
    goal: [f64; 2],
    /// The point that the walk has reached.
    here: [f64; 2],
    /// The image, in the current frame.
    image: [f64; 2],
    /// The distances of the vertex at which the line starts and of the (pseudo-)source of the
    /// image.
    distance: f64,
    sigma: f64,
    /// Greatest distance of a vertex from the line at which the path passes the vertex.
    slack: f64,
    /// Greatest difference between the length of the path and the distance.
    tolerance: f64,
    /// The longest edge so far.
    longest: f64,
    /// Of the vertices near the line, the one through which the path is shortest.
    best: Option<Best>,
    /// The position, in the frame of the first half-edge, of a vertex to which a straight line has
    /// the right length.
    aim: Option<[f64; 2]>,
    /// The sine of the angle between this line and the line to `aim`, times the length of this one.
    off: f64,
    /// Whether `best` and `aim` are searched for.
    is_careful: bool,
}

/// A vertex that the path can reach from one of its points across one face.
struct Best {
    vertex: VertexId,
    /// By how much the path through the vertex is too long.
    excess: f64,
    /// The number of points and the length of the path before the vertex, and the distance from
    /// there to the vertex.
    points: usize,
    length: f64,
    straight: f64,
}

impl ImageRay {
    /// Enters a face across an edge of length `l`. Widens the tolerances if the face is larger than
    /// all before: the rounding errors of points are proportional to its size.
    fn enter(&mut self, l: f64, apex: [f64; 2]) {
        let size = l.max(norm(apex));
        if size > self.longest {
            let slack = 4.0 * f64::EPSILON * (size - self.longest);
            self.longest = size;
            self.slack += slack;
            self.tolerance += slack;
        }
    }

    /// Sets `aim` to the position of vertex `v`, at `corner` of the current face, if a straight
    /// line to it has the right length and the angle to this line is the least so far.
    fn consider(&mut self, corner: [f64; 2], v: VertexId, paths: &Paths) {
        let known = paths.distances[v.index()];
        let [first, start] = self.start;
        let straight = sub(corner, start);
        let is_as_long = (norm(straight) + known - self.distance).abs() <= self.tolerance;
        if is_as_long && known < self.distance {
            // Rotated into the frame of the first half-edge, by the angle between the line in both
            // frames.
            let (here, there) = (sub(self.image, start), sub(self.goal, first));
            let size = square(here);
            let off = cross(here, straight).abs() / norm(straight);
            if off >= self.off {
                return;
            }
            self.off = off;
            let turn = [
                (here[0] * there[0] + here[1] * there[1]) / size,
                cross(here, there) / size,
            ];
            self.aim = Some([
                first[0] + turn[0] * straight[0] - turn[1] * straight[1],
                first[1] + turn[1] * straight[0] + turn[0] * straight[1],
            ]);
        }
    }

    /// Whether the path passes vertex `v` at `corner` of the current face. A careful walk also
    /// considers the vertex for `best` and `aim`.
    fn meets(&mut self, corner: [f64; 2], v: VertexId, paths: &Paths, path: &Path) -> bool {
        let (to_corner, to_image) = (sub(corner, self.here), sub(self.image, self.here));
        let (across, rest) = (cross(to_image, to_corner), square(to_image));
        let along = to_image[0] * to_corner[0] + to_image[1] * to_corner[1];
        let slack = self.slack * self.slack;
        let is_beside =
            square(to_corner) <= slack || (across * across <= slack * rest && along >= 0.0);
        if !is_beside && !self.is_careful {
            return false;
        }
        let known = paths.distances[v.index()];
        // Along a path towards its source, the distances of the vertices decrease.
        if known >= self.distance {
            return false;
        }
        let straight = norm(to_corner);
        let excess = straight + known - (rest.sqrt() + self.sigma);
        if self.is_careful {
            self.consider(corner, v, paths);
            if self.best.as_ref().is_none_or(|best| excess < best.excess) {
                self.best = Some(Best {
                    vertex: v,
                    excess,
                    points: path.points.len(),
                    length: path.length,
                    straight,
                });
            }
        }
        is_beside && excess.abs() <= self.tolerance
    }

    /// Ends the line at vertex `v`, at `corner`, and returns `v`.
    fn go(&self, corner: [f64; 2], v: VertexId, paths: &Paths, path: &mut Path) -> VertexId {
        let from = if self.is_careful {
            self.here
        } else {
            self.start[1]
        };
        path.length += norm(sub(corner, from));
        path.points.push(Point::at_vertex(&paths.mesh, v));
        v
    }

    /// Redirects the path to the best vertex near it, if the path through that vertex is short
    /// enough. Returns the vertex.
    #[cold]
    fn turn(&self, paths: &Paths, path: &mut Path) -> Option<VertexId> {
        let best = self.best.as_ref();
        let best = best.filter(|best| best.excess <= self.tolerance)?;
        path.points.truncate(best.points);
        path.points.push(Point::at_vertex(&paths.mesh, best.vertex));
        path.length = best.length + best.straight;
        Some(best.vertex)
    }

    /// Moves the current point to `there`. A careful walk adds the length step by step; otherwise
    /// [`go`](Self::go) adds it at the end.
    fn advance(&mut self, there: [f64; 2], path: &mut Path) {
        if self.is_careful {
            path.length += norm(sub(there, self.here));
        }
        self.here = there;
    }

    /// Maps the line into another frame.
    fn transform(&mut self, frame: impl Fn([f64; 2]) -> [f64; 2]) {
        self.start[1] = frame(self.start[1]);
        self.here = frame(self.here);
        self.image = frame(self.image);
    }
}

fn sub(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn square([x, y]: [f64; 2]) -> f64 {
    x * x + y * y
}

fn norm(v: [f64; 2]) -> f64 {
    square(v).sqrt()
}
