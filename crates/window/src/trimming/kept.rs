//! Windows stored beside thin faces, to end those that wind around a needle.

use geobench_mesh::{HalfEdgeId, Mesh};

use super::foot::pieces;
use super::overlap::{Overlap, Owner};
use super::thin::ThinFaces;
use crate::window::Window;

/// The windows that have arrived at the half-edges of thin faces, for algorithms that store none.
///
/// No shortest path crosses an edge twice, but a window that winds around a needle does. The vertex
/// filter deletes it once it is longer than a path along an edge. On a thin needle the difference
/// never exceeds rounding. MMP ends such a window when it arrives at a half-edge for the second
/// time: the stored window is as short, and among equal windows the stored one stays. This type
/// does the same on the half-edges of thin faces, which few meshes have.
///
/// ```
/// use geobench_mesh::{HalfEdgeId, Mesh};
/// use geobench_window::Window;
/// use geobench_window::trimming::KeptWindows;
///
/// let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1e-3, 0.0]];
/// let mesh = Mesh::new(positions, vec![[0, 1, 2]])?;
/// let mut kept = KeptWindows::new(&mesh, 3, HalfEdgeId::index);
/// let window = Window { b0: 0.0, b1: 1.0, px: 0.5, py: -1.0, sigma: 0.0 };
/// assert_eq!(kept.admit(0, &window), Some(window));
/// assert_eq!(kept.admit(0, &window), None); // It winds around the needle.
/// # Ok::<(), geobench_mesh::InvalidMesh>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct KeptWindows {
    /// The list of each half-edge, by its number; `NO_LIST` if it has none. Empty if no face is
    /// thin.
    lists: Vec<u32>,
    kept: Vec<KeptList>,
    doubt: f64,
    has_tip: bool,
    overlap: Overlap,
    met: Vec<Window>,
    replaced: Vec<Window>,
}

/// The windows of one half-edge, ascending and without overlaps.
#[derive(Clone, Debug)]
struct KeptList {
    length: f64,
    windows: Vec<Window>,
}

const NO_LIST: u32 = u32::MAX;

impl KeptWindows {
    /// Empty lists for `mesh`. `number` gives the number of each half-edge, which is less than
    /// `numbers`. O(faces).
    pub fn new(mesh: &Mesh, numbers: usize, number: impl Fn(HalfEdgeId) -> usize) -> Self {
        let mut kept = Self::default();
        let thin = ThinFaces::of(mesh, numbers, &number);
        if thin.is_empty() {
            return kept;
        }
        kept.doubt = thin.doubt();
        kept.has_tip = thin.has_tip();
        for h in mesh.half_edges().filter(|&h| thin.is_beside(number(h))) {
            kept.lists.resize(numbers, NO_LIST);
            kept.lists[number(h)] = kept.kept.len() as u32;
            kept.kept.push(KeptList {
                length: mesh.length(h),
                windows: Vec::new(),
            });
        }
        kept
    }

