//! Paths made locally shortest without being moved over a hole or a handle.
//!
//! A path is a row of straight pieces between vertices. Where two pieces meet at an angle below π
//! on one side, they are replaced by the shortest path across the faces that they cross and those
//! on that side of the vertex. The funnel algorithm finds it: Lee and Preparata, "Euclidean
//! shortest paths in the presence of rectilinear barriers" (1984). This goes on until no angle is
//! below π. It is the step of Sharp and Crane, "You Can Find Geodesic Paths in Triangle Meshes by
//! Just Flipping Edges" (2020), with faces unfolded in place of edges flipped. Each step makes the
//! path shorter, and there are finitely many rows of straight pieces below a length, so it ends.

use std::collections::VecDeque;
use std::f64::consts::PI;

use geobench_mesh::vector::{Point as Vector, cross_2d, dot, norm, sub, turned};
use geobench_mesh::{FaceId, HalfEdgeId, Mesh, VertexId};

use crate::lines::{LineDirection, PLACE};
use crate::path::{Path, PathPlace, Point};
use crate::turn::{BEND, EdgeCrossing, SideTurn};

/// Greatest sine of the angle by which a path passes a vertex and counts as passing through it.
const THROUGH: f64 = 1e-14;

/// Least part of two pieces by which their replacement is shorter beyond rounding.
const GAIN: f64 = 1e-14;

impl Path {
    /// A path that is not longer and cannot be made shorter by a small change, found by making this
    /// one shorter bit by bit: a *locally shortest* path. It is in the same homotopy class, that
    /// is, between both no hole and no handle lies. The shortest path of all may be in another
    /// class.
    ///
    /// The path is straight across every edge and bends at vertices only, with an angle of at least
    /// π on both sides, up to rounding: at the boundary, and where the angles around a vertex have
    /// a sum above 2π.
    ///
    /// The ends stay. If the path is `closed`, so that its last point is its first, that point
    /// moves as the others, and the result is a closed geodesic. If the path can be contracted,
    /// there may be none: the result is then a single point, of length 0. On a surface of one side
    /// a path that returns with its sides exchanged stays at one vertex, where it may bend.
    ///
    /// `None` if an end is no vertex of `mesh`, if the path leaves the surface, or if it is
    /// `closed` and its ends differ.
    ///
    /// Each step is that of Sharp and Crane, "You Can Find Geodesic Paths in Triangle Meshes by
    /// Just Flipping Edges" (2020): where the angle on one side of a vertex is below π, the path
    /// takes the shortest way across the faces on that side. The funnel algorithm of Lee and
    /// Preparata (1984) finds that way, in O(faces crossed). The number of steps is finite, without
    /// a known bound.
    ///
    /// ```
    /// use geobench_mesh::Mesh;
    /// use geobench_paths::{Path, Paths};
    /// use geobench_vtp::VtpFast;
    /// use geobench_window::Goal;
    ///
    /// // Around the corner of a square, then straight.
    /// let mesh = Mesh::generate("grid,n=4")?;
    /// let mut solver = VtpFast::new(&mesh);
    /// let one = Paths::find(&mut solver, &mesh, 0, &Goal::targets([4]))?.to(4.into())?;
    /// let other = Paths::find(&mut solver, &mesh, 4, &Goal::targets([24]))?.to(24.into())?;
    /// let path = Path::joined(one.into_iter().chain(other));
    /// let shorter = path.shortened(&mesh, false).expect("its ends are vertices");
    /// assert!(path.length == 8.0 && (shorter.length - 32.0_f64.sqrt()).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn shortened(&self, mesh: &Mesh, closed: bool) -> Option<Self> {
        let mut curve = PieceRow::along(mesh, self)?;
        if closed {
            if self.points.first()?.vertex() != self.points.last()?.vertex() {
                return None;
            }
            curve.shorten_closed();
        } else {
            curve.shorten(0);
        }
        let shorter = curve.to_path();
        // Beside faces without area, which cannot be unfolded, nothing may be gained.
        let is_longer = shorter.length > (1.0 + GAIN) * self.length;
        Some(if is_longer { self.clone() } else { shorter })
    }
}

