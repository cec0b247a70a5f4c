//! The straight lines that may end a shortest path to a vertex, found by a search.

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, TAU};

use geobench_mesh::vector::{Point as Vector, cross_2d, dot, norm, sub};
use geobench_mesh::{FaceId, HalfEdgeId, Mesh, VertexId};
use geobench_window::queue::MinHeap;
use geobench_window::{Crossing, FaceView, Side, Window, is_beaten_from_ends};

use crate::path::Point;

/// Rounding of a position on an edge, as a fraction of the longest edge that a line crosses.
pub(crate) const PLACE: f64 = 4.0 * f64::EPSILON;

/// Rounding of the length of a line, as a fraction of the line.
const ROUNDING: f64 = 1e-14;

/// A direction at a vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LineDirection {
    /// A half-edge that starts at the vertex.
    pub(crate) corner: HalfEdgeId,
    /// The angle from the half-edge, inside its face.
    pub(crate) angle: f64,
}

impl LineDirection {
    /// The direction `to` at the tail of `corner`, where `along` is that of `corner`.
    pub(crate) fn new(corner: HalfEdgeId, along: Vector, to: Vector) -> Self {
        let angle = libm::atan2(cross_2d(along, to), dot(along, to));
        // Back along an edge, rounding decides between -π and π.
        let angle = if angle < -FRAC_PI_2 {
            angle + TAU
        } else {
            angle
        };
        Self { corner, angle }
    }

    /// The direction of the edge from `v` to `to`.
    pub(crate) fn of_edge(mesh: &Mesh, v: VertexId, to: VertexId) -> Option<Self> {
        let corners = mesh.outgoing(v).iter();
        let mut directions = corners.filter_map(|&corner| {
            if mesh.head(corner) == to {
                Some(Self { corner, angle: 0.0 })
            } else {
                let angle = mesh.corner_angle(corner);
                (mesh.apex_vertex(corner) == to).then_some(Self { corner, angle })
            }
        });
        directions.next()
    }
}

/// A straight line from one vertex to another, across faces or along an edge.
#[derive(Clone, Debug)]
pub(crate) struct StraightLine {
    /// The vertex from which a path comes along the line.
    pub(crate) from: VertexId,
    pub(crate) length: f64,
    /// By how much the path along the line exceeds the distance of the vertex where the line ends.
    /// Rounding may make it negative.
    pub(crate) excess: f64,
    /// The directions of the line at its end and at `from`.
    pub(crate) directions: [LineDirection; 2],
    /// The edges that the line crosses, from its end on.
    pub(crate) crossings: Vec<Point>,
}

impl StraightLine {
    /// The faces that the line crosses.
    pub(crate) fn faces(&self) -> impl Iterator<Item = FaceId> {
        let last = self.directions[1].corner.face();
        let last = (!self.crossings.is_empty()).then_some(last);
        self.crossings.iter().filter_map(|p| p.face).chain(last)
    }

    /// The line along the edge from `from` to `end`. `None` if there is no such edge.
    pub(crate) fn along_edge(
        mesh: &Mesh,
        distances: &[f64],
        [end, from]: [VertexId; 2],
    ) -> Option<Self> {
        let edges = mesh.neighbours(end).filter(|&(v, _)| v == from);
        let length = edges.map(|(_, l)| l).fold(f64::INFINITY, f64::min);
        Some(Self {
            from,
            length,
            excess: length + distances[from.index()] - distances[end.index()],
            directions: [
                LineDirection::of_edge(mesh, end, from)?,
                LineDirection::of_edge(mesh, from, end)?,
            ],
            crossings: Vec::new(),
        })
    }
}

/// The straight lines that cross one edge on their way from the vertex at which paths end. The
/// image of that vertex is the source of `window`.
struct LineBeam {
    /// The half-edge through which the lines enter a face.
    h: HalfEdgeId,
    /// The half-edge of the same edge in the face before.
    out: HalfEdgeId,
    window: Window,
    /// The beam of the edge before this one.
    parent: Option<usize>,
    /// The longest side of the faces crossed so far.
    longest: f64,
    met: Met,
}

/// Faces that the lines of a beam have met: most of those that they have not are told at once. The
/// beams of some thousand faces are long, and each meets one face more.
#[derive(Clone, Copy, Default)]
struct Met([u64; 16]);

