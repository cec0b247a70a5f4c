//! The distances on all edges of a mesh, and those of one edge in either direction.

use std::ops::Range;

use geobench_mesh::{HalfEdgeId, Mesh, threads};

use crate::ball::{Ball, minus, norm};
use crate::difference::{Chord, Distance, RoundedDistance};
use crate::envelope::EnvelopePiece;
use crate::interval::{Interval, greater, lesser};
use crate::jump::sum_of_jumps;

/// The distance on all edges of a mesh. The pieces of an edge are stored under its canonical
/// half-edge, the one with the lower number.
#[derive(Debug)]
pub(crate) struct EdgeField<'a> {
    pub(crate) mesh: &'a Mesh,
    /// The pieces of each half-edge in `pieces`.
    pub(crate) ranges: Vec<Range<usize>>,
    pub(crate) pieces: Vec<EnvelopePiece>,
    /// The sum of the jumps between the pieces of each half-edge. Only at jumps does the distance
    /// along an edge change faster than the position.
    pub(crate) jumps: Vec<f64>,
}

/// The envelopes of consecutive half-edges.
#[derive(Debug, Default)]
pub(crate) struct Envelopes {
    pub(crate) pieces: Vec<EnvelopePiece>,
    /// For each half-edge, the number of its pieces and the sum of the jumps between them.
    pub(crate) half_edges: Vec<(usize, f64)>,
}

impl<'a> EdgeField<'a> {
    /// The field of a mesh from the envelopes of all its half-edges.
    pub(crate) fn new(mesh: &'a Mesh, parts: Vec<Envelopes>) -> Self {
        let mut ranges = Vec::with_capacity(mesh.half_edge_count());
        let mut jumps = Vec::with_capacity(mesh.half_edge_count());
        let mut pieces = Vec::new();
        let mut start = 0;
        for part in parts {
            threads::append(&mut pieces, part.pieces);
            for (count, jump) in part.half_edges {
                ranges.push(start..start + count);
                jumps.push(jump);
                start += count;
            }
        }
        Self {
            mesh,
            ranges,
            pieces,
            jumps,
        }
    }
}

/// The half-edge under which the pieces of the edge of `h` are stored, and whether `h` has the
/// opposite direction.
pub(crate) fn canonical(mesh: &Mesh, h: HalfEdgeId) -> (HalfEdgeId, bool) {
    let edge = mesh.edge_of(h);
    (edge, mesh.tail(edge) != mesh.tail(h))
}

/// A piece, or a part of one, in the frame of a half-edge of the edge, in rounded arithmetic.
#[derive(Clone, Copy)]
pub(crate) struct SidePiece {
    pub(crate) distance: RoundedDistance,
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// The chord of the piece. A distance is convex, so it is nowhere above its chord.
    pub(crate) chord: Chord,
    /// The node that stands for it in chains: the vertices come first, then the pieces.
    pub(crate) node: usize,
}

impl SidePiece {
    /// A distance on a part of a side.
    pub(crate) fn new(distance: RoundedDistance, from: f64, to: f64, node: usize) -> Self {
        let at_ends = [distance.at(from), distance.at(to)];
        Self {
            distance,
            from,
            to,
            chord: Chord::new([from, to], at_ends),
            node,
        }
    }

    /// How much it is above another distance at most in an interval, in rounded arithmetic; minus
    /// infinity if it lies outside. Their difference has at most one critical point: see
    /// [`crate::difference::greatest_difference`].
    pub(crate) fn height_above(&self, other: &RoundedDistance, [from, to]: [f64; 2]) -> f64 {
        let (from, to) = (greater(from, self.from), lesser(to, self.to));
        if from >= to {
            return f64::NEG_INFINITY;
        }
        let above = |t: f64| self.distance.at(t) - other.at(t);
        let at_ends = greater(above(from), above(to));
        let critical = self.distance.critical(other);
        if critical > from && critical < to {
            greater(above(critical), at_ends)
        } else {
            at_ends
        }
    }

    /// The distances at its ends.
    pub(crate) fn at_ends(&self) -> [f64; 2] {
        self.chord.at_ends
    }
}

/// A piece in the frame of a half-edge of the edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExactPiece {
    pub(crate) from: Ball,
    pub(crate) to: Ball,
    pub(crate) distance: Distance,
}

