//! The shape of a face, and distances on one side by paths from another side.

use geobench_mesh::{FaceId, Mesh};

use crate::ball::{Ball, BallVector, cross, cross_length, dot, minus, norm};
use crate::difference::{Chord, Distance, RoundedDistance, greatest_difference};
use crate::field::{ExactPiece, SidePiece};
use crate::interval::{Interval, greater, lesser};

/// The lengths and angles of a face, from the positions in the mesh and not from its rounded
/// lengths.
pub(crate) struct FaceShape {
    pub(crate) lengths: [Ball; 3],
    /// Cosine and sine of the angle by which each side turns into the next.
    turns: [BallVector<2>; 3],
}

impl FaceShape {
    pub(crate) fn of(mesh: &Mesh, face: FaceId) -> Self {
        let corners = mesh
            .face_vertices(face)
            .map(|v| mesh.positions()[v.index()].map(Ball::exact));
        let sides = [0, 1, 2].map(|k| minus(corners[(k + 1) % 3], corners[k]));
        let lengths = sides.map(norm);
        // The cross product is the same for all pairs, and best known for the shortest.
        let from = |k: usize| lengths[k].middle() + lengths[(k + 1) % 3].middle();
        let k = (1..3).fold(0, |best, k| if from(k) < from(best) { k } else { best });
        let double_area = cross_length(sides[k], sides[(k + 1) % 3]);
        let turns = [0, 1, 2].map(|k| {
            let next = (k + 1) % 3;
            let product = lengths[k] * lengths[next];
            [dot(sides[k], sides[next]) / product, double_area / product]
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
                offset: Ball::ZERO,
                length,
            };
        }
        let [cosine, sine] = self.turns[(k + 2) % 3];
        SideTransform {
            corner: Ball::ZERO,
            unit: [cosine, -sine],
            offset: length,
            length,
        }
    }
}

/// From the frame of one side of a face to that of another.
pub(crate) struct SideTransform {
    /// The abscissas of the shared corner on the one side (`corner`) and on the other (`offset`).
    corner: Ball,
    offset: Ball,
    /// The direction of the other side.
    unit: BallVector<2>,
    /// Its length.
    length: Ball,
}

impl SideTransform {
    fn map(&self, point: BallVector<2>) -> BallVector<2> {
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
            unit: self.unit.map(Ball::middle),
            length: self.length.middle(),
        }
    }

    /// The distance function of straight paths from the image of `distance` across the one side.
    pub(crate) fn straight(&self, distance: &Distance) -> Distance {
        let [x, y] = distance.image;
        Distance {
            image: self.map([x, -y]),
            sigma: distance.sigma,
        }
    }

    /// Where the straight paths from an image through `piece` end on the other side and the bent
    /// ones begin: those at the end of `piece`, or at its beginning.
    pub(crate) fn border(
        &self,
        piece: &ExactPiece,
        straight: &Distance,
        at_end: bool,
        bends: bool,
    ) -> Border {
        let t = if at_end { piece.to } else { piece.from };
        let image = self.map([t, Ball::ZERO]);
        let at = self.boundary(straight.image, image);
        Border {
            // Straight distances are never longer than bent ones, so in doubt the straight range is
            // extended.
            at: if at_end { at.lo } else { at.hi },
            bend: bends.then(|| Distance {
                image,
                sigma: piece.distance.at(t),
            }),
        }
    }

    /// The abscissa from which on points of the axis lie to the left of the ray from `image`
    /// through `through`.
    fn boundary(&self, image: BallVector<2>, through: BallVector<2>) -> Interval {
        let ray = minus(through, image);
        let left = |t: Ball| cross(ray, minus([t, Ball::ZERO], image)).interval();
        let (start, end) = (left(Ball::ZERO), left(self.length));
        let length = self.length.interval();
        let root = if start.lo > 0.0 {
            Interval::ZERO
        } else if end.hi < 0.0 {
            Interval::exact(length.hi)
        } else if (end - start).lo > 0.0 {
            length * (start / (start - end))
        } else {
            Interval::new(0.0, length.hi)
        };
        Interval {
            lo: root.lo.clamp(0.0, length.hi),
            hi: root.hi.clamp(0.0, length.hi),
        }
    }
}

/// An end of the range of straight paths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Border {
    pub(crate) at: f64,
    /// The distance function of the bent paths beyond; `None` if they are left out.
    pub(crate) bend: Option<Distance>,
}

/// An upper bound of how much `piece` is above `distance` from abscissa `from` to `to`; 0 if the
/// piece lies outside this interval.
pub(crate) fn excess(piece: &ExactPiece, distance: &Distance, [from, to]: [f64; 2]) -> f64 {
    let (first, last) = (
        greater(piece.from.lower(), from),
        lesser(piece.to.upper(), to),
    );
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
    /// Vectors shorter than this may be rounding noise.
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

    /// The distance between points of the two sides.
    pub(crate) fn distance(&self, from: f64, to: f64) -> f64 {
        let [x, y] = self.map([from, 0.0]);
        ((x - to) * (x - to) + y * y).sqrt()
    }

    /// As [`SideTransform::straight`].
    pub(crate) fn straight(&self, distance: &RoundedDistance) -> RoundedDistance {
        let [x, y] = distance.image;
        RoundedDistance {
            image: self.map([x, -y]),
            sigma: distance.sigma,
        }
    }

    /// The least distances over the points of `piece`, as functions on the other side.
    pub(crate) fn reaches(&self, piece: &SidePiece, straight: RoundedDistance) -> LeastDistance {
        let image = straight.image;
        let bend = |t: f64, sigma: f64| RoundedDistance {
            image: self.map([t, 0.0]),
            sigma,
        };
        let left = bend(piece.from, piece.at_ends()[0]);
        let right = bend(piece.to, piece.at_ends()[1]);
        let first = self.boundary(image, right.image, 0.0);
        let last = self.boundary(image, left.image, self.length);
        LeastDistance {
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
            // A ray that leads away from the side meets it at most in a corner, if the image lies
            // there.
            0.0
        } else {
            self.length
        }
    }
}

