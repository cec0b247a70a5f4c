//! Distances from curves: MMP with windows of parallel rays beside cones.
//!
//! Every point of a curve is a source. The shortest path to a point of the surface starts at a
//! point of the curve, or inside one of its segments and perpendicular to it. So each point of the
//! curve sends cones, as a source of MMP does, and each segment sends parallel rays to both of its
//! sides ([`Beam`]). Points and segments inside a face send their windows through its sides; no
//! face is divided.
//!
//! Everything else is MMP: windows are stored where they are the shortest of their half-edge, and
//! cross faces nearest first. The distance of parallel rays is linear along an edge. It ties with
//! another linear one at one point, and with that of a cone at two at most, as two cones do. So
//! O(n) windows are stored on an edge, and the time is O(n² log n) for n faces and segments.
//!
//! The bounds of rounding are those of [`precision`](geobench_window::precision).

use geobench_mesh::{Curve, CurveError, CurveSegment, HalfEdgeId, Mesh, SurfacePoint, VertexId};
use geobench_window::precision::PLACE;
use geobench_window::queue::MinHeap;
use geobench_window::trimming::{Overlap, Owner, ThinFaces, is_near, pieces};
use geobench_window::{
    Beam, Faces, Rays, Stop, Window, length_past_end, reach_over_edges, spawn_window,
};

/// Why there are no distances from curves.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CurveSourceError {
    /// No curve is given.
    #[error("no curve is given")]
    NoCurve,
    /// A curve does not lie on the mesh.
    #[error("curve {index}: {error}")]
    Curve {
        /// The number of the curve, from 0.
        index: usize,
        /// What is wrong with it.
        error: CurveError,
    },
}

/// Distances of all vertices from the nearest point of `curves`, as far as they are at most
/// `radius`; others are infinite. Once `stop` is set, the call returns soon, and distances are
/// upper bounds.
///
/// A curve of one point is a source as any other. Time O(n² log n), space O(n²) for n faces and
/// segments.
///
/// ```
/// use geobench_mesh::{Curve, Mesh};
/// use geobench_mmp::distances_from_curves;
/// use geobench_window::Stop;
///
/// // From the lower side of a grid of 5 x 5 vertices.
/// let mesh = Mesh::generate("grid,n=4")?;
/// let side = Curve::new([0, 1, 2, 3, 4]);
/// let distances = distances_from_curves(&mesh, &[side], f64::INFINITY, &Stop::default())?;
/// assert!((0..25).all(|v| (distances[v] - (v / 5) as f64).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// If there is no curve, or one does not lie on the mesh.
pub fn distances_from_curves(
    mesh: &Mesh,
    curves: &[Curve],
    radius: f64,
    stop: &Stop,
) -> Result<Vec<f64>, CurveSourceError> {
    if curves.is_empty() {
        return Err(CurveSourceError::NoCurve);
    }
    let mut segments = Vec::new();
    for (index, curve) in curves.iter().enumerate() {
        let found = curve.segments(mesh);
        segments.extend(found.map_err(|error| CurveSourceError::Curve { index, error })?);
    }
    let mut run = CurveRun::new(mesh);
    let points = curves.iter().flat_map(Curve::points);
    for point in points {
        run.start_at(point);
    }
    for segment in &segments {
        run.start_along(segment);
    }
    run.propagate(radius, stop);
    let mut distances = run.distances;
    reach_over_edges(mesh, &mut distances, &mut ());
    mesh.fill_copies(&mut distances);
    for d in &mut distances {
        if *d > radius {
            *d = f64::INFINITY;
        }
    }
    Ok(distances)
}

/// An event of the queue.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
enum CurveEvent {
    /// A pseudo-source sends its windows.
    Vertex(VertexId),
    /// The stored window with this number crosses its face.
    Window(u32),
}

/// A stored window.
#[derive(Clone, Copy, Debug)]
struct StoredRays {
    rays: Rays,
    half_edge: HalfEdgeId,
    state: State,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// It has an event in the queue.
    Waits,
    /// It has crossed its face.
    Crossed,
    /// Nothing of it is left.
    Gone,
}

