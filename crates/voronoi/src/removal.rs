//! Removal of redundant windows: those whose surroundings belong to one cell.

use geobench_mesh::{FaceId, HalfEdgeId};
use geobench_window::precision::MARGIN;
use geobench_window::prefetch;
use geobench_window::queue::MinHeap;

use crate::field::NO_SOURCE;
#[cfg(test)]
use crate::store::Stored;
use crate::store::edge_of;
use crate::wave::WaveState;

/// Which windows are removed during a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Removal {
    /// None. All windows that trimming leaves are kept until the end.
    Off,
    /// Windows on redundant edges, soon after the wavefront has passed (Qin, Yu, Zhang 2017,
    /// section 3).
    #[default]
    Continuous,
    /// Windows on redundant edges, by a periodic scan of the faces (Xu et al. 2014).
    Periodic {
        /// A scan follows after this number of propagations per face of the mesh.
        c: f64,
    },
}

/// Number of turns between two sweeps for redundant edges. A sweep over several faces can prefetch
/// them.
const PERIOD: u32 = 32;

/// Prefetch distances, in faces: of a face, and of the data of its edges and vertices.
const AHEAD: [usize; 2] = [8, 4];

/// The state of a face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum FaceProgress {
    /// Windows may still shorten distances in the face.
    #[default]
    Active,
    /// No window to come is shorter anywhere in the face, and several sources reach it.
    Border,
    /// As `Border`, but the face has one source.
    Redundant,
}

/// Finds redundant edges and removes their windows.
///
/// Let one point of a face be reached within distance d, and let e be the longest edge of the face.
/// Then all points of the face are reached within d + e. The face is *inactive* once all windows
/// that are still to cross any face offer more than d + e. An inactive face is *redundant* if its
/// three vertices and all windows on its edges have one source.
///
/// An edge between two redundant faces is of no use to the diagram. Its windows are removed and the
/// edge is closed. Without closing, later windows would be stored there although they are longer,
/// because no window is left to trim them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Remover {
    removal: Removal,
    states: Vec<FaceProgress>,
    /// Reached faces that are not known to be inactive, by their bound d + e.
    queue: MinHeap<u32>,
    /// Reached faces that are not known to be redundant, for the periodic scan.
    open: Vec<u32>,
    /// Propagations since the last scan.
    crossed: u64,
    /// Turns since the last sweep.
    turns: u32,
    /// Scratch: the faces that a sweep has found inactive.
    inactive: Vec<u32>,
    #[cfg(test)]
    pub(crate) traps: PublishedDefects,
}

/// Defects of the published procedure. Tests switch them on to show that they would be noticed.
#[cfg(test)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools)]
pub(crate) struct PublishedDefects {
    /// The other face of an edge need not be inactive.
    pub(crate) active_neighbour: bool,
    /// Edges are not closed when their windows are removed.
    pub(crate) no_closing: bool,
    /// The sources of the vertices of a face are ignored, only those of its windows count.
    pub(crate) windows_alone: bool,
}

impl Remover {
    pub(crate) fn new(removal: Removal) -> Self {
        Self {
            removal,
            ..Self::default()
        }
    }

    /// Whether the distances at which faces are reached have to be recorded.
    pub(crate) fn watches_faces(&self) -> bool {
        self.removal != Removal::Off
    }

    /// Prepares for a run on a mesh with this number of faces.
    pub(crate) fn reset(&mut self, faces: usize) {
        self.states.clear();
        self.queue.clear();
        self.open.clear();
        (self.crossed, self.turns) = (0, 0);
        if self.watches_faces() {
            self.states.resize(faces, FaceProgress::Active);
        }
    }

    /// Removes windows if a sweep or scan is due. `propagated` is the number of propagations since
    /// the last call. All windows still to be propagated offer `d` or more.
    pub(crate) fn step(&mut self, wave: &mut WaveState, propagated: u64, d: f64) {
        match self.removal {
            Removal::Off => {}
            Removal::Continuous => {
                self.turns += 1;
                if d == f64::INFINITY || self.turns >= PERIOD {
                    self.turns = 0;
                    self.sweep(wave, d);
                }
            }
            Removal::Periodic { c } => {
                self.open.append(&mut wave.reached);
                self.crossed += propagated;
                if d == f64::INFINITY || self.crossed as f64 >= c * self.states.len() as f64 {
                    self.crossed = 0;
                    self.look_through(wave, d);
                }
            }
        }
    }

    /// Removes the windows that have become redundant since the last sweep.
    fn sweep(&mut self, wave: &mut WaveState, d: f64) {
        for (i, &f) in wave.reached.iter().enumerate() {
            prefetch_face(wave, wave.reached.get(i + AHEAD[1]));
            self.queue.push(bound(wave, f), f);
        }
        wave.reached.clear();
        let mut inactive = std::mem::take(&mut self.inactive);
        inactive.clear();
        // The bound of a face may have fallen since it was queued. Then the face is only found
        // later.
        while let Some((bound, f)) = self.queue.peek()
            && is_less(bound, d)
        {
            self.queue.pop();
            inactive.push(f);
        }
        for (i, &f) in inactive.iter().enumerate() {
            prefetch_face(wave, inactive.get(i + AHEAD[0]));
            prefetch_around(wave, inactive.get(i + AHEAD[1]));
            self.settle(wave, f);
        }
        self.inactive = inactive;
    }

