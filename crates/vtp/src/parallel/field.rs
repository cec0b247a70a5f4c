//! What all threads see of a run.

use std::sync::atomic::Ordering::Relaxed;
use std::sync::atomic::{AtomicU32, AtomicU64};

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

/// Bits of a face's mark: the run in which it joined, whether it is queued, and whose it is.
const RUN: u32 = 16;
const QUEUED: u32 = 1 << 15;

/// The most threads of a run; numbers of threads fit into the mark of a face.
pub(super) const MOST_THREADS: usize = 1024;

/// What changes of a face.
///
/// A face that has joined the traversed area belongs to a thread, and only that touches what is here. The
/// windows that wait for a face to join lie with the thread of the face that they come from.
#[derive(Debug, Default)]
pub(super) struct FaceState {
    /// The windows that wait on each half-edge to cross the face: lists of the thread they lie with.
    lists: [AtomicU32; 3],
    mark: AtomicU32,
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

    /// Whose the face is, if it has joined in this run.
    #[inline]
    pub(super) fn owner(&self, run: u32) -> Option<usize> {
        let mark = self.mark.load(Relaxed);
        (mark >> RUN == run).then_some((mark & (QUEUED - 1)) as usize)
    }

    /// The face joins as one of `thread`; returns whether it had not joined yet.
    pub(super) fn join(&self, run: u32, thread: usize) -> bool {
        let old = self.mark.load(Relaxed);
        let new = run << RUN | thread as u32;
        old >> RUN != run
            && self
                .mark
                .compare_exchange(old, new, Relaxed, Relaxed)
                .is_ok()
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
}

/// What changes of a vertex besides its distance. Belongs to the thread that reached it first, and from its turn on
/// to the one that it has its turn with.
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

    /// Whose it is: that of `thread` if it was nobody's.
    #[inline]
    pub(super) fn owner_or(&self, thread: usize) -> usize {
        let owner = self.owner.load(Relaxed) & !PASSED;
        if owner != NO_THREAD {
            return owner as usize;
        }
        let claimed = self
            .owner
            .compare_exchange(NO_THREAD, thread as u32, Relaxed, Relaxed);
        claimed.map_or_else(|other| other as usize, |_| thread)
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

/// What a thread says at the end of a phase.
#[derive(Debug, Default)]
pub(super) struct Status {
    /// Tasks that it has for the next phase, or has sent to others.
    pub(super) work: AtomicU32,
    /// Its nearest bucket of vertices, if nobody has work.
    pub(super) nearest: AtomicU32,
    /// How long it has been at work in this round, in nanoseconds.
    pub(super) load: AtomicU64,
    /// Windows that wait in its lists, and vertices in its buckets.
    pub(super) waiting: AtomicU64,
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
    pub(super) run: u32,
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
        if self.run == u32::from(u16::MAX) {
            self.run = 0;
            for face in &self.faces {
                face.mark.store(0, Relaxed);
            }
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

    /// Whose a face is that has joined.
    #[inline]
    pub(super) fn owner(&self, face: usize) -> Option<usize> {
        self.faces[face].owner(self.run)
    }

    /// The sum of what all threads say.
    pub(super) fn sum(&self, of: impl Fn(&Status) -> u64) -> u64 {
        self.statuses.iter().map(|status| of(&status.0)).sum()
    }
}
