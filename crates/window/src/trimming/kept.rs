//! Windows stored beside thin faces, to end those that wind around a needle, and at junctions.

use geobench_mesh::{FaceId, HalfEdgeId, Mesh, Splice};

use super::foot::{is_near, pieces};
use super::groups::inner_edges;
use super::insertion::{TrimmedList, Trimmer};
use super::thin::ThinFaces;
use crate::blocks::BlockLists;
use crate::precision::MARGIN;
use crate::window::Window;

/// The windows that have arrived at the half-edges of thin faces and along
/// [junctions](Mesh::junction), for algorithms that store none.
///
/// No shortest path crosses an edge twice, but a window that winds around a needle does. The vertex
/// filter deletes it once it is longer than a path along an edge. On a thin needle the difference
/// never exceeds rounding. MMP ends such a window when it arrives at a half-edge for the second
/// time: the stored window is as short, and among equal windows the stored one stays. This type
/// does the same on the half-edges of thin faces, which few meshes have.
///
/// At a junction, windows come over several sheets. If the sheets are isometric, windows come in
/// equal copies, whose number would double from junction to junction. The first of them stays.
///
/// ```
/// use geobench_mesh::{HalfEdgeId, Mesh, Splice};
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
    /// The list of each half-edge, by its number, with [`INNER`] if it is not in use; `NO_LIST` if
    /// it has none, [`GATE`] for gates. Empty if there is no list.
    lists: Vec<u32>,
    /// Where gates begin in `lists`.
    first_gate: usize,
    /// The length of the half-edge of each list.
    lengths: Vec<f64>,
    /// The windows of each list.
    kept: BlockLists<Window, ListNote>,
    /// The thin faces, without their half-edges.
    limits: ThinFaces,
    /// The number of lists on the mesh of the set-up, and its doubt.
    own: (usize, f64),
    /// Whether each of these lists is not in use; empty if all are.
    inner: Vec<bool>,
    /// The number of half-edges of the mesh of the set-up.
    own_numbers: usize,
    doubt: f64,
    reach: f64,
    trimmer: Trimmer<Window>,
}

const NO_LIST: u32 = u32::MAX;

/// The bit of lists within groups of thin faces, which are not in use. `NO_LIST` has it as well.
const INNER: u32 = 1 << 31;

/// Gates have no list, but are [held](KeptWindows::holds), so that one test finds both.
const GATE: u32 = (NO_LIST & !INNER) - 1;

/// What is noted about the windows that wait on a half-edge.
#[derive(Clone, Copy, Debug, Default)]
struct ListNote {
    /// Some have not been admitted here.
    received: bool,
    /// Windows have been removed from the list since. Nothing may be left of those that wait.
    replaced: bool,
}

impl KeptWindows {
    /// Empty lists for `mesh`. `number` gives the number of each half-edge, which is less than
    /// `numbers`; [gates](crate::Faces::with_gates) follow. O(faces).
    pub fn new(mesh: &Mesh, numbers: usize, number: impl Fn(HalfEdgeId) -> usize) -> Self {
        let mut kept = Self::default();
        let thin = ThinFaces::of(mesh, numbers, &number);
        let mut doubt = thin.doubt();
        // Most meshes have neither, and then no half-edge is looked at.
        let are_some = !thin.is_empty() || mesh.has_junctions();
        for h in mesh.half_edges().take_while(|_| are_some) {
            let is_at_junction = mesh.junction_side(h).is_some();
            if is_at_junction {
                doubt = doubt.max(MARGIN * mesh.length(h));
            }
            if is_at_junction || thin.is_beside(number(h)) {
                kept.lists.resize(numbers, NO_LIST);
                kept.add(number(h), mesh.length(h));
            }
        }
        kept.add_gates(mesh, numbers);
        kept.kept = BlockLists::new(kept.lengths.len(), 0);
        kept.set_doubt(doubt);
        kept.own = (kept.lengths.len(), doubt);
        kept.own_numbers = numbers;
        kept.limits = thin.without_half_edges();
        kept
    }

