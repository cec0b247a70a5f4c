//! The crossing of lists whose windows [stay](crate::engine::chunks) in unfolded planes.
//!
//! In such a list no window is touched that lies beside the apex. That saves most of the work on
//! long lists, and costs more on short ones, so a wavefront chooses by the mean number of windows
//! in its lists. Rules 2 and 3 are not applied. Beside thin and long faces, and on edges far
//! shorter than the longest one, lists have the usual form. A list may have windows of both forms
//! while it waits; they get one form when it crosses.

use geobench_mesh::{HalfEdgeId, VertexId};
use geobench_window::simd::{CacheLine, Lanes, SimdProgram};
use geobench_window::{Phase, Probe, Way, Window};

use super::{Improvement, SurfaceState, Wavefront};
use crate::engine::chunks::{Chunk, ChunkStore, ROOM, unit};
use crate::engine::kernels::chunks::{ChunkPart, Sight, look};
use crate::engine::kernels::{AllowedAngle, BestPath, Gate, LOSES, Triangle};
use crate::engine::layout::{MeshLayout, NO_TWIN, half_edge, next, parts, prev};
use crate::engine::store::{COLUMNS, NO_LIST, as_window};
use crate::precision::blur;

/// Lists that cross between two decisions about their form.
const LISTS: usize = 256;

/// The lengths of edges for which the headers of chunks have the precision that they need.
const LENGTHS: [f64; 2] = [1e-15, 1e15];

/// How much longer than the [`blur`] of the mesh an edge must be for its lists to stay. A window
/// offers its straight path to an apex that is beside its rays by at most the blur. From a source
/// 1e-3 of the edge away that is an angle of 1e-5, and the path is too short by at most 5e-11.
const SHARP: f64 = 1e8;

/// The fraction of the least mean at which lists stay below which they no longer do.
const HYSTERESIS: f64 = 0.75;

/// A chunk of up to this many windows that is alone in its list is always opened.
const SMALL: u16 = 8;

/// How far below and above the apex a chunk is bounded, in lengths of the edge.
const BELOW: f64 = 2.0;
const ABOVE: f64 = 12.0;

/// A chunk that is opened.
#[derive(Clone, Copy, Debug)]
struct Opened {
    chunk: usize,
    /// The apex in its frame.
    apex: [f64; 2],
    sight: Sight,
    /// The windows with rays on both sides of the apex.
    parted: u64,
}

/// A window that rule 1 cuts at another ray than that to the apex.
#[derive(Clone, Copy, Debug)]
struct Cut {
    opened: usize,
    window: usize,
    side: usize,
    slope: f64,
}

/// The state of lists that stay, with scratch for their crossings.
#[derive(Clone, Debug)]
pub(super) struct Staying {
    pub(super) store: ChunkStore,
    /// The least mean number of windows in a list at which lists stay.
    from: f64,
    /// Whether they do now.
    on: bool,
    /// The lists that have crossed since the last decision, and their windows.
    lists: usize,
    windows: usize,
    /// How the chunks of the list [pass](Chunk::passage) the apex.
    passages: Vec<Option<usize>>,
    opened: Vec<Opened>,
    cuts: Vec<Cut>,
    slopes: [CacheLine; ROOM / CacheLine::LANES],
}

impl Staying {
    /// Lists on edges of about this `length` stay from a mean of `from` windows on, never if it is
    /// 0.
    pub(super) fn new(from: u32, length: f64) -> Self {
        let may = from > 0 && LENGTHS[0] < length && length < LENGTHS[1];
        Self {
            store: ChunkStore::default(),
            from: if may { from.into() } else { f64::INFINITY },
            on: false,
            lists: 0,
            windows: 0,
            passages: Vec::new(),
            opened: Vec::new(),
            cuts: Vec::new(),
            slopes: [CacheLine::default(); ROOM / CacheLine::LANES],
        }
    }