/// A straight line between two vertices.
#[derive(Clone, Debug)]
struct LinePiece {
    ends: [VertexId; 2],
    length: f64,
    /// The directions of the line at its start and, back, at its end.
    directions: [LineDirection; 2],
    crossings: Vec<EdgeCrossing>,
    /// For each crossing the place on its `to`, from 0 at the tail to 1 at the head.
    places: Vec<f64>,
}

/// A row of pieces, each from the end of the one before.
struct PieceRow<'a> {
    mesh: &'a Mesh,
    pieces: Vec<LinePiece>,
    /// The point that is left if there are no pieces.
    start: VertexId,
    /// How many more steps may be no shorter beyond rounding.
    patience: usize,
}

impl<'a> PieceRow<'a> {
    /// The curve along `path`; `None` if its ends are no vertices of `mesh` or it is not on it.
    fn along(mesh: &'a Mesh, path: &Path) -> Option<Self> {
        let is_on_edge = |point: &&Point| point.place != PathPlace::Face;
        let points: Vec<&Point> = path.points.iter().filter(is_on_edge).collect();
        let start = path.points.first()?.vertex()?;
        path.points.last()?.vertex()?;
        let mut all = points.iter().flat_map(|point| corners_of(point));
        if all.any(|v| v.index() >= mesh.vertex_count()) {
            return None;
        }
        let mut curve = Self {
            mesh,
            pieces: Vec::new(),
            start,
            patience: 1000 + 10 * points.len(),
        };
        let (mut from, mut face) = (start, None);
        let mut crossings = Vec::new();
        for pair in points.windows(2) {
            let [x, y] = [pair[0], pair[1]];
            let next = if x.vertex().is_some() && y.vertex().is_some() {
                None
            } else {
                Some(common_face(mesh, [x, y], face)?)
            };
            if let (PathPlace::Edge { ends, .. }, Some(face), Some(next)) = (x.place, face, next)
                && face != next
            {
                let from = side_of(mesh, face, ends)?;
                let to = side_of(mesh, next, ends)?;
                crossings.push(EdgeCrossing { from, to });
            }
            face = next;
            if let Some(v) = y.vertex() {
                let pieces = tightened(mesh, from, std::mem::take(&mut crossings), v)?;
                curve.pieces.extend(pieces);
                (from, face) = (v, None);
            }
        }
        Some(curve)
    }

    /// The turn between two pieces, the second from the end of the first.
    fn turn(&self, [before, after]: [&LinePiece; 2]) -> SideTurn {
        let directions = [before.directions[1], after.directions[0]];
        SideTurn::least(self.mesh, after.ends[0], directions)
    }

    fn is_straight(&self, turn: &SideTurn, [before, after]: [&LinePiece; 2]) -> bool {
        let lengths = [before.length, after.length];
        turn.is_straight(self.mesh, after.ends[0], lengths, BEND)
    }

    /// Whether pieces may take the place of some of this `length`: whether they are not longer.
    /// Steps that gain nothing but rounding are counted, so that there is an end to them.
    fn accepts(&mut self, pieces: &[LinePiece], length: f64) -> bool {
        let new = length_of(pieces);
        if new < (1.0 - GAIN) * length {
            return true;
        }
        self.patience = self.patience.saturating_sub(1);
        let rounding = PLACE * self.mesh.longest_edge();
        self.patience > 0 && new <= (1.0 + GAIN) * length + rounding
    }