    /// Whether no face is thin. Then no window is stored, and calls of the other methods can be
    /// skipped.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.lists.is_empty()
    }

    /// As [`ThinFaces::doubt`], for the stored windows.
    #[inline]
    pub fn doubt(&self) -> f64 {
        self.doubt
    }

    /// Whether faces are thin and the mesh has the tip of a needle, as [`ThinFaces::has_tip`].
    #[inline]
    pub fn has_tip(&self) -> bool {
        self.has_tip
    }

    /// Whether windows that arrive at half-edge number `h` are stored.
    #[inline]
    pub fn holds(&self, h: usize) -> bool {
        self.lists.get(h).is_some_and(|&list| list != NO_LIST)
    }

    /// Removes all windows.
    pub fn clear(&mut self) {
        for list in &mut self.kept {
            list.windows.clear();
        }
    }

    /// Removes the windows of half-edge number `h`.
    pub fn clear_at(&mut self, h: usize) {
        if self.holds(h) {
            self.kept[self.lists[h] as usize].windows.clear();
        }
    }

    /// Stores `new`, which arrives at half-edge number `h`, and returns the part of it to
    /// propagate; `None` if no part is needed. Returns `new` unchanged if `h` is not beside a thin
    /// face. O(k) for k windows stored there.
    ///
    /// The returned part must be propagated, even if a shorter path to its root has been found
    /// since: it may have replaced an equal window.
    #[cold]
    pub fn admit(&mut self, h: usize, new: &Window) -> Option<Window> {
        let list = self.lists.get(h).copied().unwrap_or(NO_LIST);
        let Some(KeptList {
            length,
            windows: list,
        }) = self.kept.get_mut(list as usize)
        else {
            return Some(*new);
        };
        let l = *length;
        let mut parts: Option<[f64; 2]> = None;
        for piece in pieces(new, l) {
            let first = list.partition_point(|w| w.b1 <= piece.b0);
            self.met.clear();
            let behind = list[first..].iter().copied();
            self.met.extend(behind.take_while(|w| w.b0 < piece.b1));
            self.overlap.share_out(&self.met, &piece, l);
            self.replaced.clear();
            for segment in self.overlap.segments() {
                let window = match segment.owner {
                    Owner::New => {
                        let [start, end] = parts.unwrap_or([segment.start, segment.end]);
                        parts = Some([start.min(segment.start), end.max(segment.end)]);
                        piece
                    }
                    Owner::Old(k) => list[first + k],
                };
                self.replaced.push(Window {
                    b0: segment.start,
                    b1: segment.end,
                    ..window
                });
            }
            list.splice(first..first + self.met.len(), self.replaced.iter().copied());
        }
        // The range between two parts is not needed, but harmless.
        parts.map(|[b0, b1]| Window { b0, b1, ..*new })
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::TriangleSoup;

    use super::*;

    fn mesh(height: f64) -> Mesh {
        let positions = vec![
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.5, height, 0.0],
            [0.5, -1.0, 0.0],
        ];
        let soup = TriangleSoup::new(positions, vec![[0, 1, 2], [1, 0, 3]]);
        Mesh::from_soup(soup).unwrap().0
    }

    fn kept(mesh: &Mesh) -> KeptWindows {
        KeptWindows::new(mesh, mesh.half_edge_count(), HalfEdgeId::index)
    }

    const WINDOW: Window = Window {
        b0: 0.0,
        b1: 1.0,
        px: 0.5,
        py: -1.0,
        sigma: 1.0,
    };

    #[test]
    fn windows_are_kept_beside_thin_faces_only() {
        assert!(kept(&mesh(1.0)).is_empty() && kept(&mesh(1e-2)).is_empty());
        assert!(!kept(&mesh(1e-5)).is_empty());
    }

    #[test]
    fn a_window_that_comes_again_goes_on_once() {
        let mut kept = kept(&mesh(1e-5));
        assert_eq!(kept.admit(0, &WINDOW), Some(WINDOW));
        let again = Window {
            sigma: 1.0 + 1e-14,
            ..WINDOW
        };
        assert_eq!(kept.admit(0, &again), None);
        // It has wound around the needle, and rounding has brought its source nearer.
        let again = Window {
            py: WINDOW.py + 1e-14,
            ..WINDOW
        };
        assert_eq!(kept.admit(0, &again), None);
        let shorter = Window {
            sigma: 0.5,
            ..WINDOW
        };
        assert_eq!(kept.admit(0, &shorter), Some(shorter));
        kept.clear();
        assert_eq!(kept.admit(0, &again), Some(again));
    }

    /// Its old windows once won each tie with the new ones, so that the next pseudo-source got the
    /// old distance, and so on.
    #[test]
    fn a_source_that_has_come_nearer_replaces_its_windows() {
        let mut kept = kept(&mesh(1e-5));
        let mut sent = WINDOW;
        for _ in 0..3 {
            assert_eq!(kept.admit(0, &sent), Some(sent));
            sent.sigma = sent.sigma.next_down();
        }
    }

    #[test]
    fn only_the_part_that_is_shorter_goes_on() {
        let mut kept = kept(&mesh(1e-5));
        let left = Window { b1: 0.5, ..WINDOW };
        assert_eq!(kept.admit(0, &left), Some(left));
        let right = Window { b0: 0.5, ..WINDOW };
        assert_eq!(kept.admit(0, &WINDOW), Some(right));
    }
}
