//! Isolines of the exact geodesic distance on a triangle mesh.
//!
//! The distance at a point of a face is the minimum over the windows that enter the face and over
//! the vertices of the face. So an isoline consists of circular arcs around images of sources and
//! pseudo-sources. [`DistanceField`] keeps the windows of a run. [`DistanceField::isoline`] returns
//! the arcs at a distance, joined into loops and into lines between points of the boundary:
//!
//! ```
//! use geobench_isolines::DistanceField;
//! use geobench_mesh::Mesh;
//! use std::f64::consts::PI;
//!
//! // A square, and a point near its middle.
//! let mesh = Mesh::generate("grid,n=8")?;
//! let side = mesh.positions().iter().map(|p| p[0]).fold(0.0, f64::max);
//! let (middle, _) = mesh.nearest_point([0.43 * side, 0.55 * side, 0.0])?;
//! let field = DistanceField::new(&mesh, &[middle])?;
//! let isoline = field.isoline(0.3 * side);
//! let [circle] = &isoline.lines[..] else { panic!("one circle") };
//! assert!(circle.closed);
//! assert!((circle.length() - 0.6 * PI * side).abs() < 1e-12 * side);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The crossings of an edge with an isoline are computed once, from the windows of both sides, and
//! shared by both faces. So rounding errors cannot leave a loop open. Inside a face the circle of a
//! window is cut where its cone ends, where it leaves the face, and where another window or a
//! vertex gives a shorter distance.

mod arc;
mod cones;
mod crossings;
mod face;
mod query;

use std::collections::HashMap;

use geobench_mesh::{FaceId, HalfEdgeId, Mesh, PointError, Refined, SurfacePoint};
use geobench_mmp::{Carrier, Mmp, mmp_from, windows_of};
use geobench_window::queue::CalendarQueue;
use geobench_window::{SolveError, Solver, Window};

pub use arc::CircleArc;
pub use query::QueryError;

use cones::{ConeArc, FaceCones};
use crossings::crossings;
use face::Link;
use geobench_mesh::vector::{self, Point, sub};

/// A level is lowered if the distance of a vertex differs from it by at most this fraction.
const TIE: f64 = 4e-12;

/// Loops that cross at most one edge and are not longer than this fraction of their level are
/// dropped. Rounding produces them where another part of the isoline touches an edge.
const SPECK: f64 = 1e-7;

/// The maximum number of levels of [`DistanceField::levels_every`].
const MOST_LEVELS: u64 = 10_000;

/// Step between levels, as a fraction of the longest edge, that asks for too many isolines wherever
/// the farthest point is far from all vertices.
const FINE: f64 = 1e-6;

/// A step between levels asks for more isolines than a program can use.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "a step of {step} asks for {count} isolines, up to a distance of {farthest}; at most \
     {MOST_LEVELS} are made: take a step of {} or more, or name the levels",
    farthest / MOST_LEVELS as f64
)]
pub struct TooManyLevels {
    /// The step.
    pub step: f64,
    /// The number of isolines at its multiples.
    pub count: f64,
    /// The greatest distance of a vertex, or of an isoline beyond all vertices.
    pub farthest: f64,
}

/// Why a [`DistanceField`] cannot be computed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FieldError {
    /// A source is not a point of the mesh, or there are too many sources.
    #[error(transparent)]
    Point(#[from] PointError),
    /// The solver failed, for example because no source was given.
    #[error(transparent)]
    Solve(#[from] SolveError),
}

/// The exact distance from the nearest source to every point of a surface, stored as all windows of
/// an MMP run. See the [example](crate).
pub struct DistanceField {
    mesh: Mesh,
    /// The mesh with a vertex inserted at each source.
    refined: Refined,
    solver: Mmp<CalendarQueue>,
    /// The distances of all vertices of `refined`.
    distances: Vec<f64>,
    /// The finite distances, in ascending order.
    sorted: Vec<f64>,
}

/// The points of a surface at one distance from the nearest source.
///
/// ```
/// use geobench_isolines::DistanceField;
/// use geobench_mesh::{Mesh, VertexId};
///
/// let mesh = Mesh::generate("sphere,subdiv=3")?;
/// let pole = mesh.point_at_vertex(VertexId::new(0))?;
/// let isoline = DistanceField::new(&mesh, &[pole])?.isoline(0.5);
/// assert_eq!((isoline.distance, isoline.lines.len()), (0.5, 1));
/// // The circle of latitude at this distance from the pole of the unit sphere.
/// let latitude = std::f64::consts::TAU * 0.5_f64.sin();
/// assert!((isoline.length() - latitude).abs() < 0.02 * latitude);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Isoline {
    /// The requested distance. If a vertex is at this distance up to rounding, the lines are those
    /// of a distance that is smaller by about 1e-11 of it.
    pub distance: f64,
    /// The connected components: loops, and lines between points of the boundary or of
    /// [junctions](Mesh::junction), where several parts may meet.
    pub lines: Vec<Line>,
    /// The largest gap that was closed by joining the ends of arcs and the crossings of edges
    /// within a face. It measures rounding errors.
    pub gap: f64,
}