    /// Makes the curve straight at the vertices between its pieces, from the end of piece `first`
    /// on. Returns whether it has changed.
    fn shorten(&mut self, first: usize) -> bool {
        let mut has_changed = false;
        let mut i = first;
        while i + 1 < self.pieces.len() {
            let pair = [&self.pieces[i], &self.pieces[i + 1]];
            let turn = self.turn(pair);
            if self.is_straight(&turn, pair) {
                i += 1;
                continue;
            }
            let [before, after] = pair;
            let length = before.length + after.length;
            let crossings = [&before.crossings[..], &turn.crossings, &after.crossings].concat();
            let pieces = tightened(self.mesh, before.ends[0], crossings, after.ends[1]);
            match pieces {
                Some(pieces) if self.accepts(&pieces, length) => {
                    self.pieces.splice(i..i + 2, pieces);
                    i = i.saturating_sub(1);
                    has_changed = true;
                }
                _ => i += 1,
            }
        }
        has_changed
    }

    /// As [`shorten`](Self::shorten), and at the first vertex, where the curve ends, as well.
    fn shorten_closed(&mut self) {
        self.shorten(0);
        // The vertices at which the curve was not made straight since it last changed.
        let mut done = 0;
        while done < self.pieces.len() {
            let last = self.pieces.len() - 1;
            let pair = [&self.pieces[last], &self.pieces[0]];
            let turn = self.turn(pair);
            if self.is_straight(&turn, pair) {
                return;
            }
            done += 1;
            if last == 0 {
                let old = self.pieces[0].length;
                match self.moved_on(&turn) {
                    Some(pieces) if self.accepts(&pieces, old) => self.pieces = pieces,
                    _ => return,
                }
                self.shorten(0);
                done = 0;
            } else {
                // The first vertex becomes one between two pieces.
                self.pieces.rotate_left(1);
                if self.shorten(last - 1) {
                    done = 0;
                }
            }
        }
    }

    /// The shortest closed curve through the vertex that the only piece, a closed one, meets first
    /// when it becomes shorter where it takes `turn`.
    ///
    /// The faces that are crossed, those of the turn included, form a ring. Unfolded again and
    /// again they show the piece as a chain of equal sides with equal turns: part of a regular
    /// polygon. On its way to the centre each side moves parallel to itself, so the vertex met
    /// first is the one nearest to a side. `None` if the only piece cannot be unfolded.
    fn moved_on(&self, turn: &SideTurn) -> Option<Vec<LinePiece>> {
        let (mesh, piece) = (self.mesh, &self.pieces[0]);
        let v = piece.ends[0];
        let count = piece.crossings.len();
        let all = [&piece.crossings[..], &turn.crossings].concat();
        let ring = ring(&all);
        if ring.is_empty() {
            return Some(Vec::new());
        }
        let is_turned = |c: &&EdgeCrossing| mesh.tail(c.from) == mesh.tail(c.to);
        if all.iter().filter(is_turned).count() % 2 == 1 {
            // After one round the sides are exchanged.
            let least = least_loop(mesh, &ring)?;
            return (length_of(&least) < (1.0 - GAIN) * piece.length).then_some(least);
        }
        let strip = Strip::unfolded(mesh, &all)?;
        let first = &strip.portals[0];
        // The place of `v` after one round, and the side to which the curve moves: 0 is left.
        let (end, side) = match strip.portals.get(count) {
            Some(portal) if portal[0].vertex == v => (portal[0].at, 1),
            Some(portal) => (portal[1].at, 0),
            None => {
                let from_left = |k: usize| {
                    let (h, place) = (piece.crossings[k].to, piece.places[k]);
                    if mesh.tail(h) == first[0].vertex {
                        place
                    } else {
                        1.0 - place
                    }
                };
                (strip.end, usize::from(from_left(count - 1) > from_left(0)))
            }
        };
        let along = sub(end, strip.start);
        let along = along.map(|x| x / norm(along));
        let sign = if side == 0 { 1.0 } else { -1.0 };
        let (c, s) = (
            libm::cos(PI - turn.angle),
            sign * libm::sin(PI - turn.angle),
        );
        let by = |s: f64| [c * along[0] - s * along[1], s * along[0] + c * along[1]];
        let sides = [(strip.start, along), (strip.start, by(-s)), (end, by(s))];
        let height = |at: Vector| {
            let heights = sides.map(|(from, along)| cross_2d(along, sub(at, from)).abs());
            heights.into_iter().fold(f64::INFINITY, f64::min)
        };
        let corner = |j: usize| strip.portals[ring[j].0][side];
        let nearest = (0..ring.len()).min_by(|&i, &j| {
            let [a, b] = [i, j].map(|k| height(corner(k).at));
            a.total_cmp(&b)
        })?;
        loop_through(mesh, &ring, corner(nearest).vertex, nearest)
    }

