//! Redundant windows: those around which all comes from one source.

use geobench_mesh::{FaceId, HalfEdgeId};
use geobench_window::precision::MARGIN;
use geobench_window::prefetch;
use geobench_window::queue::MinHeap;

use crate::field::NO_SOURCE;
#[cfg(test)]
use crate::store::Stored;
use crate::store::edge_of;
use crate::wave::Wave;

/// Which windows are given up during a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Removal {
    /// None: all that trimming leaves are kept until the end.
    Off,
    /// Those on redundant edges, as soon as the wave has passed (Qin, Yu, Zhang 2017, section 3).
    #[default]
    Continuous,
    /// The same edges, looked for among all faces at times (Xu et al. 2014).
    Periodic {
        /// The faces are looked through after this many propagations for each face of the mesh.
        c: f64,
    },
}

/// Number of turns between two searches for redundant edges. Faces that are looked at together are
/// prefetched.
const PERIOD: u32 = 32;

/// How many faces ahead a face is prefetched, and how many ahead the data of its edges and
/// vertices.
const AHEAD: [usize; 2] = [8, 4];

/// The state of a face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    /// Windows may still improve it.
    #[default]
    Active,
    /// No window that is still to come is shorter anywhere in it, and several sources reach it.
    Border,
    /// As `Border`, but it has one source.
    Redundant,
}

/// Finds redundant edges and gives their windows up.
///
/// A face is *inactive* once all windows that are still to cross any face offer more than
/// `d + e` everywhere, where one point of the face is reached within d, and e is its longest edge:
/// all its points are reached within that. It is *redundant* if, then, the windows on its edges and
/// its three vertices have one source. An edge both of whose faces are so is of no use to the
/// diagram. It is closed: what comes later would be longer there, and settle nevertheless, since
/// nothing is left to compare it with.
#[derive(Clone, Debug, Default)]
pub(crate) struct Remover {
    removal: Removal,
    states: Vec<State>,
    /// Faces that are not inactive by the length below which they may be.
    queue: MinHeap<u32>,
    /// Faces that have been reached and not been found redundant, for the periodic check.
    open: Vec<u32>,
    crossed: u64,
    /// Turns since the last sweep.
    turns: u32,
    /// Faces found inactive by a sweep.
    inactive: Vec<u32>,
    #[cfg(test)]
    pub(crate) traps: Traps,
}

/// Mistakes of the printed procedure, to show that tests notice them.
#[cfg(test)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools)]
pub(crate) struct Traps {
    /// The neighbour need not be inactive.
    pub(crate) active_neighbour: bool,
    /// Edges stay open.
    pub(crate) no_closing: bool,
    /// Vertices do not count, only windows.
    pub(crate) windows_alone: bool,
}

impl Remover {
    pub(crate) fn new(removal: Removal) -> Self {
        Self {
            removal,
            ..Self::default()
        }
    }

    /// Whether it needs to know how near faces are.
    pub(crate) fn watches_faces(&self) -> bool {
        self.removal != Removal::Off
    }

    /// Forgets the last run, on a mesh of so many faces.
    pub(crate) fn reset(&mut self, faces: usize) {
        self.states.clear();
        self.queue.clear();
        self.open.clear();
        (self.crossed, self.turns) = (0, 0);
        if self.watches_faces() {
            self.states.resize(faces, State::Active);
        }
    }

    /// So many more windows have been propagated, and all that are still to be offer `d` or more.
    pub(crate) fn step(&mut self, wave: &mut Wave, propagated: u64, d: f64) {
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

    /// Gives up what has become redundant since the last time.
    fn sweep(&mut self, wave: &mut Wave, d: f64) {
        for (i, &f) in wave.reached.iter().enumerate() {
            prefetch_face(wave, wave.reached.get(i + AHEAD[1]));
            self.queue.push(bound(wave, f), f);
        }
        wave.reached.clear();
        let mut inactive = std::mem::take(&mut self.inactive);
        inactive.clear();
        // Where the bound has fallen since the face was queued, it waits longer than it must.
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

    /// The same, looking at every face that is not known to be redundant.
    fn look_through(&mut self, wave: &mut Wave, d: f64) {
        let mut open = std::mem::take(&mut self.open);
        open.retain(|&f| {
            if is_inactive(wave, f, d) {
                self.settle(wave, f);
            }
            self.states[f as usize] != State::Redundant
        });
        self.open = open;
    }

    /// Face `f` is inactive.
    fn settle(&mut self, wave: &mut Wave, f: u32) {
        let face = FaceId::new(f);
        if !self.has_one_source(wave, face) {
            self.states[f as usize] = State::Border;
            return;
        }
        self.states[f as usize] = State::Redundant;
        for h in [0, 1, 2].map(|corner| face.half_edge(corner)) {
            // The edges of the boundary hold no windows.
            if let Some(twin) = wave.faces.twin(h)
                && self.is_redundant(wave, twin)
            {
                wave.store.give_up(edge_of(h, twin).0, self.closes());
            }
        }
    }

    fn is_redundant(&self, wave: &Wave, h: HalfEdgeId) -> bool {
        #[cfg(test)]
        if self.traps.active_neighbour {
            return self.has_one_source(wave, h.face());
        }
        let _ = wave;
        self.states[h.face().index()] == State::Redundant
    }

    #[allow(clippy::unused_self)] // Tests set a trap here.
    fn closes(&self) -> bool {
        #[cfg(test)]
        if self.traps.no_closing {
            return false;
        }
        true
    }

    /// Whether all windows on the edges of `face` and its vertices have the same source.
    #[allow(clippy::unused_self)] // As above.
    fn has_one_source(&self, wave: &Wave, face: FaceId) -> bool {
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

/// The edges of `face` that hold windows: not those of the boundary.
fn edges_of(wave: &Wave, face: FaceId) -> impl Iterator<Item = usize> {
    let half_edges = [0, 1, 2].into_iter().map(move |c| face.half_edge(c));
    half_edges.filter_map(|h| Some(edge_of(h, wave.faces.twin(h)?).0))
}

/// Whether the windows on the edges of `face` have the same source, whatever its vertices have.
#[cfg(test)]
fn windows_have_one_source(wave: &Wave, face: FaceId) -> bool {
    let windows = edges_of(wave, face).flat_map(|e| wave.store.list(e));
    let mut sources = windows.map(Stored::source);
    let first = sources.next();
    first != Some(NO_SOURCE) && sources.all(|source| Some(source) == first)
}

/// Prefetches face `f`.
#[inline]
fn prefetch_face(wave: &Wave, f: Option<&u32>) {
    if let Some(&f) = f {
        wave.faces.announce(FaceId::new(f).half_edge(0));
    }
}

/// Prefetches what [`Remover::settle`] looks at, after [`prefetch_face`].
#[inline]
fn prefetch_around(wave: &Wave, f: Option<&u32>) {
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

/// The length within which all points of face `f` are reached.
fn bound(wave: &Wave, f: u32) -> f64 {
    let face = FaceId::new(f);
    let lengths = [0, 1, 2].map(|corner| wave.faces.length(face.half_edge(corner)));
    wave.nearest[f as usize] + lengths.into_iter().fold(0.0, f64::max)
}

/// Whether windows of `d` and more cannot improve face `f`, beyond doubt.
fn is_inactive(wave: &Wave, f: u32, d: f64) -> bool {
    is_less(bound(wave, f), d)
}

/// Whether `bound` is less than `d`, beyond doubt.
fn is_less(bound: f64, d: f64) -> bool {
    bound * (1.0 + MARGIN) < d
}