    /// Clears the state of the last run.
    pub(super) fn reset(&mut self) {
        self.on = self.from <= 1.0;
        self.lists = 0;
        self.windows = 0;
    }

    /// Whether lists stay now.
    #[inline(always)]
    pub(super) fn is_on(&self) -> bool {
        self.on
    }

    /// All windows that stay, each in the frame of its edge.
    pub(super) fn windows(&self, layout: &MeshLayout) -> impl Iterator<Item = Window> {
        let lists = self.store.lists().iter();
        let chunks = lists.flat_map(|list| list.chunks.iter().map(move |chunk| (list.h, chunk)));
        let rows = chunks.flat_map(move |(h, chunk)| self.store.rows(chunk, layout.length(h)));
        rows.map(as_window)
    }

    /// Removes the chunks of `list`.
    pub(super) fn abandon(&mut self, list: u32) {
        let chunks = self.store.take(list);
        for chunk in &chunks {
            self.store.drop(chunk);
        }
        self.store.spare(chunks);
    }

    /// Counts a list of `windows` that crosses.
    #[inline(always)]
    pub(super) fn count(&mut self, windows: usize) {
        self.lists += 1;
        self.windows += windows;
    }

    /// Decides about the form of lists, if enough have crossed.
    #[inline]
    pub(super) fn decide(&mut self) {
        if self.lists >= LISTS {
            let mean = self.windows as f64 / self.lists as f64;
            let least = if self.on {
                self.from * HYSTERESIS
            } else {
                self.from
            };
            self.on = mean >= least;
            self.lists = 0;
            self.windows = 0;
        }
    }

    /// Opens the chunks that do not pass the apex on one side. Returns the opened chunk with the
    /// shortest path to the apex.
    #[inline(always)]
    fn look_at_apex<L: Lanes>(
        &mut self,
        simd: L::Token,
        chunks: &[Chunk],
        gate: &Gate,
    ) -> Option<usize> {
        self.passages.clear();
        self.opened.clear();
        self.cuts.clear();
        let small = chunks.len() == 1 && chunks[0].len <= SMALL;
        let (mut best, mut distance) = (None, f64::INFINITY);
        for (i, chunk) in chunks.iter().enumerate() {
            let apex = chunk.inside(gate.apex);
            let passage = if small { None } else { chunk.passage(apex) };
            self.passages.push(passage);
            if passage.is_none() {
                let blur = chunk.blur(gate.longest);
                let sight = look::<L>(simd, self.store.columns(chunk), apex, blur);
                if sight.distance < distance {
                    distance = sight.distance;
                    best = Some(self.opened.len());
                }
                self.opened.push(Opened {
                    chunk: i,
                    apex,
                    sight,
                    parted: sight.sides[0] & sight.sides[1],
                });
            }
        }
        best
    }

    /// Applies rule 1 to the windows with rays on both sides of the apex. The shortest path to it,
    /// `path`, is that of the opened chunk `best`.
    fn apply_rule_1(&mut self, chunks: &[Chunk], gate: &Gate, best: usize, path: &BestPath) {
        let own = self.opened[best];
        let size = gate.l + own.sight.distance;
        let own_blur = chunks[own.chunk].blur(gate.longest);
        for (i, opened) in self.opened.iter_mut().enumerate() {
            let mut parted = opened.parted;
            if i == best {
                parted &= !(1 << own.sight.best);
            }
            let chunk = &chunks[opened.chunk];
            let blur = own_blur + chunk.blur(gate.longest);
            let path = BestPath::new(path.entry, path.source, size, blur);
            while parted != 0 {
                let window = parted.trailing_zeros() as usize;
                parted &= parted - 1;
                let row = self.store.row(chunk, window, gate.l);
                // Rounding has left nothing of a narrow window on the edge.
                if row[1] <= row[0] {
                    continue;
                }
                for (side, allowed) in path.allowed(row, gate.apex).into_iter().enumerate() {
                    match allowed {
                        AllowedAngle::All => {}
                        AllowedAngle::None => opened.sight.sides[side] &= !(1 << window),
                        AllowedAngle::Until(limit) => {
                            let [x, y] = chunk.inside([limit, 0.0]);
                            let [px, py, ..] = self.store.columns(chunk).row(window);
                            if py < y {
                                self.cuts.push(Cut {
                                    opened: i,
                                    window,
                                    side,
                                    slope: (x - px) / (y - py),
                                });
                            }
                        }
                    }
                }
            }
        }
    }

