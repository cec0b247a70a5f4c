//! A judge of shortest paths.

use std::collections::{HashMap, HashSet};
use std::error::Error;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt;

use crate::scalar::RealNumber;
use crate::surface::{PreciseSurface, next, prev};

/// Greatest difference between a path and the distance of its target, as a fraction of the
/// distance.
const LENGTH: f64 = 1e-12;

/// Greatest distance of a path from the straight line, as a fraction of the line.
const STRAIGHT: f64 = 1e-11;

/// Rounding of a position on a side, as a fraction of the longest side: of those that the path
/// meets where it is to be straight, of all sides where it is to be as long as a distance.
const PLACE: f64 = 1e-15;

/// Most steps of ways around a vertex that are tried. Only junctions have more ways than two.
const MOST_TURNS: usize = 100_000;

/// A point of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JudgedPoint {
    /// A vertex.
    Vertex(u32),
    /// A point on an edge, which the path crosses.
    Edge {
        /// A triangle with this edge; if there are more than two, the one that the path enters.
        triangle: u32,
        /// The vertices of the edge.
        ends: [u32; 2],
        /// Position between them: 0 at the first vertex, 1 at the second.
        t: f64,
    },
}

/// What is wrong with a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathFlaw {
    /// The path does not start at a source or does not end at the target.
    Ends,
    /// The path does not go on across one triangle, or along one edge, from this point to the next;
    /// or it returns across the edge on which the point lies; or it meets a triangle twice.
    Broken(usize),
    /// The path, as told or as measured, is not as long as the distance.
    Length(f64),
    /// The path is not straight at this point, by this distance from the straight line.
    Bent(usize, f64),
}

impl fmt::Display for PathFlaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ends => write!(f, "it does not lead from a source to the target"),
            Self::Broken(i) => write!(f, "it is broken at point {i}"),
            Self::Length(by) => write!(f, "it exceeds the distance by {by:e}"),
            Self::Bent(i, by) => write!(f, "it is bent at point {i}, by {by:e}"),
        }
    }
}

impl Error for PathFlaw {}

/// A straight piece of a path, between two vertices.
struct StraightPiece<S> {
    /// The numbers of its first and its last point.
    ends: [usize; 2],
    /// Length of the straight line in the plane into which the triangles are unfolded.
    straight: S,
    /// Length along the points.
    length: S,
    /// The direction at both ends: a side that leaves the vertex, and the angle from it.
    directions: [(usize, f64); 2],
    /// The point farthest from the straight line, and its distance.
    farthest: (usize, S),
    /// The longest side of the triangles met.
    longest: S,
    /// The triangles crossed.
    triangles: Vec<usize>,
}

/// A way around a vertex, up to an edge.
struct Turn {
    /// The edge, named by its other end.
    edge: usize,
    /// The angle from the direction where the way begins.
    angle: f64,
    /// How far the nearest vertex is between that direction and the edge.
    nearest: f64,
    /// The corner through which the way has come to the edge.
    through: usize,
    /// Number of edges before this one.
    before: usize,
}

/// What a path could be moved by at a vertex that it passes.
struct Room {
    /// How far it could be moved to a side where the angle is below π: up to the nearest vertex
    /// there, or up to a straight line.
    room: f64,
    /// The longest edge at the vertex.
    longest: f64,
}

