//! Whether a distance on the boundary of a face grows no faster than the way inside the face.
//!
//! Rounded arithmetic sorts out pairs of pieces that are far from it, by a margin ten thousand times
//! its error. All that is left is computed in interval arithmetic.

use geobench_mesh::{FaceId, HalfEdgeId, Mesh};

use crate::difference::{Distance, Rounded, greatest_difference};
use crate::envelope::Piece;
use crate::interval::{Interval, Vector, cross, cross_length, dot, minus, norm};

/// The distance on all edges of a mesh: the pieces of an edge under its canonical half-edge, the
/// one of less number.
#[derive(Debug)]
pub(crate) struct EdgeField<'a> {
    pub(crate) mesh: &'a Mesh,
    /// Where the pieces of each half-edge begin in `pieces`, and a last entry for their end.
    pub(crate) starts: Vec<usize>,
    pub(crate) pieces: Vec<Piece>,
    /// The sum of all jumps between the pieces of each half-edge: along an edge the distance grows no
    /// faster than the way but there.
    pub(crate) jumps: Vec<f64>,
}

/// The half-edge under which the pieces of the edge of `h` are stored.
pub(crate) fn canonical(mesh: &Mesh, h: HalfEdgeId) -> HalfEdgeId {
    mesh.twin(h).map_or(h, |twin| twin.min(h))
}

/// A piece in the frame of a half-edge of the edge, in whichever direction.
#[derive(Clone, Copy)]
struct Oriented {
    from: Interval,
    to: Interval,
    distance: Distance,
    /// The same, rounded.
    near: Part,
    /// Its middle, and the distance there.
    middle: [f64; 2],
    /// The distances at its ends.
    at_ends: [f64; 2],
}

/// Pieces of a side in a row, which are sorted out together.
#[derive(Clone, Copy)]
struct Block {
    first: usize,
    end: usize,
    /// The middle of the part of the side that they cover, and half its length.
    middle: f64,
    half: f64,
    /// The greatest distance on them: a piece is convex and has its greatest at an end.
    top: f64,
}

/// Pieces in a block.
const BLOCK: usize = 6;

impl Block {
    fn of(pieces: &[Oriented], first: usize, end: usize) -> Self {
        let own = &pieces[first..end];
        let (mut from, mut to, mut top) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
        for piece in own {
            from = from.min(piece.near.from);
            to = to.max(piece.near.to);
            top = top.max(piece.at_ends[0]).max(piece.at_ends[1]);
        }
        Self {
            first,
            end,
            middle: f64::midpoint(from, to),
            half: (to - from) / 2.0,
            top,
        }
    }
}

/// A side of a face.
#[derive(Default)]
struct Side {
    pieces: Vec<Oriented>,
    blocks: Vec<Block>,
    /// All pieces.
    whole: Option<Block>,
}

impl Side {
    fn group(&mut self) {
        let pieces = &self.pieces;
        self.blocks.clear();
        let firsts = (0..pieces.len()).step_by(BLOCK);
        let blocks = firsts.map(|i| Block::of(pieces, i, (i + BLOCK).min(pieces.len())));
        self.blocks.extend(blocks);
        self.whole = (!pieces.is_empty()).then(|| Block::of(pieces, 0, pieces.len()));
    }
}

/// A distance on a part of a side, rounded, and the node that stands for it.
#[derive(Clone, Copy)]
struct Part {
    distance: Rounded,
    from: f64,
    to: f64,
    node: usize,
}