    fn to_path(&self) -> Path {
        let mesh = self.mesh;
        let start = self
            .pieces
            .first()
            .map_or(self.start, |piece| piece.ends[0]);
        let mut path = Path {
            length: 0.0,
            points: vec![Point::at_vertex(mesh, start)],
        };
        for piece in &self.pieces {
            path.length += piece.length;
            for (crossing, &t) in piece.crossings.iter().zip(&piece.places) {
                let h = crossing.to;
                path.points
                    .push(Point::on_edge(h, [mesh.tail(h), mesh.head(h)], t));
            }
            path.points.push(Point::at_vertex(mesh, piece.ends[1]));
        }
        path
    }
}

/// The vertices between which a point of a path lies.
fn corners_of(point: &Point) -> Vec<VertexId> {
    match point.place {
        PathPlace::Vertex(v) => vec![v],
        PathPlace::Edge { ends, .. } => ends.to_vec(),
        PathPlace::Face => Vec::new(),
    }
}

/// The half-edge of `face` between `ends`.
fn side_of(mesh: &Mesh, face: FaceId, ends: [VertexId; 2]) -> Option<HalfEdgeId> {
    let mut sides = face.half_edges().into_iter();
    sides.find(|&h| {
        let [a, b] = [mesh.tail(h), mesh.head(h)];
        ends == [a, b] || ends == [b, a]
    })
}

/// The face across which a path runs from `x` to `y`, at least one of them on an edge, after it has
/// crossed the face `before`.
fn common_face(mesh: &Mesh, [x, y]: [&Point; 2], before: Option<FaceId>) -> Option<FaceId> {
    let ends = [x, y].into_iter().find_map(|point| match point.place {
        PathPlace::Edge { ends, .. } => Some(ends),
        _ => None,
    })?;
    let all = ends.into_iter().flat_map(|v| mesh.outgoing(v));
    let corners: Vec<VertexId> = [x, y].into_iter().flat_map(corners_of).collect();
    let contains = |face: &FaceId| {
        let own = mesh.face_vertices(*face);
        corners.iter().all(|v| own.contains(v))
    };
    // The face of a point on an edge is the one behind it.
    let unlikely = |face: &FaceId| match x.vertex() {
        None => [before == Some(*face), x.face != Some(*face)],
        Some(_) => [false, y.face == Some(*face)],
    };
    all.map(|h| h.face()).filter(contains).min_by_key(unlikely)
}

/// The crossings of a path without those that it takes back at once.
fn reduced(
    crossings: impl IntoIterator<Item = (usize, EdgeCrossing)>,
) -> VecDeque<(usize, EdgeCrossing)> {
    let mut kept: VecDeque<(usize, EdgeCrossing)> = VecDeque::new();
    for (i, next) in crossings {
        match kept.back_mut() {
            Some((_, last)) if last.to == next.from => {
                last.to = next.to;
                if last.from == last.to {
                    kept.pop_back();
                }
            }
            _ => kept.push_back((i, next)),
        }
    }
    kept
}

/// The crossings of a closed path, each with its place among `all`, without those that it takes
/// back at once.
fn ring(all: &[EdgeCrossing]) -> Vec<(usize, EdgeCrossing)> {
    let mut kept = reduced(all.iter().copied().enumerate());
    while kept.len() > 1 && kept[kept.len() - 1].1.to == kept[0].1.from {
        let first = kept.pop_front();
        let last = kept.pop_back();
        if let (Some((_, first)), Some((i, last))) = (first, last) {
            let both = EdgeCrossing {
                from: last.from,
                to: first.to,
            };
            if both.from != both.to {
                kept.push_back((i, both));
            }
        }
    }
    kept.into()
}