/// A connected part of an isoline.
///
/// ```
/// use geobench_isolines::DistanceField;
/// use geobench_mesh::{Mesh, VertexId};
///
/// let mesh = Mesh::generate("sphere,subdiv=3")?;
/// let pole = mesh.point_at_vertex(VertexId::new(0))?;
/// let isoline = DistanceField::new(&mesh, &[pole])?.isoline(0.5);
/// let line = &isoline.lines[0];
/// assert!(line.closed);
/// // Chords at most a thousandth from the arcs.
/// let points: Vec<[f64; 3]> = line.polyline(&mesh, 1e-3);
/// assert_eq!(points.first(), points.last());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Whether it is a loop.
    pub closed: bool,
    /// Its arcs in order. Each starts where the previous one ends. Points nearer to the source are
    /// on their left.
    pub arcs: Vec<CircleArc>,
}

impl Line {
    /// Its length, in the units of the mesh; O(arcs).
    pub fn length(&self) -> f64 {
        self.arcs.iter().map(CircleArc::length).sum()
    }

    /// Positions along the line whose chords deviate from the arcs by at most `tolerance`, within
    /// the limits of [`CircleArc::points`]. A loop ends with its first position. Empty for a mesh
    /// without positions.
    pub fn polyline(&self, mesh: &Mesh, tolerance: f64) -> Vec<[f64; 3]> {
        let mut points = Vec::new();
        for (i, arc) in self.arcs.iter().enumerate() {
            let skip = usize::from(i > 0);
            let on_arc = arc.points(tolerance).into_iter().skip(skip);
            points.extend(on_arc.filter_map(|at| arc.position(mesh, at)));
        }
        if self.closed
            && let Some(&first) = points.first()
        {
            let last = points.len() - 1;
            if last > 0 {
                points[last] = first;
            }
        }
        points
    }
}

impl Isoline {
    /// The total length of its lines, in the units of the mesh; O(arcs).
    pub fn length(&self) -> f64 {
        // The sum of no numbers would be -0.
        self.lines
            .iter()
            .map(Line::length)
            .fold(0.0, |sum, length| sum + length)
    }
}

/// `k` times `step`. For a decimal step the result is the decimal multiple: 3 times 0.2 is 0.6,
/// although 0.2 is no binary fraction.
fn multiple(k: f64, step: f64) -> f64 {
    // A step with at most nine decimal places is the quotient of two integers. Then only the
    // division of `k * whole` by `scale` rounds.
    let scales = (0..=9).map(|places| 10_f64.powi(places));
    let mut fractions = scales.map(|scale| ((step * scale).round(), scale));
    match fractions.find(|(whole, scale)| whole / scale == step) {
        Some((whole, scale)) => k * whole / scale,
        None => k * step,
    }
}

impl DistanceField {
    /// Computes the distances from the nearest of `sources` by [MMP](geobench_mmp::mmp), and keeps
    /// its windows: time O(n² log n), space O(n²) for n faces, about n^1.5 windows in practice.
    ///
    /// # Errors
    ///
    /// If there is no source, or one that is not on the mesh.
    pub fn new(mesh: &Mesh, sources: &[SurfacePoint]) -> Result<Self, FieldError> {
        let refined = mesh.with_points(sources)?;
        let queue = CalendarQueue::new(&refined.mesh);
        let mut solver = mmp_from(&refined.mesh, Carrier::HalfEdge, queue);
        let distances = solver.solve(&refined.vertices)?.distances;
        let mut sorted: Vec<f64> = distances
            .iter()
            .copied()
            .filter(|d| d.is_finite())
            .collect();
        sorted.sort_by(f64::total_cmp);
        Ok(Self {
            mesh: mesh.clone(),
            refined,
            solver,
            distances,
            sorted,
        })
    }