    /// Stores no windows within groups of thin faces, if many faces are thin. `mesh` and `number`
    /// are as for [`new`](Self::new), and no window may be stored. O(faces).
    ///
    /// To store a window takes several times as long as to let it cross a face. Windows that are
    /// not trimmed at one edge are at one of the next, so hardly more of them cross.
    #[must_use]
    pub fn in_groups(mut self, mesh: &Mesh, number: impl Fn(HalfEdgeId) -> usize) -> Self {
        if let Some(inner) = inner_edges(mesh, &self.limits) {
            self.inner.resize(self.lengths.len(), false);
            for h in mesh.half_edges().filter(|h| inner[h.index()]) {
                let list = &mut self.lists[number(h)];
                self.inner[*list as usize] = true;
                *list |= INNER;
            }
        }
        self
    }

    fn add_gates(&mut self, mesh: &Mesh, numbers: usize) {
        self.first_gate = numbers;
        let gates = mesh.junction_sides().len();
        if gates > 0 {
            self.lists.resize(numbers + gates, GATE);
        }
    }

    fn add(&mut self, h: usize, length: f64) {
        self.lists[h] = self.lengths.len() as u32;
        self.lengths.push(length);
    }

    fn set_doubt(&mut self, doubt: f64) {
        self.doubt = doubt;
        self.reach = 4.0 * doubt / MARGIN;
    }

    /// Follows a change of the mesh, as [`ThinFaces::splice`]. No window may be stored.
    pub fn splice(
        &mut self,
        mesh: &Mesh,
        splice: &Splice,
        numbers: usize,
        number: impl Fn(HalfEdgeId) -> usize,
    ) {
        let (own, own_doubt) = self.own;
        self.lengths.truncate(own);
        self.lists.truncate(self.first_gate);
        let mut doubt = own_doubt;
        if own == 0 {
            self.lists.clear();
        } else {
            self.lists.resize(numbers, NO_LIST);
        }
        let is_undone = numbers == self.own_numbers;
        for h in splice.faces().flat_map(FaceId::half_edges) {
            let is_at_junction = mesh.junction_side(h).is_some();
            let beside = is_at_junction || self.limits.is_beside_on(mesh, h);
            if beside && self.lists.is_empty() {
                self.lists.resize(numbers, NO_LIST);
            }
            for h in (!self.lists.is_empty())
                .then(|| mesh.along_edge(h))
                .into_iter()
                .flatten()
            {
                // A list of the set-up stays: storing windows where no face is thin does no harm.
                let i = number(h);
                let list = self.lists[i] & !INNER;
                match self.lengths.get_mut(list as usize) {
                    Some(length) => {
                        *length = mesh.length(h);
                        // Parts of a split face are in no group.
                        let is_inner = self.inner.get(list as usize) == Some(&true);
                        self.lists[i] = if is_undone && is_inner {
                            list | INNER
                        } else {
                            list
                        };
                    }
                    None if beside => self.add(i, mesh.length(h)),
                    None => self.lists[i] = NO_LIST,
                }
            }
            if is_at_junction || self.limits.is_thin(mesh, h.face()) {
                doubt = doubt.max(MARGIN * mesh.length(h));
            }
        }
        self.add_gates(mesh, numbers);
        self.kept.set_count(self.lengths.len(), 0);
        self.kept.clear();
        self.set_doubt(doubt);
    }

