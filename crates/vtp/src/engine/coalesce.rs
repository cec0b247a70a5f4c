//! Coalescing of adjacent windows with the same source image.
//!
//! A vertex splits a window into one that passes on its left and one that passes on its right. If
//! the surface is flat at the vertex, both meet again on the edge behind it, side by side, with the
//! same source image. From there on they cover the rays of a single window over both intervals. No
//! rule drops a window for being narrow. Without coalescing, a plane would be crossed by one window
//! for every vertex that the source sees.

use super::layout::{FaceLayout, MeshLayout, next, prev};
use super::store::{COLUMNS, WindowStore};

/// Lists of up to this many windows are processed one window at a time if windows are coalesced.
/// Most lists are no longer, and one number is computed faster than eight of which seven are
/// unused.
pub(crate) const ONE_BY_ONE: usize = 4;

/// The least fraction of half-edges behind flat vertices at which windows are coalesced.
const ENOUGH: f64 = 0.125;

/// The difference between two source images that counts as rounding, relative to their distance and
/// the edge.
const SAME_IMAGE: f64 = 1e-13;

/// The gap between two intervals that counts as rounding, relative to the edge.
const GAP: f64 = 1e-12;

impl MeshLayout {
    /// Whether the mesh has enough flat vertices for coalescing to pay.
    pub(crate) fn has_many_flat_vertices(&self) -> bool {
        let behind = self.faces.iter().flat_map(|face| face.flat);
        let flat = behind.filter(|&flat| flat).count();
        flat as f64 > ENOUGH * 3.0 * self.faces.len() as f64
    }
}

impl WindowStore {
    /// Coalesces windows in `lists`, those behind both exits of `face`, after a list has crossed
    /// the face from half-edge `corner`. Each list had `before` windows and now has `after`.
    /// Returns the remaining numbers of windows.
    #[inline(always)]
    pub(crate) fn coalesce_behind(
        &mut self,
        face: &FaceLayout,
        corner: usize,
        lists: [u32; 2],
        before: [usize; 2],
        mut after: [usize; 2],
    ) -> [usize; 2] {
        for (side, exit) in [prev(corner), next(corner)].into_iter().enumerate() {
            if face.flat[exit] && before[side] > 0 {
                let (list, l) = (lists[side], face.length[exit]);
                after[side] = self.coalesce(list, before[side], after[side], l);
            }
        }
        after
    }

    /// Coalesces the windows with numbers from `waiting` up to `len` in `list`, on a half-edge of
    /// length `l`, with the first `waiting` ones. Returns the number of windows left; O(waiting ·
    /// (len - waiting)).
    ///
    /// Distances change only by rounding: a ray in a gap passes the flat vertex on one side or the
    /// other.
    fn coalesce(&mut self, list: u32, waiting: usize, len: usize, l: f64) -> usize {
        let mut left = waiting;
        for i in waiting..len {
            let window = self.get(list, i);
            // Windows of other sources may lie between the two.
            let mut others = (0..waiting).map(|i| (i, self.get(list, i)));
            if let Some((place, half)) = others.find(|(_, other)| are_halves(&window, other, l)) {
                self.put(list, place, united(&window, &half));
            } else {
                self.put(list, left, window);
                left += 1;
            }
        }
        left
    }
}

/// Whether two windows on a half-edge of length `l` have the same source image and adjacent
/// intervals.
#[inline]
fn are_halves(a: &[f64; COLUMNS], b: &[f64; COLUMNS], l: f64) -> bool {
    let [a0, a1, ax, ay, a_sigma] = *a;
    let [b0, b1, bx, by, b_sigma] = *b;
    let apart = (ax - bx).abs() + (ay - by).abs();
    a_sigma == b_sigma
        && apart <= SAME_IMAGE * (ax.abs() + ay.abs() + l)
        && a0.max(b0) - a1.min(b1) <= GAP * l
}

/// The window over both intervals, with the source image of `b`.
#[inline]
fn united(a: &[f64; COLUMNS], b: &[f64; COLUMNS]) -> [f64; COLUMNS] {
    [a[0].min(b[0]), a[1].max(b[1]), b[2], b[3], b[4]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::store::NO_LIST;

    /// The windows left of `waiting` and `came`, on a half-edge of length 1.
    fn coalesced(waiting: &[[f64; COLUMNS]], came: &[[f64; COLUMNS]]) -> Vec<[f64; COLUMNS]> {
        let mut store = WindowStore::new();
        let len = waiting.len() + came.len();
        let list = store.reserve(NO_LIST, len);
        for (i, &window) in waiting.iter().chain(came).enumerate() {
            store.put(list, i, window);
        }
        let left = store.coalesce(list, waiting.len(), len, 1.0);
        (0..left).map(|i| store.get(list, i)).collect()
    }

    const LEFT: [f64; COLUMNS] = [0.25, 0.5, 3.0, -40.0, 2.0];
    const RIGHT: [f64; COLUMNS] = [0.5, 0.75, 3.0, -40.0, 2.0];
    const WHOLE: [f64; COLUMNS] = [0.25, 0.75, 3.0, -40.0, 2.0];

    #[test]
    fn halves_become_one_in_whatever_order_they_come() {
        let other = [0.0, 1.0, 1.0, -1.0, 39.0];
        assert_eq!(coalesced(&[LEFT], &[RIGHT]), [WHOLE]);
        assert_eq!(coalesced(&[RIGHT], &[LEFT]), [WHOLE]);
        assert_eq!(coalesced(&[RIGHT, other], &[other, LEFT]), [WHOLE, other]);
        let (many, far) = ([other; 9], RIGHT.map(|x| 3.0 * x));
        let waiting = [&many[..], &[LEFT]].concat();
        assert_eq!(
            coalesced(&waiting, &[far, RIGHT]),
            [&many[..], &[WHOLE, far]].concat()
        );
    }

    #[test]
    fn halves_that_rounding_has_moved_become_one() {
        let moved = |c: usize, by: f64| {
            let mut window = RIGHT;
            window[c] += by;
            coalesced(&[LEFT], &[window]).len()
        };
        for (c, noise, difference) in [(0, 1e-13, 1e-11), (2, 1e-12, 1e-10), (3, -1e-12, -1e-10)] {
            assert_eq!((moved(c, noise), moved(c, difference)), (1, 2), "{c}");
        }
        assert_eq!((moved(4, 0.0), moved(4, 1e-15)), (1, 2));
    }

    /// A hole separates the two windows: the rays between them reach no window.
    #[test]
    fn windows_of_one_source_apart_from_each_other_stay_two() {
        let beyond = [0.6, 0.75, 3.0, -40.0, 2.0];
        assert_eq!(coalesced(&[LEFT], &[beyond]), [LEFT, beyond]);
    }
}
