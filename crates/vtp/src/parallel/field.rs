//! What all threads see of a run.

use std::sync::atomic::Ordering::Relaxed;
use std::sync::atomic::{AtomicU16, AtomicU32, AtomicU64};

use super::mail::Post;
use super::padded::Padded;
use crate::engine::sample::Sample;
use crate::engine::shadow::Origin;
use crate::engine::store::NO_LIST;
use crate::engine::surface::Surface;

/// Stands for no thread.
const NO_THREAD: u32 = 0x7fff_ffff;

/// Marks vertices whose turn has come.
const PASSED: u32 = 1 << 31;

/// Bits of a face's mark: the run in which somebody got it, whether it is queued, and whose it is.
const RUN: u32 = 11;
const QUEUED: u16 = 1 << 10;

/// The number of the last run before numbers start again.
const LAST_RUN: u16 = u16::MAX >> RUN;

/// The most threads of a run; numbers of threads fit into the mark of a face.
pub(super) const MOST_THREADS: usize = QUEUED as usize;

/// What changes of a face.
///
/// A face belongs to a thread from the time on when windows come to one of its half-edges. Whose it becomes is decided by
/// where it is, so that all threads agree. Only its owner touches its lists, which lie with it, and queues it.
#[derive(Debug, Default)]
pub(super) struct FaceState {
    /// The windows that wait on each half-edge to cross the face: lists of its owner.
    lists: [AtomicU32; 3],
    /// The run in which the face joined the traversed area last; written by whoever has a vertex of it pass.
    joined: AtomicU16,
    mark: AtomicU16,
}

const _: () = assert!(NO_LIST == 0 && size_of::<FaceState>() == 16);

impl FaceState {
    #[inline]
    pub(super) fn list(&self, corner: usize) -> u32 {
        self.lists[corner].load(Relaxed)
    }

    #[inline]
    pub(super) fn set_list(&self, corner: usize, list: u32) {
        self.lists[corner].store(list, Relaxed);
    }

    /// Whose the face is, if it is somebody's in this run.
    #[inline]
    pub(super) fn owner(&self, run: u16) -> Option<usize> {
        let mark = self.mark.load(Relaxed);
        (mark >> RUN == run).then_some(usize::from(mark & (QUEUED - 1)))
    }

    /// Whose the face is; that of `thread` from now on if it was nobody's.
    #[inline]
    pub(super) fn owner_or(&self, run: u16, thread: impl FnOnce() -> usize) -> usize {
        let mark = self.mark.load(Relaxed);
        if mark >> RUN == run {
            return usize::from(mark & (QUEUED - 1));
        }
        let thread = thread();
        let new = run << RUN | thread as u16;
        // Another thread may have been faster, but has decided the same.
        let _ = self.mark.compare_exchange(mark, new, Relaxed, Relaxed);
        thread
    }

    /// Whether the face has joined the traversed area.
    #[inline]
    pub(super) fn has_joined(&self, run: u16) -> bool {
        self.joined.load(Relaxed) == run
    }

    /// The face joins; returns whether it had not joined yet, to more than one thread perhaps if they ask at the
    /// same time.
    #[inline]
    pub(super) fn join(&self, run: u16) -> bool {
        let news = !self.has_joined(run);
        if news {
            self.joined.store(run, Relaxed);
        }
        news
    }

    /// Marks the face as queued; returns whether it was not.
    #[inline]
    pub(super) fn enqueue(&self) -> bool {
        let mark = self.mark.load(Relaxed);
        self.mark.store(mark | QUEUED, Relaxed);
        mark & QUEUED == 0
    }

    /// Takes all lists from the face, which is not queued any more.
    #[inline]
    pub(super) fn take(&self) -> [u32; 3] {
        self.mark.store(self.mark.load(Relaxed) & !QUEUED, Relaxed);
        self.lists.each_ref().map(|list| {
            let taken = list.load(Relaxed);
            list.store(NO_LIST, Relaxed);
            taken
        })
    }

    fn forget(&self) {
        self.joined.store(0, Relaxed);
        self.mark.store(0, Relaxed);
    }
}

/// What changes of a vertex besides its distance. Belongs to a thread from the time on when a path reaches it,
/// as faces do.
#[derive(Debug)]
pub(super) struct VertexState {
    /// The distance at which it has sent out windows last, if it is a pseudo-source.
    pub(super) spawned: Number,
    /// How the shortest path reached it.
    entry: Number,
    h: AtomicU32,
    owner: AtomicU32,
}

impl VertexState {
    fn new() -> Self {
        Self {
            spawned: Number::new(f64::INFINITY),
            entry: Number::new(0.0),
            h: AtomicU32::new(0),
            owner: AtomicU32::new(NO_THREAD),
        }
    }