    /// The distances of the vertices of the mesh, in their order and in the units of the mesh;
    /// infinite for unreachable vertices.
    pub fn distances(&self) -> &[f64] {
        &self.distances[..self.mesh.vertex_count()]
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The multiples of `step` up to the distance of the farthest point of the surface, which may
    /// lie inside a face; none if `step` is not positive. Computes some dozens of isolines at most.
    ///
    /// # Errors
    ///
    /// If these are more than 10,000 levels.
    pub fn levels_every(&self, step: f64) -> Result<Vec<f64>, TooManyLevels> {
        if step.is_nan() || step <= 0.0 {
            return Ok(Vec::new());
        }
        let of_vertices = self.sorted.last().copied().unwrap_or(0.0);
        let mut count = (of_vertices / step).floor();
        // The distance is continuous: there are isolines up to the farthest point, and none beyond.
        let is_line = |level: f64| !self.isoline(level).lines.is_empty();
        let longest = self.refined.mesh.longest_edge();
        let is_fine = step < FINE * longest;
        if count <= MOST_LEVELS as f64 && (is_fine || is_line(multiple(count + 1.0, step))) {
            // Points of a face are no farther than its longest edge from a corner.
            let (mut some, mut none) = (of_vertices, of_vertices + longest);
            let mut middle = 0.5 * (some + none);
            while none - some > 0.5 * step && some < middle && middle < none {
                if is_line(middle) {
                    some = middle;
                } else {
                    none = middle;
                }
                middle = 0.5 * (some + none);
            }
            count = (some / step).floor();
            if is_line(multiple(count + 1.0, step)) {
                count += 1.0;
            }
        }
        if count > MOST_LEVELS as f64 {
            let farthest = of_vertices.max(multiple(count, step));
            return Err(TooManyLevels {
                step,
                count,
                farthest,
            });
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // At most MOST_LEVELS.
        let count = count as u64;
        Ok((1..=count).map(|k| multiple(k as f64, step)).collect())
    }

    /// The isolines at `levels`, in this order; see [`isoline`](Self::isoline). All together read
    /// every face once.
    pub fn isolines(&self, levels: &[f64]) -> Vec<Isoline> {
        let free: Vec<f64> = levels.iter().map(|&level| self.free_level(level)).collect();
        let faces = self.faces_near(&free);
        let traced = levels.iter().zip(free).zip(faces);
        traced
            .map(|((&distance, level), faces)| self.trace(distance, level, &faces))
            .collect()
    }

    /// The points at `distance` from the nearest source. The isoline has no lines if `distance` is
    /// not positive.
    ///
    /// Takes O(faces) time, and O(w² + a w + a² log a) for each face near the isoline, where w
    /// windows enter the face and their circles cut each other into a pieces.
    pub fn isoline(&self, distance: f64) -> Isoline {
        let level = self.free_level(distance);
        let faces = self.faces_near(&[level]);
        self.trace(distance, level, &faces[0])
    }

    /// For each level, the faces that its isoline may cross, in ascending order.
    fn faces_near(&self, levels: &[f64]) -> Vec<Vec<FaceId>> {
        let mesh = &self.refined.mesh;
        let mut order: Vec<usize> = (0..levels.len()).collect();
        order.sort_by(|&i, &j| levels[i].total_cmp(&levels[j]));
        let mut near = vec![Vec::new(); levels.len()];
        for face in mesh.faces() {
            let distances = mesh.face_vertices(face).map(|v| self.distances[v.index()]);
            let size = mesh.side_lengths(face);
            let size = size.into_iter().fold(0.0, f64::max);
            // Points of the face are no farther than its longest edge from a corner.
            let least = distances.into_iter().fold(f64::INFINITY, f64::min) - size;
            let greatest = distances.into_iter().fold(0.0, f64::max) + size;
            let first = order.partition_point(|&i| levels[i] < least);
            for &i in order[first..]
                .iter()
                .take_while(|&&i| levels[i] <= greatest)
            {
                near[i].push(face);
            }
        }
        near
    }

    /// The isoline at `distance`, computed as that at `level`, which `faces` hold.
    fn trace(&self, distance: f64, level: f64, faces: &[FaceId]) -> Isoline {
        let mut tracer = Tracer::new(self, level);
        if distance > 0.0 {
            tracer.trace_faces(faces);
            tracer.join();
        }
        Isoline {
            distance,
            lines: tracer.lines,
            gap: tracer.gap,
        }
    }

    /// A level at or just below `level` that differs from the distances of all vertices by more
    /// than rounding. So no isoline passes through a vertex.
    fn free_level(&self, level: f64) -> f64 {
        let slack = TIE * level;
        let mut free = level;
        // A lowered level can again be close to the distance of a vertex. The limit only bounds the
        // time: so long a chain of distances that close to each other is not expected.
        for _ in 0..1000 {
            let near = self.sorted.partition_point(|&d| d < free - slack);
            match self.sorted.get(near) {
                Some(&d) if d <= free + slack => free = d - 2.0 * slack,
                _ => break,
            }
        }
        free
    }

    fn windows(&self, h: HalfEdgeId) -> impl Iterator<Item = Window> {
        windows_of(&self.solver, h)
    }

    fn cones(&self, face: FaceId) -> FaceCones {
        FaceCones::new(
            &self.refined.mesh,
            &self.distances,
            |h| self.windows(h),
            face,
        )
    }

    /// The abscissas at which the distance passes `level`, along the half-edge with the lowest
    /// number of its edge. O(windows of all faces at the edge).
    fn crossings_of_edge(&self, h: HalfEdgeId, level: f64) -> Vec<f64> {
        let mesh = &self.refined.mesh;
        let l = mesh.length(h);
        let ends = [mesh.tail(h), mesh.head(h)].map(|v| self.distances[v.index()]);
        if ends.iter().all(|d| (d - level).abs() > l) {
            return Vec::new();
        }
        if !mesh.is_boundary_edge(h) {
            let of_side = |side: HalfEdgeId| {
                let is_turned = mesh.tail(side) != mesh.tail(h);
                let turn = move |w: Window| if is_turned { w.reversed(l) } else { w };
                self.windows(side).map(turn)
            };
            let windows = mesh.along_edge(h).flat_map(of_side);
            return crossings(windows, ends, l, level);
        }
        let cones = self.cones(h.face());
        let k = h.corner() as usize;
        let [from, to] = [cones.corners[k], cones.corners[(k + 1) % 3]];
        let direction = vector::scale(sub(to, from), 1.0 / l);
        // No windows are stored on a boundary edge, since no face follows. They are computed from
        // the cones of the face. The cones of the two ends are covered by `ends`.
        let seen = cones.cones.iter();
        let seen = seen.filter(|cone| cone.centre != from && cone.centre != to);
        let seen = seen.filter_map(|cone| cone.window(from, direction, l));
        crossings(seen, ends, l, level)
    }

    /// The arc between two points around `centre`, given in the plane of `face` of the refined
    /// mesh, converted to the face of the original mesh that contains it.
    fn arc(&self, face: FaceId, [from, to]: [Point; 2], centre: Point) -> CircleArc {
        let parent = self.refined.parent(face);
        let split = self.refined.mesh.face_vertices(face) != self.mesh.face_vertices(parent);
        if !split {
            return CircleArc::new(parent, [from, to], centre);
        }
        let motion = self.refined.motion(face);
        CircleArc::new(parent, [from, to].map(|p| motion.of(p)), motion.of(centre))
    }
}

/// The points at which the isoline crosses an edge.
struct EdgeCrossings {
    /// The number of the first crossing. The others have the numbers that follow.
    first: usize,
    /// The abscissas, in ascending order along the half-edge with the lower number.
    at: Vec<f64>,
}

/// Computes the isoline of one level.
struct Tracer<'a> {
    field: &'a DistanceField,
    level: f64,
    /// The crossings of each edge, by its half-edge with the lower number; at a junction those of
    /// each half-edge, so that lines end there.
    edges: HashMap<HalfEdgeId, EdgeCrossings>,
    /// The abscissas at each junction, along the half-edge with the lowest number. All faces there
    /// share them; each of them anew would take the windows of all faces.
    at_junctions: HashMap<HalfEdgeId, Vec<f64>>,
    /// The edge of each crossing.
    edge_of: Vec<HalfEdgeId>,
    /// For each crossing, the part of the isoline in the face that it enters. `None` where the
    /// isoline ends at the boundary.
    links: Vec<Option<Link>>,
    lines: Vec<Line>,
    gap: f64,
}

impl<'a> Tracer<'a> {
    fn new(field: &'a DistanceField, level: f64) -> Self {
        Self {
            field,
            level,
            edges: HashMap::new(),
            at_junctions: HashMap::new(),
            edge_of: Vec::new(),
            links: Vec::new(),
            lines: Vec::new(),
            gap: 0.0,
        }
    }

