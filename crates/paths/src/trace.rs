//! From a vertex back to its source.

use geobench_mesh::{FaceId, HalfEdgeId, Mesh, VertexId};
use geobench_window::{Goal, Origin, Origins, SolveError, Solver, Sources};

use crate::path::{Path, Place, Point};

/// How far beside the straight line to an image a vertex may lie that the path passes, as a
/// fraction of the length of the line: more than unfolding moves the image.
const BESIDE: f64 = 1e-11;

/// By how much a path may differ from its distance, relatively.
const TOLERANCE: f64 = 5e-13;

/// The same at first, as much as rounding moves a distance: a vertex beside the line that makes the
/// path longer is passed only where no other one continues it.
const ROUNDING: f64 = 3e-14;

/// The height of a face over an edge, in lengths of that, below which unfolding it moves vertices too
/// far.
const THIN: f64 = 1e-7;

/// Why a path was lost.
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
    /// The line to the image ends in a face, and no vertex is near.
    #[error(
        "the path to vertex {target} ends in face {face}, where no vertex continues it; please report the mesh"
    )]
    Lost {
        /// The target.
        target: VertexId,
        /// Where it ends.
        face: FaceId,
    },
    /// The path crosses more edges than the mesh has faces, or passes more vertices than it has.
    #[error(
        "the path to vertex {target} crosses more edges than there are faces; please report the mesh"
    )]
    Endless {
        /// The target.
        target: VertexId,
    },
}

/// Why there is no path to hand out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// The run did not start.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The path was lost.
    #[error(transparent)]
    Trace(#[from] TraceError),
}

/// The shortest paths to the vertices of a mesh from the nearest of the sources of a run; see the
/// [example](crate).
#[derive(Clone, Debug)]
pub struct Paths {
    mesh: Mesh,
    distances: Vec<f64>,
    origins: Origins,
    /// All half-edges as paths cross them, if many paths are to be traced.
    steps: Vec<Step>,
}

/// A half-edge across which a path enters a face. What it needs is in one place, since paths go
/// through memory at random.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// The apex in the frame of the half-edge, in lengths of that.
    apex: [f64; 2],
    tail: VertexId,
    twin: Option<HalfEdgeId>,
}

impl Step {
    fn new(mesh: &Mesh, h: HalfEdgeId, apex: [f64; 2]) -> Self {
        let l = mesh.length(h);
        Self {
            apex: apex.map(|x| x / l),
            tail: mesh.tail(h),
            twin: mesh.twin(h),
        }
    }
}

/// For more targets than one in so many half-edges, the shapes of all faces are computed at once.
const FEW: usize = 64;

impl Paths {
    /// Has `solver`, set up for `mesh`, find what `goal` asks for, and how paths come there.
    ///
    /// # Errors
    ///
    /// When a source or a target does not exist, there is no source, or the solver cannot trace.
    pub fn find(
        solver: &mut (impl Solver + ?Sized),
        mesh: &Mesh,
        sources: impl Sources,
        goal: &Goal,
    ) -> Result<Self, SolveError> {
        let (solution, origins) = solver.trace(&sources.into_vertices(), goal)?;
        let few = mesh.half_edge_count() / FEW;
        let steps = |f: FaceId| {
            let apexes = mesh.apexes(f).into_iter();
            apexes
                .zip(0..)
                .map(move |(apex, k)| Step::new(mesh, f.half_edge(k), apex))
        };
        let steps = match goal.vertices() {
            Some(targets) if targets.len() <= few => Vec::new(),
            _ => mesh.faces().flat_map(steps).collect(),
        };
        Ok(Self {
            steps,
            mesh: mesh.clone(),
            distances: solution.distances,
            origins,
        })
    }

    /// The distances of all vertices; infinite where there is no path or none was asked for.
    pub fn distances(&self) -> &[f64] {
        &self.distances
    }

    /// The shortest path to `target`; `None` if none leads there, or none was asked for. O(faces
    /// crossed).
    ///
    /// # Errors
    ///
    /// When `target` does not exist, or the path is lost, which is a defect of this program.
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
            // A shortest path is in each face once, so it crosses fewer edges than there are faces.
            // Along edges it may take as many more steps as it passes vertices: an edge of faces
            // without area counts for none of them.
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
    fn step(&self, h: HalfEdgeId) -> Step {
        let known = self.steps.get(h.index());
        known
            .copied()
            .unwrap_or_else(|| Step::new(&self.mesh, h, self.mesh.apex(h)))
    }

    #[inline]
    fn tail(&self, h: HalfEdgeId) -> VertexId {
        let known = self.steps.get(h.index());
        known.map_or_else(|| self.mesh.tail(h), |step| step.tail)
    }

