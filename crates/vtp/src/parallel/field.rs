//! What all threads see of a run.

use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64};

use super::mail::Post;
use super::owners::Owners;
use super::pace::Pace;
use super::split::Split;
use crate::engine::sample::Sample;
use crate::engine::shadow::Origin;
use crate::engine::surface::Surface;
use crate::fast::Options;

/// Faces and vertices of a block, which belongs to one thread, as powers of 2. Of smaller blocks more windows travel, and larger
/// ones are shared out too long before their lists cross.
const FACES_OF_A_BLOCK: u32 = 5;
const VERTICES_OF_A_BLOCK: u32 = 4;

/// Marks a half-edge that is queued, in the handle of its list.
const QUEUED: u32 = 1 << 31;

/// What changes of a face. Only its owner touches its lists and queues them.
#[derive(Debug, Default)]
pub(super) struct FaceState {
    /// The windows that wait on each half-edge to cross the face: lists of its owner.
    lists: [AtomicU32; 3],
    /// The run in which the face joined the traversed area last; written by whoever has a vertex of it pass.
    joined: AtomicU32,
}

const _: () = assert!(size_of::<FaceState>() == 16);

impl FaceState {
    #[inline(always)]
    pub(super) fn list(&self, corner: usize) -> u32 {
        self.lists[corner].load(Relaxed) & !QUEUED
    }

    #[inline(always)]
    pub(super) fn set_list(&self, corner: usize, list: u32) {
        let queued = self.lists[corner].load(Relaxed) & QUEUED;
        self.lists[corner].store(list | queued, Relaxed);
    }

    /// Takes the list from a half-edge, which is not queued any more.
    #[inline(always)]
    pub(super) fn take(&self, corner: usize) -> u32 {
        let list = self.lists[corner].load(Relaxed);
        self.lists[corner].store(0, Relaxed);
        list & !QUEUED
    }

    /// Marks a half-edge as queued; returns whether it was not.
    #[inline(always)]
    pub(super) fn enqueue(&self, corner: usize) -> bool {
        let list = self.lists[corner].load(Relaxed);
        self.lists[corner].store(list | QUEUED, Relaxed);
        list & QUEUED == 0
    }

    /// Whether the face has joined the traversed area.
    #[inline(always)]
    pub(super) fn has_joined(&self, run: u32) -> bool {
        self.joined.load(Relaxed) == run
    }

    /// The face joins; returns whether it had not joined yet, to more than one thread perhaps if they ask at the
    /// same time.
    #[inline(always)]
    pub(super) fn join(&self, run: u32) -> bool {
        let news = !self.has_joined(run);
        if news {
            self.joined.store(run, Relaxed);
        }
        news
    }
}

/// What its owner knows of a vertex; of a source, what the first thread says before anybody else reads it.
#[derive(Debug)]
pub(super) struct VertexState {
    /// The distance at which it has sent out windows last, if it is a pseudo-source.
    pub(super) spawned: Number,
    /// How the shortest path reached it, and the length of that path.
    ///
    /// Other threads lower the distance before its owner learns of their path, so the two may differ.
    pub(super) reached: Number,
    entry: Number,
    h: AtomicU32,
    passed: AtomicBool,
}

impl VertexState {
    fn new() -> Self {
        Self {
            spawned: Number::new(f64::INFINITY),
            reached: Number::new(f64::INFINITY),
            entry: Number::new(0.0),
            h: AtomicU32::new(0),
            passed: AtomicBool::new(false),
        }
    }

    fn reset(&self) {
        self.spawned.set(f64::INFINITY);
        self.reached.set(f64::INFINITY);
        self.passed.store(false, Relaxed);
    }

    pub(super) fn origin(&self) -> Origin {
        Origin {
            h: self.h.load(Relaxed),
            entry: self.entry.get(),
        }
    }

    /// A path of length `distance` is the shortest.
    pub(super) fn reach(&self, distance: f64, origin: Origin) {
        self.reached.set(distance);
        self.h.store(origin.h, Relaxed);
        self.entry.set(origin.entry);
    }

    /// It has its turn.
    pub(super) fn pass(&self) {
        self.passed.store(true, Relaxed);
    }

    #[inline(always)]
    pub(super) fn has_passed(&self) -> bool {
        self.passed.load(Relaxed)
    }
}

