//! Whether a distance on the boundary of a face grows no faster than the way inside the face.
//!
//! Rounded arithmetic sorts out pairs of pieces that are far from it, by a margin ten thousand times
//! its error. All that is left is computed in interval arithmetic.

use geobench_mesh::{FaceId, HalfEdgeId};

use crate::difference::{CLOSE, Distance, Rounded, peak};
use crate::field::{EdgeField, ExactPiece, FaceSide, SidePiece, canonical};
use crate::interval::{Interval, greater, lesser};
use crate::shape::{Border, FaceShape, Reaches, RoundedTransform, SideTransform, excess};

/// A way across a face that a shortest path may take.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChainLink {
    /// The node that it leaves: a piece, or a vertex with all points near it.
    pub(crate) from: u32,
    /// The node to which it comes.
    pub(crate) to: u32,
    pub(crate) face: FaceId,
    /// At least `d(y) - d(x) - |xy|` for the points x and y of the two nodes.
    pub(crate) excess: f32,
}

/// Rounded arithmetic is right to this part of the *size* of a face, the greatest distance on its
/// sides and their lengths.
///
/// Windows have sigmas that are not negative. So the distance between an image and a point of the
/// side is at most that point's distance, and both coordinates of the image are at most the size.
/// Let u be 2^-53, half a unit in the last place of 1. Lengths, cosines and sines are the middles
/// of intervals of at most 20 operations: right to 40 u. An image in the frame of another side is
/// at most 4 times the size from its origin, and comes from 7 operations and these factors: it is
/// right to 300 u of the size. A distance to an image of given coordinates is right to 4 u of it,
/// and differences and tangents add a few more. The sum is below 1000 u, or 1.2e-13.
const MARGIN: f64 = 1e-11;

/// Sizes of faces between which no square overflows, or loses what the margin does not cover.
const SIZES: std::ops::Range<f64> = 1e-130..1e130;

/// The most links that are kept, 16 bytes each. Errors on more of them are added up by distance.
pub(crate) const MOST_LINKS: usize = 1 << 26;

/// Ways as short as this part of the margin have no direction.
const TINY: f64 = 0.1;

/// The points this near to a vertex, in lengths of its shortest edge, are one node with it: around a
/// vertex there are ways of almost no length in all directions.
const NEAR_VERTEX: f64 = 0.01;

/// Checks faces one after another.
pub(crate) struct Checker<'a> {
    field: &'a EdgeField<'a>,
    /// How far from each vertex points are one node with it.
    radii: Vec<f64>,
    /// Ways that are too long by more than this are left out.
    clear: f64,
    /// The ways that are left, up to [`MOST_LINKS`] and those of one face more.
    pub(crate) links: Vec<ChainLink>,
    sides: [FaceSide; 3],
}

impl<'a> Checker<'a> {
    /// For the pieces of `field`; ways that are longer than the distance by more than `clear` are
    /// left out.
    pub(crate) fn new(field: &'a EdgeField<'a>, clear: f64) -> Self {
        let mut radii = vec![f64::INFINITY; field.mesh.vertex_count()];
        for h in field.mesh.half_edges() {
            for v in [field.mesh.tail(h), field.mesh.head(h)] {
                let radius = &mut radii[v.index()];
                *radius = radius.min(NEAR_VERTEX * field.mesh.length(h));
            }
        }
        Self {
            field,
            radii,
            clear,
            links: Vec::new(),
            sides: std::array::from_fn(|_| FaceSide::default()),
        }
    }

    /// An upper bound of `d(y) - d(x) - |xy|` over all points x and y of the boundary of `face`,
    /// not less than 0, and the side on which d(y) is too long. Adds the ways across the face.
    pub(crate) fn violation(&mut self, face: FaceId) -> (f64, HalfEdgeId) {
        let mut sides = std::mem::take(&mut self.sides);
        let shape = FaceShape::of(self.field.mesh, face);
        let lengths = shape.lengths.map(Interval::middle);
        for (k, side) in (0..).zip(&mut sides) {
            side.set(self.field, face.half_edge(k), lengths[k as usize]);
        }
        let found = self.violation_of_sides(face, &shape, lengths, &sides);
        self.sides = sides;
        found
    }