impl Met {
    fn bit(face: FaceId) -> (usize, u64) {
        // Fibonacci hashing: faces of one neighbourhood have similar numbers.
        let hash = face.raw().wrapping_mul(0x9E37_79B9);
        ((hash >> 28) as usize, 1 << (hash >> 22 & 63))
    }

    fn with(mut self, face: FaceId) -> Self {
        let (word, bit) = Self::bit(face);
        self.0[word] |= bit;
        self
    }

    fn may_have(&self, face: FaceId) -> bool {
        let (word, bit) = Self::bit(face);
        self.0[word] & bit != 0
    }
}

struct LineSearch<'a> {
    mesh: &'a Mesh,
    distances: &'a [f64],
    /// The vertex at which paths end, and its distance.
    end: VertexId,
    distance: f64,
    /// By how much a path may exceed the distance.
    slack: f64,
    beams: Vec<LineBeam>,
    /// The beams not yet propagated, nearest first.
    queue: MinHeap<usize>,
    /// Lengths of paths from `end` to the vertices met.
    met: HashMap<VertexId, f64>,
    /// The windows kept on half-edges of junctions.
    kept: HashMap<HalfEdgeId, Vec<Window>>,
    lines: Vec<FoundLine>,
}

struct FoundLine {
    from: VertexId,
    length: f64,
    excess: f64,
    /// Part of `excess` that may be rounding.
    noise: f64,
    /// The last beam; `None` for a line along an edge.
    beam: Option<usize>,
}

/// The straight lines to vertex `end` along which its distance is attained, or exceeded by at most
/// `slack`; the best to follow first.
///
/// The search sends windows from `end`, whose rays cover every direction, and keeps a window while
/// the distances allow a shortest path in it: the distance of a vertex of the edge, less the part
/// of the edge between, is a lower bound. So it follows a band around the shortest paths to `end`,
/// whatever the solver has recorded. It drops windows
///
/// * that a path through a vertex beats on all rays, as the filter of ICH does; and
/// * that meet a face again, or one at `end`: the straight line within the face is shorter. This
///   ends windows that wind around the tip of a needle, where lengths do not differ; and
/// * those whose lines are no shorter, up to rounding, than others that have arrived at the same
///   half-edge of a junction.
///
/// The last rule ends the copies that come over the sheets of a junction: over m lenses, of k equal
/// sheets each, there are k^m. It is that of MMP. A path that follows the longer line to the edge
/// and goes on from there can follow the shorter one instead, and is no longer. If that one meets a
/// face again beyond the edge, neither is shortest. The path is longer by at most the rounding of a
/// length at each junction on the line.
///
/// No window is lost for being narrow, so one of the lines ends at the last bend of a shortest
/// path, or at a vertex beside the line through which the path is as long up to rounding.
///
/// If the distance is known less exactly than `slack` allows, and no line attains it, a greater
/// slack is taken.
pub(crate) fn lines_to(
    mesh: &Mesh,
    distances: &[f64],
    end: VertexId,
    slack: f64,
) -> Vec<StraightLine> {
    let distance = distances[end.index()];
    let mut slack = slack;
    loop {
        let search = LineSearch::run(mesh, distances, end, slack);
        let lines = search.sorted();
        if !lines.is_empty() || slack > distance {
            return lines;
        }
        slack *= 1e3;
    }
}

impl<'a> LineSearch<'a> {
    fn run(mesh: &'a Mesh, distances: &'a [f64], end: VertexId, slack: f64) -> Self {
        let mut search = Self {
            mesh,
            distances,
            end,
            distance: distances[end.index()],
            slack,
            beams: Vec::new(),
            queue: MinHeap::default(),
            met: HashMap::new(),
            kept: HashMap::new(),
            lines: Vec::new(),
        };
        search.start();
        while let Some((_, i)) = search.queue.pop() {
            search.propagate(i);
        }
        search
    }

    fn start(&mut self) {
        for (v, length) in self.mesh.neighbours(self.end) {
            self.meet(v, length);
            self.find(v, length, None, length);
        }
        for &h in self.mesh.outgoing(self.end) {
            let view = FaceView::of(self.mesh, h);
            let exit = view.exit(Side::Right);
            let [px, py] = exit.behind;
            let window = Window {
                b0: 0.0,
                b1: exit.length,
                px,
                py,
                sigma: 0.0,
            };
            let longest = view.frame.l.max(view.frame.la).max(view.frame.lb);
            self.leave(h.next(), window, None, longest);
        }
    }