impl EdgeField<'_> {
    /// The pieces of the edge of `h` in the direction of the canonical half-edge.
    fn pieces(&self, h: HalfEdgeId) -> &[Piece] {
        let h = canonical(self.mesh, h).index();
        &self.pieces[self.starts[h]..self.starts[h + 1]]
    }

    /// Sets `oriented` to the pieces of the edge of `h` in the direction of `h`.
    fn orient(&self, h: HalfEdgeId, length: Interval, oriented: &mut Vec<Oriented>) {
        let canonical = canonical(self.mesh, h);
        let reverse = canonical != h;
        let first = self.starts[canonical.index()];
        // The length in the mesh is rounded; the last piece ends where the edge does.
        let rounded = self.mesh.length(h);
        let turn = |t: f64| length - Interval::exact(t);
        let pieces = self.pieces(h).iter().enumerate().map(|(i, piece)| {
            let end = |t: f64| match (reverse, t == 0.0, t == rounded) {
                (false, _, true) | (true, true, _) => length,
                (true, _, true) => Interval::ZERO,
                (true, ..) => turn(t),
                (false, ..) => Interval::exact(t),
            };
            let (from, to) = if reverse {
                (end(piece.to), end(piece.from))
            } else {
                (end(piece.from), end(piece.to))
            };
            let [x, y] = piece.image;
            let x = if reverse { turn(x) } else { Interval::exact(x) };
            let distance = Distance {
                image: [x, Interval::exact(y.abs())],
                sigma: Interval::exact(piece.sigma),
            };
            let near = Part {
                distance: distance.rounded(),
                from: from.middle(),
                to: to.middle(),
                node: first + i,
            };
            let middle = f64::midpoint(near.from, near.to);
            Oriented {
                from,
                to,
                distance,
                near,
                middle: [middle, near.distance.at(middle)],
                at_ends: [near.from, near.to].map(|t| near.distance.at(t)),
            }
        });
        oriented.clear();
        oriented.extend(pieces);
        if reverse {
            oriented.reverse();
        }
    }

    /// The distance at the beginning of the canonical half-edge of the edge of `h`, or at its end;
    /// `None` where the edge has no distances.
    pub(crate) fn at_end(&self, h: HalfEdgeId, beginning: bool) -> Option<Interval> {
        let h = canonical(self.mesh, h);
        let pieces = self.pieces(h);
        let (piece, t) = if beginning {
            (pieces.first()?, Interval::ZERO)
        } else {
            let ends = [self.mesh.tail(h), self.mesh.head(h)];
            let [a, b] = ends.map(|v| self.mesh.positions()[v.index()].map(Interval::exact));
            (pieces.last()?, norm(minus(b, a)))
        };
        let distance = Distance {
            image: piece.image.map(Interval::exact),
            sigma: Interval::exact(piece.sigma),
        };
        Some(distance.at(t))
    }
}

/// A way across a face that a shortest path may take.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    /// The node that it leaves: a piece, or a vertex with all points near it.
    pub(crate) from: u32,
    /// The node to which it comes.
    pub(crate) to: u32,
    pub(crate) face: FaceId,
    /// At least `d(y) - d(x) - |xy|` for the points x and y of the two nodes.
    pub(crate) excess: f32,
}

/// The error of rounded arithmetic is less than this part of the numbers involved: coordinates and
/// distances come from fewer than a hundred operations, each right to 1.1e-16 of them.
const MARGIN: f64 = 1e-11;

/// The most ways that are kept, 16 bytes each. Errors on more of them are added up by distance.
pub(crate) const MOST_WAYS: usize = 1 << 26;

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
    /// The ways that are left, up to [`MOST_WAYS`] and those of one face more.
    pub(crate) ways: Vec<Way>,
    sides: [Side; 3],
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
            ways: Vec::new(),
            sides: std::array::from_fn(|_| Side::default()),
        }
    }

    /// An upper bound of `d(y) - d(x) - |xy|` over all points x and y of the boundary of `face`,
    /// not less than 0, and the side on which d(y) is too long. Adds the ways across the face.
    pub(crate) fn violation(&mut self, face: FaceId) -> (f64, HalfEdgeId) {
        let mut sides = std::mem::take(&mut self.sides);
        let shape = Shape::of(self.field.mesh, face);
        for (k, side) in (0..).zip(&mut sides) {
            let h = face.half_edge(k);
            let length = shape.lengths[k as usize];
            self.field.orient(h, length, &mut side.pieces);
            side.group();
        }
        let pieces = sides.iter().flat_map(|side| &side.pieces);
        let at_ends = pieces.flat_map(|p| p.at_ends);
        let around: f64 = shape.lengths.iter().map(|l| l.hi).sum();
        let margin = MARGIN * (at_ends.fold(0.0, f64::max) + around);
        let mut most = (0.0_f64, face.half_edge(0));
        for k in 0..3 {
            let mut from_side = (0.0_f64, k);
            for step in [1, 2] {
                let there = (k + step) % 3;
                let turn = shape.turn(k, step);
                let corners = self.field.mesh.face_vertices(face);
                let ball = |corner: usize| {
                    let v = corners[corner % 3];
                    (self.field.pieces.len() + v.index(), self.radii[v.index()])
                };
                let across = Across {
                    turn: &turn,
                    near: turn.rounded(TINY * margin),
                    balls: [[ball(k), ball(k + 1)], [ball(there), ball(there + 1)]],
                    lengths: [k, there].map(|k| shape.lengths[k].middle()),
                    face,
                    margin,
                    clear: self.clear,
                };
                for i in 0..sides[k].pieces.len() {
                    let here = &sides[k].pieces;
                    let found = across.excess(here, i, &sides[there], &mut self.ways);
                    if found > from_side.0 {
                        from_side = (found, there);
                    }
                }
            }
            // What bends at a concave kink is no shorter than what goes through the piece beyond,
            // but for the jump there.
            let side = face.half_edge(k as u32);
            let jump = self.field.jumps[canonical(self.field.mesh, side).index()];
            let (found, there) = from_side;
            let violation = (found + jump).next_up();
            if violation > most.0 {
                let worst = if jump > found { k } else { there };
                most = (violation, face.half_edge(worst as u32));
            }
        }
        self.sides = sides;
        most
    }
}

