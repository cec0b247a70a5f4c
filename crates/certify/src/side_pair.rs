//! The Lipschitz condition between two sides of a face, piece by piece.

use geobench_mesh::{FaceId, HalfEdgeId};

use crate::ball::Ball;
use crate::difference::{CLOSE, Chord, Distance, RoundedDistance, peak};
use crate::field::{EdgeField, ExactPiece, FaceSide, SidePiece};
use crate::interval::greater;
use crate::shape::{Border, LeastDistance, RoundedTransform, SideTransform, excess};

/// A link of a chain: segments across a face between two nodes, of which a shortest path may take
/// one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChainLink {
    /// The node that it leaves: a piece, or a vertex with its neighbourhood.
    pub(crate) from: u32,
    /// The node at which it arrives.
    pub(crate) to: u32,
    pub(crate) face: FaceId,
    /// An upper bound of `d(y) - d(x) - |xy|` for the points x and y of the two nodes; minus the
    /// detour.
    pub(crate) excess: f32,
}

/// The greatest number of links that are kept, 16 bytes each. With more, violations are added up by
/// distance instead of along chains.
pub(crate) const MOST_LINKS: usize = 1 << 26;

/// Whether the slope of the distance decreases where `left` ends and `right` begins. Then no
/// shortest path bends there: moving the bend into one of the two pieces makes the path shorter.
fn is_concave(left: Option<&SidePiece>, right: Option<&SidePiece>, margin: f64) -> bool {
    let (Some(left), Some(right)) = (left, right) else {
        return false;
    };
    if left.to != right.from {
        // Parts of the edge were cut off.
        return false;
    }
    let t = left.to;
    let sides = [left, right].map(|p| p.distance);
    // The error of a slope is at most 1e-10 if its image is not too near.
    let is_far = sides.iter().all(|d| d.at(t) - d.sigma > 1e5 * margin);
    is_far && sides[0].slope(t) - sides[1].slope(t) > 1e-8
}

/// All pairs of pieces of two sides of a face, for paths from the one side to the other.
pub(crate) struct SidePair<'a> {
    pub(crate) field: &'a EdgeField<'a>,
    /// The side that paths leave, and the one at which they arrive. All pairs below are in this
    /// order.
    pub(crate) sides: [&'a FaceSide; 2],
    pub(crate) half_edges: [HalfEdgeId; 2],
    pub(crate) exact_lengths: [Ball; 2],
    pub(crate) lengths: [f64; 2],
    pub(crate) transform: &'a SideTransform,
    pub(crate) near: RoundedTransform,
    /// The nodes and radii of the neighbourhoods of the ends of both sides.
    pub(crate) balls: [[(usize, f64); 2]; 2],
    pub(crate) margin: f64,
    /// See [`FaceSize::error`](crate::face::FaceSize).
    pub(crate) error: f64,
    /// Violations up to this need not be known better.
    pub(crate) accepted: f64,
    pub(crate) clear: f64,
    /// An upper bound of the violations on the second side. It is not tightened where that could
    /// not change the result.
    pub(crate) excess: f64,
    /// How many more pairs may be compared in numbers of two doubles.
    pub(crate) exact_left: usize,
    /// Whether paths that bend at a concave kink were left out.
    pub(crate) skips_bends: bool,
    pub(crate) parts: &'a mut Parts,
}

/// The paths that leave one piece. Options are computed when they are first needed.
struct FromPiece<'a> {
    index: usize,
    piece: &'a SidePiece,
    straight: RoundedDistance,
    reaches: LeastDistance,
    exact_straight: Option<Distance>,
    exact_piece: Option<ExactPiece>,
    /// At the end of the piece and at its beginning.
    borders: [Option<Border>; 2],
    /// Whether its parts are known.
    is_split: bool,
}

/// The parts of two pieces in the neighbourhoods of the ends of their sides and between them.
#[derive(Default)]
pub(crate) struct Parts {
    /// Each with the paths that leave it.
    from: Vec<(SidePiece, Option<LeastDistance>)>,
    to: Vec<SidePiece>,
}

impl<'a> FromPiece<'a> {
    fn new(
        index: usize,
        piece: &'a SidePiece,
        straight: RoundedDistance,
        near: RoundedTransform,
    ) -> Self {
        Self {
            index,
            piece,
            straight,
            reaches: near.reaches(piece, straight),
            exact_straight: None,
            exact_piece: None,
            borders: [None; 2],
            is_split: false,
        }
    }
}

