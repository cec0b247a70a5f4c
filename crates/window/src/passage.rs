//! A window crossing a triangle whole, as the algorithms do that take one window at a time.
//!
//! The formulas are those of [`left_child`](crate::left_child) and its neighbours, without the
//! division for the separating abscissa: with D0 = cy·px - py·cx and e = cy - py, of which that is
//! the quotient, the sign of s·e - D0 tells the side on which the ray through s leaves, and the
//! number itself is the numerator of the right exit.

use crate::frame::Frame;
use crate::window::{Window, greater, less, norm};

/// A window about to leave the triangle that it has entered.
#[derive(Clone, Copy, Debug)]
pub struct Passage<'a> {
    frame: &'a Frame,
    window: &'a Window,
    /// D0.
    offset: f64,
    /// e, the height of the apex above the source.
    height: f64,
    /// s·e - D0 at both ends of the window: negative where a ray leaves through AC, positive where
    /// it leaves through CB.
    sides: [f64; 2],
}

impl<'a> Passage<'a> {
    /// `window` has entered the triangle of `frame`.
    #[inline]
    pub fn new(frame: &'a Frame, window: &'a Window) -> Self {
        let offset = frame.cy * window.px - window.py * frame.cx;
        let height = frame.cy - window.py;
        Self {
            frame,
            window,
            offset,
            height,
            sides: [window.b0 * height - offset, window.b1 * height - offset],
        }
    }

    /// The triangle.
    #[inline]
    pub fn frame(&self) -> &Frame {
        self.frame
    }

    /// The window.
    #[inline]
    pub fn window(&self) -> &Window {
        self.window
    }

    /// Whether any ray leaves through AC.
    #[inline]
    pub fn goes_left(&self) -> bool {
        self.sides[0] < 0.0
    }

    /// Whether any ray leaves through CB.
    #[inline]
    pub fn goes_right(&self) -> bool {
        self.sides[1] > 0.0
    }

    /// Whether the window sees the apex and has rays on both sides of it.
    #[inline]
    pub fn covers_apex(&self) -> bool {
        self.goes_left() && self.goes_right()
    }

    /// Where the ray to the apex meets the half-edge, inside the window or not.
    #[inline]
    pub fn separation(&self) -> f64 {
        self.offset / self.height
    }

    /// Length of the straight path to the apex, which the window has if it
    /// [covers](Self::covers_apex) it.
    #[inline]
    pub fn straight_distance(&self) -> f64 {
        self.window.sigma + self.squared_straight().sqrt()
    }

    /// Length of the path to the apex if it is less than `known`: straight if the window sees the
    /// apex, else bent at the end of the window that is nearer to the straight one. A path that
    /// would be too long even if it were straight, as nearly all are, is told without a root.
    #[inline]
    pub fn apex_distance_below(&self, known: f64) -> Option<f64> {
        let rest = known - self.window.sigma;
        if !(rest > 0.0 && rest * rest > self.squared_straight()) {
            return None;
        }
        let w = self.window;
        let distance = if self.sides[0] > 0.0 {
            self.bent_distance(w.b0)
        } else if self.sides[1] < 0.0 {
            self.bent_distance(w.b1)
        } else {
            self.straight_distance()
        };
        (distance < known).then_some(distance)
    }

    #[inline]
    fn squared_straight(&self) -> f64 {
        let x = self.frame.cx - self.window.px;
        x * x + self.height * self.height
    }

    fn bent_distance(&self, bend: f64) -> f64 {
        self.window.distance(bend) + norm(self.frame.cx - bend, self.frame.cy)
    }

    /// What arrives at AC, in the frame of the neighbour's half-edge A → C.
    #[inline]
    pub fn left_child(&self) -> Option<Window> {
        if !self.goes_left() {
            return None;
        }
        let (frame, w) = (self.frame, self.window);
        let scale = -frame.la * w.py;
        let at = |s: f64| scale * s / (self.offset - frame.cy * s);
        let [ux, uy] = frame.left;
        let child = Window {
            b0: greater(at(w.b0), 0.0),
            b1: if self.sides[1] >= 0.0 {
                frame.la
            } else {
                less(at(w.b1), frame.la)
            },
            px: ux * w.px + uy * w.py,
            py: less(ux * w.py - uy * w.px, 0.0),
            sigma: w.sigma,
        };
        (child.b0 < child.b1).then_some(child)
    }

    /// What arrives at CB, in the frame of the neighbour's half-edge C → B.
    #[inline]
    pub fn right_child(&self) -> Option<Window> {
        if !self.goes_right() {
            return None;
        }
        let (frame, w) = (self.frame, self.window);
        let offset = -frame.cy * w.px - (frame.l - frame.cx) * w.py;
        let at = |s: f64, side: f64| frame.lb * side / (offset + frame.cy * s);
        let [vx, vy] = frame.right;
        let (x, y) = (w.px - frame.cx, w.py - frame.cy);
        let child = Window {
            b0: if self.sides[0] <= 0.0 {
                0.0
            } else {
                greater(at(w.b0, self.sides[0]), 0.0)
            },
            b1: less(at(w.b1, self.sides[1]), frame.lb),
            px: vx * x + vy * y,
            py: less(vx * y - vy * x, 0.0),
            sigma: w.sigma,
        };
        (child.b0 < child.b1).then_some(child)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::cross::{apex_distance, left_child, right_child, separating_abscissa};
    use crate::window::tests::windows;

    /// A triangle on an edge of length 1.
    fn frames() -> impl Strategy<Value = Frame> {
        (-1.0..2.0f64, 0.01..2.0f64).prop_map(|(cx, cy)| {
            let (la, lb) = (norm(cx, cy), norm(1.0 - cx, cy));
            Frame {
                l: 1.0,
                la,
                lb,
                cx,
                cy,
                left: [cx / la, cy / la],
                right: [(1.0 - cx) / lb, -cy / lb],
            }
        })
    }

    fn close(a: Option<Window>, b: Option<Window>) -> bool {
        let numbers = |w: Window| [w.b0, w.b1, w.px, w.py, w.sigma];
        match (a, b) {
            (Some(a), Some(b)) => {
                let pairs = numbers(a).into_iter().zip(numbers(b));
                pairs.into_iter().all(|(a, b)| (a - b).abs() <= 1e-12)
            }
            // One of them may be as narrow as rounding.
            (Some(w), None) | (None, Some(w)) => w.b1 - w.b0 < 1e-12,
            (None, None) => true,
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn it_is_the_same_as_crossing_step_by_step(
            frame in frames(), w in windows(), known in 0.0..8.0f64,
        ) {
            let passage = Passage::new(&frame, &w);
            let sp = separating_abscissa(&frame, &w);
            prop_assert!((passage.separation() - sp).abs() < 1e-12);
            let left = left_child(&frame, &w, sp, w.b1.min(sp));
            prop_assert!(close(passage.left_child(), left), "{:?} {left:?}", passage.left_child());
            let right = right_child(&frame, &w, sp, w.b0.max(sp));
            prop_assert!(close(passage.right_child(), right), "{:?} {right:?}", passage.right_child());
            let offer = apex_distance(&frame, &w, sp);
            match passage.apex_distance_below(known) {
                Some(d) => prop_assert!((d - offer).abs() < 1e-12 && d < known),
                None => prop_assert!(offer >= known * (1.0 - 1e-15)),
            }
            prop_assert_eq!(passage.apex_distance_below(f64::INFINITY).is_some(), true);
            if passage.covers_apex() {
                prop_assert!((passage.straight_distance() - offer).abs() < 1e-12);
            }
        }
    }
}
