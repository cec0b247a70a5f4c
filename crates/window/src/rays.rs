//! Windows of cones and of parallel rays, for sources that are curves.

use crate::crossing::Crossing;
use crate::filter::is_beaten_from_ends;
use crate::frame::{FaceView, Frame, HalfEdgeBeyond, Side};
use crate::precision::MARGIN;
use crate::window::{Window, norm};

/// Parallel rays through one half-edge, from a straight segment at distance 0 to which they are
/// perpendicular; in the frame of that half-edge, about to enter its face.
///
/// It is a [`Window`] whose source is at infinity. The distance is linear in the plane: `offset` at
/// the tail of the half-edge, and more by the way in the direction of the rays.
///
/// ```
/// use geobench_window::Beam;
///
/// // A segment 3 below the edge and parallel to it.
/// let beam = Beam { b0: 0.0, b1: 4.0, direction: [0.0, 1.0], offset: 3.0 };
/// assert_eq!(beam.distance(1.0), 3.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Left end of the interval; 0 ≤ `b0` < `b1`.
    pub b0: f64,
    /// Right end of the interval, at most the length of the half-edge.
    pub b1: f64,
    /// Unit vector along the rays. Its ordinate is not negative.
    pub direction: [f64; 2],
    /// The distance at the tail of the half-edge, which may be outside the interval.
    pub offset: f64,
}

/// A window of a point, or of a straight segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rays {
    /// From a point.
    Cone(Window),
    /// From a segment.
    Beam(Beam),
}

/// The result of crossing a face: a path to the apex, and windows on the exits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossedRays {
    /// Length of the shortest path to the apex: straight, or bent at an end of the interval.
    pub distance: f64,
    /// The abscissa at which that path enters the face.
    pub entry: f64,
    /// The windows on the left and on the right exit, in the frames of the half-edges there.
    pub children: [Option<Rays>; 2],
}

impl Beam {
    /// The distance that the beam offers at abscissa `x` of its edge.
    #[inline]
    pub fn distance(&self, x: f64) -> f64 {
        self.offset + self.direction[0] * x
    }

    /// The distance at a point of the plane, if a ray passes there.
    fn distance_at(&self, [x, y]: [f64; 2]) -> f64 {
        self.offset + (self.direction[0] * x + self.direction[1] * y)
    }

    /// Crosses a face, as [`Crossing`]: the limit of its formulas for a source at infinity.
    fn cross(&self, view: &FaceView) -> CrossedRays {
        let Frame {
            l, la, lb, cx, cy, ..
        } = view.frame;
        let [ux, uy] = self.direction;
        // s·uy - separation is negative for rays that leave through AC.
        let separation = uy * cx - ux * cy;
        let [side0, side1] = [self.b0, self.b1].map(|s| s * uy - separation);
        // A ray divides an exit as n : m, two areas that are not negative.
        let on_left = |s: f64, side: f64| {
            let (n, m) = (uy * s, (-side).max(0.0));
            la * n / (n + m)
        };
        let on_right = |s: f64, side: f64| {
            let (n, m) = (side.max(0.0), uy * (l - s));
            lb * n / (n + m)
        };
        let (goes_left, goes_right) = (side0 < 0.0, side1 > 0.0);
        let left = goes_left.then(|| {
            let b1 = if goes_right {
                la
            } else {
                on_left(self.b1, side1)
            };
            self.turned(view, Side::Left, on_left(self.b0, side0), b1)
        });
        let right = (goes_right || !goes_left).then(|| {
            let b0 = if goes_left {
                0.0
            } else {
                on_right(self.b0, side0)
            };
            self.turned(view, Side::Right, b0, on_right(self.b1, side1))
        });
        let is_straight = goes_left && goes_right;
        let bend = if goes_left { self.b1 } else { self.b0 };
        let (distance, entry) = if is_straight {
            let entry = (separation / uy).max(self.b0).min(self.b1);
            (self.distance_at([cx, cy]), entry)
        } else {
            (self.distance(bend) + norm(cx - bend, cy), bend)
        };
        CrossedRays {
            distance,
            entry,
            children: [left.flatten(), right.flatten()],
        }
    }

    /// The beam between `b0` and `b1` of an exit, in the frame of the half-edge there; `None` if
    /// the interval is empty.
    fn turned(&self, view: &FaceView, side: Side, b0: f64, b1: f64) -> Option<Rays> {
        let exit = view.exit(side);
        let [wx, wy] = exit.direction;
        let [ux, uy] = self.direction;
        let start = match side {
            Side::Left => [0.0; 2],
            Side::Right => [view.frame.cx, view.frame.cy],
        };
        let (b0, b1) = (b0.max(0.0), b1.min(exit.length));
        (b0 < b1).then(|| {
            Rays::Beam(Self {
                b0,
                b1,
                // A direction that comes out below its edge is mirrored, as images are.
                direction: [wx * ux + wy * uy, (wx * uy - wy * ux).abs()],
                offset: self.distance_at(start),
            })
        })
    }
}

impl Rays {
    /// The interval.
    #[inline]
    pub const fn interval(&self) -> [f64; 2] {
        match self {
            Self::Cone(w) => [w.b0, w.b1],
            Self::Beam(w) => [w.b0, w.b1],
        }
    }

    /// The part between `b0` and `b1`.
    #[must_use]
    pub const fn cut(&self, b0: f64, b1: f64) -> Self {
        match self {
            Self::Cone(w) => Self::Cone(w.cut(b0, b1)),
            Self::Beam(w) => Self::Beam(Beam { b0, b1, ..*w }),
        }
    }