/// The shortest closed path from `v`, an end of the edge at the place `j` of a ring, once around
/// it. `None` as of [`tightened`].
fn loop_through(
    mesh: &Mesh,
    ring: &[(usize, EdgeCrossing)],
    v: VertexId,
    j: usize,
) -> Option<Vec<LinePiece>> {
    let around = ring[j + 1..].iter().chain(&ring[..=j]);
    tightened(mesh, v, around.map(|&(_, crossing)| crossing).collect(), v)
}

/// The shortest closed path through a vertex of a ring and once around.
fn least_loop(mesh: &Mesh, ring: &[(usize, EdgeCrossing)]) -> Option<Vec<LinePiece>> {
    let ends = |j: usize| {
        let h = ring[j].1.from;
        [mesh.tail(h), mesh.head(h)].map(|v| (v, j))
    };
    let loops = (0..ring.len())
        .flat_map(ends)
        .filter_map(|(v, j)| loop_through(mesh, ring, v, j));
    loops.min_by(|a, b| length_of(a).total_cmp(&length_of(b)))
}

fn length_of(pieces: &[LinePiece]) -> f64 {
    pieces.iter().map(|piece| piece.length).sum()
}

/// The shortest path from `start` to `end` across the faces between `crossings`; without pieces if
/// both are one point. `None` if they are not on a row of faces.
fn tightened(
    mesh: &Mesh,
    start: VertexId,
    crossings: Vec<EdgeCrossing>,
    end: VertexId,
) -> Option<Vec<LinePiece>> {
    let kept = reduced(crossings.into_iter().enumerate());
    let mut crossings: Vec<EdgeCrossing> = kept.into_iter().map(|(_, crossing)| crossing).collect();
    // A path that starts by turning around its start starts in the last face of the turn.
    let turns = crossings.iter().take_while(|c| c.touches(mesh, start));
    crossings.drain(..turns.count());
    while crossings.last().is_some_and(|c| c.touches(mesh, end)) {
        crossings.pop();
    }
    if crossings.is_empty() {
        return if start == end {
            Some(Vec::new())
        } else {
            Some(vec![LinePiece::along_edge(mesh, [start, end])?])
        };
    }
    let strip = Strip::unfolded(mesh, &crossings)?;
    let stops = strip.funnel(start, end);
    let pieces = stops.windows(2).map(|pair| {
        let (from, to) = (&pair[0], &pair[1]);
        let between = crossings.get(from.after..to.first).unwrap_or(&[]);
        LinePiece::straight(mesh, [from.vertex, to.vertex], between)
    });
    pieces.collect()
}

impl LinePiece {
    /// The line along the edge between `ends`.
    fn along_edge(mesh: &Mesh, ends: [VertexId; 2]) -> Option<Self> {
        let [from, to] = ends;
        let length = mesh.neighbours(from).find(|&(v, _)| v == to)?.1;
        Some(Self {
            ends,
            length,
            directions: [
                LineDirection::of_edge(mesh, from, to)?,
                LineDirection::of_edge(mesh, to, from)?,
            ],
            crossings: Vec::new(),
            places: Vec::new(),
        })
    }