    /// Whether no face is thin and there is no junction. Then no window is stored, and calls of the
    /// other methods can be skipped.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.lists.is_empty()
    }

    /// As [`ThinFaces::doubt`], for the stored windows: those along junctions as well.
    #[inline]
    pub fn doubt(&self) -> f64 {
        self.doubt
    }

    /// The distance from which on the margin of the vertex filter covers the [doubt](Self::doubt);
    /// 0 if no window is stored.
    ///
    /// A window at distance d is deleted only if it is beaten by [`MARGIN`] of d/2, or by d/2
    /// itself. From four times the longest side of a thin face, or of a junction, on, both are at
    /// least twice the doubt.
    #[inline]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Whether faces are thin and the mesh has the tip of a needle, as [`ThinFaces::has_tip`].
    #[inline]
    pub fn has_tip(&self) -> bool {
        !self.is_empty() && self.limits.has_tip()
    }

    /// Whether windows that arrive at half-edge number `h` are stored, or `h` is a gate.
    #[inline]
    pub fn holds(&self, h: usize) -> bool {
        self.lists.get(h).is_some_and(|&list| list & INNER == 0)
    }

    /// Whether half-edge number `h` is [held](Self::holds), or lies [within a
    /// group](Self::in_groups) of thin faces.
    #[inline]
    pub fn is_beside(&self, h: usize) -> bool {
        self.lists.get(h).is_some_and(|&list| list != NO_LIST)
    }

    /// The list of half-edge number `h`.
    #[inline]
    fn list(&self, h: usize) -> Option<usize> {
        let list = self.lists.get(h).filter(|&&list| list < GATE)?;
        Some(*list as usize)
    }

    /// Removes all windows.
    pub fn clear(&mut self) {
        self.kept.clear();
    }

    /// Removes the windows of half-edge number `h`.
    pub fn clear_at(&mut self, h: usize) {
        if let Some(list) = self.list(h) {
            self.kept.remove_all(list, false);
        }
    }

    /// Notes that windows wait on half-edge number `h` which were admitted elsewhere.
    pub fn receive(&mut self, h: usize) {
        if let Some(list) = self.list(h) {
            self.kept.note_mut(list).received = true;
        }
    }

    /// Stores `new`, which arrives at half-edge number `h`, and returns the part of it to
    /// propagate; `None` if no part is needed. Returns `new` unchanged if `h` is not
    /// [held](Self::holds). O(k) for k windows stored there.
    ///
    /// The returned part must be propagated, even if a shorter path to its root has been found
    /// since: it may have replaced an equal window.
    #[cold]
    pub fn admit(&mut self, h: usize, new: &Window) -> Option<Window> {
        let Some(list) = self.list(h) else {
            return Some(*new);
        };
        let l = self.lengths[list];
        let mut parts = None;
        if is_near(new, l) {
            let pieces: Vec<Window> = pieces(new, l, self.kept.entries(list)).collect();
            for piece in pieces {
                self.insert(list, &piece, l, &mut parts);
            }
        } else {
            self.insert(list, new, l, &mut parts);
        }
        // The range between two parts is not needed, but harmless.
        parts.map(|[b0, b1]| Window { b0, b1, ..*new })
    }

    /// Stores `new` in list `list`, on an edge of length `l`. Its source is not [near](is_near) the
    /// edge, or it is one of the [`pieces`] of a window. `parts` becomes the least range with its
    /// own and all that is stored.
    #[inline]
    fn insert(&mut self, list: usize, new: &Window, l: f64, parts: &mut Option<[f64; 2]>) {
        let first = self.kept.leading(list, |w| w.b1 <= new.b0);
        let (windows, note) = self.kept.entries_mut(list);
        let mut admission = Admission {
            windows,
            parts,
            replaced: &mut note.replaced,
        };
        let old = self.trimmer.insert_one(&mut admission, first, new, l);
        self.kept.replace(list, old, self.trimmer.pieces());
    }

    /// Whether [`has_replaced`](Self::has_replaced) may hold for a window that waits on half-edge
    /// number `h`.
    #[inline]
    pub fn may_have_replaced(&self, h: usize) -> bool {
        self.list(h).is_some_and(|list| {
            let note = self.kept.note(list);
            note.replaced && !note.received
        })
    }

    /// Notes that all windows which wait on half-edge number `h` cross now or are dropped.
    pub fn note_crossing(&mut self, h: usize) {
        if let Some(list) = self.list(h) {
            self.kept.note_mut(list).replaced = false;
        }
    }

    /// Whether later windows have replaced all of `waiting`, which waits on half-edge number `h`.
    /// False if `h` is not [held](Self::holds), and where windows [were received](Self::receive).
    /// O(k) for k windows stored there.
    ///
    /// It then need not cross. The windows in its place are shorter, and cross instead, unless they
    /// are replaced in turn. Windows that were dropped because they tied with it are no shorter
    /// than those by more than a tie, so nothing adds up.
    ///
    /// A part that is left does not tell that the rest is needed, but the window crosses as a
    /// whole.
    #[cold]
    pub fn has_replaced(&self, h: usize, waiting: &Window) -> bool {
        let Some(list) = self.list(h).filter(|_| self.may_have_replaced(h)) else {
            return false;
        };
        let first = self.kept.leading(list, |w| w.b1 <= waiting.b0);
        let behind = self.kept.entries(list)[first..].iter();
        let mut met = behind.take_while(|w| w.b0 < waiting.b1);
        !met.any(|w| w.source() == waiting.source() && w.sigma == waiting.sigma)
    }
}