    /// Sends `chunks` into the lists `behind` both exits of `triangle`, unless there is no face
    /// (`open`). `reach` bounds useful paths at the tail, the apex and the head.
    #[inline(always)]
    fn send<L: Lanes>(
        &mut self,
        simd: L::Token,
        chunks: &mut [Chunk],
        behind: &mut [Vec<Chunk>; 2],
        open: [bool; 2],
        triangle: &Triangle,
        reach: [f64; 3],
    ) {
        let waited_on_left = behind[0].len();
        let shortest = [0, 1].map(|side| reach[side].min(reach[side + 1]));
        // Whether the last part for the right has been deleted as a whole.
        let mut dead = false;
        let mut opened = self.opened.iter().enumerate();
        for (chunk, &passage) in chunks.iter_mut().zip(&self.passages) {
            let was_dead = std::mem::take(&mut dead);
            if let Some(side) = passage {
                if open[side] {
                    chunk.doubtful = was_dead && side == 1;
                    let list = &mut behind[side];
                    (self.store).push::<L>(simd, list, chunk, side, triangle, shortest[side]);
                } else {
                    self.store.drop(chunk);
                }
                continue;
            }
            let Some((number, of)) = opened.next() else {
                break;
            };
            let sides = [0, 1].map(|side| if open[side] { of.sight.sides[side] } else { 0 });
            // The larger part stays in its body.
            let larger = usize::from(sides[0].count_ones() < sides[1].count_ones());
            if sides[larger] == 0 {
                self.store.drop(chunk);
                continue;
            }
            let from = *chunk;
            let corners = [[0.0; 2], triangle.apex, [triangle.l, 0.0]].map(|p| from.inside(p));
            let mut left_over = [None; 2];
            for side in [1 - larger, larger] {
                if sides[side] == 0 {
                    continue;
                }
                let mut cut = 0;
                let cuts = self.cuts.iter();
                for c in cuts.filter(|c| c.opened == number && c.side == side) {
                    cut |= 1 << c.window;
                    let line = &mut self.slopes[c.window / CacheLine::LANES];
                    line.0[c.window % CacheLine::LANES] = c.slope;
                }
                let [start, end] = [corners[side], corners[side + 1]];
                let length = triangle.exits[side];
                let part = ChunkPart {
                    left: side == 0,
                    chosen: sides[side],
                    parted: of.parted,
                    apex: of.apex,
                    cut,
                    slopes: &self.slopes,
                    start,
                    along: [end[0] - start[0], end[1] - start[1]],
                    length,
                    reach: [reach[side], reach[side + 1] + length],
                    heights: [
                        of.apex[1] - BELOW * triangle.l,
                        of.apex[1] + ABOVE * triangle.l,
                    ],
                };
                let mut to = if side == larger {
                    from
                } else {
                    self.store.another(&from)
                };
                self.store.leave::<L>(simd, &from, &mut to, &part);
                left_over[side] = Some(to);
            }
            for (side, part) in left_over.into_iter().enumerate() {
                let Some(part) = part else {
                    continue;
                };
                let list = &mut behind[side];
                if part.len > 0 {
                    (self.store).push::<L>(simd, list, &part, side, triangle, shortest[side]);
                    continue;
                }
                // Windows are deleted from the outside; the neighbours of these may be next.
                self.store.drop(&part);
                if side == 1 {
                    dead = true;
                } else if list.len() > waited_on_left
                    && let Some(last) = list.last_mut()
                {
                    last.doubtful = true;
                }
            }
        }
    }
}