impl EdgeField<'_> {
    /// The pieces of the edge of `h` in the direction of the canonical half-edge.
    pub(crate) fn pieces(&self, h: HalfEdgeId) -> &[EnvelopePiece] {
        let h = self.mesh.edge_of(h).index();
        &self.pieces[self.ranges[h].clone()]
    }

    /// Replaces the pieces of canonical half-edge `h` by others.
    pub(crate) fn replace(&mut self, h: HalfEdgeId, pieces: &[EnvelopePiece]) {
        let first = self.pieces.len();
        self.pieces.extend_from_slice(pieces);
        self.ranges[h.index()] = first..self.pieces.len();
        self.jumps[h.index()] = sum_of_jumps(pieces);
    }

    /// The node of the first piece of a canonical half-edge.
    fn first_node(&self, h: HalfEdgeId) -> usize {
        self.mesh.vertex_count() + self.ranges[h.index()].start
    }

    /// Sets `oriented` to the pieces of the edge of `h` in the direction of `h`, rounded.
    pub(crate) fn orient(&self, h: HalfEdgeId, length: f64, oriented: &mut Vec<SidePiece>) {
        let (canonical, is_turned) = canonical(self.mesh, h);
        let first = self.first_node(canonical);
        let pieces = self.pieces(h).iter();
        let turn = |(i, piece): (usize, &EnvelopePiece), [from, to, x]: [f64; 3]| {
            let distance = RoundedDistance {
                image: [x, piece.image[1]],
                sigma: piece.sigma,
            };
            SidePiece::new(distance, from, to, first + i)
        };
        oriented.clear();
        let pieces = pieces.enumerate();
        if is_turned {
            let turned = |x: f64| length - x;
            let pieces = pieces.rev();
            oriented.extend(pieces.map(|p| turn(p, [p.1.to, p.1.from, p.1.image[0]].map(turned))));
        } else {
            oriented.extend(pieces.map(|p| turn(p, [p.1.from, p.1.to, p.1.image[0]])));
        }
    }

    /// The piece `node` of the edge of `h`, of this length, in the direction of `h`.
    ///
    /// The length in the mesh is rounded. So the last piece ends where the edge does, and a piece
    /// of which a part lies beyond that end is cut there. Straight lines through points beyond a
    /// corner would reach points of the face that they do not. An end that is in doubt becomes the
    /// corner: the proof then covers more points.
    pub(crate) fn exact(&self, h: HalfEdgeId, length: Ball, node: usize) -> ExactPiece {
        let piece = &self.pieces[node - self.mesh.vertex_count()];
        let [mut x, y] = piece.image.map(Ball::exact);
        let least = lesser(self.mesh.length(h), length.lower());
        let end = |t| if t >= least { length } else { Ball::exact(t) };
        let mut ends = [piece.from, piece.to].map(end);
        let (_, is_turned) = canonical(self.mesh, h);
        if is_turned {
            x = length - x;
            ends = [ends[1], ends[0]].map(|t| if t == length { Ball::ZERO } else { length - t });
        }
        ExactPiece {
            from: ends[0],
            to: ends[1],
            distance: Distance {
                image: [x, y],
                sigma: Ball::exact(piece.sigma),
            },
        }
    }

    /// The distances at the ends of canonical half-edge `h`; `None` where the edge has no
    /// distances.
    pub(crate) fn at_ends(&self, h: HalfEdgeId) -> Option<[Interval; 2]> {
        let pieces = self.pieces(h);
        let ends = [self.mesh.tail(h), self.mesh.head(h)];
        let [a, b] = ends.map(|v| self.mesh.positions()[v.index()].map(Ball::exact));
        let at = |piece: &EnvelopePiece, t| {
            let distance = Distance {
                image: piece.image.map(Ball::exact),
                sigma: Ball::exact(piece.sigma),
            };
            distance.at(t).interval()
        };
        let (first, last) = (pieces.first()?, pieces.last()?);
        Some([at(first, Ball::ZERO), at(last, norm(minus(b, a)))])
    }
}

/// Consecutive pieces of a side, which are compared together.
#[derive(Clone, Copy)]
pub(crate) struct PieceBlock {
    pub(crate) first: usize,
    pub(crate) end: usize,
    /// A linear function that is nowhere below the pieces.
    pub(crate) chord: Chord,
}

/// Pieces in a block.
const BLOCK: usize = 6;

impl PieceBlock {
    fn of(pieces: &[SidePiece], first: usize, end: usize) -> Option<Self> {
        let own = pieces.get(first..end)?;
        let (left, right) = (own.first()?, own.last()?);
        let (from, to) = (left.from, right.to);
        let rise = right.at_ends()[1] - left.at_ends()[0];
        let slope = if to > from { rise / (to - from) } else { 0.0 };
        // How far the ends of pieces are above the line of this slope through the origin.
        let above = own.iter().fold(f64::NEG_INFINITY, |most, piece| {
            let first = piece.at_ends()[0] - slope * piece.from;
            let last = piece.at_ends()[1] - slope * piece.to;
            greater(most, greater(first, last))
        });
        Some(Self {
            first,
            end,
            chord: Chord::new([from, to], [from, to].map(|t| above + slope * t)),
        })
    }
}

/// A side of a face.
#[derive(Default)]
pub(crate) struct FaceSide {
    pub(crate) pieces: Vec<SidePiece>,
    /// Empty if a single block would hold all pieces.
    blocks: Vec<PieceBlock>,
    /// All pieces.
    pub(crate) whole: Option<PieceBlock>,
}

impl FaceSide {
    /// Blocks of all pieces.
    pub(crate) fn blocks(&self) -> &[PieceBlock] {
        if self.blocks.is_empty() {
            self.whole.as_slice()
        } else {
            &self.blocks
        }
    }

    /// Sets it to the pieces of the edge of `h` in the direction of `h`.
    pub(crate) fn set(&mut self, field: &EdgeField<'_>, h: HalfEdgeId, length: f64) {
        field.orient(h, length, &mut self.pieces);
        let pieces = &self.pieces;
        self.whole = PieceBlock::of(pieces, 0, pieces.len());
        self.blocks.clear();
        if pieces.len() > BLOCK {
            let firsts = (0..pieces.len()).step_by(BLOCK);
            let block = |i: usize| PieceBlock::of(pieces, i, (i + BLOCK).min(pieces.len()));
            self.blocks.extend(firsts.filter_map(block));
        }
    }
}