/// Checks that `points` are a shortest path from one of `sources` to `target`, whose distance is
/// `distance`; `told` is its length as the program tells it.
///
/// The path must lead from triangle to triangle, and cross none twice. It must be as long as it is
/// told to be, and as the distance, to 1e-12 and the rounding of its points, straight wherever it
/// crosses an edge, and have an angle of at least π on both sides of each vertex that it passes. A
/// smaller angle is allowed where the vertices beside it leave no room for a shortcut that is
/// longer than rounding. Lines and angles are measured with all digits of `S`.
///
/// ```
/// use geobench_oracle::{DoubleDouble, Model, PathFlaw, JudgedPoint, judge_path};
///
/// // A square cut along the diagonal from 1 to 2.
/// let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
/// let model = Model::new("square", positions.to_vec(), vec![[0, 1, 2], [1, 3, 2]]);
/// let surface = model.surface::<DoubleDouble>();
/// let across = |t| {
///     let crossing = JudgedPoint::Edge { triangle: 0, ends: [1, 2], t };
///     [JudgedPoint::Vertex(0), crossing, JudgedPoint::Vertex(3)]
/// };
/// let d = 2.0_f64.sqrt();
/// assert_eq!(judge_path(&surface, &across(0.5), &[0], 3, [d, d]), Ok(()));
/// let bent = judge_path(&surface, &across(0.5 + 1e-9), &[0], 3, [d, d]);
/// assert!(matches!(bent, Err(PathFlaw::Bent(1, _))));
/// ```
///
/// # Errors
///
/// What is wrong with the path.
pub fn judge_path<S: RealNumber>(
    surface: &PreciseSurface<S>,
    points: &[JudgedPoint],
    sources: &[u32],
    target: u32,
    [distance, told]: [f64; 2],
) -> Result<(), PathFlaw> {
    match (points.first(), points.last()) {
        (Some(JudgedPoint::Vertex(source)), Some(JudgedPoint::Vertex(last)))
            if sources.contains(source) && *last == target => {}
        _ => return Err(PathFlaw::Ends),
    }
    let pieces = surface.pieces(points)?;
    let mut triangles: Vec<(usize, usize)> = Vec::new();
    for piece in &pieces {
        triangles.extend(piece.triangles.iter().map(|&t| (t, piece.ends[0])));
    }
    triangles.sort_unstable();
    if let Some(twice) = triangles.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        return Err(PathFlaw::Broken(twice[1].1));
    }
    let joints: Vec<_> = pieces.windows(2).map(|pair| [&pair[0], &pair[1]]).collect();
    surface.judge_pieces(&pieces, &joints, [distance, told])
}

/// Checks that `points`, from one vertex to another, are a geodesic: as [`judge_path`] for the
/// distance `told`, which is its length as the program tells it; but the path may cross a triangle
/// twice. If it is `closed`, it ends where it starts, and goes on there as at other vertices.
///
/// # Errors
///
/// What is wrong with the path.
pub fn judge_geodesic<S: RealNumber>(
    surface: &PreciseSurface<S>,
    points: &[JudgedPoint],
    closed: bool,
    told: f64,
) -> Result<(), PathFlaw> {
    let is_vertex = |point: Option<&JudgedPoint>| matches!(point, Some(JudgedPoint::Vertex(_)));
    if !is_vertex(points.first())
        || !is_vertex(points.last())
        || closed && points.first() != points.last()
    {
        return Err(PathFlaw::Ends);
    }
    let pieces = surface.pieces(points)?;
    let mut joints: Vec<_> = pieces.windows(2).map(|pair| [&pair[0], &pair[1]]).collect();
    if let (true, Some(first), Some(last)) = (closed, pieces.first(), pieces.last()) {
        joints.push([last, first]);
    }
    surface.judge_pieces(&pieces, &joints, [told; 2])
}

impl<S: RealNumber> PreciseSurface<S> {
    /// The straight pieces between the vertices of a path.
    fn pieces(&self, points: &[JudgedPoint]) -> Result<Vec<StraightPiece<S>>, PathFlaw> {
        let is_vertex = |i: &usize| matches!(points[*i], JudgedPoint::Vertex(_));
        let at_vertices: Vec<usize> = (0..points.len()).filter(is_vertex).collect();
        let pieces = at_vertices.windows(2);
        let pieces = pieces.map(|ends| self.piece(points, [ends[0], ends[1]]));
        pieces.collect()
    }