/// A number that threads can see.
#[derive(Debug)]
pub(super) struct Number(AtomicU64);

impl Number {
    fn new(value: f64) -> Self {
        Self(AtomicU64::new(value.to_bits()))
    }

    #[inline(always)]
    pub(super) fn get(&self) -> f64 {
        f64::from_bits(self.0.load(Relaxed))
    }

    #[inline(always)]
    pub(super) fn set(&self, value: f64) {
        self.0.store(value.to_bits(), Relaxed);
    }

    /// Takes a lesser value, neither of them negative; returns whether it was less.
    #[inline]
    pub(super) fn lower(&self, value: f64) -> bool {
        // The bits of such numbers are in the same order.
        let bits = value.to_bits();
        self.0.fetch_min(bits, Relaxed) > bits
    }
}

/// The state of a run that threads share.
///
/// All of it is atomic, but in no order of its own: what one thread must know of another comes by mail, or with the block that the
/// other gives away, whose new owner sees all that was done with it before. What a thread sees besides may be old. An old distance is a longer
/// one, and prunes less.
#[derive(Debug)]
pub(super) struct Field {
    pub(super) surface: Surface,
    pub(super) shadow: bool,
    /// Whether windows parted by flat vertices become one again.
    pub(super) reunites: bool,
    /// Lists whose pairs are compared.
    pub(super) compared: Sample,
    pub(super) threads: usize,
    /// The number of this run.
    pub(super) run: u32,
    pub(super) faces: Vec<FaceState>,
    pub(super) distances: Vec<Number>,
    pub(super) vertices: Vec<VertexState>,
    pub(super) face_owners: Owners,
    pub(super) vertex_owners: Owners,
    pub(super) split: Split,
    pub(super) post: Post,
    pub(super) pace: Pace,
}

impl Field {
    pub(super) fn new(surface: Surface, options: &Options, threads: usize) -> Self {
        let (faces, vertices) = (surface.faces.len(), surface.vertices.len());
        Self {
            shadow: options.shadow,
            reunites: options.reunite && surface.has_many_flat_vertices(),
            compared: Sample::new(options.pairs),
            threads,
            run: 0,
            faces: (0..faces).map(|_| FaceState::default()).collect(),
            distances: (0..vertices).map(|_| Number::new(f64::INFINITY)).collect(),
            vertices: (0..vertices).map(|_| VertexState::new()).collect(),
            face_owners: Owners::new(faces, FACES_OF_A_BLOCK),
            vertex_owners: Owners::new(vertices, VERTICES_OF_A_BLOCK),
            split: Split::new(&surface, threads),
            post: Post::new(threads),
            pace: Pace::new(threads),
            surface,
        }
    }

    /// Forgets what a run has left behind that was broken off.
    pub(super) fn recover(&mut self) {
        self.faces.fill_with(FaceState::default);
        self.post = Post::new(self.threads);
        self.split = Split::new(&self.surface, self.threads);
    }

    /// Starts another run; every list is empty, and threads are to reset the vertices.
    pub(super) fn start(&mut self) {
        if self.run == u32::MAX {
            self.run = 0;
            self.faces.fill_with(FaceState::default);
        }
        self.run += 1;
        self.face_owners.reset();
        self.vertex_owners.reset();
        self.split.reset(&self.surface);
        self.pace.reset();
    }

    /// Forgets the last run at the vertices in `range`.
    pub(super) fn reset_vertices(&self, range: Range<usize>) {
        for distance in &self.distances[range.clone()] {
            distance.set(f64::INFINITY);
        }
        for vertex in &self.vertices[range] {
            vertex.reset();
        }
    }

    #[inline(always)]
    pub(super) fn distance(&self, v: u32) -> f64 {
        self.distances[v as usize].get()
    }

    /// Whose a face is, from now on if it was nobody's.
    #[inline(always)]
    pub(super) fn owner_of_face(&self, f: usize) -> usize {
        if self.threads == 1 {
            return 0;
        }
        self.face_owners.of(f, || self.split.owner_of_face(f))
    }

    /// Whose a vertex is, from now on if it was nobody's.
    #[inline(always)]
    pub(super) fn owner_of_vertex(&self, v: u32) -> usize {
        if self.threads == 1 {
            return 0;
        }
        self.vertex_owners
            .of(v as usize, || self.split.owner_of_vertex(v))
    }
}