    /// A lower bound of the distance of `v`. A run with a goal leaves distances infinite that
    /// exceed those asked for.
    fn least(&self, v: VertexId) -> f64 {
        let known = self.distances[v.index()];
        if known.is_finite() {
            known
        } else {
            self.distance
        }
    }

    fn meet(&mut self, v: VertexId, length: f64) {
        let known = self.met.entry(v).or_insert(f64::INFINITY);
        *known = known.min(length);
    }

    /// Whether a path through a vertex beats every line of `window` on `h`.
    fn is_beaten(&self, h: HalfEdgeId, window: &Window) -> bool {
        let met = |v| self.met.get(&v).copied().unwrap_or(f64::INFINITY);
        let [tail, head] = [self.mesh.tail(h), self.mesh.head(h)].map(met);
        is_beaten_from_ends(window, self.mesh.length(h), tail, head)
    }

    fn has_met(&self, face: FaceId, mut beam: Option<usize>) -> bool {
        if self.mesh.face_vertices(face).contains(&self.end) {
            return true;
        }
        if !beam.is_some_and(|i| self.beams[i].met.may_have(face)) {
            return false;
        }
        while let Some(i) = beam {
            if self.beams[i].h.face() == face {
                return true;
            }
            beam = self.beams[i].parent;
        }
        false
    }

    /// Adds the beams into all other faces at the edge of `out`, through which a window leaves its
    /// face. The window is in the frame of a half-edge of the opposite direction.
    fn leave(&mut self, out: HalfEdgeId, window: Window, parent: Option<usize>, longest: f64) {
        if let Some(twin) = self.mesh.twin(out) {
            return self.add([out, twin], window, parent, longest);
        }
        let mesh = self.mesh;
        for &h in mesh.junction(out).iter().filter(|&&h| h != out) {
            let own = if mesh.tail(h) == mesh.tail(out) {
                window.mirrored(mesh.length(h))
            } else {
                window
            };
            if own.b0 < own.b1 && !self.is_blind(h, &own, longest) {
                self.add([out, h], own, parent, longest);
            }
        }
    }

    /// Whether the face of `h` leads to its apex only, and that is too far for any line of
    /// `window`. Most faces at an edge of many are like that, and a search comes to all of them.
    fn is_blind(&self, h: HalfEdgeId, window: &Window, longest: f64) -> bool {
        let mesh = self.mesh;
        let [_, height] = mesh.apex(h);
        let least = self.least(mesh.apex_vertex(h)) + height - window.py;
        let mut others = [h.next(), h.prev()].into_iter();
        least > self.distance + self.slack + PLACE * longest
            && others.all(|side| mesh.is_boundary_edge(side))
    }

    fn add(
        &mut self,
        [out, h]: [HalfEdgeId; 2],
        window: Window,
        parent: Option<usize>,
        longest: f64,
    ) {
        let (tail, head) = (self.mesh.tail(h), self.mesh.head(h));
        let rest =
            (self.least(tail) - window.b1).max(self.least(head) - self.mesh.length(h) + window.b0);
        let length = window.min_distance();
        let is_too_long = length + rest.max(0.0) > self.distance + self.slack + PLACE * longest;
        if is_too_long || self.is_beaten(h, &window) || self.has_met(h.face(), parent) {
            return;
        }
        let mut window = window;
        if self.mesh.twin(h).is_none() {
            let kept = self.kept.entry(h).or_default();
            let Some(rest) = uncovered(kept, &window, PLACE * longest) else {
                return;
            };
            window = rest;
            kept.push(window);
        }
        let met = parent.map_or_else(Met::default, |i| self.beams[i].met);
        self.queue.push(length, self.beams.len());
        self.beams.push(LineBeam {
            h,
            out,
            window,
            parent,
            longest,
            met: met.with(h.face()),
        });
    }