    /// Checks that all `pieces` are straight, and the path as well where two of them meet, its
    /// `joints`; and that the length, as measured and as `told`, is the distance.
    fn judge_pieces(
        &self,
        pieces: &[StraightPiece<S>],
        joints: &[[&StraightPiece<S>; 2]],
        [distance, told]: [f64; 2],
    ) -> Result<(), PathFlaw> {
        let bends = joints.iter().map(|pair| {
            let directions = [pair[0].directions[1], pair[1].directions[0]];
            self.room(directions, [0, 1].map(|k| pair[k].straight.to_f64()))
        });
        let bends: Vec<Room> = bends.collect();
        let points = 1 + pieces.last().map_or(0, |piece| piece.ends[1]);
        let longest = pieces.iter().map(|piece| piece.longest.to_f64());
        let longest = longest.chain(bends.iter().map(|bend| bend.longest));
        let rounding = PLACE * longest.fold(0.0, f64::max) * points as f64;
        let lengths = pieces.iter().map(|piece| piece.length);
        let length = lengths.fold(S::zero(), |sum, l| sum + l);
        // The distance may be the difference of greater ones, elsewhere on the surface.
        let sides = self.sides.iter().map(|side| side.length.to_f64());
        let of_surface = PLACE * sides.fold(0.0, f64::max) * points as f64;
        let (distance, told) = (S::from_f64(distance), S::from_f64(told));
        for (by, rounding) in [
            (told - distance, of_surface),
            (length - distance, of_surface),
            // The path itself has the rounding of its own triangles only.
            (length - told, rounding),
        ] {
            let by = by.to_f64();
            if by.is_nan() || by.abs() > LENGTH * distance.to_f64() + rounding {
                return Err(PathFlaw::Length(by));
            }
        }
        let is_bent = |by: f64, length: f64| by.is_nan() || by > STRAIGHT * length + rounding;
        for piece in pieces {
            let (point, by) = piece.farthest;
            if is_bent(by.to_f64(), piece.straight.to_f64()) {
                return Err(PathFlaw::Bent(point, by.to_f64()));
            }
        }
        for (pair, bend) in joints.iter().zip(bends) {
            let [before, after] = [0, 1].map(|k| pair[k].straight.to_f64());
            if is_bent(bend.room, before + after) {
                return Err(PathFlaw::Bent(pair[0].ends[1], bend.room));
            }
        }
        Ok(())
    }

    /// The vertex opposite to a side.
    fn third(&self, side: usize) -> usize {
        self.sides[prev(side)].tail
    }

    fn head(&self, side: usize) -> usize {
        self.sides[next(side)].tail
    }

    /// The two sides of the edge of `point`, the one of its triangle first, and its position from
    /// the tail of that one.
    fn edge(&self, point: JudgedPoint) -> Option<(usize, S)> {
        let JudgedPoint::Edge { triangle, ends, t } = point else {
            return None;
        };
        let t = S::from_f64(t);
        let is_inside = t >= S::zero() && t <= S::from_f64(1.0);
        let sides = (0..3).map(|k| 3 * triangle as usize + k);
        let mut sides = sides.filter(|&side| side < self.sides.len() && is_inside);
        sides.find_map(|side| {
            let found = [self.sides[side].tail as u32, self.head(side) as u32];
            if found == ends {
                Some((side, t))
            } else if found == [ends[1], ends[0]] {
                Some((side, S::from_f64(1.0) - t))
            } else {
                None
            }
        })
    }

    /// The piece between two vertices, the points with the numbers `ends`.
    fn piece(
        &self,
        points: &[JudgedPoint],
        [first, last]: [usize; 2],
    ) -> Result<StraightPiece<S>, PathFlaw> {
        let broken = |i| PathFlaw::Broken(i);
        let (JudgedPoint::Vertex(from), JudgedPoint::Vertex(to)) = (points[first], points[last])
        else {
            return Err(broken(first));
        };
        let [from, to] = [from, to].map(|v| v as usize);
        if last == first + 1 {
            return self
                .along_edge([from, to], [first, last])
                .ok_or(broken(first));
        }
        // A triangle and its neighbour may have all their vertices in common.
        let (side, _) = self.edge(points[first + 1]).ok_or(broken(first + 1))?;
        let others = self.beyond[side].iter().map(|beyond| beyond.side);
        let starts = [side].into_iter().chain(others);
        let starts = starts.filter(|&side| self.third(side) == from);
        let mut found = Err(broken(first));
        for start in starts {
            found = self.across(points, [first, last], start, to);
            if found.is_ok() {
                break;
            }
        }
        found
    }