    /// Computes the crossings and the arcs of `faces`.
    fn trace_faces(&mut self, faces: &[FaceId]) {
        let field = self.field;
        let mesh = &field.refined.mesh;
        for &face in faces {
            for h in face.half_edges() {
                let h = mesh.twin(h).map_or(h, |twin| twin.min(h));
                if !self.edges.contains_key(&h) {
                    let at = self.crossings(h);
                    let first = self.edge_of.len();
                    self.edge_of.resize(first + at.len(), h);
                    self.edges.insert(h, EdgeCrossings { first, at });
                }
            }
            self.trace_face(face);
        }
    }

    /// The abscissas along `h` at which the distance passes the level. All faces of its edge get
    /// the same crossings.
    fn crossings(&mut self, h: HalfEdgeId) -> Vec<f64> {
        let (field, level) = (self.field, self.level);
        let mesh = &field.refined.mesh;
        let edge = mesh.edge_of(h);
        if mesh.junction(h).is_empty() {
            return field.crossings_of_edge(edge, level);
        }
        let found = self.at_junctions.entry(edge);
        let at = found.or_insert_with(|| field.crossings_of_edge(edge, level));
        if mesh.tail(edge) == mesh.tail(h) {
            return at.clone();
        }
        let l = mesh.length(h);
        at.iter().rev().map(|x| l - x).collect()
    }