    fn propagate(&mut self, i: usize) {
        let LineBeam {
            h, window, longest, ..
        } = self.beams[i];
        if self.is_beaten(h, &window) {
            return;
        }
        let view = FaceView::of(self.mesh, h);
        let apex = view.corners[2];
        let longest = longest.max(view.frame.la).max(view.frame.lb);
        let crossing = Crossing::new(&view.frame, &window);
        let sides = [Side::Left, Side::Right].map(|side| view.exit(side));
        let [left, right] = &sides;
        let children = if crossing.covers_apex() {
            let length = crossing.straight_distance();
            self.meet(apex, length);
            self.find(apex, length, Some(i), longest);
            [crossing.left_child(left), crossing.right_child(right)]
        } else if crossing.goes_left() {
            self.meet(apex, crossing.bent_distance(left));
            [crossing.only_child(left), None]
        } else {
            self.meet(apex, crossing.bent_distance(right));
            [None, crossing.only_child(right)]
        };
        for (out, child) in [h.prev(), h.next()].into_iter().zip(children) {
            if let Some(window) = child {
                self.leave(out, window, Some(i), longest);
            }
        }
    }

    /// Adds the line from `v`, `length` long, if it is short enough.
    fn find(&mut self, from: VertexId, length: f64, beam: Option<usize>, longest: f64) {
        let excess = length + self.distances[from.index()] - self.distance;
        let rounding = PLACE * (longest + self.distance);
        if excess <= self.slack + rounding {
            self.lines.push(FoundLine {
                from,
                length,
                excess,
                noise: rounding + ROUNDING * length,
                beam,
            });
        }
    }

    /// The lines found. First those that no other one beats by more than rounding, from the vertex
    /// nearest to the sources on: a line through a vertex is one line, not two. Then the others by
    /// their excess. Last those from vertices that are no nearer to the sources than `end`, beside
    /// it by less than the rounding of distances.
    fn sorted(self) -> Vec<StraightLine> {
        let nearness = |line: &FoundLine| self.distances[line.from.index()];
        let is_nearer = |line: &FoundLine| nearness(line) < self.distance;
        let nearer = self.lines.iter().filter(|line| is_nearer(line));
        let least = nearer.map(|line| line.excess).fold(f64::INFINITY, f64::min);
        let key = |line: &FoundLine| {
            if !is_nearer(line) {
                (2, line.length)
            } else if line.excess <= least + line.noise {
                (0, nearness(line))
            } else {
                (1, line.excess)
            }
        };
        let mut order: Vec<&FoundLine> = self.lines.iter().collect();
        order.sort_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        order.into_iter().filter_map(|l| self.line(l)).collect()
    }

    /// The line itself.
    ///
    /// In the frame of each edge, the image of the one end is that of the beam, unfolded from
    /// there; that of the other end is unfolded from that other end. So near both ends the points
    /// err by the rounding of the faces between. `None` if the points are too far for the slack.
    fn line(&self, found: &FoundLine) -> Option<StraightLine> {
        let mesh = self.mesh;
        let Some(last) = found.beam else {
            return StraightLine::along_edge(mesh, self.distances, [self.end, found.from]);
        };
        let LineBeam {
            h, window, longest, ..
        } = self.beams[last];
        // The vertex `from`, above the edge of the beam.
        let mut from = mesh.apex(h);
        let at_from = LineDirection::new(h.prev(), sub([0.0; 2], from), sub(window.source(), from));
        let mut at_end = at_from;
        let mut crossings = Vec::new();
        // The distance from `from` of the point before.
        let mut reached = 0.0;
        // That point, and the length of the line up to it.
        let mut before = from;
        let mut length = 0.0;
        let mut next = Some(last);
        while let Some(i) = next {
            let LineBeam {
                h,
                out,
                window,
                parent,
                ..
            } = self.beams[i];
            // From here on in the frame of a half-edge with the direction opposite to that of
            // `out`, the half-edge of the face before, which is on the side of the end.
            let l = mesh.length(h);
            let is_mirrored = mesh.tail(h) == mesh.tail(out);
            let here = |[x, y]: Vector| if is_mirrored { [l - x, y] } else { [x, y] };
            let window = if is_mirrored {
                window.mirrored(l)
            } else {
                window
            };
            let [x, y] = here(from);
            let at = on_edge([x, y], window.source(), reached).clamp(window.b0, window.b1);
            reached = norm([at - x, y]);
            length += norm(sub([at, 0.0], here(before)));
            let ends = [mesh.tail(out), mesh.head(out)];
            crossings.push(Point::on_edge(out, ends, (l - at) / l));
            next = parent;
            // The half-edge through which the line entered the face before; in the first face, the
            // one from the end to the tail of `out`. Its frame gives the direction at the end: in
            // that of the exit, which may be long, the end errs by more than it is away from there.
            let entry = parent.map_or(out.prev(), |i| self.beams[i].h);
            let view = FaceView::of(mesh, entry);
            let ([ux, uy], [x0, y0]) = if out == entry.prev() {
                (view.frame.left, [0.0; 2])
            } else {
                (view.frame.right, [view.frame.cx, view.frame.cy])
            };
            before = [x0 + ux * at, y0 + uy * at];
            from = [x0 + ux * x - uy * y, y0 + uy * x + ux * y];
            if parent.is_none() {
                at_end = LineDirection::new(entry, [1.0, 0.0], from);
            }
        }
        // In the frame of the first edge, the end is at the origin.
        length += norm(before);
        let rounding = found.noise + PLACE * longest * crossings.len() as f64;
        // Around a vertex nearer than the rounding of a position, windows may turn by more than π.
        // Their lines are longer than the image is far.
        let excess = (length - found.length - rounding).max(0.0);
        crossings.reverse();
        (excess <= self.slack).then_some(StraightLine {
            from: found.from,
            length: found.length + excess,
            excess: found.excess + excess,
            directions: [at_end, at_from],
            crossings,
        })
    }
}