/// Whether the slope of the distance decreases where `left` ends and `right` begins. Then no point
/// has its least distance by a way that bends there: it can be moved to a piece beside.
fn is_concave(left: Option<&Oriented>, right: Option<&Oriented>, margin: f64) -> bool {
    let (Some(left), Some(right)) = (left, right) else {
        return false;
    };
    let t = left.near.to;
    let sides = [left, right].map(|p| p.near.distance);
    // Slopes are right to 1e-10 where images are not too near.
    let is_far = sides.iter().all(|d| d.at(t) - d.sigma > 1e5 * margin);
    is_far && sides[0].slope(t) - sides[1].slope(t) > 1e-8
}

/// The lengths and angles of a face, from the positions in the mesh and not from its rounded
/// lengths.
struct Shape {
    lengths: [Interval; 3],
    /// Cosine and sine of the angle by which each side turns into the next.
    turns: [Vector<2>; 3],
}

impl Shape {
    fn of(mesh: &Mesh, face: FaceId) -> Self {
        let corners = mesh
            .face_vertices(face)
            .map(|v| mesh.positions()[v.index()].map(Interval::exact));
        let sides = [0, 1, 2].map(|k| minus(corners[(k + 1) % 3], corners[k]));
        let lengths = sides.map(norm);
        let turns = [0, 1, 2].map(|k| {
            let next = (k + 1) % 3;
            let product = lengths[k] * lengths[next];
            let (a, b) = (sides[k], sides[next]);
            [dot(a, b) / product, cross_length(a, b) / product]
        });
        Self { lengths, turns }
    }

    /// From the frame of side `k` to that of the next (`step` 1), or of the one after it.
    fn turn(&self, k: usize, step: usize) -> Turn {
        let length = self.lengths[(k + step) % 3];
        if step == 1 {
            return Turn {
                corner: self.lengths[k],
                unit: self.turns[k],
                offset: Interval::ZERO,
                length,
            };
        }
        let [cosine, sine] = self.turns[(k + 2) % 3];
        Turn {
            corner: Interval::ZERO,
            unit: [cosine, -sine],
            offset: length,
            length,
        }
    }
}

/// From the frame of one side of a face to that of another.
struct Turn {
    /// The corner of both, on the one side and on the other.
    corner: Interval,
    offset: Interval,
    /// The direction of the other side.
    unit: Vector<2>,
    /// Its length.
    length: Interval,
}

impl Turn {
    fn map(&self, point: Vector<2>) -> Vector<2> {
        let from_corner = [point[0] - self.corner, point[1]];
        [
            dot(from_corner, self.unit) + self.offset,
            cross(self.unit, from_corner),
        ]
    }

    fn rounded(&self, tiny: f64) -> RoundedTurn {
        RoundedTurn {
            tiny,
            corner: self.corner.middle(),
            offset: self.offset.middle(),
            unit: self.unit.map(Interval::middle),
            length: self.length.middle(),
        }
    }

