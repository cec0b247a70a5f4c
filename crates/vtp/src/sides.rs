//! Rule 1, one angle, two sides: a path to an apex parts the windows of a list.

use geobench_window::{Frame, Window, apex_distance};

use crate::orient::{is_clearly_left, is_clearly_right};

/// [`BestPath::slack`] as a fraction of the half-edge.
const SLACK: f64 = 1e-12;

/// A window's shortest path to the apex: the best one of a list, for rule 1.
#[derive(Clone, Copy, Debug)]
pub struct BestPath {
    /// Length of the path from the source of the run to the apex.
    pub(crate) distance: f64,
    /// Abscissa S at which it crosses the half-edge.
    pub(crate) entry: f64,
    /// Image of the window's (pseudo-)source.
    pub(crate) source: [f64; 2],
    /// Bound on what rounding does to lengths on the edge.
    pub(crate) slack: f64,
}

/// Limits within which a window may go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides {
    /// Right limit of the rays for the left exit, if any of them may go there.
    pub(crate) left: Option<f64>,
    /// Left limit of the rays for the right exit, if any of them may go there.
    pub(crate) right: Option<f64>,
}

impl Sides {
    /// Everything: rays left of the ray to the apex, whose abscissa is `sp`, to the left exit, the
    /// others to the right one.
    #[inline]
    pub(crate) fn both(w: &Window, sp: f64) -> Self {
        Self {
            left: Some(w.b1.min(sp)),
            right: Some(w.b0.max(sp)),
        }
    }

    /// What two rules leave together.
    #[inline]
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            left: self.left.zip(other.left).map(|(a, b)| a.min(b)),
            right: self.right.zip(other.right).map(|(a, b)| a.max(b)),
        }
    }
}

impl BestPath {
    /// The shortest path of `w`, whose separating abscissa is `sp`.
    #[inline]
    pub(crate) fn of(frame: &Frame, w: &Window, sp: f64) -> Self {
        Self {
            distance: apex_distance(frame, w, sp),
            entry: sp.max(w.b0).min(w.b1),
            source: w.source(),
            slack: SLACK * frame.l,
        }
    }

    /// What rule 1 leaves of `w`, whose separating abscissa is `sp`.
    ///
    /// Every path of `w` to the apex C is at least as long as the best one. A ray of `w` that
    /// enters left of S but heads for the right exit crosses the segment S → C of the best path,
    /// and is useless from there on; so rays left of S may only go left, and rays right of S only
    /// right. Rays on their own side survive, unless the best path has crossed them before it
    /// reached S: that is certain for all rays right of S if the best source lies right of the
    /// window's last ray and the window's source left of the best path, and mirrored on the left.
    #[inline]
    pub(crate) fn sides(&self, w: &Window, sp: f64) -> Sides {
        let s = self.entry;
        let crossed_left = || {
            is_clearly_left(w.source(), [w.b0, 0.0], self.source)
                && is_clearly_right(self.source, [s, 0.0], w.source())
        };
        let crossed_right = || {
            is_clearly_right(w.source(), [w.b1, 0.0], self.source)
                && is_clearly_left(self.source, [s, 0.0], w.source())
        };
        let (left_limit, right_limit) = (sp.min(w.b1), sp.max(w.b0));
        // A source that stands on the edge, behind a face of no area, sends rays of all directions
        // through less width than rounding moves S by; it is not cut so close to S.
        let slack = if w.py < -self.slack { 0.0 } else { self.slack };
        let (cut_left, cut_right) = (s < left_limit - slack, s > right_limit + slack);
        let left = w.b0 < s + slack && !(cut_left && crossed_left());
        let right = w.b1 > s - slack && !(cut_right && crossed_right());
        Sides {
            left: left.then_some(if cut_left { s } else { left_limit }),
            right: right.then_some(if cut_right { s } else { right_limit }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(b0: f64, b1: f64, px: f64, py: f64) -> Window {
        Window {
            b0,
            b1,
            px,
            py,
            sigma: 0.0,
        }
    }

    fn best(entry: f64, source: [f64; 2]) -> BestPath {
        BestPath {
            distance: 1.0,
            entry,
            source,
            slack: 1e-12,
        }
    }

    #[test]
    fn windows_on_either_side_of_the_best_path_go_one_way() {
        let best = best(0.5, [0.5, -1.0]);
        let on_the_left = best.sides(&window(0.1, 0.4, 0.5, -1.0), 0.5);
        assert_eq!(
            on_the_left,
            Sides {
                left: Some(0.4),
                right: None
            }
        );
        let on_the_right = best.sides(&window(0.6, 0.9, 0.5, -1.0), 0.5);
        assert_eq!(
            on_the_right,
            Sides {
                left: None,
                right: Some(0.6)
            }
        );
    }

    #[test]
    fn the_best_window_is_split_at_its_own_ray() {
        let sides = best(0.5, [0.5, -1.0]).sides(&window(0.1, 0.9, 0.5, -1.0), 0.5);
        assert_eq!(
            sides,
            Sides {
                left: Some(0.5),
                right: Some(0.5)
            }
        );
    }

    #[test]
    fn a_window_split_left_of_the_best_path_is_cut_there() {
        // Its rays between 0.3 and 0.5 head right and cross the best path; those beyond 0.5 head
        // right too, and are crossed before the edge if the best source lies beyond them.
        let w = window(0.1, 0.9, 0.2, -1.0);
        let beside = best(0.5, [0.6, -0.2]).sides(&w, 0.3);
        assert_eq!(
            beside,
            Sides {
                left: Some(0.3),
                right: Some(0.5)
            }
        );
        let beyond = best(0.5, [3.0, -0.5]).sides(&w, 0.3);
        assert_eq!(
            beyond,
            Sides {
                left: Some(0.3),
                right: None
            }
        );
    }

    #[test]
    fn a_window_split_right_of_the_best_path_is_cut_there() {
        let w = window(0.1, 0.9, 0.8, -1.0);
        let beside = best(0.5, [0.4, -0.2]).sides(&w, 0.7);
        assert_eq!(
            beside,
            Sides {
                left: Some(0.5),
                right: Some(0.7)
            }
        );
        let beyond = best(0.5, [-2.0, -0.5]).sides(&w, 0.7);
        assert_eq!(
            beyond,
            Sides {
                left: None,
                right: Some(0.7)
            }
        );
    }

    /// On a flat grid all windows have one source, seen through different triangles. When the side
    /// on which its images lie was read from their rounding, whole windows died and hundreds of
    /// vertices stayed at infinity.
    #[test]
    fn rounding_between_images_of_one_source_deletes_nothing() {
        let source = [0.5, -1.0];
        let noise = [-3e-16, 0.0, 3e-16];
        for dx in noise {
            for dy in noise {
                for ds in noise {
                    let w = window(0.1, 0.9, 0.5 + dx, -1.0 + dy);
                    let sides = best(0.5 + ds, source).sides(&w, 0.5 - ds);
                    assert!(
                        sides.left.is_some() && sides.right.is_some(),
                        "{dx} {dy} {ds}"
                    );
                }
            }
        }
    }
}
