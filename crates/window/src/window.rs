//! The window: a cone of straight paths through one half-edge.

use crate::frame::Frame;

/// The straight paths from one (pseudo-)source through an interval of a half-edge, in the frame of
/// that half-edge, about to enter its face.
///
/// All faces that the paths have crossed are unfolded into the plane of the frame; the image of the
/// source lies below the edge. The window stores the position of the image. Two distances instead,
/// as in the papers, would lose about ε·d²/w of the position for a window of width w. With the
/// position, crossing a triangle takes a rotation and two divisions, and no square root.
///
/// ```
/// use geobench_window::Window;
///
/// // A source 3 below the start of its edge, seen through the interval from 0 to 4.
/// let window = Window { b0: 0.0, b1: 4.0, px: 0.0, py: -3.0, sigma: 0.0 };
/// assert_eq!(window.distance(4.0), 5.0);
/// assert_eq!(window.min_distance(), 3.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Window {
    /// Left end of the interval; 0 ≤ `b0` < `b1`.
    pub b0: f64,
    /// Right end of the interval, at most the length of the half-edge.
    pub b1: f64,
    /// Abscissa of the image of the source.
    pub px: f64,
    /// Ordinate of the image of the source; at most 0.
    pub py: f64,
    /// σ, the distance from the source of the run to the (pseudo-)source of the window.
    pub sigma: f64,
}

impl Window {
    /// The part of the window between `b0` and `b1`.
    #[inline]
    #[must_use]
    pub const fn cut(&self, b0: f64, b1: f64) -> Self {
        Self { b0, b1, ..*self }
    }

    /// The image of the (pseudo-)source.
    #[inline]
    pub const fn source(&self) -> [f64; 2] {
        [self.px, self.py]
    }

    /// The distance that the window offers at abscissa `x` of its edge: σ + |p x|. Defined for `x`
    /// in the interval.
    #[inline]
    pub fn distance(&self, x: f64) -> f64 {
        self.sigma + norm(x - self.px, self.py)
    }

    /// The least distance that the window offers on its interval. It is the key by which queues
    /// order windows.
    #[inline]
    pub fn min_distance(&self) -> f64 {
        self.distance(self.nearest_abscissa())
    }

    /// The abscissa of the point of the interval that is nearest to the source.
    #[inline]
    pub fn nearest_abscissa(&self) -> f64 {
        less(greater(self.px, self.b0), self.b1)
    }

    /// Where its shortest path to the apex of the triangle of `frame` crosses the half-edge: on the
    /// straight line, or at the end of the interval that is next to it.
    #[inline]
    pub fn entry(&self, frame: &Frame) -> f64 {
        let ray = (frame.cy * self.px - frame.cx * self.py) / (frame.cy - self.py);
        ray.max(self.b0).min(self.b1)
    }

    /// The same paths in the frame of the twin half-edge, where the source lies above the edge. `l`
    /// is the length of the edge.
    #[inline]
    #[must_use]
    pub fn reversed(&self, l: f64) -> Self {
        Self {
            b0: l - self.b1,
            b1: l - self.b0,
            px: l - self.px,
            py: -self.py,
            sigma: self.sigma,
        }
    }

    /// The same paths in the frame of a half-edge of the opposite direction whose face is unfolded
    /// above the edge as well, as if turned over. `l` is the length of the edge.
    ///
    /// Rounding may leave no interval of a window that is narrower than the rounding of `l`.
    /// Trimming keeps such windows only if their source is as close to the edge, which is the case
    /// beside its ends. All vertices of junctions are pseudo-sources, whose paths take the place of
    /// the window.
    #[inline]
    #[must_use]
    pub fn mirrored(&self, l: f64) -> Self {
        Self {
            py: self.py,
            ..self.reversed(l)
        }
    }
}

/// Length of the vector `(x, y)`. The lengths of a valid mesh do not overflow, and `f64::hypot` is
/// several times slower.
#[inline]
pub(crate) fn norm(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// The greater of `x` and `y`; `y` if either is NaN. This is one instruction; `f64::max` takes
/// four, because it handles NaN.
#[inline]
pub(crate) fn greater(x: f64, y: f64) -> f64 {
    if x > y { x } else { y }
}

/// The lesser of `x` and `y`, `y` if either is NaN.
#[inline]
pub(crate) fn less(x: f64, y: f64) -> f64 {
    if x < y { x } else { y }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proptest::prelude::*;

    prop_compose! {
        /// A window on an edge of length 1 with its source below it.
        pub(crate) fn windows()(
            ends in (0.0..1.0f64, 0.0..1.0f64),
            px in -3.0..4.0f64,
            py in -5.0..0.0f64,
            sigma in prop_oneof![Just(0.0), 0.0..3.0f64],
        ) -> Window {
            let (b0, b1) = if ends.0 < ends.1 { ends } else { (ends.1, ends.0) };
            Window { b0, b1: b1.max(b0 + 1e-6), px, py, sigma }
        }
    }

    proptest! {
        #[test]
        fn min_distance_is_the_least_on_the_interval(w in windows(), t in 0.0..=1.0f64) {
            let x = w.b0 + t * (w.b1 - w.b0);
            prop_assert!(w.min_distance() <= w.distance(x) * (1.0 + 1e-15));
            let ends = [w.b0, w.b1, w.px].map(|x| w.distance(x.clamp(w.b0, w.b1)));
            prop_assert!(ends.contains(&w.min_distance()));
        }

        #[test]
        fn reversing_keeps_every_distance(w in windows(), x in 0.0..=1.0f64) {
            let there = w.reversed(1.0).distance(1.0 - x);
            prop_assert!((there - w.distance(x)).abs() <= 1e-14 * there);
        }
    }
}
