//! The shape of a face, and distances on one side of it by ways from another.

use geobench_mesh::{FaceId, Mesh};

use crate::difference::{Chord, Distance, Rounded, greatest_difference};
use crate::field::{ExactPiece, SidePiece};
use crate::interval::{
    Interval, IntervalVector, cross, cross_length, dot, greater, lesser, minus, norm,
};

/// The lengths and angles of a face, from the positions in the mesh and not from its rounded
/// lengths.
pub(crate) struct FaceShape {
    pub(crate) lengths: [Interval; 3],
    /// Cosine and sine of the angle by which each side turns into the next.
    turns: [IntervalVector<2>; 3],
}

impl FaceShape {
    pub(crate) fn of(mesh: &Mesh, face: FaceId) -> Self {
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
    pub(crate) fn transform(&self, k: usize, step: usize) -> SideTransform {
        let length = self.lengths[(k + step) % 3];
        if step == 1 {
            return SideTransform {
                corner: self.lengths[k],
                unit: self.turns[k],
                offset: Interval::ZERO,
                length,
            };
        }
        let [cosine, sine] = self.turns[(k + 2) % 3];
        SideTransform {
            corner: Interval::ZERO,
            unit: [cosine, -sine],
            offset: length,
            length,
        }
    }
}

/// From the frame of one side of a face to that of another.
pub(crate) struct SideTransform {
    /// The corner of both, on the one side and on the other.
    corner: Interval,
    offset: Interval,
    /// The direction of the other side.
    unit: IntervalVector<2>,
    /// Its length.
    length: Interval,
}

impl SideTransform {
    fn map(&self, point: IntervalVector<2>) -> IntervalVector<2> {
        let from_corner = [point[0] - self.corner, point[1]];
        [
            dot(from_corner, self.unit) + self.offset,
            cross(self.unit, from_corner),
        ]
    }

    pub(crate) fn rounded(&self, tiny: f64) -> RoundedTransform {
        RoundedTransform {
            tiny,
            corner: self.corner.middle(),
            offset: self.offset.middle(),
            unit: self.unit.map(Interval::middle),
            length: self.length.middle(),
        }
    }

    /// The distances by the straight ways from the image of a distance across the one side.
    pub(crate) fn straight(&self, distance: &Distance) -> Distance {
        let [x, y] = distance.image;
        Distance {
            image: self.map([x, -y]),
            sigma: distance.sigma,
        }
    }

    /// Where the straight ways from an image through `piece` end on the other side, and the ways that
    /// bend there begin: on the side of the end of `piece`, or of its beginning.
    pub(crate) fn border(
        &self,
        piece: &ExactPiece,
        straight: &Distance,
        at_end: bool,
        bends: bool,
    ) -> Border {
        let t = if at_end { piece.to } else { piece.from };
        let image = self.map([t, Interval::ZERO]);
        let at = self.boundary(straight.image, image);
        Border {
            // Straight ways are never longer than those that bend: in doubt they are the bound.
            at: if at_end { at.lo } else { at.hi },
            bend: bends.then(|| Distance {
                image,
                sigma: piece.distance.at(t),
            }),
        }
    }

    /// The abscissa from which on points of the axis lie to the left of the ray from `image`
    /// through `through`.
    fn boundary(&self, image: IntervalVector<2>, through: IntervalVector<2>) -> Interval {
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

/// Where straight ways end.
#[derive(Clone, Copy)]
pub(crate) struct Border {
    pub(crate) at: f64,
    /// The distance beyond, by the ways that bend; `None` if these do not count.
    pub(crate) bend: Option<Distance>,
}

/// How far `piece` is above a distance from abscissa `from` to `to`, at most; 0 where it lies beside.
pub(crate) fn excess(piece: &ExactPiece, distance: &Distance, [from, to]: [f64; 2]) -> f64 {
    let (first, last) = (greater(piece.from.lo, from), lesser(piece.to.hi, to));
    if from >= to || first > last {
        return 0.0;
    }
    greatest_difference(&piece.distance, distance, first, last)
}

/// As [`SideTransform`], in rounded arithmetic.
#[derive(Clone, Copy)]
pub(crate) struct RoundedTransform {
    corner: f64,
    offset: f64,
    unit: [f64; 2],
    length: f64,
    /// Ways that rounding may have made.
    tiny: f64,
}

impl RoundedTransform {
    fn map(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (x, [c, s]) = (x - self.corner, self.unit);
        [x * c + y * s + self.offset, c * y - s * x]
    }

    /// Whether all is known that it is made of.
    pub(crate) fn is_finite(&self) -> bool {
        self.unit.iter().all(|x| x.is_finite())
    }

    /// The way between points of the two sides.
    pub(crate) fn way(&self, from: f64, to: f64) -> f64 {
        let [x, y] = self.map([from, 0.0]);
        ((x - to) * (x - to) + y * y).sqrt()
    }

    /// As [`SideTransform::straight`].
    pub(crate) fn straight(&self, distance: &Rounded) -> Rounded {
        let [x, y] = distance.image;
        Rounded {
            image: self.map([x, -y]),
            sigma: distance.sigma,
        }
    }

    /// The least distances over the points of `piece` to the points of the other side.
    pub(crate) fn reaches(&self, piece: &SidePiece, straight: Rounded) -> Reaches {
        let image = straight.image;
        let bend = |t: f64, sigma: f64| Rounded {
            image: self.map([t, 0.0]),
            sigma,
        };
        let left = bend(piece.from, piece.at_ends()[0]);
        let right = bend(piece.to, piece.at_ends()[1]);
        let first = self.boundary(image, right.image, 0.0);
        let last = self.boundary(image, left.image, self.length);
        Reaches {
            distances: [right, straight, left],
            bounds: [0.0, first, greater(last, first), self.length],
            tiny: self.tiny,
        }
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
}

/// The least distances over the points of a piece to the points of another side, in rounded
/// arithmetic.
#[derive(Clone, Copy)]
pub(crate) struct Reaches {
    /// By the ways that bend at the end of the piece, by the straight ones, and by those that bend
    /// at its beginning.
    distances: [Rounded; 3],
    /// Where each of them begins and ends.
    bounds: [f64; 4],
    tiny: f64,
}

impl Reaches {
    /// Where one of the three begins and ends.
    pub(crate) fn bounds(&self, k: usize) -> [f64; 2] {
        [self.bounds[k], self.bounds[k + 1]]
    }

    /// Whether a chord is everywhere below the least of the three by more than `clear`, as told by
    /// that at its middle alone.
    ///
    /// The least of them is convex, since the way is and distances are: nowhere below its tangent.
    /// Where rounding takes the wrong one, both have one value and one slope but for its second
    /// order, unless the way is short.
    pub(crate) fn is_above(&self, chord: &Chord, clear: f64) -> bool {
        let t = chord.middle;
        let k = usize::from(t > self.bounds[1]) + usize::from(t > self.bounds[2]);
        if k == 1 {
            // Callers have compared it with the straight distance.
            return false;
        }
        let distance = &self.distances[k];
        chord.is_shorter_than_way(distance) && chord.is_below(distance, clear)
    }

    /// How far `other` is above each of the three, but for rounding; minus infinity where it lies
    /// beside.
    pub(crate) fn differences(&self, other: &SidePiece) -> [f64; 3] {
        [0, 1, 2].map(|k| {
            let from = greater(self.bounds[k], other.from);
            let to = lesser(self.bounds[k + 1], other.to);
            if from > to {
                return f64::NEG_INFINITY;
            }
            let distance = &self.distances[k];
            other.distance.excess(distance, from, to, self.tiny)
        })
    }
}