/// The state of one run.
struct CurveRun<'m> {
    mesh: &'m Mesh,
    faces: Faces,
    /// How much longer than the shortest path a window beside a thin face may be.
    doubt: f64,
    distances: Vec<f64>,
    queue: MinHeap<CurveEvent>,
    windows: Vec<StoredRays>,
    /// The windows of each half-edge, ascending and disjoint.
    lists: Vec<Vec<u32>>,
    overlap: Overlap,
}

impl<'m> CurveRun<'m> {
    fn new(mesh: &'m Mesh) -> Self {
        let half_edges = mesh.half_edge_count();
        Self {
            mesh,
            faces: Faces::new(mesh).with_gates(mesh),
            doubt: ThinFaces::of(mesh, half_edges, HalfEdgeId::index).doubt(),
            distances: vec![f64::INFINITY; mesh.vertex_count()],
            queue: MinHeap::default(),
            windows: Vec::new(),
            lists: vec![Vec::new(); half_edges],
            overlap: Overlap::default(),
        }
    }

    /// A point of a curve sends its windows.
    fn start_at(&mut self, point: &SurfacePoint) {
        if let Some(v) = point.vertex() {
            let v = self.mesh.kept_vertex(v);
            if self.distances[v.index()] > 0.0 {
                self.distances[v.index()] = 0.0;
                self.spawn(v);
            }
            return;
        }
        // It is on the mesh: its curve has been checked.
        for (face, weights) in self.mesh.faces_of(point).into_iter().flatten() {
            for h in face.half_edges() {
                let [px, py] = self.below(h, weights);
                let tail = self.mesh.tail(h);
                // The tail of `h` is the head of the exit.
                let l = self.mesh.length(h);
                self.offer(tail, libm::hypot(l - px, py));
                if weight_opposite(h, weights) > 0.0 {
                    let (b0, b1) = (0.0, l);
                    let (py, sigma) = (-py.abs(), 0.0);
                    let cone = Window {
                        b0,
                        b1,
                        px,
                        py,
                        sigma,
                    };
                    self.leave(h, &Rays::Cone(cone));
                }
            }
        }
    }

    /// A segment of a curve sends parallel rays.
    fn start_along(&mut self, segment: &CurveSegment) {
        if let Some(h) = segment.side() {
            return self.start_along_side(h, segment);
        }
        let face = segment.face;
        let lengths = self.mesh.side_lengths(face);
        let longest = lengths.into_iter().fold(0.0, f64::max);
        for h in face.half_edges() {
            let [q, r] = segment.ends.map(|weights| self.below(h, weights));
            let (sx, sy) = (r[0] - q[0], r[1] - q[1]);
            let length = libm::hypot(sx, sy);
            if length == 0.0 {
                // Rounding makes the ends one point, whose cone is as short.
                continue;
            }
            // The unit vector that is perpendicular to the segment and leads to the edge.
            let sign = if sx < 0.0 { -1.0 } else { 1.0 };
            let (ux, uy) = (-sy / length * sign, sx / length * sign);
            let offset = -(q[0] * ux + q[1] * uy);
            // The tail of `h`, which is the head of the exit, if a ray leads there.
            let l = self.mesh.length(h);
            let along = (l - q[0]) * sx - q[1] * sy;
            if 0.0 < along && along < length * length {
                let d = (offset + ux * l).abs();
                self.offer(self.mesh.tail(h), d);
            }
            if uy <= PLACE {
                // The rays that leave here are less than the margin apart.
                continue;
            }
            let [x0, x1] = [q, r].map(|[x, y]| x - y * (ux / uy));
            let margin = PLACE * longest / uy;
            let (b0, b1) = (x0.min(x1) + margin, x0.max(x1) - margin);
            let (b0, b1) = (b0.max(0.0), b1.min(l));
            if b0 < b1 {
                let direction = [ux, uy];
                self.leave(
                    h,
                    &Rays::Beam(Beam {
                        b0,
                        b1,
                        direction,
                        offset,
                    }),
                );
            }
        }
    }