    fn along_edge(&self, [from, to]: [usize; 2], ends: [usize; 2]) -> Option<StraightPiece<S>> {
        let along = |from: usize, to: usize| {
            let mut leaving = self.leaving[from].iter().copied();
            leaving.find(|&side| self.head(side) == to)
        };
        // The edge at its other end: the side of the next triangle, or that of the same triangle.
        let direction = |from: usize, to: usize| {
            let forward = along(from, to).map(|side| (side, 0.0));
            forward.or_else(|| along(to, from).map(|side| (next(side), self.angle(next(side)))))
        };
        let directions = [direction(from, to)?, direction(to, from)?];
        let side = along(from, to).or_else(|| along(to, from))?;
        let straight = self.sides[side].length;
        Some(StraightPiece {
            ends,
            straight,
            length: straight,
            directions,
            farthest: (ends[0], S::zero()),
            longest: straight,
            triangles: Vec::new(),
        })
    }

    /// The piece that leaves its first vertex through `start`, a side of the first triangle.
    fn across(
        &self,
        points: &[JudgedPoint],
        [first, last]: [usize; 2],
        start: usize,
        to: usize,
    ) -> Result<StraightPiece<S>, PathFlaw> {
        // The triangle of `side` has been crossed; `ends` are the positions of its tail and head in
        // the plane. It is on the left of the side, or on its right if it is `turned` over.
        let mut side = start;
        let mut turned = false;
        let mut ends = [[S::zero(); 2], [self.sides[side].length, S::zero()]];
        let mut places = vec![self.sides[side].apex];
        let mut triangles = vec![side / 3];
        let mut longest = S::zero();
        for i in first + 1..last {
            let (of_triangle, t) = self.edge(points[i]).ok_or(PathFlaw::Broken(i))?;
            let has_direction = self.sides[of_triangle].tail == self.sides[side].tail;
            let t = if has_direction {
                t
            } else {
                S::from_f64(1.0) - t
            };
            // Of an edge with more than two triangles, a point names the one that the path enters.
            let others = self.beyond[side].iter();
            let mut others = others.filter(|other| match of_triangle {
                named if named == side => self.beyond[side].len() == 1,
                named => other.side == named || self.beyond[side].len() == 1,
            });
            if of_triangle != side && self.beyond[side].iter().all(|o| o.side != of_triangle) {
                return Err(PathFlaw::Broken(i));
            }
            places.push(between(ends, t));
            let beyond = others.next().ok_or(PathFlaw::Broken(i))?;
            let is_same = beyond.turned;
            let beyond = beyond.side;
            for side in [side, next(side), prev(side), next(beyond), prev(beyond)] {
                longest = longest.max(self.sides[side].length);
            }
            // The tail and the head of the side of the next triangle.
            let [tail, head] = if is_same { ends } else { [ends[1], ends[0]] };
            turned ^= is_same;
            let frame = self.sides[beyond];
            let along = [0, 1].map(|k| (head[k] - tail[k]) / frame.length);
            let [x, y] = frame.apex;
            let y = if turned { -y } else { y };
            let apex = [
                tail[0] + along[0] * x - along[1] * y,
                tail[1] + along[1] * x + along[0] * y,
            ];
            triangles.push(beyond / 3);
            if i + 1 == last {
                places.push(apex);
                if self.third(beyond) != to {
                    return Err(PathFlaw::Broken(i));
                }
                side = beyond;
                ends = [tail, head];
                break;
            }
            let (on, _) = self.edge(points[i + 1]).ok_or(PathFlaw::Broken(i + 1))?;
            let is_on = |side: usize| on == side || self.beyond[on].iter().any(|o| o.side == side);
            (side, ends) = if is_on(next(beyond)) {
                (next(beyond), [head, apex])
            } else if is_on(prev(beyond)) {
                (prev(beyond), [apex, tail])
            } else {
                return Err(PathFlaw::Broken(i));
            };
        }
        let (start_place, end_place) = (places[0], places[places.len() - 1]);
        let line = minus(end_place, start_place);
        let straight = norm(line);
        // Beside a triangle without area, the first crossing may be at the vertex itself. So the
        // directions are those of the whole line.
        let back = [-line[0], -line[1]];
        // Back along a side, rounding decides between -π and π: within a triangle it is π.
        let within = |angle: f64| {
            if angle < -FRAC_PI_2 {
                angle + TAU
            } else {
                angle
            }
        };
        let at_start = turn(minus([S::zero(); 2], start_place), line);
        let at_end = turn(minus(ends[0], end_place), back);
        let directions = [
            (prev(start), within(at_start)),
            (prev(side), within(if turned { -at_end } else { at_end })),
        ];
        let mut farthest = (first, S::zero());
        let mut length = S::zero();
        let mut reached = S::zero();
        for (i, pair) in places.windows(2).enumerate() {
            length = length + norm(minus(pair[1], pair[0]));
            let [x, y] = minus(pair[1], start_place);
            let across = (line[0] * y - line[1] * x) / straight;
            let along = (line[0] * x + line[1] * y) / straight;
            // A step back is a deviation as well.
            let off = across.max(-across).max(reached - along);
            reached = reached.max(along);
            if off.to_f64().is_nan() || off > farthest.1 {
                farthest = (first + i + 1, off);
            }
        }
        Ok(StraightPiece {
            ends: [first, last],
            straight,
            length,
            directions,
            farthest,
            longest,
            triangles,
        })
    }