    /// The least distances over the points of `piece` to the points of the other side: by the ways
    /// that bend at its ends, and between them by the straight ones.
    /// `bends` says whether ways bend at the beginning and at the end of the piece.
    fn reaches(&self, piece: &Oriented, bends: [bool; 2]) -> [Option<Reach>; 3] {
        let [x, y] = piece.distance.image;
        let image = self.map([x, -y]);
        let [left, right] = [piece.from, piece.to].map(|t| self.map([t, Interval::ZERO]));
        let bend = |t: Interval, image: Vector<2>, from: f64, to: f64| {
            let sigma = piece.distance.at(t);
            Reach::new(Distance { image, sigma }, from, to)
        };
        let straight = Distance {
            image,
            sigma: piece.distance.sigma,
        };
        // Straight ways are never longer than those that bend: in doubt they are the bound.
        let last = self.boundary(image, left).hi;
        let first = self.boundary(image, right).lo;
        let end = self.length.hi;
        [
            bends[1].then(|| bend(piece.to, right, 0.0, first)),
            Some(Reach::new(straight, first, last)),
            bends[0].then(|| bend(piece.from, left, last, end)),
        ]
    }

    /// The abscissa from which on points of the axis lie to the left of the ray from `image`
    /// through `through`.
    fn boundary(&self, image: Vector<2>, through: Vector<2>) -> Interval {
        let ray = minus(through, image);
        let left = |t: Interval| cross(ray, minus([t, Interval::ZERO], image));
        let (start, end) = (left(Interval::ZERO), left(self.length));
        let root = if start.lo > 0.0 {
            Interval::ZERO
        } else if end.hi < 0.0 {
            Interval::exact(self.length.hi)
        } else if (end - start).lo > 0.0 {
            self.length * (start / (start - end))
        } else {
            Interval::new(0.0, self.length.hi)
        };
        Interval {
            lo: root.lo.clamp(0.0, self.length.hi),
            hi: root.hi.clamp(0.0, self.length.hi),
        }
    }
}

/// A distance on a part of a side.
struct Reach {
    distance: Distance,
    from: f64,
    to: f64,
}

impl Reach {
    fn new(distance: Distance, from: f64, to: f64) -> Self {
        Self { distance, from, to }
    }

    /// How far `piece` of that side is above it, at most.
    fn excess(&self, piece: &Oriented) -> f64 {
        let from = piece.from.lo.max(self.from);
        let to = piece.to.hi.min(self.to);
        if self.from >= self.to || from > to {
            return 0.0;
        }
        greatest_difference(&piece.distance, &self.distance, from, to)
    }
}

/// As [`Turn`], in rounded arithmetic.
#[derive(Clone, Copy)]
struct RoundedTurn {
    corner: f64,
    offset: f64,
    unit: [f64; 2],
    length: f64,
    /// Ways that rounding may have made.
    tiny: f64,
}

impl RoundedTurn {
    fn map(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (x, [c, s]) = (x - self.corner, self.unit);
        [x * c + y * s + self.offset, c * y - s * x]
    }

    /// As [`Turn::reaches`], by the distances at the ends of `part`.
    fn reaches(&self, part: &Part, at_ends: [f64; 2]) -> [Part; 3] {
        let Rounded { image: [x, y], .. } = part.distance;
        let image = self.map([x, -y]);
        let bend = |t: f64, sigma: f64| Rounded {
            image: self.map([t, 0.0]),
            sigma,
        };
        let [left, right] =
            [(part.from, at_ends[0]), (part.to, at_ends[1])].map(|(t, d)| bend(t, d));
        let straight = Rounded {
            image,
            sigma: part.distance.sigma,
        };
        let first = self.boundary(image, right.image, 0.0);
        let last = self.boundary(image, left.image, self.length);
        let on = |distance: Rounded, from: f64, to: f64| Part {
            distance,
            from,
            to,
            node: part.node,
        };
        [
            on(right, 0.0, first),
            on(straight, first, last.max(first)),
            on(left, last, self.length),
        ]
    }