    /// A segment along `h` sends parallel rays into the face of `h`. They wait there at distance 0,
    /// so that windows which cross the curve end.
    fn start_along_side(&mut self, h: HalfEdgeId, segment: &CurveSegment) {
        let l = self.mesh.length(h);
        let head = h.next().corner() as usize;
        let [x0, x1] = segment.ends.map(|weights| weights[head] * l);
        let margin = PLACE * l;
        let (b0, b1) = (x0.min(x1) + margin, x0.max(x1) - margin);
        if b0 < b1 {
            let (direction, offset) = ([0.0, 1.0], 0.0);
            self.arrive(
                h,
                &Rays::Beam(Beam {
                    b0,
                    b1,
                    direction,
                    offset,
                }),
            );
        }
    }

    /// The point of the face of `h` with these barycentric coordinates, in the frame of the
    /// half-edge beyond `h`, below it.
    fn below(&self, h: HalfEdgeId, weights: [f64; 3]) -> [f64; 2] {
        let [x, y] = self.faces.apex_below(h);
        let (tail, apex) = (weights[h.corner() as usize], weight_opposite(h, weights));
        [tail * self.mesh.length(h) + apex * x, apex * y]
    }

    /// Rays leave the face of `h` through `h`. They are in the frame of the half-edge beyond it.
    fn leave(&mut self, h: HalfEdgeId, rays: &Rays) {
        if let Some(exit) = self.faces.twin(h) {
            self.pass(exit, rays);
        }
    }

    /// Rays arrive at `exit`, which is a half-edge or a gate.
    fn pass(&mut self, exit: HalfEdgeId, rays: &Rays) {
        let Some(beyond) = self.faces.beyond(exit) else {
            return self.arrive(exit, rays);
        };
        let l = self.faces.length(exit);
        let entrances: Vec<_> = beyond.collect();
        for entrance in entrances {
            if let Some(rays) = rays.carried(&entrance, l) {
                self.arrive(entrance.half_edge, &rays);
            }
        }
    }

    /// Offers `v` a path of length `d`.
    fn offer(&mut self, v: VertexId, d: f64) {
        let known = &mut self.distances[v.index()];
        if d < *known {
            *known = d;
            if self.mesh.is_pseudo_source(v) {
                self.queue.push(d, CurveEvent::Vertex(v));
            }
        }
    }

    /// Offers distances along the edges of `v` and sends windows across its faces.
    fn spawn(&mut self, v: VertexId) {
        let sigma = self.distances[v.index()];
        for &h in self.mesh.outgoing(v) {
            for path in self.faces.edge_paths(h) {
                self.offer(path.end, sigma + path.length);
            }
        }
        for &h in self.mesh.outgoing(v) {
            if let Some((exit, window)) = spawn_window(&self.faces, h, sigma) {
                self.pass(exit, &Rays::Cone(window));
            }
        }
    }

    /// Stores the part of `rays` that is the shortest of the half-edge `h`.
    fn arrive(&mut self, h: HalfEdgeId, rays: &Rays) {
        let [tail, head, _] = self.faces.corners(h);
        let [tail, head] = [tail, head].map(|v| self.distances[v.index()] + self.doubt);
        let l = self.faces.length(h);
        if rays.is_beaten_from_ends(l, tail, head) {
            return;
        }
        match rays {
            Rays::Cone(window) if is_near(window, l) => {
                let stored = self.lists[h.index()].iter();
                let cones = stored.filter_map(|&i| match &self.windows[i as usize].rays {
                    Rays::Cone(window) => Some(window),
                    Rays::Beam(_) => None,
                });
                let parts: Vec<Window> = pieces(window, l, cones).collect();
                for part in parts {
                    self.insert(h, &Rays::Cone(part), l);
                }
            }
            _ => self.insert(h, rays, l),
        }
    }

