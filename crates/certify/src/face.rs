//! Whether a distance on the boundary of a face grows no faster than the way inside the face.

use geobench_mesh::{FaceId, HalfEdgeId, Mesh};

use crate::difference::{Distance, greatest_difference};
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
}

/// The half-edge under which the pieces of the edge of `h` are stored.
pub(crate) fn canonical(mesh: &Mesh, h: HalfEdgeId) -> HalfEdgeId {
    mesh.twin(h).map_or(h, |twin| twin.min(h))
}

/// A piece in the frame of a half-edge of the edge, in whichever direction.
struct Oriented {
    from: Interval,
    to: Interval,
    distance: Distance,
}

impl EdgeField<'_> {
    /// The pieces of the edge of `h` in the direction of the canonical half-edge.
    pub(crate) fn pieces(&self, h: HalfEdgeId) -> &[Piece] {
        let h = canonical(self.mesh, h).index();
        &self.pieces[self.starts[h]..self.starts[h + 1]]
    }

    fn oriented(&self, h: HalfEdgeId, length: Interval) -> Vec<Oriented> {
        let reverse = canonical(self.mesh, h) != h;
        // The length in the mesh is rounded; the last piece ends where the edge does.
        let rounded = self.mesh.length(h);
        let turn = |t: f64| length - Interval::exact(t);
        let pieces = self.pieces(h).iter().map(|piece| {
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
            Oriented {
                from,
                to,
                distance: Distance {
                    image: [x, Interval::exact(y.abs())],
                    sigma: Interval::exact(piece.sigma),
                },
            }
        });
        let mut oriented: Vec<Oriented> = pieces.collect();
        if reverse {
            oriented.reverse();
        }
        oriented
    }

    /// An upper bound of `d(y) - d(x) - |xy|` over all points x and y of the boundary of `face`,
    /// not less than 0.
    pub(crate) fn violation(&self, face: FaceId) -> f64 {
        let sides = Side::of(self.mesh, face);
        let half_edges = [0, 1, 2].map(|corner| face.half_edge(corner));
        let pieces: [Vec<Oriented>; 3] =
            std::array::from_fn(|k| self.oriented(half_edges[k], sides[k].length));
        let mut most = 0.0_f64;
        for k in 0..3 {
            most = most.max(jumps(&pieces[k]));
            for step in [1, 2] {
                let there = (k + step) % 3;
                let turn = Turn::new(&sides[k], sides[there].length, step);
                for piece in &pieces[k] {
                    for reach in turn.reaches(piece) {
                        most = most.max(reach.excess(&pieces[there]));
                    }
                }
            }
        }
        most
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

    /// About the least distance on the boundary of `face`, at most 1e-9 of it too large.
    pub(crate) fn least(&self, face: FaceId) -> f64 {
        let edges = [0, 1, 2].map(|corner| face.half_edge(corner));
        let pieces = edges.iter().flat_map(|&h| self.pieces(h));
        let least = |p: &Piece| {
            let nearest = p.image[0].max(p.from).min(p.to);
            p.sigma + (nearest - p.image[0]).hypot(p.image[1])
        };
        pieces.map(least).fold(f64::INFINITY, f64::min)
    }
}

/// The sum of all jumps between neighbouring pieces: along the edge itself the distance grows no
/// faster than the way but there.
fn jumps(pieces: &[Oriented]) -> f64 {
    let sum = pieces.windows(2).fold(Interval::ZERO, |sum, pair| {
        let t = pair[0].to;
        sum + (pair[0].distance.at(t) - pair[1].distance.at(t)).abs()
    });
    sum.hi
}

/// A side of a face as the abscissa axis: the third corner lies at `apex`, above it. From the
/// positions in the mesh, not from its rounded lengths.
struct Side {
    length: Interval,
    apex: Vector<2>,
}

impl Side {
    fn of(mesh: &Mesh, face: FaceId) -> [Self; 3] {
        let corners = mesh
            .face_vertices(face)
            .map(|v| mesh.positions()[v.index()].map(Interval::exact));
        [0, 1, 2].map(|k| {
            let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
            let (ab, ac) = (minus(b, a), minus(c, a));
            let length = norm(ab);
            Self {
                length,
                apex: [dot(ab, ac) / length, cross_length(ab, ac) / length],
            }
        })
    }
}

/// From the frame of one side of a face to that of another.
struct Turn {
    origin: Vector<2>,
    unit: Vector<2>,
    length: Interval,
}

impl Turn {
    /// To the next side (`step` 1), or to the one after it, of this length.
    fn new(side: &Side, length: Interval, step: usize) -> Self {
        let end = [side.length, Interval::ZERO];
        let (origin, head) = if step == 1 {
            (end, side.apex)
        } else {
            (side.apex, [Interval::ZERO; 2])
        };
        Self {
            origin,
            unit: minus(head, origin).map(|x| x / length),
            length,
        }
    }

    fn map(&self, point: Vector<2>) -> Vector<2> {
        let from_origin = minus(point, self.origin);
        [dot(from_origin, self.unit), cross(self.unit, from_origin)]
    }

    /// The least distances over the points of `piece` to the points of the other side: by the ways
    /// that bend at its ends, and between them by the straight ones.
    fn reaches(&self, piece: &Oriented) -> [Reach; 3] {
        let [x, y] = piece.distance.image;
        let image = self.map([x, -y]);
        let bend = |t: Interval| {
            let point = [t, Interval::ZERO];
            Distance {
                image: self.map(point),
                sigma: piece.distance.at(t),
            }
        };
        let (left, right) = (bend(piece.from), bend(piece.to));
        let straight = Distance {
            image,
            sigma: piece.distance.sigma,
        };
        // Straight ways are never longer than those that bend: in doubt they are the bound.
        let last = self.boundary(image, left.image).hi;
        let first = self.boundary(image, right.image).lo;
        [
            Reach::new(right, 0.0, first),
            Reach::new(straight, first, last),
            Reach::new(left, last, self.length.hi),
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

    /// How far the pieces of that side are above it, at most.
    fn excess(&self, pieces: &[Oriented]) -> f64 {
        if self.from >= self.to {
            return 0.0;
        }
        let first = pieces.partition_point(|p| p.to.hi < self.from);
        let meets = pieces[first..].iter().take_while(|p| p.from.lo <= self.to);
        meets
            .map(|p| {
                let (from, to) = (p.from.lo.max(self.from), p.to.hi.min(self.to));
                greatest_difference(&p.distance, &self.distance, from, to.max(from))
            })
            .fold(0.0, f64::max)
    }
}