    fn violation_of_sides(
        &mut self,
        face: FaceId,
        shape: &FaceShape,
        lengths: [f64; 3],
        sides: &[FaceSide; 3],
    ) -> (f64, HalfEdgeId) {
        let at_ends = sides.iter().flat_map(|side| &side.pieces);
        let top = at_ends.fold(0.0, |top, p| {
            greater(top, greater(p.at_ends()[0], p.at_ends()[1]))
        });
        let size = top + lengths.iter().sum::<f64>();
        let nothing = (f64::INFINITY, face.half_edge(0));
        if !SIZES.contains(&size) {
            return nothing;
        }
        let margin = MARGIN * size;
        let corners = self.field.mesh.face_vertices(face);
        let ball = |corner: usize| {
            let v = corners[corner % 3];
            (self.field.pieces.len() + v.index(), self.radii[v.index()])
        };
        let mut most = (0.0_f64, face.half_edge(0));
        for k in 0..3 {
            let mut from_side = (0.0_f64, k);
            let mut skips_bends = false;
            for step in [1, 2] {
                let there = (k + step) % 3;
                let transform = shape.transform(k, step);
                let near = transform.rounded(TINY * margin);
                if !near.is_finite() {
                    return nothing;
                }
                let mut across = Across {
                    field: self.field,
                    sides: [&sides[k], &sides[there]],
                    half_edges: [k, there].map(|k| face.half_edge(k as u32)),
                    exact_lengths: [k, there].map(|k| shape.lengths[k]),
                    lengths: [k, there].map(|k| lengths[k]),
                    transform: &transform,
                    near,
                    balls: [[ball(k), ball(k + 1)], [ball(there), ball(there + 1)]],
                    margin,
                    clear: self.clear,
                    excess: from_side.0,
                    skips_bends: false,
                };
                across.compare_all(&mut self.links);
                skips_bends |= across.skips_bends;
                if across.excess > from_side.0 {
                    from_side = (across.excess, there);
                }
            }
            // Between two points of one side the distance grows faster than the way by the jumps
            // there. What bends at a concave kink is no shorter than what goes through the piece
            // beyond, but for the jump there.
            let side = canonical(self.field.mesh, face.half_edge(k as u32));
            let jump = self.field.jumps[side.index()];
            let (found, there) = from_side;
            let violation = if skips_bends {
                (found + jump).next_up()
            } else {
                greater(found, jump)
            };
            if violation > most.0 {
                let worst = if jump > found { k } else { there };
                most = (violation, face.half_edge(worst as u32));
            }
        }
        most
    }
}

/// Whether the slope of the distance decreases where `left` ends and `right` begins. Then no point
/// has its least distance by a way that bends there: it can be moved to a piece beside.
fn is_concave(left: Option<&SidePiece>, right: Option<&SidePiece>, margin: f64) -> bool {
    let (Some(left), Some(right)) = (left, right) else {
        return false;
    };
    let t = left.to;
    let sides = [left, right].map(|p| p.distance);
    // Slopes are right to 1e-10 where images are not too near.
    let is_far = sides.iter().all(|d| d.at(t) - d.sigma > 1e5 * margin);
    is_far && sides[0].slope(t) - sides[1].slope(t) > 1e-8
}

/// All ways from one side of a face to another.
struct Across<'a> {
    field: &'a EdgeField<'a>,
    /// The side that ways leave, and that to which they come; so are all pairs.
    sides: [&'a FaceSide; 2],
    half_edges: [HalfEdgeId; 2],
    exact_lengths: [Interval; 2],
    lengths: [f64; 2],
    transform: &'a SideTransform,
    near: RoundedTransform,
    /// Nodes and sizes of the neighbourhoods of the ends of both sides.
    balls: [[(usize, f64); 2]; 2],
    margin: f64,
    clear: f64,
    /// How far the distances of the one side are above those by ways from the other, at most; or more
    /// where no better bound is of use.
    excess: f64,
    /// Whether ways that bend at a concave kink were left out.
    skips_bends: bool,
}