impl Wavefront {
    /// Makes room for `more` windows in `list`, as [`WindowStore::reserve`] does.
    ///
    /// [`WindowStore::reserve`]: crate::engine::store::WindowStore::reserve
    #[inline(always)]
    pub(super) fn reserve(&mut self, list: u32, more: usize) -> u32 {
        let new = self.store.reserve(list, more);
        if new != list {
            self.staying.store.rename(list, new);
        }
        new
    }

    /// Sets the length of `list`. An empty list without chunks is freed, and [`NO_LIST`] is
    /// returned for it.
    #[inline(always)]
    pub(super) fn set_len(&mut self, list: u32, len: usize) -> u32 {
        if len == 0 && self.staying.store.holds(list) {
            return list;
        }
        self.store.set_len(list, len)
    }

    /// Propagates the `list` taken from `h`, if its windows stay or shall stay. Otherwise returns
    /// the list, all of whose windows have the usual form now.
    #[inline(always)]
    pub(super) fn cross_staying<L: Lanes, F: SurfaceState, P: Probe>(
        &mut self,
        simd: L::Token,
        state: &mut F,
        h: u32,
        list: u32,
        probe: &mut P,
    ) -> Option<u32> {
        if !self.staying.on && !self.staying.store.holds(list) {
            return Some(list);
        }
        let mut chunks = self.staying.store.take(list);
        let layout = state.layout();
        let by_distance = |h| h != NO_TWIN && layout.is_by_distance(h);
        let l = layout.length(h);
        let usual = by_distance(h)
            || layout.exits(h).into_iter().any(by_distance)
            || l < SHARP * blur(layout.longest_edge);
        let len = self.store.len(list);
        let stays = self.staying.on
            && !usual
            && (len == 0 || {
                let windows = self.store.first(list, len);
                self.staying.store.bring(windows, l, &mut chunks)
            });
        if !stays {
            return Some(self.give_up_chunks(list, l, chunks));
        }
        self.store.set_len(list, 0);
        L::run_apart(
            simd,
            CrossChunks {
                wavefront: self,
                state,
                h,
                chunks,
                probe,
            },
        );
        None
    }

    /// Appends the windows of `chunks` to those of `list` in the usual form, on an edge of length
    /// `l`. Returns the list.
    #[cold]
    fn give_up_chunks(&mut self, mut list: u32, l: f64, chunks: Vec<Chunk>) -> u32 {
        for chunk in &chunks {
            let rows = self.staying.store.rows(chunk, l);
            let rows: Vec<[f64; COLUMNS]> = rows.filter(|[b0, b1, ..]| b0 < b1).collect();
            list = self.store.append_rows(list, &rows);
            self.staying.store.drop(chunk);
        }
        self.staying.store.spare(chunks);
        list
    }

    /// Prefetches what the list at index `place` of the queue will read and change of its chunks.
    #[inline(always)]
    pub(super) fn prefetch_chunks(&self, state: &impl SurfaceState, place: usize) {
        if let Some(&h) = self.ready.get(place) {
            let (f, corner) = parts(h);
            let list = state.list(f, corner);
            let apex = state.layout().faces[f].apex(corner);
            self.staying.store.prefetch_bodies(list, apex);
        }
        if let Some(&h) = self.ready.get(place + 4) {
            let (f, corner) = parts(h);
            self.staying
                .store
                .prefetch_headers(state.list(f, corner), 12);
        }
    }

