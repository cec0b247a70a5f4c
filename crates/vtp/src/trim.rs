//! Overlapping windows cut at their tie points.

use geobench_window::Window;
use geobench_window::trimming::ties_between;

use crate::precision::WINS;

/// The rest of a window: up to three pieces, from left to right.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pieces {
    windows: [Window; 3],
    len: usize,
}

impl Pieces {
    /// Whether nothing is left.
    pub(crate) fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The pieces, from left to right.
    pub(crate) fn iter(&self) -> std::slice::Iter<'_, Window> {
        self.windows[..self.len].iter()
    }

    /// The parts of `w` outside the ranges of `stretches` that `lost` marks.
    fn of(w: &Window, stretches: &[f64], lost: [bool; 3]) -> Self {
        let mut pieces = Self {
            windows: [*w; 3],
            len: 0,
        };
        let mut start = w.b0;
        for (range, _) in stretches.windows(2).zip(lost).filter(|(_, lost)| *lost) {
            pieces.push(w, start, range[0]);
            start = range[1];
        }
        pieces.push(w, start, w.b1);
        pieces
    }

    fn push(&mut self, w: &Window, b0: f64, b1: f64) {
        if b0 < b1 {
            self.windows[self.len] = Window { b0, b1, ..*w };
            self.len += 1;
        }
    }
}

/// Height of a source, as a fraction of the edge, below which it counts as on the edge.
pub(crate) const ON_EDGE: f64 = 1e-10;

/// What two overlapping windows of one edge of length `l` keep if each gives up the ranges on which
/// the other is shorter (Surazhsky et al. 2005, section 3.5).
///
/// The overlap is cut at the tie points. The midpoint of each range between them decides which
/// window is shorter on it. Both windows keep a range on which they are equal up to rounding, such
/// as the whole overlap of two images of one source. `None` if the windows do not overlap, or if a
/// source is on the edge, behind a face of no area: its rays of all directions then pass through
/// less width than the rounding of a tie point.
pub(crate) fn trim_pair(a: &Window, b: &Window, l: f64) -> Option<(Pieces, Pieces)> {
    let (lo, hi) = (a.b0.max(b.b0), a.b1.min(b.b1));
    if lo >= hi || a.py.max(b.py) > -ON_EDGE * l {
        return None;
    }
    let mut stretches = [lo; 4];
    let mut cuts = 1;
    for &tie in ties_between(a, b, lo, hi, l).as_slice() {
        if lo < tie && tie < hi {
            stretches[cuts] = tie;
            cuts += 1;
        }
    }
    stretches[cuts] = hi;
    let stretches = &stretches[..=cuts];
    let (mut lost_by_a, mut lost_by_b) = ([false; 3], [false; 3]);
    for (i, range) in stretches.windows(2).enumerate() {
        let middle = 0.5 * (range[0] + range[1]);
        let (da, db) = (a.distance(middle), b.distance(middle));
        lost_by_a[i] = db < da * WINS;
        lost_by_b[i] = da < db * WINS;
    }
    Some((
        Pieces::of(a, stretches, lost_by_a),
        Pieces::of(b, stretches, lost_by_b),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    prop_compose! {
        fn windows()(
            b0 in 0.0..0.9f64, width in 0.01..1.0f64,
            px in -1.0..2.0f64, py in -2.0..-0.01f64, sigma in 0.0..1.0f64,
        ) -> Window {
            Window { b0, b1: (b0 + width).min(1.0), px, py, sigma }
        }
    }

    proptest! {
        /// At every point of the edge the shorter window is kept.
        #[test]
        fn no_distance_is_lost(a in windows(), b in windows(), x in 0.0..1.0f64) {
            let covers = |w: &Window| w.b0 <= x && x <= w.b1;
            let least = |windows: &[Window]| {
                let reached = windows.iter().filter(|w| covers(w));
                reached.map(|w| w.distance(x)).fold(f64::INFINITY, f64::min)
            };
            prop_assume!(a.b0.max(b.b0) < a.b1.min(b.b1));
            let (of_a, of_b) = trim_pair(&a, &b, 1.0).unwrap();
            let kept: Vec<_> = of_a.iter().chain(of_b.iter()).copied().collect();
            let (before, after) = (least(&[a, b]), least(&kept));
            prop_assert!(before == after || (after - before).abs() <= 1e-12 * before);
        }
    }

    /// The gap between two windows was once taken for an overlap, and both lost rays.
    #[test]
    fn windows_apart_lose_nothing_to_each_other() {
        let window = |b0, b1| Window {
            b0,
            b1,
            px: 0.5,
            py: -1.0,
            sigma: b0,
        };
        for (a, b) in [
            (window(0.0, 0.2), window(0.4, 0.6)),
            (window(0.0, 0.2), window(0.2, 0.6)),
        ] {
            assert!(trim_pair(&a, &b, 1.0).is_none() && trim_pair(&b, &a, 1.0).is_none());
        }
    }

    /// Rounding once cut the windows of a vertex on the edge, and a vertex behind a face without
    /// area was a tenth too far.
    #[test]
    fn a_source_on_the_edge_is_not_trimmed() {
        let fan = Window {
            b0: 0.5,
            b1: 0.5 + 1e-14,
            px: 0.5,
            py: -1e-20,
            sigma: 0.0,
        };
        let other = Window {
            b0: 0.0,
            b1: 1.0,
            py: -1.0,
            ..fan
        };
        assert!(trim_pair(&fan, &other, 1.0).is_none() && trim_pair(&other, &fan, 1.0).is_none());
    }

    /// In a list that is not final, two windows may tie twice. One window then gets the middle, the
    /// other both sides.
    #[test]
    fn two_tie_points_leave_three_pieces() {
        let near = Window {
            b0: 0.0,
            b1: 1.0,
            px: 0.5,
            py: -0.1,
            sigma: 1.95,
        };
        let far = Window {
            py: -2.0,
            sigma: 0.0,
            ..near
        };
        let (of_near, of_far) = trim_pair(&near, &far, 1.0).unwrap();
        assert_eq!((of_near.iter().count(), of_far.iter().count()), (0, 1));
        let near = Window {
            sigma: 1.85,
            ..near
        };
        let (of_near, of_far) = trim_pair(&near, &far, 1.0).unwrap();
        assert_eq!((of_near.iter().count(), of_far.iter().count()), (1, 2));
    }
}