    /// The angle of a triangle at the tail of `side`.
    fn angle(&self, side: usize) -> f64 {
        let [x, y] = self.sides[side].apex;
        y.to_f64().atan2(x.to_f64())
    }

    /// The room at a vertex. `directions` are those of the pieces before and after it, and
    /// `lengths` their lengths.
    ///
    /// A way from one direction to the other turns around the vertex from edge to edge, within
    /// triangles, and from an edge of several triangles into each of them. Of all ways of less than
    /// π, up to [`MOST_TURNS`] steps of them, the one with the most room counts.
    fn room(&self, directions: [(usize, f64); 2], lengths: [f64; 2]) -> Room {
        let [(start, at_start), (end, at_end)] = directions;
        let corners = &self.leaving[self.sides[start].tail];
        // Edges are named by their other ends.
        let mut at_edge: HashMap<usize, Vec<usize>> = HashMap::new();
        let mut spokes: HashMap<usize, f64> = HashMap::new();
        for &corner in corners {
            let edges = [
                (self.head(corner), corner),
                (self.third(corner), prev(corner)),
            ];
            for (edge, side) in edges {
                at_edge.entry(edge).or_default().push(corner);
                spokes.insert(edge, self.sides[side].length.to_f64());
            }
        }
        let longest = spokes.values().copied().fold(0.0, f64::max);
        let free = lengths[0].min(lengths[1]);
        let mut most = 0.0_f64;
        if start == end {
            most = (PI - (at_start - at_end).abs()) * free;
        }
        let first = |edge, angle| Turn {
            edge,
            angle,
            nearest: free,
            through: start,
            before: 0,
        };
        let last = self.angle(start) - at_start;
        let mut ways = vec![
            first(self.head(start), at_start),
            first(self.third(start), last),
        ];
        let mut way: Vec<usize> = Vec::new();
        let mut passed: HashSet<usize> = HashSet::new();
        for _ in 0..MOST_TURNS {
            let Some(turn) = ways.pop() else {
                break;
            };
            for edge in way.drain(turn.before..) {
                passed.remove(&edge);
            }
            if turn.angle >= PI || !passed.insert(turn.edge) {
                continue;
            }
            way.push(turn.edge);
            let beyond = if turn.angle > 0.0 {
                turn.nearest.min(spokes[&turn.edge])
            } else {
                turn.nearest
            };
            for &corner in at_edge[&turn.edge].iter().filter(|&&c| c != turn.through) {
                let is_first = self.head(corner) == turn.edge;
                let angle = self.angle(corner);
                if corner == end {
                    let rest = if is_first { at_end } else { angle - at_end };
                    let nearest = if rest > 0.0 { beyond } else { turn.nearest };
                    most = most.max((PI - turn.angle - rest) * nearest);
                }
                ways.push(Turn {
                    edge: if is_first {
                        self.third(corner)
                    } else {
                        self.head(corner)
                    },
                    angle: turn.angle + angle,
                    nearest: beyond,
                    through: corner,
                    before: way.len(),
                });
            }
        }
        Room {
            room: most,
            longest,
        }
    }
}