    /// Connects the crossings of the edges of `face` through the arcs inside it.
    fn trace_face(&mut self, face: FaceId) {
        let mesh = &self.field.refined.mesh;
        let cones = self.field.cones(face);
        let mut joints = face::FaceConnections::default();
        for k in 0..3 {
            let h = face.half_edge(k);
            let l = mesh.length(h);
            let own = mesh.twin(h).map_or(h, |twin| twin.min(h));
            let crossings = &self.edges[&own];
            let count = crossings.at.len();
            let mut is_near = self.field.distances[mesh.tail(h).index()] < self.level;
            let k = k as usize;
            let (from, to) = (cones.corners[k], cones.corners[(k + 1) % 3]);
            for i in 0..count {
                let (i, x) = if own == h {
                    (i, crossings.at[i])
                } else {
                    let i = count - 1 - i;
                    (i, l - crossings.at[i])
                };
                let t = x / l;
                let at = vector::add(vector::scale(from, 1.0 - t), vector::scale(to, t));
                // Edges run counter-clockwise around the face. Where one passes from nearer to
                // farther points, the line enters the face, since nearer points are on its left.
                joints.cross(crossings.first + i, at, is_near);
                is_near = !is_near;
            }
        }
        let found = cones.arcs(self.level);
        if found.is_empty() && joints.is_empty() {
            return;
        }
        for arc in &found {
            let cone = &cones.cones[arc.cone];
            let radius = cone.radius(self.level);
            joints.arc([arc.from, arc.to].map(|angle| cone.at(angle, radius)));
        }
        let (links, loops, gap) = joints.connect();
        self.gap = self.gap.max(gap);
        for (entry, mut link) in links {
            self.finish(face, &cones, &found, &mut link);
            if self.links.len() <= entry {
                self.links.resize_with(entry + 1, || None);
            }
            self.links[entry] = Some(link);
        }
        for mut link in loops {
            self.finish(face, &cones, &found, &mut link);
            self.add(link.arcs, true, true);
        }
    }