    /// Propagates `chunks` from `h` across its face.
    #[inline(always)]
    fn cross_chunks<L: Lanes, F: SurfaceState, P: Probe>(
        &mut self,
        simd: L::Token,
        state: &mut F,
        h: u32,
        mut chunks: Vec<Chunk>,
        probe: &mut P,
    ) {
        probe.enter(Phase::Propagation);
        let (f, corner) = parts(h);
        let (after, before) = (next(corner), prev(corner));
        let face = &state.layout().faces[f];
        let [tail, head, apex] = [corner, after, before].map(|k| face.vertex[k]);
        let exits = [face.twin[before], face.twin[after]];
        let mut triangle = face.triangle(corner);
        for direction in &mut triangle.directions {
            *direction = unit(*direction);
        }
        let gate = Gate {
            l: triangle.l,
            apex: triangle.apex,
            ends: [tail, head].map(|v| state.distance(v)),
            longest: state.layout().longest_edge,
        };
        let windows = chunks.iter().map(|chunk| usize::from(chunk.len)).sum();
        let best = self.staying.look_at_apex::<L>(simd, &chunks, &gate);
        let known = state.distance(apex);
        let found = match best {
            Some(best) => {
                let Opened { chunk, sight, .. } = self.staying.opened[best];
                let distance = sight.distance;
                let chunk = &chunks[chunk];
                let row = self.staying.store.row(chunk, sight.best, gate.l);
                let path = BestPath::of_window(row, &gate, distance);
                self.staying.apply_rule_1(&chunks, &gate, best, &path);
                Some((path.entry, path.source, distance))
            }
            // Some path makes the vertex wait for its turn.
            None if known == f64::INFINITY => {
                let paths = [0, 1].map(|i| gate.ends[i] + triangle.exits[i]);
                let nearer = usize::from(paths[1] < paths[0]);
                Some(([0.0, gate.l][nearer], [0.0; 2], paths[nearer]))
            }
            None => None,
        };
        if let Some((entry, source, distance)) = found {
            let news = state.offer(apex, distance);
            if P::TRACES && news {
                let way = Way::through(entry, source, gate.l);
                let own = half_edge(f as u32, before);
                probe.reach(VertexId::new(apex), HalfEdgeId::new(own), way);
            }
            let path = Improvement {
                vertex: apex,
                h,
                entry,
                distance,
            };
            self.note(path, news);
        }
        probe.enter(Phase::Management);
        let ends = [gate.ends[0], state.distance(apex), gate.ends[1]];
        let blur = blur(gate.longest);
        let reach = ends.map(|d| d * LOSES + blur);
        let open = exits.map(|exit| exit != NO_TWIN);
        let mut behind = exits.map(|exit| {
            let (f, k) = parts(exit);
            let list = if exit == NO_TWIN {
                NO_LIST
            } else {
                state.list(f, k)
            };
            self.staying.store.take(list)
        });
        (self.staying).send::<L>(simd, &mut chunks, &mut behind, open, &triangle, reach);
        self.staying.store.spare(chunks);
        for (exit, chunks) in exits.into_iter().zip(behind) {
            if chunks.is_empty() {
                self.staying.store.spare(chunks);
                continue;
            }
            let (f, k) = parts(exit);
            let mut list = state.list(f, k);
            if list == NO_LIST {
                list = self.store.reserve(NO_LIST, 1);
                state.set_list(f, k, list);
            }
            self.staying.store.put(list, exit, chunks);
            self.make_ready(state, f, k);
        }
        self.staying.count(windows);
        if P::STOPS {
            self.end_check.advance(windows);
        }
    }
}

/// The crossing of chunks.
struct CrossChunks<'a, F, P> {
    wavefront: &'a mut Wavefront,
    state: &'a mut F,
    h: u32,
    chunks: Vec<Chunk>,
    probe: &'a mut P,
}

impl<F: SurfaceState, P: Probe> SimdProgram for CrossChunks<'_, F, P> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, simd: L::Token) {
        self.wavefront
            .cross_chunks::<L, F, P>(simd, self.state, self.h, self.chunks, self.probe);
    }
}