    /// The line across `crossings`, which it meets up to rounding.
    fn straight(mesh: &Mesh, ends: [VertexId; 2], crossings: &[EdgeCrossing]) -> Option<Self> {
        let (Some(first), Some(last)) = (crossings.first(), crossings.last()) else {
            return Self::along_edge(mesh, ends);
        };
        let strip = Strip::unfolded(mesh, crossings)?;
        let way = sub(strip.end, strip.start);
        let place = |([left, right], c): (&[StripCorner; 2], &EdgeCrossing)| {
            let [a, b] = [left, right].map(|corner| cross_2d(way, sub(corner.at, strip.start)));
            let t = if a > b { a / (a - b) } else { 0.5 };
            let t = t.clamp(0.0, 1.0);
            if mesh.tail(c.to) == left.vertex {
                t
            } else {
                1.0 - t
            }
        };
        let places: Vec<f64> = strip.portals.iter().zip(crossings).map(place).collect();
        let direction = |h: HalfEdgeId, at: Vector, corner: &StripCorner, way: Vector| {
            let along = sub(corner.at, at);
            LineDirection {
                corner: h.prev(),
                angle: libm::atan2(cross_2d(along, way).abs(), dot(along, way)),
            }
        };
        let tail_of = |h: HalfEdgeId, portal: &[StripCorner; 2]| {
            portal[usize::from(portal[0].vertex != mesh.tail(h))]
        };
        let entered = tail_of(first.from, strip.portals.first()?);
        let left = tail_of(last.to, strip.portals.last()?);
        Some(Self {
            ends,
            length: length_along(mesh, crossings, &places),
            directions: [
                direction(first.from, strip.start, &entered, way),
                direction(last.to, strip.end, &left, way.map(|x| -x)),
            ],
            places,
            crossings: crossings.to_vec(),
        })
    }
}

/// The length of the path from the vertex opposite to the first edge over the `places` on all edges
/// to the vertex opposite to the last, face by face. Faces without area cannot be unfolded, but
/// this length holds.
fn length_along(mesh: &Mesh, crossings: &[EdgeCrossing], places: &[f64]) -> f64 {
    let mut sum = 0.0;
    let mut entered: Option<(HalfEdgeId, f64)> = None;
    for (crossing, &place) in crossings.iter().zip(places) {
        let h = crossing.from;
        let is_same = mesh.tail(h) == mesh.tail(crossing.to);
        let at = if is_same { place } else { 1.0 - place };
        let (l, apex) = (mesh.length(h), mesh.apex(h));
        let before = match entered {
            None => apex,
            // On the side from the head to the apex, or on that from the apex to the tail.
            Some((side, t)) if side == h.next() => [l + t * (apex[0] - l), t * apex[1]],
            Some((_, t)) => apex.map(|x| (1.0 - t) * x),
        };
        sum += norm(sub([at * l, 0.0], before));
        entered = Some((crossing.to, place));
    }
    entered.map_or(sum, |(h, t)| {
        sum + norm(sub(mesh.apex(h), [t * mesh.length(h), 0.0]))
    })
}

/// A vertex of an unfolded strip.
#[derive(Clone, Copy, Debug)]
struct StripCorner {
    vertex: VertexId,
    at: Vector,
}

/// A row of faces, unfolded into the plane.
struct Strip {
    /// The vertex of the first face that is not on the first edge.
    start: Vector,
    /// The ends of each crossed edge, the left one first.
    portals: Vec<[StripCorner; 2]>,
    /// The vertex of the last face that is not on the last edge.
    end: Vector,
}

/// A vertex on the shortest path across a strip.
struct FunnelStop {
    vertex: VertexId,
    /// The first portal that it is on, and the one after the last.
    first: usize,
    after: usize,
}

impl Strip {
    /// The faces between `crossings`, and those before and behind. `None` without any.
    fn unfolded(mesh: &Mesh, crossings: &[EdgeCrossing]) -> Option<Self> {
        let h = crossings.first()?.from;
        let corner = |vertex, at| StripCorner { vertex, at };
        let mut portal = [
            corner(mesh.head(h), [mesh.length(h), 0.0]),
            corner(mesh.tail(h), [0.0; 2]),
        ];
        let start = mesh.apex(h);
        let mut end = start;
        let mut portals = Vec::with_capacity(crossings.len());
        for (i, crossing) in crossings.iter().enumerate() {
            portals.push(portal);
            let [left, right] = portal;
            let to = crossing.to;
            let (l, [x, y]) = (mesh.length(to), mesh.apex(to));
            let across = turned(sub(right.at, left.at));
            let (tail, head) = if mesh.tail(to) == left.vertex {
                (left, right)
            } else {
                (right, left)
            };
            let along = sub(head.at, tail.at);
            end = [0, 1].map(|k| tail.at[k] + x / l * along[k] + y / l * across[k]);
            let apex = corner(mesh.apex_vertex(to), end);
            if let Some(next) = crossings.get(i + 1) {
                let stays = usize::from(!next.touches(mesh, left.vertex));
                portal[1 - stays] = apex;
            }
        }
        Some(Self {
            start,
            portals,
            end,
        })
    }