/// Where the line from `from`, on or above the edge, to the end, on or below it, meets the edge.
/// The point before it on the line is `reached` from `from`.
fn on_edge([x, y]: Vector, [px, py]: Vector, reached: f64) -> f64 {
    // Beside a face without height, rounding may put an end on the wrong side of the edge: it
    // counts as on the edge.
    let (above, below) = (y.max(0.0), (-py).max(0.0));
    if above + below > f64::EPSILON * (x - px).abs() {
        px + below / (above + below) * (x - px)
    } else {
        // The edge lies along the line. The next point is no nearer to `from`.
        x + reached * (px - x).signum()
    }
}

/// The least range of `window` with all parts on which it is shorter than each of `kept`, windows
/// of the same half-edge; `None` if there are none. `rounding` is that of a position on the edge.
///
/// A part no wider than `rounding` does not count. It lies between the ends of kept windows, which
/// are rays through one vertex, or beside a tie, on both sides of which the kept windows go on.
fn uncovered(kept: &[Window], window: &Window, rounding: f64) -> Option<Window> {
    let covered = kept.iter().filter_map(|old| covered(old, window, rounding));
    let mut covered: Vec<[f64; 2]> = covered.collect();
    let (mut b0, mut b1) = (window.b0, window.b1);
    covered.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for [start, end] in &covered {
        if *start <= b0 + rounding {
            b0 = b0.max(*end);
        }
    }
    covered.sort_by(|a, b| b[1].total_cmp(&a[1]));
    for [start, end] in &covered {
        if *end >= b1 - rounding {
            b1 = b1.min(*start);
        }
    }
    let is_whole = (b0, b1) == (window.b0, window.b1);
    (is_whole || b1 - b0 > rounding).then(|| window.cut(b0, b1))
}

/// The range of `new` that is not needed beside `old`: all that they share, if `old` is as short
/// there up to `rounding` and that of a length; else what begins at an end and is shorter by more.
///
/// The squares of both distances differ by a linear function of the position. So on a range without
/// a tie one window is shorter everywhere. Where neither is by more than rounding, the
/// comparison at the foot of the new image and at the ends of its sides holds between them, too, up
/// to a factor of √2: the linear function is below the chord of the convex distance.
///
/// Beside a tie rounding decides which one is shorter. The rays of two images 1e-9 apart that go
/// around a vertex on both sides tie there, and differ by no more than rounding up to 1e-7 of an
/// edge away. Only one of them leads straight to what lies behind. So both stay there.
fn covered(old: &Window, new: &Window, rounding: f64) -> Option<[f64; 2]> {
    let (lo, hi) = (old.b0.max(new.b0), old.b1.min(new.b1));
    if lo > hi {
        return None;
    }
    let gain = |x| old.distance(x) - new.distance(x);
    let doubt = |x| rounding + PLACE * new.distance(x);
    let is_as_short = |x| gain(x) <= doubt(x);
    if [lo, new.px.clamp(lo, hi), hi].into_iter().all(is_as_short) {
        return Some([lo, hi]);
    }
    // The points that are nearer to one image than to another by a constant are convex.
    let is_shorter = |x| gain(x) < -doubt(x);
    if is_shorter(lo) {
        Some([lo, last_of(is_shorter, lo, hi)])
    } else if is_shorter(hi) {
        Some([last_of(is_shorter, hi, lo), hi])
    } else {
        None
    }
}