fn between<S: RealNumber>([a, b]: [[S; 2]; 2], t: S) -> [S; 2] {
    [0, 1].map(|k| a[k] + t * (b[k] - a[k]))
}

fn minus<S: RealNumber>(a: [S; 2], b: [S; 2]) -> [S; 2] {
    [0, 1].map(|k| a[k] - b[k])
}

fn norm<S: RealNumber>([x, y]: [S; 2]) -> S {
    x.hypot(y)
}

/// The angle from `a` to `b`, counter-clockwise.
fn turn<S: RealNumber>(a: [S; 2], b: [S; 2]) -> f64 {
    let (across, along) = (a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
    // Far from 1, a product may have no double in its low half, or no value at all.
    across.to_f64().atan2(along.to_f64())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DoubleDouble, Model};

    fn surface(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> PreciseSurface<DoubleDouble> {
        Model::new("", positions.to_vec(), triangles.to_vec()).surface()
    }

    /// A strip of four unit squares, each cut from its lower left corner.
    fn strip() -> PreciseSurface<DoubleDouble> {
        let mut positions = Vec::new();
        let mut triangles = Vec::new();
        for i in 0..5_u32 {
            positions.extend([[f64::from(i), 0.0, 0.0], [f64::from(i), 1.0, 0.0]]);
            if i > 0 {
                let [a, b, c, d] = [2 * i - 2, 2 * i, 2 * i - 1, 2 * i + 1];
                triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
        surface(&positions, &triangles)
    }

    fn crossing(triangle: u32, ends: [u32; 2], t: f64) -> JudgedPoint {
        JudgedPoint::Edge { triangle, ends, t }
    }

    #[test]
    fn a_path_must_lead_on_from_triangle_to_triangle() {
        let strip = strip();
        let from_1_to_4 = [
            JudgedPoint::Vertex(1),
            crossing(1, [0, 3], 2.0 / 3.0),
            crossing(0, [3, 2], 0.5),
            JudgedPoint::Vertex(4),
        ];
        // From (0, 1) to (2, 0) across the diagonals at 2/3 and 4/3.
        let points = |last: JudgedPoint| {
            let [a, _, b, c] = from_1_to_4;
            [a, crossing(1, [3, 0], 1.0 / 3.0), b, last, c]
        };
        let d = 5.0_f64.sqrt();
        let right = points(crossing(3, [2, 5], 1.0 / 3.0));
        let judge = |points: &[JudgedPoint]| judge_path(&strip, points, &[1], 4, [d, d]);
        assert_eq!(judge(&right), Ok(()));
        assert_eq!(judge(&right[..4]), Err(PathFlaw::Ends));
        // Not an edge of the triangle, outside the edge, and an edge left out.
        assert!(matches!(
            judge(&points(crossing(3, [4, 5], 0.5))),
            Err(PathFlaw::Broken(_))
        ));
        assert!(matches!(
            judge(&points(crossing(3, [2, 5], 1.5))),
            Err(PathFlaw::Broken(_))
        ));
        let [a, b, _, c, e] = right;
        assert!(matches!(judge(&[a, b, c, e]), Err(PathFlaw::Broken(_))));
        // There and back.
        assert!(matches!(judge(&[a, b, c, c, e]), Err(PathFlaw::Broken(_))));
        let bent = points(crossing(3, [2, 5], 0.334));
        let flaw = judge(&bent);
        assert!(
            matches!(flaw, Err(PathFlaw::Length(_) | PathFlaw::Bent(3, _))),
            "{flaw:?}"
        );
        let told = judge_path(&strip, &right, &[1], 4, [d, d * (1.0 + 1e-11)]);
        assert!(matches!(told, Err(PathFlaw::Length(_))));
    }

    /// The rounding of long sides elsewhere once excused a length that is not that of the points.
    #[test]
    fn the_length_told_is_that_of_the_points() {
        let far = [[0.0, 1e9, 0.0], [1e9, 1e9, 0.0], [0.0, 2e9, 0.0]];
        let square = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        let positions = [&square[..], &far].concat();
        let surface = surface(&positions, &[[0, 1, 2], [1, 3, 2], [4, 5, 6]]);
        let along = [0, 1, 3].map(JudgedPoint::Vertex);
        let across = [
            JudgedPoint::Vertex(0),
            crossing(0, [1, 2], 0.5),
            JudgedPoint::Vertex(3),
        ];
        let d = 2.0_f64.sqrt();
        let judge = |points: &[JudgedPoint], told| judge_path(&surface, points, &[0], 3, [d, told]);
        assert_eq!(judge(&across, d), Ok(()));
        for (points, told) in [(across, d + 1e-9), (along, d)] {
            assert!(matches!(judge(&points, told), Err(PathFlaw::Length(_))));
        }
    }

    #[test]
    fn a_path_bends_only_where_no_shortcut_exists() {
        let strip = strip();
        let along = [0, 2, 4].map(JudgedPoint::Vertex);
        assert_eq!(judge_path(&strip, &along, &[0], 4, [2.0; 2]), Ok(()));
        // Along two sides of a square, where a shortcut through its inside exists.
        let around = [1, 3, 2].map(JudgedPoint::Vertex);
        let flaw = judge_path(&strip, &around, &[1], 2, [2.0; 2]);
        assert!(matches!(flaw, Err(PathFlaw::Bent(1, by)) if (by - PI / 2.0).abs() < 1e-12));
        // Around the inner corner of an L, where the shortcut would lie outside.
        let corner = surface(
            &[
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [-1.0, 0.0, 0.0],
                [0.0, -1.0, 0.0],
                [-1.0, -1.0, 0.0],
            ],
            &[[0, 2, 3], [0, 3, 5], [0, 5, 4], [0, 4, 1]],
        );
        let inside = [1, 0, 2].map(JudgedPoint::Vertex);
        assert_eq!(judge_path(&corner, &inside, &[1], 2, [2.0; 2]), Ok(()));
    }

    /// Regression test: directions at a vertex were compared within one fan of triangles only.
    #[test]
    fn a_shortcut_may_lead_across_an_edge_of_three_triangles() {
        // Three triangles at the edge from 0 to 1, each with a corner of 60 degrees at 0.
        let (out, up) = (0.75_f64.sqrt(), 0.5);
        let book = surface(
            &[
                [0.0; 3],
                [1.0, 0.0, 0.0],
                [up, out, 0.0],
                [up, -0.5 * out, 0.75],
                [up, -0.5 * out, -0.75],
            ],
            &[[0, 1, 2], [0, 1, 3], [0, 1, 4]],
        );
        let around = [2, 0, 3].map(JudgedPoint::Vertex);
        let flaw = judge_path(&book, &around, &[2], 3, [2.0; 2]);
        assert!(matches!(flaw, Err(PathFlaw::Bent(1, by)) if (by - PI / 3.0).abs() < 1e-12));
    }
}