/// The least distances over the points of a piece, as functions on another side, in rounded
/// arithmetic.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeastDistance {
    /// Distances by paths (0) bent at the end of the piece, (1) straight, (2) bent at its start.
    distances: [RoundedDistance; 3],
    /// The abscissas at which the three parts begin and end.
    bounds: [f64; 4],
    tiny: f64,
}

impl LeastDistance {
    /// The distances of part `k`.
    pub(crate) fn distance(&self, k: usize) -> &RoundedDistance {
        &self.distances[k]
    }

    /// The abscissas at which part `k` begins and ends.
    pub(crate) fn bounds(&self, k: usize) -> [f64; 2] {
        [self.bounds[k], self.bounds[k + 1]]
    }

    /// Whether a chord is everywhere below the least of the three by more than `clear`, judged by
    /// the tangent in the middle of the chord.
    ///
    /// The least of the three is convex, so it is nowhere below its tangent. If rounding selects
    /// the wrong part, the two parts have the same value and slope there up to second order, unless
    /// the path is short.
    pub(crate) fn is_above(&self, chord: &Chord, clear: f64) -> bool {
        let t = chord.middle;
        let k = usize::from(t > self.bounds[1]) + usize::from(t > self.bounds[2]);
        if k == 1 {
            // Callers have compared it with the straight distance.
            return false;
        }
        let distance = &self.distances[k];
        chord.is_shorter_than_distance(distance) && chord.is_below(distance, clear)
    }

    /// An upper bound, up to `error`, of how much `other` is above the least of the three. In doubt
    /// where a part begins, both parts are compared: beyond its ends, a straight distance is less
    /// than the least, and a bent one is not.
    pub(crate) fn below(&self, other: &SidePiece, error: f64) -> f64 {
        let [.., first, last, _] = self.bounds;
        let doubts = [0, 2].map(|k| self.doubt(k, error));
        let last_bend = if last > first {
            last - doubts[1]
        } else {
            f64::NEG_INFINITY
        };
        let ranges = [
            [f64::NEG_INFINITY, first + doubts[0]],
            [first - doubts[0], last + doubts[1]],
            [last_bend, f64::INFINITY],
        ];
        let parts = self
            .distances
            .iter()
            .zip(ranges)
            .map(|(distance, [from, to])| {
                let (from, to) = (greater(from, other.from), lesser(to, other.to));
                if from > to {
                    return f64::NEG_INFINITY;
                }
                let at_ends = [(from, other.from, 0), (to, other.to, 1)].map(|(t, end, i)| {
                    if t == end {
                        other.at_ends()[i]
                    } else {
                        other.distance.at(t)
                    }
                });
                let bound = distance.below_chord([from, to], at_ends);
                if bound > error {
                    lesser(bound, other.distance.peak(distance))
                } else {
                    bound
                }
            });
        parts.fold(f64::NEG_INFINITY, greater)
    }

    /// More than the error of the end of the straight part that lies beside part `k`, if the
    /// coordinates of images are known up to a quarter of `error`.
    ///
    /// Let the line through the image I and the end P of the piece meet the side at an angle with
    /// sine s and cosine c, and let e be the error of both points. Moving one of them turns the
    /// line about the other. So it moves the end by at most `e (|y_I| + |y_P|) / (|y_P - y_I| s)`,
    /// and a little more if e is no more than a hundredth of the difference. Rounding of the
    /// products adds at most `e/s`. Where the line is too flat, the end is known only if all of the
    /// side lies clearly on one side of it.
    fn doubt(&self, k: usize, error: f64) -> f64 {
        let (image, through) = (self.distances[1].image, self.distances[k].image);
        let ray = [through[0] - image[0], through[1] - image[1]];
        let [run, rise] = ray.map(f64::abs);
        let is_towards = ray[1] < 0.0;
        if is_towards && rise > 25.0 * error {
            let slant = (run + rise) / rise;
            return slant * error * ((image[1].abs() + through[1].abs()) / rise + 1.0);
        }
        let left = |t: f64| ray[0] * -image[1] - ray[1] * (t - image[0]);
        let (start, end) = (left(0.0), left(self.bounds[3]));
        let reach = run + rise + image[0].abs() + image[1].abs() + self.bounds[3];
        let clear = 4.0 * error * reach;
        if start > clear && end > clear || start < -clear && end < -clear {
            0.0
        } else {
            f64::INFINITY
        }
    }

    /// How much `other` is above each of the three, up to rounding; minus infinity where it lies
    /// outside the part.
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