/// The arrival of a window at a list.
struct Admission<'a> {
    windows: &'a mut [Window],
    /// The least range with all parts that are stored.
    parts: &'a mut Option<[f64; 2]>,
    /// Becomes true if a stored window is removed.
    replaced: &'a mut bool,
}

impl TrimmedList for Admission<'_> {
    type Entry = Window;

    fn entries(&self) -> &[Window] {
        self.windows
    }

    fn entries_mut(&mut self) -> &mut [Window] {
        self.windows
    }

    fn window<'a>(&'a self, entry: &'a Window) -> &'a Window {
        entry
    }

    fn keep(&mut self, _: usize, part: Window) -> Window {
        let [start, end] = self.parts.unwrap_or([part.b0, part.b1]);
        *self.parts = Some([start.min(part.b0), end.max(part.b1)]);
        part
    }

    fn drop_new(&mut self, _: usize) {}

    fn cut(&mut self, old: &Window, b0: f64, b1: f64) -> Window {
        old.cut(b0, b1)
    }

    fn split(&mut self, old: &Window, b0: f64, b1: f64) -> Window {
        old.cut(b0, b1)
    }

    fn remove(&mut self, _: &Window) {
        *self.replaced = true;
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
    fn windows_are_kept_along_junctions_and_gates_are_held() {
        let positions = vec![
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.5, 1.0, 0.0],
            [0.5, -1.0, 0.0],
            [0.5, 0.0, 1.0],
        ];
        let mesh = Mesh::new(positions, vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]]).unwrap();
        let mut kept = kept(&mesh);
        let held: Vec<usize> = (0..13).filter(|&h| kept.holds(h)).collect();
        assert_eq!(held, [0, 3, 6, 9, 10, 11]);
        assert_eq!(kept.admit(3, &WINDOW), Some(WINDOW));
        assert_eq!(kept.admit(3, &WINDOW), None);
        assert_eq!(kept.admit(6, &WINDOW), Some(WINDOW));
        for gate in [9, 9] {
            assert_eq!(kept.admit(gate, &WINDOW), Some(WINDOW));
        }
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

    /// On strips of needles, windows once crossed faces after shorter ones had taken their places,
    /// and so did all that came of them.
    #[test]
    fn a_window_is_replaced_once_nothing_of_it_is_left() {
        let mut kept = kept(&mesh(1e-5));
        let shorter = Window {
            sigma: 0.5,
            ..WINDOW
        };
        assert_eq!(kept.admit(0, &WINDOW), Some(WINDOW));
        kept.admit(0, &Window { b1: 0.5, ..shorter });
        assert!(!kept.has_replaced(0, &WINDOW));
        kept.admit(0, &Window { b0: 0.5, ..shorter });
        assert!(kept.has_replaced(0, &WINDOW) && !kept.has_replaced(0, &shorter));
        kept.receive(0);
        assert!(!kept.has_replaced(0, &WINDOW));
        let away = (0..6).find(|&h| !kept.holds(h)).unwrap();
        assert!(!kept.has_replaced(away, &WINDOW));
    }

    #[test]
    fn windows_are_replaced_before_they_cross() {
        let mut kept = kept(&mesh(1e-5));
        let shorter = |sigma| Window { sigma, ..WINDOW };
        kept.admit(0, &WINDOW);
        assert!(!kept.may_have_replaced(0));
        kept.admit(0, &shorter(0.5));
        assert!(kept.may_have_replaced(0) && kept.has_replaced(0, &WINDOW));
        kept.note_crossing(0);
        assert!(!kept.may_have_replaced(0));
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