impl SidePair<'_> {
    /// Raises `excess`, and adds the links. Leaves out paths that bend at a concave kink.
    ///
    /// By the triangle inequality, no path from a point x of the line through the piece to a point
    /// y is shorter than the straight one from the image: `d(x) + |xy| >= straight(y)`. If `other`
    /// is below the straight distance, the range of straight paths need not be known.
    pub(crate) fn compare_all(&mut self, links: &mut Vec<ChainLink>) {
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
            let mut from = FromPiece::new(index, piece, straight, self.near);
            let is_clear = |reaches: &LeastDistance, chord: &Chord| {
                chord.is_below(&straight, clear) || reaches.is_above(chord, clear)
            };
            for block in there.blocks() {
                if is_clear(&from.reaches, &block.chord) {
                    continue;
                }
                for other in &there.pieces[block.first..block.end] {
                    if !is_clear(&from.reaches, &other.chord) {
                        self.compare(&mut from, other, links);
                    }
                }
            }
        }
    }

    /// Raises `excess` to the violations of `other` by paths from one piece, and adds the links
    /// between them.
    fn compare(&mut self, from: &mut FromPiece<'_>, other: &SidePiece, links: &mut Vec<ChainLink>) {
        // The straight distance is a lower bound of all paths from the piece.
        let limit = greater(self.accepted, self.excess) - self.error;
        let bound = from.straight.below(other, limit);
        if bound <= limit {
            let upper = bound + self.error;
            if upper > -self.clear {
                self.excess = greater(upper, self.excess);
                self.connect(from, other, upper, links);
            }
            return;
        }
        let found = from.reaches.differences(other);
        let upper = greater(greater(found[0], found[1]), found[2]) + self.margin;
        if upper <= -self.clear {
            return;
        }
        if upper > -self.margin {
            let rounded = if limit >= 0.0 {
                from.reaches.below(other, self.error)
            } else {
                f64::INFINITY
            };
            let excess = if rounded <= limit {
                rounded + self.error
            } else if self.exact_left > 0 {
                self.exact_left -= 1;
                self.exact_excess(from, other, found)
            } else {
                upper
            };
            self.excess = if excess.is_nan() {
                f64::INFINITY
            } else {
                greater(excess, self.excess)
            };
        }
        self.connect(from, other, upper, links);
    }

    /// An upper bound of how much `other` is above the distances by paths from one piece. `found`
    /// holds the same for each of the three parts of [`LeastDistance`], in rounded arithmetic.
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
        // Rounding is harmless here: `close` only decides when a bound is good enough.
        let close = CLOSE * other.at_ends()[0];
        let simple = self.above_straight(other, &from.straight, &exact_other, &straight);
        if simple <= greater(close, self.excess) {
            return greater(simple, 0.0);
        }
        let begin = from.reaches.bounds(1);
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
            // If `other` does not reach this end of the straight range, the end need not be known.
            let is_beyond = if at_end {
                begin[0] + self.margin < other.from
            } else {
                begin[1] - self.margin > other.to
            };
            if is_beyond {
                continue;
            }
            let border = self.border(from, at_end, &exact_piece, &straight);
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

    /// An upper bound of how much `other`, exactly `exact_other`, is above the straight distance
    /// from a piece, exactly `straight`. That is a lower bound of all paths from the piece, so the
    /// result bounds the violation. Infinite if no bound is found in a few steps.
    fn above_straight(
        &self,
        other: &SidePiece,
        rounded: &RoundedDistance,
        exact_other: &ExactPiece,
        straight: &Distance,
    ) -> f64 {
        if other.distance.peak(rounded) <= self.margin {
            return peak(&exact_other.distance, straight);
        }
        let at = |t: Ball| (exact_other.distance.at(t) - straight.at(t)).upper();
        // The chord of `other` minus a tangent of the straight distance bounds the difference, and
        // equals it at the point of tangency. If the bound is clearly negative at the other end,
        // the difference at the point of tangency is the greatest one that matters.
        let width = other.to - other.from;
        let [first, last] = other.at_ends();
        let [value, slope] = rounded.tangent(other.from);
        if last - (value + slope * width) <= -self.margin {
            return at(exact_other.from);
        }
        let [value, slope] = rounded.tangent(other.to);
        if first - (value - slope * width) <= -self.margin {
            return at(exact_other.to);
        }
        f64::INFINITY
    }

    /// Where the straight paths from a piece end, and the bent ones there; kept in `from`.
    fn border(
        &self,
        from: &mut FromPiece<'_>,
        at_end: bool,
        piece: &ExactPiece,
        straight: &Distance,
    ) -> Border {
        let pieces = &self.sides[0].pieces;
        *from.borders[usize::from(!at_end)].get_or_insert_with(|| {
            let [left, right] = if at_end {
                [Some(from.piece), pieces.get(from.index + 1)]
            } else {
                [
                    from.index.checked_sub(1).map(|i| &pieces[i]),
                    Some(from.piece),
                ]
            };
            let bends = !is_concave(left, right, self.margin);
            self.transform.border(piece, straight, at_end, bends)
        })
    }

    /// Whether a piece is certainly nowhere above the bent paths. `difference` is how much it is
    /// above them in rounded arithmetic. `border` is where they begin, and `rounded` the same in
    /// rounded arithmetic.
    fn is_below(&self, difference: f64, border: f64, rounded: f64) -> bool {
        let lies_beside = difference == f64::NEG_INFINITY;
        let off = (border - rounded).abs();
        !lies_beside && off <= self.margin / 8.0 && difference <= -2.0 * self.margin
    }

    /// Adds the links between the nodes of two pieces.
    fn connect(
        &mut self,
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
        let clear = self.clear + self.margin;
        let Parts {
            from: parts,
            to: others,
        } = &mut *self.parts;
        if !std::mem::replace(&mut from.is_split, true) {
            parts.clear();
            let range = (self.balls[0], self.lengths[0]);
            split(from.piece, range, |part| parts.push((part, None)));
        }
        others.clear();
        split(other, (self.balls[1], self.lengths[1]), |part| {
            if !part.chord.is_below(&from.straight, clear) {
                others.push(part);
            }
        });
        for (part, reaches) in parts {
            for other in &*others {
                if other.node == part.node || is_far(&self.near, part, other, clear) {
                    continue;
                }
                let reaches = reaches.get_or_insert_with(|| self.near.reaches(part, from.straight));
                if reaches.is_above(&other.chord, clear) {
                    continue;
                }
                let found = reaches.differences(other);
                let upper = greater(greater(found[0], found[1]), found[2]) + self.margin;
                add(part.node, other.node, upper);
            }
        }
    }

    /// Whether a piece lies outside the neighbourhoods of both ends of the side.
    fn is_between(&self, side: usize, piece: &SidePiece) -> bool {
        let [(_, near_tail), (_, near_head)] = self.balls[side];
        piece.from >= near_tail && piece.to <= self.lengths[side] - near_head
    }
}