    /// Inserts `new` into the list of `h`, whose length is `l`.
    fn insert(&mut self, h: HalfEdgeId, new: &Rays, l: f64) {
        let [b0, b1] = new.interval();
        let interval = |i: &u32| self.windows[*i as usize].rays.interval();
        let list = &self.lists[h.index()];
        let first = list.partition_point(|i| interval(i)[1] <= b0);
        let count = list[first..]
            .iter()
            .take_while(|i| interval(i)[0] < b1)
            .count();
        let old: Vec<u32> = list[first..first + count].to_vec();
        let met: Vec<Rays> = old.iter().map(|&i| self.windows[i as usize].rays).collect();
        self.overlap.share_out_rays(&met, new, l);
        let segments = self.overlap.segments().to_vec();
        if !segments.iter().any(|segment| segment.owner == Owner::New) {
            return;
        }
        let mut kept = vec![false; old.len()];
        let mut list = Vec::with_capacity(segments.len());
        for segment in segments {
            let (start, end) = (segment.start, segment.end);
            list.push(match segment.owner {
                Owner::New => self.store(h, new.cut(start, end), State::Waits),
                Owner::Old(k) if kept[k] => {
                    let state = self.windows[old[k] as usize].state;
                    self.store(h, met[k].cut(start, end), state)
                }
                Owner::Old(k) => {
                    kept[k] = true;
                    self.windows[old[k] as usize].rays = met[k].cut(start, end);
                    old[k]
                }
            });
        }
        for (&i, _) in old.iter().zip(&kept).filter(|(_, kept)| !**kept) {
            self.windows[i as usize].state = State::Gone;
        }
        self.lists[h.index()].splice(first..first + count, list);
    }

    fn store(&mut self, half_edge: HalfEdgeId, rays: Rays, state: State) -> u32 {
        let i = self.windows.len() as u32;
        self.windows.push(StoredRays {
            rays,
            half_edge,
            state,
        });
        if state == State::Waits {
            self.queue.push(rays.min_distance(), CurveEvent::Window(i));
        }
        i
    }

    /// Takes all events up to `radius`, nearest first.
    fn propagate(&mut self, radius: f64, stop: &Stop) {
        while let Some((label, event)) = self.queue.pop() {
            if label > radius || stop.is_set() {
                break;
            }
            match event {
                // A vertex is queued anew whenever it improves; its older events are void.
                CurveEvent::Vertex(v) if self.distances[v.index()] == label => self.spawn(v),
                CurveEvent::Vertex(_) => {}
                CurveEvent::Window(i) => {
                    let StoredRays {
                        rays,
                        half_edge,
                        state,
                    } = self.windows[i as usize];
                    let least = rays.min_distance();
                    if state != State::Waits {
                        continue;
                    }
                    if least > label {
                        // It has been cut since.
                        self.queue.push(least, event);
                        continue;
                    }
                    self.windows[i as usize].state = State::Crossed;
                    self.cross(half_edge, &rays);
                }
            }
        }
    }

    /// Rays cross the face of `h`.
    fn cross(&mut self, h: HalfEdgeId, rays: &Rays) {
        let view = self.faces.face_view(h);
        let crossed = rays.cross(&view);
        let [tail, head, apex] = view.corners;
        let d = crossed.distance;
        if d < self.distances[apex.index()] {
            let frame = view.frame;
            let ends = [tail, head].map(|v| self.distances[v.index()]);
            let d = length_past_end(d, crossed.entry, frame.l, ends, [frame.la, frame.lb]);
            self.offer(apex, d.max(0.0));
        }
        for (exit, child) in view.exits.into_iter().zip(crossed.children) {
            if let (Some(exit), Some(child)) = (exit, child) {
                self.pass(exit, &child);
            }
        }
    }
}

/// The barycentric coordinate of the corner opposite to `h`.
fn weight_opposite(h: HalfEdgeId, weights: [f64; 3]) -> f64 {
    weights[h.prev().corner() as usize]
}