/// The ways that leave one piece. Each is computed when it is first needed.
struct FromPiece<'a> {
    index: usize,
    piece: &'a SidePiece,
    straight: Rounded,
    reaches: Option<Reaches>,
    exact_straight: Option<Distance>,
    exact_piece: Option<ExactPiece>,
    /// Beyond its end, and before its beginning.
    borders: [Option<Border>; 2],
    parts: Option<Parts>,
}

/// The parts of a piece in the neighbourhoods of the ends of the side and between them, each with
/// the ways that leave it.
type Parts = [Option<(SidePiece, Option<Reaches>)>; 3];

impl<'a> FromPiece<'a> {
    fn new(index: usize, piece: &'a SidePiece, straight: Rounded) -> Self {
        Self {
            index,
            piece,
            straight,
            reaches: None,
            exact_straight: None,
            exact_piece: None,
            borders: [None; 2],
            parts: None,
        }
    }
}

impl Across<'_> {
    /// Sets the excess, and adds the ways. Ways that bend at ends of pieces do not count where the
    /// distance has a concave kink.
    ///
    /// A way from any point x of the line through the piece to a point y is no shorter than the
    /// straight one from its image, by the triangle inequality: `d(x) + |xy| >= straight(y)`. So
    /// what is below the straight distance needs no look at where straight ways arrive.
    fn compare_all(&mut self, links: &mut Vec<ChainLink>) {
        let [here, there] = self.sides;
        let Some(whole) = &there.whole else {
            return;
        };
        let clear = self.clear + self.margin;
        for (index, piece) in here.pieces.iter().enumerate() {
            let straight = self.near.straight(&piece.distance);
            if whole.chord.is_below(&straight, clear) {
                continue;
            }
            let mut from = None;
            let blocks = if there.blocks.is_empty() {
                std::slice::from_ref(whole)
            } else {
                &there.blocks
            };
            for block in blocks {
                if blocks.len() > 1 && block.chord.is_below(&straight, clear) {
                    continue;
                }
                for other in &there.pieces[block.first..block.end] {
                    if !other.chord.is_below(&straight, clear) {
                        let from =
                            from.get_or_insert_with(|| FromPiece::new(index, piece, straight));
                        self.compare(from, other, links);
                    }
                }
            }
        }
    }

    /// Raises the excess to how far `other` is above the distances by ways from a piece; adds the
    /// ways between them.
    fn compare(&mut self, from: &mut FromPiece<'_>, other: &SidePiece, links: &mut Vec<ChainLink>) {
        let near = self.near;
        let reaches = from
            .reaches
            .get_or_insert_with(|| near.reaches(from.piece, from.straight));
        if reaches.is_above(&other.chord, self.clear + self.margin) {
            return;
        }
        let found = reaches.differences(other);
        let upper = greater(greater(found[0], found[1]), found[2]) + self.margin;
        if upper <= -self.clear {
            return;
        }
        if upper > -self.margin {
            let excess = self.exact_excess(from, other, found);
            self.excess = if excess.is_nan() {
                f64::INFINITY
            } else {
                greater(excess, self.excess)
            };
        }
        self.connect(from, other, upper, links);
    }

    /// How far `other` is above the distances by ways from a piece, at most. `found` is how far
    /// `other` is above each of the three reaches, but for rounding.
    fn exact_excess(
        &mut self,
        from: &mut FromPiece<'_>,
        other: &SidePiece,
        found: [f64; 3],
    ) -> f64 {
        let [here, there] = [0, 1].map(|k| (self.half_edges[k], self.exact_lengths[k]));
        let exact_other = self.field.exact(there.0, there.1, other.node);
        let exact_piece = *from
            .exact_piece
            .get_or_insert_with(|| self.field.exact(here.0, here.1, from.piece.node));
        let straight = *from
            .exact_straight
            .get_or_insert_with(|| self.transform.straight(&exact_piece.distance));
        // It only decides how good a bound has to be: rounding does not matter.
        let close = CLOSE * other.at_ends()[0];
        // The triangle inequality again: what is not above the straight ways is above none.
        let at = |t: Interval| (exact_other.distance.at(t) - straight.at(t)).hi;
        let width = other.to - other.from;
        let simple = if other.distance.peak(&from.straight) <= self.margin {
            peak(&exact_other.distance, &straight)
        } else {
            // A chord of the one is below a tangent of the other: at one end by far, so that the
            // greatest difference is at the other end.
            let [first, last] = other.at_ends();
            let [value, slope] = from.straight.tangent(other.from);
            if last - (value + slope * width) <= -self.margin {
                at(exact_other.from)
            } else {
                let [value, slope] = from.straight.tangent(other.to);
                if first - (value - slope * width) <= -self.margin {
                    at(exact_other.to)
                } else {
                    f64::INFINITY
                }
            }
        };
        if simple <= greater(close, self.excess) {
            return greater(simple, 0.0);
        }
        let pieces = &self.sides[0].pieces;
        let begin = from
            .reaches
            .map_or([f64::NEG_INFINITY, f64::INFINITY], |r| r.bounds(1));
        let mut most = 0.0_f64;
        let mut range = [f64::NEG_INFINITY, f64::INFINITY];
        let mut raise = |found: f64| {
            most = if found.is_nan() {
                f64::INFINITY
            } else {
                greater(found, most)
            };
        };
        for at_end in [true, false] {
            // Where no border is in sight, straight ways are the bound, wherever they end.
            let is_beyond = if at_end {
                begin[0] + self.margin < other.from
            } else {
                begin[1] - self.margin > other.to
            };
            if is_beyond {
                continue;
            }
            let border = from.borders[usize::from(!at_end)].get_or_insert_with(|| {
                let [left, right] = if at_end {
                    [Some(from.piece), pieces.get(from.index + 1)]
                } else {
                    [
                        from.index.checked_sub(1).map(|i| &pieces[i]),
                        Some(from.piece),
                    ]
                };
                let bends = !is_concave(left, right, self.margin);
                self.transform
                    .border(&exact_piece, &straight, at_end, bends)
            });
            let (k, beyond) = if at_end {
                range[0] = border.at;
                (0, [f64::NEG_INFINITY, border.at])
            } else {
                range[1] = border.at;
                (2, [border.at, f64::INFINITY])
            };
            match border.bend {
                None => self.skips_bends = true,
                Some(bend) if !self.is_below(found[k], border.at, begin[k / 2]) => {
                    raise(excess(&exact_other, &bend, beyond));
                }
                Some(_) => {}
            }
        }
        raise(excess(&exact_other, &straight, range));
        if simple < most {
            greater(simple, 0.0)
        } else {
            most
        }
    }

    /// Whether a piece is nowhere above ways that bend, as told by how far it is above the same,
    /// rounded, and by where both begin.
    fn is_below(&self, difference: f64, border: f64, rounded: f64) -> bool {
        let lies_beside = difference == f64::NEG_INFINITY;
        let off = (border - rounded).abs();
        !lies_beside && off <= self.margin / 8.0 && difference <= -2.0 * self.margin
    }

    /// Adds the ways between the nodes of two pieces.
    fn connect(
        &self,
        from: &mut FromPiece<'_>,
        other: &SidePiece,
        upper: f64,
        links: &mut Vec<ChainLink>,
    ) {
        let face = self.half_edges[0].face();
        let mut add = |from: usize, to: usize, upper: f64| {
            if upper > -self.clear && links.len() <= MOST_LINKS {
                links.push(ChainLink {
                    from: from as u32,
                    to: to as u32,
                    face,
                    excess: (upper as f32).next_up(),
                });
            }
        };
        if self.is_between(0, from.piece) && self.is_between(1, other) {
            if from.piece.node != other.node {
                add(from.piece.node, other.node, upper);
            }
            return;
        }
        let parts = from.parts.get_or_insert_with(|| {
            let parts = self.split(0, from.piece);
            parts.map(|part| part.map(|part| (part, None)))
        });
        let others = self.split(1, other);
        for (part, reaches) in parts.iter_mut().flatten() {
            for other in others.iter().flatten() {
                if other.node == part.node || self.is_far(part, other) {
                    continue;
                }
                let reaches = reaches.get_or_insert_with(|| self.near.reaches(part, from.straight));
                if reaches.is_above(&other.chord, self.clear + self.margin) {
                    continue;
                }
                let found = reaches.differences(other);
                let upper = greater(greater(found[0], found[1]), found[2]) + self.margin;
                add(part.node, other.node, upper);
            }
        }
    }

    /// Whether all ways between two parts are too long by more than matters, as told by their
    /// beginnings: from there distances and ways change by at most the widths of the parts.
    fn is_far(&self, part: &SidePiece, other: &SidePiece) -> bool {
        let way = self.near.way(part.from, other.from);
        let widths = (part.to - part.from) + (other.to - other.from);
        let excess = other.at_ends()[0] - part.at_ends()[0] - way;
        excess + 2.0 * widths + self.margin <= -self.clear
    }

    /// Whether a piece has no part in the neighbourhoods of the ends of the side.
    fn is_between(&self, side: usize, piece: &SidePiece) -> bool {
        let [(_, near_tail), (_, near_head)] = self.balls[side];
        piece.from >= near_tail && piece.to <= self.lengths[side] - near_head
    }

    /// The parts of a piece in the neighbourhoods of the ends of the side, and between them.
    fn split(&self, side: usize, piece: &SidePiece) -> [Option<SidePiece>; 3] {
        if self.is_between(side, piece) {
            return [Some(*piece), None, None];
        }
        let [(tail, near_tail), (head, near_head)] = self.balls[side];
        let near_head = self.lengths[side] - near_head;
        let bounds = [
            (f64::NEG_INFINITY, near_tail, tail),
            (near_tail, near_head, piece.node),
            (near_head, f64::INFINITY, head),
        ];
        let parts = bounds.map(|(from, to, node)| {
            (piece.from < to && piece.to > from).then(|| {
                let (from, to) = (greater(piece.from, from), lesser(piece.to, to));
                SidePiece::new(piece.distance, from, to, node)
            })
        });
        if parts.iter().all(Option::is_none) {
            // A piece of no length.
            return [Some(*piece), None, None];
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::Mesh;

    use super::*;
    use crate::envelope::EnvelopePiece;

    /// Face 11996 of the scan igea from vertex 0, and two pieces of it. The ways that bend at the
    /// end of the first piece reach the second up to its very end, and the straight ones begin there.
    #[test]
    #[expect(clippy::unreadable_literal, reason = "as the program prints them")]
    fn pieces_that_meet_in_one_point_are_compared_there() {
        let positions = vec![
            [
                0.028835000470280647,
                0.025356000289320946,
                -0.008697000332176685,
            ],
            [
                0.02889700047671795,
                0.025023000314831734,
                -0.008716000244021416,
            ],
            [
                0.0287299994379282,
                0.025356000289320946,
                -0.009185000322759151,
            ],
            [0.029, 0.0252, -0.0084],
            [0.0287, 0.0257, -0.0089],
        ];
        // Beside faces of less number its sides 0 and 2 are turned.
        let mesh = Mesh::new(positions, vec![[1, 0, 3], [0, 2, 4], [0, 1, 2]]).unwrap();
        let far = EnvelopePiece {
            from: 1.4883927423876347e-15,
            to: 8.178653061323015e-5,
            image: [-0.03639741439737471, 0.0034468109485394187],
            sigma: 0.05372740948147406,
        };
        let near = EnvelopePiece {
            from: 3.20819438888775e-5,
            to: 3.218347146565396e-5,
            image: [5.532985414092948e-6, 0.0003392099151418724],
            sigma: 0.09028766495827824,
        };
        let field = EdgeField {
            mesh: &mesh,
            starts: vec![0, 1, 1, 1, 2, 2, 2, 2, 2, 2],
            pieces: vec![far, near],
            jumps: vec![0.0; 9],
        };
        let found = Checker::new(&field, 1e-9).violation(FaceId::new(2)).0;
        assert!(found < 1e-12, "{found:e}");
        // Both are compared: the second may not be longer.
        let mut field = field;
        field.pieces[1].sigma += 1e-10;
        let (found, side) = Checker::new(&field, 1e-9).violation(FaceId::new(2));
        assert_eq!(side, FaceId::new(2).half_edge(2));
        assert!(found > 0.9e-10 && found < 1.1e-10, "{found:e}");
    }
}