/// Whether all segments between two parts have a detour above `clear`, judged by the segment
/// between their beginnings. The change from there is bounded by the widths of the parts.
fn is_far(near: &RoundedTransform, part: &SidePiece, other: &SidePiece, clear: f64) -> bool {
    let length = near.distance(part.from, other.from);
    let widths = (part.to - part.from) + (other.to - other.from);
    let excess = other.at_ends()[0] - part.at_ends()[0] - length;
    excess + 2.0 * widths <= -clear
}

/// The parts of a piece in the neighbourhoods of the ends of the side, and between them.
fn split(
    piece: &SidePiece,
    (balls, length): ([(usize, f64); 2], f64),
    mut part: impl FnMut(SidePiece),
) {
    let [(tail, near_tail), (head, near_head)] = balls;
    let (mut from, [mut first, last]) = (piece.from, piece.at_ends());
    let nodes = [
        (near_tail, tail),
        (length - near_head, piece.node),
        (f64::INFINITY, head),
    ];
    for (end, node) in nodes {
        if from >= end {
            continue;
        }
        let is_last = piece.to <= end;
        let (to, at_end) = if is_last {
            (piece.to, last)
        } else {
            (end, piece.distance.at(end))
        };
        part(SidePiece {
            distance: piece.distance,
            from,
            to,
            chord: Chord::new([from, to], [first, at_end]),
            node,
        });
        if is_last {
            return;
        }
        (from, first) = (to, at_end);
    }
}