    /// As [`sweep`](Self::sweep), by a scan of all reached faces that are not known to be
    /// redundant.
    fn look_through(&mut self, wave: &mut WaveState, d: f64) {
        let mut open = std::mem::take(&mut self.open);
        open.retain(|&f| {
            if is_inactive(wave, f, d) {
                self.settle(wave, f);
            }
            self.states[f as usize] != FaceProgress::Redundant
        });
        self.open = open;
    }

    /// Sets the state of face `f`, which is inactive, and removes the windows of its edges that
    /// have become redundant.
    fn settle(&mut self, wave: &mut WaveState, f: u32) {
        let face = FaceId::new(f);
        if !self.has_one_source(wave, face) {
            self.states[f as usize] = FaceProgress::Border;
            return;
        }
        self.states[f as usize] = FaceProgress::Redundant;
        for h in face.half_edges() {
            // Boundary edges hold no windows.
            if let Some(twin) = wave.faces.twin(h)
                && self.is_redundant(wave, twin)
            {
                wave.store.give_up(edge_of(h, twin).0, self.closes());
            }
        }
    }

    /// Whether the face of `h` is redundant.
    fn is_redundant(&self, wave: &WaveState, h: HalfEdgeId) -> bool {
        #[cfg(test)]
        if self.traps.active_neighbour {
            return self.has_one_source(wave, h.face());
        }
        let _ = wave;
        self.states[h.face().index()] == FaceProgress::Redundant
    }

    /// Whether an edge is closed when its windows are removed.
    #[allow(clippy::unused_self)] // Tests read `traps` here.
    fn closes(&self) -> bool {
        #[cfg(test)]
        if self.traps.no_closing {
            return false;
        }
        true
    }

    /// Whether all windows on the edges of `face`, and all its vertices, have the same source.
    #[allow(clippy::unused_self)] // As above.
    fn has_one_source(&self, wave: &WaveState, face: FaceId) -> bool {
        let corners = wave.faces.corners(face.half_edge(0));
        let [first, others @ ..] = corners.map(|v| wave.labels[v.index()]);
        #[cfg(test)]
        if self.traps.windows_alone {
            return windows_have_one_source(wave, face);
        }
        first != NO_SOURCE
            && others.iter().all(|&other| other == first)
            && edges_of(wave, face).all(|e| wave.store.has_one_source(e, first))
    }
}

/// The edges of `face` that can hold windows: all but boundary edges.
fn edges_of(wave: &WaveState, face: FaceId) -> impl Iterator<Item = usize> {
    let half_edges = face.half_edges().into_iter();
    half_edges.filter_map(|h| Some(edge_of(h, wave.faces.twin(h)?).0))
}

/// Whether the windows on the edges of `face` have the same source, regardless of its vertices.
#[cfg(test)]
fn windows_have_one_source(wave: &WaveState, face: FaceId) -> bool {
    let windows = edges_of(wave, face).flat_map(|e| wave.store.list(e));
    let mut sources = windows.map(Stored::source);
    let first = sources.next();
    first != Some(NO_SOURCE) && sources.all(|source| Some(source) == first)
}

/// Prefetches face `f`.
#[inline]
fn prefetch_face(wave: &WaveState, f: Option<&u32>) {
    if let Some(&f) = f {
        wave.faces.announce(FaceId::new(f).half_edge(0));
    }
}

/// Prefetches the data that [`Remover::settle`] reads. The face must have been
/// [prefetched](prefetch_face) before.
#[inline]
fn prefetch_around(wave: &WaveState, f: Option<&u32>) {
    if let Some(&f) = f {
        let face = FaceId::new(f);
        for v in wave.faces.corners(face.half_edge(0)) {
            prefetch(&wave.labels, v.index());
        }
        for e in edges_of(wave, face) {
            wave.store.prefetch_list(e);
        }
    }
}

/// The distance d + e within which all points of face `f` are reached.
fn bound(wave: &WaveState, f: u32) -> f64 {
    let face = FaceId::new(f);
    let lengths = face.half_edges().map(|h| wave.faces.length(h));
    wave.nearest[f as usize] + lengths.into_iter().fold(0.0, f64::max)
}

/// Whether windows that offer `d` or more cannot improve face `f`, beyond rounding.
fn is_inactive(wave: &WaveState, f: u32, d: f64) -> bool {
    is_less(bound(wave, f), d)
}

/// Whether `bound` is less than `d`, beyond rounding.
fn is_less(bound: f64, d: f64) -> bool {
    bound * (1.0 + MARGIN) < d
}