    /// Fills `link.arcs` from the arc numbers in `link.ends`.
    fn finish(&self, face: FaceId, cones: &FaceCones, found: &[ConeArc], link: &mut Link) {
        let ends = link.ends.drain(..);
        link.arcs = ends
            .map(|(i, ends)| {
                let centre = cones.cones[found[i].cone].centre;
                self.field.arc(face, ends, centre)
            })
            .collect();
        // No arc was found between two crossings: the face has no height, or the arc cuts off so
        // small a corner that it was lost in rounding.
        if let Some([from, to]) = link.straight {
            let middle = vector::scale(vector::add(from, to), 0.5);
            if let Some(i) = cones.nearest(middle) {
                let centre = cones.cones[i].centre;
                link.arcs.push(self.field.arc(face, [from, to], centre));
            }
        }
    }

    /// Adds a line, unless it is an artefact of rounding (see [`SPECK`]).
    fn add(&mut self, arcs: Vec<CircleArc>, closed: bool, crosses_one_edge: bool) {
        let mut arcs = arc::joined(arcs, closed);
        // Faces without height leave arcs of length zero. They are removed, but a line that has no
        // others keeps one.
        if arcs.iter().any(CircleArc::has_length) {
            arcs.retain(CircleArc::has_length);
        } else {
            arcs.truncate(1);
        }
        let line = Line { closed, arcs };
        let is_speck = closed && crosses_one_edge && line.length() <= SPECK * self.level;
        if !is_speck && !line.arcs.is_empty() {
            self.lines.push(line);
        }
    }

    /// Joins the links of all faces into lines: first those that start at the boundary, then loops.
    fn join(&mut self) {
        let count = self.edge_of.len();
        self.links.resize_with(count, || None);
        let mut has_start = vec![false; count];
        for link in self.links.iter().flatten() {
            if let Some(exit) = link.exit {
                has_start[exit] = true;
            }
        }
        let starts = (0..count).filter(|&i| !has_start[i]);
        let order: Vec<usize> = starts.chain(0..count).collect();
        for start in order {
            let mut arcs = Vec::new();
            let mut at = start;
            let mut closed = false;
            let mut crosses_one_edge = true;
            while let Some(link) = self.links[at].take() {
                arcs.extend(link.arcs);
                let Some(exit) = link.exit else {
                    break;
                };
                at = exit;
                closed = at == start;
                crosses_one_edge &= self.edge_of[at] == self.edge_of[start];
            }
            self.add(arcs, closed, crosses_one_edge);
        }
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::{Mesh, TriangleSoup};

    use super::{DistanceField, Tracer, multiple};

    /// Each face at an edge of many took the windows of all: 24 s for 3,000 faces.
    #[test]
    fn crossings_of_a_junction_are_computed_once() {
        let (mut positions, mut faces) = (vec![[0.0; 3], [0.0, 0.0, 1.0]], Vec::new());
        for k in 0..40 {
            let (sin, cos) = f64::from(k).sin_cos();
            positions.push([cos, sin, 0.5]);
            faces.push(if k % 3 == 0 {
                [0, 1, 2 + k]
            } else {
                [1, 0, 2 + k]
            });
        }
        let soup = TriangleSoup::new(positions, faces);
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        let source = mesh.point_at_vertex(2.into()).unwrap();
        let field = DistanceField::new(&mesh, &[source]).unwrap();
        // The middle of the edge is at 1, its ends are at 1.118.
        let level = 1.1;
        let mut tracer = Tracer::new(&field, level);
        tracer.trace_faces(&field.faces_near(&[level])[0]);
        assert_eq!(tracer.at_junctions.len(), 1);
        let sides: Vec<_> = mesh.junction_sides().collect();
        assert_eq!(sides.len(), 40);
        for h in sides {
            let found = &tracer.edges[&h].at;
            assert!(
                (found[0] - (0.5 - 0.21_f64.sqrt())).abs() < 1e-12,
                "{found:?}"
            );
            assert!(
                (found[1] - (0.5 + 0.21_f64.sqrt())).abs() < 1e-12,
                "{found:?}"
            );
        }
    }

    #[test]
    fn multiples_of_a_decimal_step_are_the_decimals() {
        assert_eq!(multiple(3.0, 0.2), 0.6);
        assert_eq!(multiple(12.0, 0.2), 2.4);
        assert_eq!(multiple(3.0, 0.3), 0.9);
        assert_eq!(multiple(7.0, 1e-3), 0.007);
        let step = std::f64::consts::PI;
        assert_eq!(multiple(3.0, step), 3.0 * step);
        assert_eq!(multiple(3.0, 1e300), 3e300);
    }
}