/// The last point from `inside` to `outside` that `holds`, as `inside` does and `outside` does not.
fn last_of(holds: impl Fn(f64) -> bool, mut inside: f64, mut outside: f64) -> f64 {
    loop {
        let middle = f64::midpoint(inside, outside);
        if middle == inside || middle == outside {
            return inside;
        }
        if holds(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::TriangleSoup;
    use geobench_mmp::mmp;
    use geobench_window::Solver;

    use super::*;

    /// Pairs of sheets in a row, equal but for a reflection, sewn along the edges between lenses.
    fn lenses(count: u32) -> Mesh {
        let pair = |x: u32, z: f64| [0.0, 1.0].map(|y| [f64::from(x), y, z]);
        let mut positions: Vec<_> = (0..=count).flat_map(|i| pair(2 * i, 0.0)).collect();
        let mut faces = Vec::new();
        for i in 0..count {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| 2 * i + k);
            for z in [1.0, -1.0] {
                let low = positions.len() as u32;
                let high = low + 1;
                positions.extend(pair(2 * i + 1, z));
                faces.extend([[a, low, high], [a, high, b], [low, c, d], [low, d, high]]);
            }
        }
        Mesh::from_soup(TriangleSoup::new(positions, faces))
            .unwrap()
            .0
    }

    /// The copies of a window that come over the sheets of each lens were all followed, 2^m over m
    /// lenses.
    #[test]
    fn a_search_over_lenses_follows_one_of_equal_windows() {
        for count in [20, 40] {
            let mesh = lenses(count);
            let distances = mmp(&mesh).solve(&[0.into()]).unwrap().distances;
            for end in mesh.vertices().skip(1) {
                let slack = 1e-12 * distances[end.index()];
                let search = LineSearch::run(&mesh, &distances, end, slack);
                let (beams, most) = (search.beams.len(), 40 * count as usize);
                assert!(beams <= most, "{count} lenses, to {end}: {beams} beams");
                assert!(!search.lines.is_empty());
            }
        }
    }

    const WINDOW: Window = Window {
        b0: 0.0,
        b1: 1.0,
        px: 0.5,
        py: -1.0,
        sigma: 0.0,
    };

    #[test]
    fn a_window_goes_on_where_no_other_is_as_short() {
        let rest =
            |kept: &[Window], new: &Window| uncovered(kept, new, 1e-15).map(|w| (w.b0, w.b1));
        let left = WINDOW.cut(0.0, 0.5);
        assert_eq!(rest(&[], &WINDOW), Some((0.0, 1.0)));
        assert_eq!(rest(&[WINDOW], &left), None);
        assert_eq!(rest(&[left], &WINDOW), Some((0.5, 1.0)));
        assert_eq!(rest(&[left, WINDOW.cut(0.5, 1.0)], &WINDOW), None);
        assert_eq!(rest(&[WINDOW.cut(0.2, 0.5)], &WINDOW), Some((0.0, 1.0)));
        // An image beside that one, by rounding and by more.
        let beside = |by| Window {
            px: 0.5 + by,
            ..WINDOW
        };
        assert_eq!(rest(&[WINDOW], &beside(1e-16)), None);
        let (b0, b1) = rest(&[WINDOW], &beside(0.25)).unwrap();
        assert!(b0 < 0.625 && 0.625 - b0 < 1e-13 && b1 == 1.0, "{b0}");
        // Beside the tie of images that are 1e-9 apart both stay.
        let turned = |angle: f64| Window {
            px: angle.sin(),
            py: -angle.cos(),
            ..WINDOW
        };
        let (b0, _) = rest(&[turned(1.0)], &turned(1.0 + 1e-9)).unwrap();
        assert_eq!(b0, 0.0);
        let shorter = Window { py: -0.9, ..WINDOW };
        assert_eq!(rest(&[shorter], &WINDOW), None);
        assert_eq!(rest(&[WINDOW], &shorter), Some((0.0, 1.0)));
        // A narrow one that nothing covers.
        let narrow = WINDOW.cut(0.5, 0.5 + 1e-16);
        assert_eq!(
            rest(&[WINDOW.cut(0.6, 1.0)], &narrow),
            Some((0.5, narrow.b1))
        );
    }
}