    /// The distance offered at abscissa `x` of the edge. Defined for `x` in the interval.
    #[inline]
    pub fn distance(&self, x: f64) -> f64 {
        match self {
            Self::Cone(w) => w.distance(x),
            Self::Beam(w) => w.distance(x),
        }
    }

    /// The least distance offered on the interval.
    pub fn min_distance(&self) -> f64 {
        match self {
            Self::Cone(w) => w.min_distance(),
            Self::Beam(w) => w.distance(w.b0).min(w.distance(w.b1)),
        }
    }

    /// Whether paths along the edge, of length `l`, from one of its ends beat every ray, as
    /// [`is_beaten_from_ends`]. `tail` and `head` are the distances known there.
    pub fn is_beaten_from_ends(&self, l: f64, tail: f64, head: f64) -> bool {
        match self {
            Self::Cone(w) => is_beaten_from_ends(w, l, tail, head),
            Self::Beam(w) => {
                let [tail, head] = [tail, head].map(|d| d + (d + l) * MARGIN);
                tail + w.b1 < w.distance(w.b1) || head + (l - w.b0) < w.distance(w.b0)
            }
        }
    }

    /// Crosses the face of `view`.
    pub fn cross(&self, view: &FaceView) -> CrossedRays {
        let w = match self {
            Self::Cone(w) => w,
            Self::Beam(w) => return w.cross(view),
        };
        let crossing = Crossing::new(&view.frame, w);
        let entry = w.entry(&view.frame);
        if crossing.covers_apex() {
            let left = crossing.left_child(&view.exit(Side::Left));
            let right = crossing.right_child(&view.exit(Side::Right));
            return CrossedRays {
                distance: crossing.straight_distance(),
                entry,
                children: [left, right].map(|child| child.map(Self::Cone)),
            };
        }
        let exit = view.exit(crossing.side());
        let child = crossing.only_child(&exit).map(Self::Cone);
        CrossedRays {
            distance: crossing.bent_distance(&exit),
            entry,
            children: match crossing.side() {
                Side::Left => [child, None],
                Side::Right => [None, child],
            },
        }
    }

    /// The rays at a gate, whose length is `l`, in the frame of a half-edge beyond it, as
    /// [`HalfEdgeBeyond::carry`].
    pub fn carried(&self, beyond: &HalfEdgeBeyond, l: f64) -> Option<Self> {
        match self {
            Self::Cone(w) => beyond.carry(w, l).map(Self::Cone),
            Self::Beam(w) if beyond.mirrored => {
                let [ux, uy] = w.direction;
                let mirrored = Beam {
                    b0: l - w.b1,
                    b1: l - w.b0,
                    direction: [-ux, uy],
                    offset: w.distance(l),
                };
                (mirrored.b0 < mirrored.b1).then_some(Self::Beam(mirrored))
            }
            Self::Beam(_) => Some(*self),
        }
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::{FaceId, Mesh};
    use proptest::prelude::*;

    use super::*;

    /// How far away the source of a cone is that stands for a beam.
    const FAR: f64 = 1e8;

    proptest! {
        #[test]
        fn a_beam_crosses_as_the_window_of_a_source_far_away(
            apex in (-1.0..2.0f64, 0.1..2.0f64), slope in -3.0..3.0f64, offset in 0.0..2.0f64,
            ends in (0.0..1.0f64, 0.0..1.0f64),
        ) {
            let positions = vec![
                [0.0; 3],
                [1.0, 0.0, 0.0],
                [apex.0, apex.1, 0.0],
                [apex.0 - 1.0, apex.1 + 0.5, 0.0],
                [apex.0 + 1.0, apex.1 + 0.5, 0.0],
            ];
            let mesh = Mesh::new(positions, vec![[0, 1, 2], [2, 3, 0], [2, 1, 4]]).unwrap();
            let view = FaceView::of(&mesh, FaceId::new(0).half_edge(0));
            let (b0, b1) = (ends.0.min(ends.1), ends.0.max(ends.1) + 1e-3);
            let size = slope.hypot(1.0);
            let direction = [slope / size, 1.0 / size];
            let beam = Beam { b0, b1: b1.min(1.0), direction, offset };
            // The image lies on the ray through the tail.
            let cone = Window {
                b0,
                b1: beam.b1,
                px: -FAR * direction[0],
                py: -FAR * direction[1],
                sigma: offset - FAR,
            };
            let [near, far] = [Rays::Beam(beam), Rays::Cone(cone)].map(|rays| rays.cross(&view));
            // Rounding and curvature of a cone so far away.
            let slack = 1e-6;
            prop_assert!((near.distance - far.distance).abs() < slack);
            for (beam, cone) in near.children.into_iter().zip(far.children) {
                let (Some(Rays::Beam(beam)), Some(cone)) = (beam, cone) else {
                    // Rays that pass the apex closely may be on either side of it.
                    let only = beam.or(cone).map_or([0.0; 2], |rays| rays.interval());
                    prop_assert!(only[1] - only[0] < 1e-3);
                    continue;
                };
                let [x, y] = [[beam.b0, beam.b1], cone.interval()];
                for (x, y) in x.into_iter().zip(y) {
                    // Between the rays, not along the exit.
                    let apart = (x - y).abs() * beam.direction[1];
                    prop_assert!(apart < slack, "{beam:?} {cone:?}");
                    prop_assert!((beam.distance(x) - cone.distance(x)).abs() < slack);
                }
            }
        }
    }
}