    fn boundary(&self, image: [f64; 2], through: [f64; 2], in_doubt: f64) -> f64 {
        let ray = [through[0] - image[0], through[1] - image[1]];
        if ray[0].abs() + ray[1].abs() <= self.tiny {
            return in_doubt;
        }
        // Left of the ray at 0, and by how much more at the end.
        let start = ray[1] * image[0] - ray[0] * image[1];
        let rise = -ray[1] * self.length;
        if rise > 0.0 {
            (self.length * (-start / rise)).clamp(0.0, self.length)
        } else if start + rise / 2.0 > 0.0 {
            // No ray that leads away meets the side but in its corner, where the image is then.
            0.0
        } else {
            self.length
        }
    }

    /// Whether the distance by `reaches` is more than those of all pieces of a block by `clear`.
    ///
    /// The distance at y is the least `d(x) + |xy|` over points x, so it changes by at most the way
    /// along the side: on the block it is at least that in the middle less half the block. `clear`
    /// covers rounding, also of the abscissas between the ways: there both ways have one length and
    /// one direction, so that the wrong one of them is longer only to second order.
    fn is_block_beyond(reaches: &[Part; 3], block: &Block, clear: f64) -> bool {
        let t = block.middle;
        let k = usize::from(t > reaches[0].to) + usize::from(t > reaches[1].to);
        let Rounded {
            image: [x, y],
            sigma,
        } = reaches[k].distance;
        let x = t - x;
        let least = block.top - sigma + block.half + clear;
        least <= 0.0 || x * x + y * y >= least * least
    }

    /// Whether the distance by `reaches` is more than that of `piece` by `clear` everywhere, as told
    /// by its middle alone.
    fn is_beyond(reaches: &[Part; 3], piece: &Oriented, clear: f64) -> bool {
        let [t, d] = piece.middle;
        let k = usize::from(t > reaches[0].to) + usize::from(t > reaches[1].to);
        let Rounded {
            image: [x, y],
            sigma,
        } = reaches[k].distance;
        let (x, width) = (t - x, piece.near.to - piece.near.from);
        let square = x * x + y * y;
        // Both distances change by at most the way along the side.
        let least = d - sigma + width + clear;
        if least <= 0.0 || square >= least * least {
            return true;
        }
        let way = square.sqrt();
        if way <= width {
            // Rounding of the image would tell in the slope.
            return false;
        }
        // Both are convex, since the way is and distances are: the one by `reaches` is above its
        // tangent, and that of the piece is farthest above the tangent at one of its ends.
        let (reach, rise) = (sigma + way, x / way * (width / 2.0));
        let [first, last] = piece.at_ends;
        (first + rise).max(last - rise) + clear <= reach
    }
}

/// All ways from one side of a face to another.
struct Across<'a> {
    turn: &'a Turn,
    near: RoundedTurn,
    /// Nodes and sizes of the neighbourhoods of the ends of both sides.
    balls: [[(usize, f64); 2]; 2],
    lengths: [f64; 2],
    face: FaceId,
    margin: f64,
    clear: f64,
}