    /// The vertices of the shortest path from the start to the end of the strip: these, and those
    /// at which it bends.
    fn funnel(&self, start: VertexId, end: VertexId) -> Vec<FunnelStop> {
        let mut funnel = Funnel::new(StripCorner {
            vertex: start,
            at: self.start,
        });
        let mut current: [Option<usize>; 2] = [None; 2];
        for (i, portal) in self.portals.iter().enumerate() {
            for side in [0, 1] {
                let corner = portal[side];
                let stays =
                    current[side].filter(|&k| funnel.points[k].corner.vertex == corner.vertex);
                let k = stays.unwrap_or_else(|| funnel.add(side, corner, i));
                funnel.points[k].after = i + 1;
                current[side] = Some(k);
            }
        }
        let target = StripCorner {
            vertex: end,
            at: self.end,
        };
        let mut last = Some(funnel.add(0, target, self.portals.len()));
        let mut stops = Vec::new();
        while let Some(k) = last {
            let point = &funnel.points[k];
            stops.push(FunnelStop {
                vertex: point.corner.vertex,
                first: point.first,
                after: point.after,
            });
            last = point.before;
        }
        stops.reverse();
        stops
    }
}

/// A corner that the funnel has met.
struct FunnelPoint {
    corner: StripCorner,
    /// The first portal that it is on, and the one after the last.
    first: usize,
    after: usize,
    /// The point before it on the shortest path to it.
    before: Option<usize>,
}

/// The shortest paths to both ends of a portal. They part at the apex.
struct Funnel {
    points: Vec<FunnelPoint>,
    apex: usize,
    /// The points behind the apex, on the left and on the right.
    chains: [VecDeque<usize>; 2],
}

impl Funnel {
    fn new(start: StripCorner) -> Self {
        Self {
            points: vec![FunnelPoint {
                corner: start,
                first: 0,
                after: 0,
                before: None,
            }],
            apex: 0,
            chains: [VecDeque::new(), VecDeque::new()],
        }
    }

    /// Whether the way from `a` over `b` to `to` turns to the side on which `b` is, so that it is
    /// the shortest one around `b`, or is straight.
    fn turns(&self, side: usize, [a, b]: [usize; 2], to: Vector) -> bool {
        let [a, b] = [a, b].map(|k| self.points[k].corner.at);
        let (one, two) = (sub(b, a), sub(to, b));
        let turn = cross_2d(one, two);
        let turn = if side == 0 { turn } else { -turn };
        let straight = THROUGH * norm(one) * norm(two);
        turn > straight || turn >= -straight && dot(one, two) > 0.0
    }

    /// Adds the next corner on `side`, 0 for the left, which is first on a portal `at`. Returns its
    /// number.
    fn add(&mut self, side: usize, corner: StripCorner, at: usize) -> usize {
        let to = corner.at;
        while let Some(&b) = self.chains[side].back() {
            let count = self.chains[side].len();
            let a = count
                .checked_sub(2)
                .map_or(self.apex, |i| self.chains[side][i]);
            if self.turns(side, [a, b], to) {
                break;
            }
            self.chains[side].pop_back();
        }
        if self.chains[side].is_empty() {
            // The path to the corner follows the other chain as far as that is in the way.
            while let Some(&b) = self.chains[1 - side].front() {
                if !self.turns(1 - side, [self.apex, b], to) {
                    break;
                }
                self.apex = b;
                self.chains[1 - side].pop_front();
            }
        }
        let before = self.chains[side].back().copied().unwrap_or(self.apex);
        let number = self.points.len();
        self.points.push(FunnelPoint {
            corner,
            first: at,
            after: at,
            before: Some(before),
        });
        self.chains[side].push_back(number);
        number
    }
}