    fn reset(&self) {
        self.spawned.set(f64::INFINITY);
        self.owner.store(NO_THREAD, Relaxed);
    }

    pub(super) fn origin(&self) -> Origin {
        Origin {
            h: self.h.load(Relaxed),
            entry: self.entry.get(),
        }
    }

    pub(super) fn set_origin(&self, origin: Origin) {
        self.h.store(origin.h, Relaxed);
        self.entry.set(origin.entry);
    }

    /// Whose it is; that of `thread` from now on if it was nobody's.
    #[inline]
    pub(super) fn owner_or(&self, thread: impl FnOnce() -> usize) -> usize {
        let owner = self.owner.load(Relaxed) & !PASSED;
        if owner != NO_THREAD {
            return owner as usize;
        }
        let thread = thread();
        // Another thread may have been faster, but has decided the same.
        let _ = self
            .owner
            .compare_exchange(NO_THREAD, thread as u32, Relaxed, Relaxed);
        thread
    }

    /// It has its turn with `thread`.
    pub(super) fn pass(&self, thread: usize) {
        self.owner.store(thread as u32 | PASSED, Relaxed);
    }

    #[inline]
    pub(super) fn has_passed(&self) -> bool {
        self.owner.load(Relaxed) & PASSED != 0
    }
}

/// A number that threads can see; who may write it when is a matter of phases.
#[derive(Debug)]
pub(super) struct Number(AtomicU64);

impl Number {
    fn new(value: f64) -> Self {
        Self(AtomicU64::new(value.to_bits()))
    }

    #[inline]
    pub(super) fn get(&self) -> f64 {
        f64::from_bits(self.0.load(Relaxed))
    }

    #[inline]
    pub(super) fn set(&self, value: f64) {
        self.0.store(value.to_bits(), Relaxed);
    }
}

/// What a thread says at the end of each half of a step.
#[derive(Debug, Default)]
pub(super) struct Status {
    /// What it had to cross in the first half, about, in windows.
    pub(super) load: AtomicU64,
    /// Windows that have crossed in the first half and are to cross again in the next step.
    pub(super) again: AtomicU64,
    /// Windows that wait in its lists or are on their way to others, after the first half.
    pub(super) waiting: AtomicU64,
    /// Tasks that it has for the next step, or has sent to others, after the second half.
    pub(super) work: AtomicU32,
    /// Its nearest bucket of vertices then, and the number of vertices that wait.
    pub(super) nearest: AtomicU32,
    pub(super) queued: AtomicU64,
}

/// The state of a run that threads share. All of it is atomic, but in no order of its own: a phase reads what
/// an earlier one wrote, and between the two all threads have met.
#[derive(Debug)]
pub(super) struct Field {
    pub(super) surface: Surface,
    pub(super) shadow: bool,
    /// Lists whose pairs are compared.
    pub(super) compared: Sample,
    pub(super) threads: usize,
    /// The number of this run.
    pub(super) run: u16,
    pub(super) faces: Vec<FaceState>,
    pub(super) distances: Vec<Number>,
    pub(super) vertices: Vec<VertexState>,
    pub(super) statuses: Vec<Padded<Status>>,
    pub(super) post: Post,
}

impl Field {
    pub(super) fn new(surface: Surface, shadow: bool, compared: Sample, threads: usize) -> Self {
        let (faces, vertices) = (surface.faces.len(), surface.vertices.len());
        Self {
            surface,
            shadow,
            compared,
            threads,
            run: 0,
            faces: (0..faces).map(|_| FaceState::default()).collect(),
            distances: (0..vertices).map(|_| Number::new(f64::INFINITY)).collect(),
            vertices: (0..vertices).map(|_| VertexState::new()).collect(),
            statuses: (0..threads).map(|_| Padded::default()).collect(),
            post: Post::new(threads),
        }
    }

    /// Starts another run; every list is empty, and threads are to reset the vertices.
    pub(super) fn start(&mut self) {
        if self.run == LAST_RUN {
            self.run = 0;
            self.faces.iter().for_each(FaceState::forget);
        }
        self.run += 1;
    }

    /// Forgets the last run at the vertices in `range`.
    pub(super) fn reset_vertices(&self, range: std::ops::Range<usize>) {
        for distance in &self.distances[range.clone()] {
            distance.set(f64::INFINITY);
        }
        for vertex in &self.vertices[range] {
            vertex.reset();
        }
    }

    #[inline]
    pub(super) fn distance(&self, v: u32) -> f64 {
        self.distances[v as usize].get()
    }

    /// The sum of what all threads say.
    pub(super) fn sum(&self, of: impl Fn(&Status) -> u64) -> u64 {
        self.statuses.iter().map(|status| of(&status.0)).sum()
    }
}