impl Across<'_> {
    /// How far the distances of `there` are above those by piece `i` of the side `here`, at most.
    /// Ways that bend at its ends do not count where the distance has a concave kink.
    fn excess(&self, here: &[Oriented], i: usize, there: &Side, ways: &mut Vec<Way>) -> f64 {
        let piece = &here[i];
        let clear = self.clear + self.margin;
        let Some(whole) = &there.whole else {
            return 0.0;
        };
        // A distance changes by at most the way: no point of the piece is nearer than this.
        let width = piece.near.to - piece.near.from;
        if piece.at_ends[0].max(piece.at_ends[1]) - width >= whole.top + clear {
            return 0.0;
        }
        let reaches = self.near.reaches(&piece.near, piece.at_ends);
        let is_near = |block: &&Block| !RoundedTurn::is_block_beyond(&reaches, block, clear);
        if !is_near(&whole) {
            return 0.0;
        }
        let mut exact = None;
        let mut most = 0.0_f64;
        let blocks = &there.blocks;
        let blocks = blocks.iter().filter(is_near);
        for other in blocks.flat_map(|block| &there.pieces[block.first..block.end]) {
            if RoundedTurn::is_beyond(&reaches, other, clear) {
                continue;
            }
            let found = self.differences(&reaches, &other.near);
            let upper = found.into_iter().fold(f64::NEG_INFINITY, f64::max) + self.margin;
            if upper <= -self.clear {
                continue;
            }
            if upper > -self.margin {
                let exact = exact.get_or_insert_with(|| {
                    let bends = |left, right| !is_concave(left, right, self.margin);
                    let before = i.checked_sub(1).map(|i| &here[i]);
                    let bends = [
                        bends(before, Some(piece)),
                        bends(Some(piece), here.get(i + 1)),
                    ];
                    self.turn.reaches(piece, bends)
                });
                for (k, reach) in exact.iter().enumerate() {
                    let Some(reach) = reach else { continue };
                    if !self.is_below(found[k], reach, &reaches[k]) {
                        most = most.max(reach.excess(other));
                    }
                }
            }
            self.connect(&piece.near, &other.near, upper, ways);
        }
        most
    }

    /// Whether a piece is nowhere above `reach`, as told by how far it is above `near`, the same
    /// rounded, where that begins and ends as `reach` does.
    fn is_below(&self, difference: f64, reach: &Reach, near: &Part) -> bool {
        let off = (reach.from - near.from).abs() + (reach.to - near.to).abs();
        let lies_beside = difference == f64::NEG_INFINITY;
        !lies_beside && off <= self.margin / 8.0 && difference <= -2.0 * self.margin
    }

    /// At least how far `other` is above the nearest of `reaches`.
    fn upper(&self, reaches: &[Part; 3], other: &Part) -> f64 {
        let found = self.differences(reaches, other).into_iter();
        found.fold(f64::NEG_INFINITY, f64::max) + self.margin
    }

    /// How far `other` is above each of `reaches`, but for rounding; minus infinity where it lies
    /// beside.
    fn differences(&self, reaches: &[Part; 3], other: &Part) -> [f64; 3] {
        [0, 1, 2].map(|k| {
            let reach = &reaches[k];
            let (from, to) = (reach.from.max(other.from), reach.to.min(other.to));
            if from > to {
                return f64::NEG_INFINITY;
            }
            let distance = &reach.distance;
            other.distance.excess(distance, from, to, self.near.tiny)
        })
    }

    /// Adds the ways between the nodes of two pieces.
    fn connect(&self, piece: &Part, other: &Part, upper: f64, ways: &mut Vec<Way>) {
        let mut add = |from: &Part, to: &Part, upper: f64| {
            if upper > -self.clear && ways.len() <= MOST_WAYS {
                ways.push(Way {
                    from: from.node as u32,
                    to: to.node as u32,
                    face: self.face,
                    excess: (upper as f32).next_up(),
                });
            }
        };
        let parts = self.split(0, piece);
        let others = self.split(1, other);
        if parts[1..].iter().chain(&others[1..]).all(Option::is_none) {
            if let ([Some(part), ..], [Some(other), ..]) = (parts, others)
                && part.node != other.node
            {
                add(&part, &other, upper);
            }
            return;
        }
        for part in parts.iter().flatten() {
            let mut reaches = None;
            for other in others
                .iter()
                .flatten()
                .filter(|other| other.node != part.node)
            {
                let reaches = reaches.get_or_insert_with(|| {
                    let at_ends = [part.from, part.to].map(|t| part.distance.at(t));
                    self.near.reaches(part, at_ends)
                });
                add(part, other, self.upper(reaches, other));
            }
        }
    }

    /// The parts of a piece in the neighbourhoods of the ends of the side, and between them.
    fn split(&self, side: usize, piece: &Part) -> [Option<Part>; 3] {
        let [(tail, near_tail), (head, near_head)] = self.balls[side];
        let near_head = self.lengths[side] - near_head;
        let bounds = [
            (f64::NEG_INFINITY, near_tail, tail),
            (near_tail, near_head, piece.node),
            (near_head, f64::INFINITY, head),
        ];
        let mut parts = [None; 3];
        let mut count = 0;
        for (from, to, node) in bounds {
            if piece.from < to && piece.to > from {
                parts[count] = Some(Part {
                    from: piece.from.max(from),
                    to: piece.to.min(to),
                    node,
                    ..*piece
                });
                count += 1;
            }
        }
        if count == 0 {
            // A piece of no length.
            parts[0] = Some(*piece);
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let far = Piece {
            from: 1.4883927423876347e-15,
            to: 8.178653061323015e-5,
            image: [-0.03639741439737471, 0.0034468109485394187],
            sigma: 0.05372740948147406,
        };
        let near = Piece {
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