    /// Follows the straight line from `v`, the apex of `h`, to `image`, in the frame of `h`, up to
    /// the vertex that `image` is or to one before it. Adds the points on the way to `path` and
    /// returns that vertex.
    ///
    /// Beside slivers an image may be further off than what its distance tells. The line then
    /// comes by the vertex that is meant, and is drawn once more to where that lies.
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

    /// Follows the line from `v`, the apex of `h`, to `image` in a frame of its own, in which it is
    /// the x-axis, and into which the faces on the way are unfolded. That is all that is needed but
    /// beside slivers. Returns the vertex in which it ends, or `None` if that is in doubt.
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
        let way = sub(image, start);
        let length = norm(way);
        let beside = BESIDE * length;
        let along = way.map(|x| x / length);
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
        // The ends of the edge under way, and the vertices there.
        let mut right = (turned([0.0; 2]), self.tail(h));
        let mut left = (turned([self.mesh.length(h), 0.0]), self.tail(h.next()));
        for (at, v) in [right, left] {
            if at[1].abs() <= beside && meets(at, v) {
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
            // Beyond the image, past the vertex that it is of.
            let x = a[0] + t * (b[0] - a[0]);
            if x.is_nan() || x > length + beside {
                return None;
            }
            path.points.push(on_edge(out, [right.1, left.1], t));
            let g = self.step(out).twin?;
            let [along, across] = self.step(g).apex;
            if !(across > THIN && across < 1.0 / THIN) {
                return None;
            }
            let edge = sub(a, b);
            let apex = [
                b[0] + along * edge[0] - across * edge[1],
                b[1] + along * edge[1] + across * edge[0],
            ];
            let corner = self.tail(g.prev());
            if apex[1].abs() <= beside && meets(apex, corner) {
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

    /// The line from `v`, the apex of `h`, to `image`, which may be too long by `tolerance`.
    fn line(&self, v: VertexId, h: HalfEdgeId, image: [f64; 2], tolerance: f64) -> Line {
        let apex = self.mesh.apex(h);
        let length = norm(sub(image, apex));
        let distance = self.distances[v.index()];
        Line {
            start: [apex; 2],
            goal: image,
            here: apex,
            image,
            distance,
            sigma: distance - length,
            beside: BESIDE * length,
            tolerance,
            longest: 0.0,
            best: None,
            aim: None,
            off: f64::INFINITY,
            is_careful: false,
        }
    }

    /// Considers the vertices behind `h`, in whose frame `line` is. Where the faces there have no
    /// area, a path may bend at one that lies on `h`.
    fn consider_behind(&self, h: HalfEdgeId, line: &mut Line) {
        // Half-edges on `h`, with the abscissas where they start and end.
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
            if y <= line.beside {
                ahead.extend([(g.next(), [from, at]), (g.prev(), [at, to])]);
            }
        }
    }

    /// Goes along `line` from the apex of `h` to the vertex where it ends, or to one that it
    /// passes. If there is none, returns the face in which it ends.
    fn walk(&self, h: HalfEdgeId, line: &mut Line, path: &mut Path) -> Result<VertexId, FaceId> {
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
        // Not if it is NaN either.
        if !(s >= -line.beside && s <= l + line.beside) {
            return Err(h.face());
        }
        let s = s.clamp(0.0, l);
        line.advance([s, 0.0], path);
        path.points
            .push(on_edge(h, [mesh.tail(h), mesh.head(h)], s / l));
        // About to cross edge `out`, in whose frame everything is.
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
            let left = if square(to_image) > line.beside * line.beside {
                cross(to_image, sub(apex, line.here)) <= 0.0
            } else {
                // The image is on this edge, and is the corner of another face without area.
                line.here[0] < apex[0]
            };
            // The exit from one corner to the other one, beyond which the image lies.
            let (from, along, exit) = if left {
                ([0.0; 2], apex[0], g.prev())
            } else {
                // How far the apex is from the head along `g`, which is less than a difference of
                // two long edges if that is a needle's short side.
                let exit = g.next();
                (apex, mesh.apex(exit)[0] / l * mesh.length(exit), exit)
            };
            let size = mesh.length(exit);
            let up = if left { apex[1] } else { -apex[1] };
            let unit = [along, up].map(|x| x / size);
            let before = cross(unit, sub(line.here, from)).min(0.0);
            let behind = cross(unit, sub(line.image, from));
            if behind.is_nan() || behind < -line.beside {
                return Err(g.face());
            }
            let share = (before / (before - behind.max(0.0))).clamp(0.0, 1.0);
            // There is no way to go if it is NaN.
            let share = if share.is_nan() { 0.0 } else { share };
            line.advance([0, 1].map(|k| line.here[k] + share * to_image[k]), path);
            // Into the frame of the exit, which runs from `to` to `from`; the image is below.
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

/// The point at the fraction `t` of `h`, which runs between `ends`.
#[inline]
fn on_edge(h: HalfEdgeId, ends: [VertexId; 2], t: f64) -> Point {
    let barycentric = match h.corner() {
        0 => [1.0 - t, t, 0.0],
        1 => [0.0, 1.0 - t, t],
        _ => [t, 0.0, 1.0 - t],
    };
    Point {
        place: Place::Edge { ends, t },
        face: Some(h.face()),
        barycentric,
    }
}

/// The rest of the line to an image, in the frame of the face under way.
struct Line {
    /// Where it starts: in the frame of its first half-edge, and in that of the face under way.
    start: [[f64; 2]; 2],
    /// The image in the frame of the first half-edge.
    goal: [f64; 2],
    here: [f64; 2],
    image: [f64; 2],
    /// The distance of the vertex at which it starts, and of what the image is of.
    distance: f64,
    sigma: f64,
    /// How far beside it a vertex may be that it passes.
    beside: f64,
    /// By how much it may be too long.
    tolerance: f64,
    /// The longest edge met.
    longest: f64,
    /// The vertex through which the path would be shortest, of those that it came by.
    best: Option<Best>,
    /// Where a vertex lies, in the frame of the first half-edge, to which the line would have the
    /// right length.
    aim: Option<[f64; 2]>,
    /// The sine of the angle between the two lines, times the length of this one.
    off: f64,
    /// Whether the two are looked for.
    is_careful: bool,
}

/// A vertex to which a path can go from one of its points, across one face.
struct Best {
    vertex: VertexId,
    /// By how much the path would be too long.
    excess: f64,
    /// Its points up to there, its length up to there, and how far the vertex is.
    points: usize,
    length: f64,
    way: f64,
}

impl Line {
    /// Enters a face across an edge of length `l` with the apex beyond it: rounding moves points by
    /// parts of its size.
    fn enter(&mut self, l: f64, apex: [f64; 2]) {
        let size = l.max(norm(apex));
        if size > self.longest {
            let slack = 4.0 * f64::EPSILON * (size - self.longest);
            self.longest = size;
            self.beside += slack;
            self.tolerance += slack;
        }
    }

    /// Notes where vertex `v` lies, at `corner` of the face under way, if a straight line to it
    /// would have the right length, and is the nearest to this one.
    fn consider(&mut self, corner: [f64; 2], v: VertexId, paths: &Paths) {
        let known = paths.distances[v.index()];
        let [first, start] = self.start;
        let straight = sub(corner, start);
        let is_as_long = (norm(straight) + known - self.distance).abs() <= self.tolerance;
        if is_as_long && known < self.distance {
            // Turned back by the angle between the line here and there.
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

    /// Whether the path passes vertex `v` at `corner` of the face under way.
    fn meets(&mut self, corner: [f64; 2], v: VertexId, paths: &Paths, path: &Path) -> bool {
        let (to_corner, to_image) = (sub(corner, self.here), sub(self.image, self.here));
        let (across, rest) = (cross(to_image, to_corner), square(to_image));
        let along = to_image[0] * to_corner[0] + to_image[1] * to_corner[1];
        let beside = self.beside * self.beside;
        let is_beside =
            square(to_corner) <= beside || (across * across <= beside * rest && along >= 0.0);
        if !is_beside && !self.is_careful {
            return false;
        }
        let known = paths.distances[v.index()];
        // The vertices of a path come ever nearer to its source.
        if known >= self.distance {
            return false;
        }
        let way = norm(to_corner);
        let excess = way + known - (rest.sqrt() + self.sigma);
        if self.is_careful {
            self.consider(corner, v, paths);
            if self.best.as_ref().is_none_or(|best| excess < best.excess) {
                self.best = Some(Best {
                    vertex: v,
                    excess,
                    points: path.points.len(),
                    length: path.length,
                    way,
                });
            }
        }
        is_beside && excess.abs() <= self.tolerance
    }

    /// Ends in vertex `v` at `corner`.
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

    /// Turns to a vertex on the way from which the path is as short, if there is one.
    #[cold]
    fn turn(&self, paths: &Paths, path: &mut Path) -> Option<VertexId> {
        let best = self.best.as_ref();
        let best = best.filter(|best| best.excess <= self.tolerance)?;
        path.points.truncate(best.points);
        path.points.push(Point::at_vertex(&paths.mesh, best.vertex));
        path.length = best.length + best.way;
        Some(best.vertex)
    }

    /// Goes on to `there`. The length of a line that is not careful is added at its end.
    fn advance(&mut self, there: [f64; 2], path: &mut Path) {
        if self.is_careful {
            path.length += norm(sub(there, self.here));
        }
        self.here = there;
    }

    /// Into another frame.
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
