//! What `vtp-fast` and each thread of `pvtp` run: buckets of vertices have their turns, and lists
//! cross faces until all wait.
//!
//! A [`Wavefront`] holds what one thread alone changes, its windows and its queues; what it runs over is
//! a [`SurfaceState`]. The two programs differ in their fields, in how a wavefront starts and in what happens
//! between turns.

// The kernels must be inlined into the functions that have the features of the processor.
#![allow(clippy::inline_always)]

mod cross;
mod spawn;
mod surface_state;
mod turns;

use geobench_window::trimming::KeptWindows;

pub(crate) use self::surface_state::SurfaceState;
use crate::engine::buckets::Buckets;
use crate::engine::kernels::Cuts;
use crate::engine::levels::Levels;
use crate::engine::sample::Sample;
use crate::engine::spawn_wedge::Origin;
use crate::engine::store::WindowStore;
use crate::engine::surface::Surface;
use crate::fast::Options;

/// Paths wait for their consequences until so many have come together.
const IMPROVEMENTS: usize = 4096;

/// A path to a vertex whose consequences wait: it was the shortest that this wavefront saw when it was
/// found; or it is the first, at all or since the vertex was given away, to one that other wavefronts
/// know, which is to have a turn in this one too; or another wavefront has given it, with the vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Improvement {
    pub(crate) vertex: u32,
    /// The half-edge that it crossed last.
    pub(crate) h: u32,
    /// Where.
    pub(crate) entry: f64,
    /// Its length.
    pub(crate) distance: f64,
}

/// Windows on their way, and the queues that say where they go next.
#[derive(Clone, Debug)]
pub(crate) struct Wavefront {
    /// Lists whose pairs are compared.
    compared: Sample,
    /// Whether pseudo-sources send windows only into the shadow of the path that reached them.
    spawn_wedge: bool,
    pub(crate) store: WindowStore,
    /// Half-edges whose lists are about to cross.
    ready: Vec<u32>,
    pub(crate) buckets: Buckets,
    /// Vertices that have their turns.
    turn: Vec<u32>,
    /// Vertices whose turn has come.
    passed: Vec<bool>,
    /// The distance at which each pseudo-source has sent out windows last.
    spawned: Vec<f64>,
    /// How the path reached each pseudo-source that is as long as the field has it
    /// [reached](Field::reached).
    pub(crate) origins: Vec<Origin>,
    improvements: Vec<Improvement>,
    improved: usize,
    keep: Vec<u8>,
    cuts: Cuts,
    levels: Levels,
    kept: KeptWindows,
}

impl Wavefront {
    /// For a surface; O(vertices).
    pub(crate) fn new(surface: &Surface, options: &Options) -> Self {
        let vertices = surface.vertices.len();
        Self {
            compared: Sample::new(options.pairs),
            spawn_wedge: options.spawn_wedge,
            store: WindowStore::new(),
            ready: Vec::new(),
            buckets: Buckets::new(vertices, options.bucket * surface.mean_length),
            turn: Vec::new(),
            passed: Vec::new(),
            spawned: Vec::new(),
            origins: vec![Origin::default(); vertices],
            improvements: vec![Improvement::default(); IMPROVEMENTS],
            improved: 0,
            keep: Vec::new(),
            cuts: Cuts::default(),
            levels: Levels::default(),
            kept: surface.kept.clone(),
        }
    }

    /// Whether no window and no vertex waits, as after a run.
    pub(crate) fn is_empty(&self) -> bool {
        self.store.waiting() == 0 && self.buckets.len() == 0
    }

    /// The vertices that had their turns last.
    pub(crate) fn last_turn(&self) -> &[u32] {
        &self.turn
    }

    /// Forgets what the last run has learnt. Every list and queue must be empty, as after a run
    /// that was not broken off.
    pub(crate) fn reset(&mut self) {
        let vertices = self.origins.len();
        self.buckets.reset();
        self.turn.clear();
        self.levels.clear();
        self.kept.clear();
        self.spawned.clear();
        self.spawned.resize(vertices, f64::INFINITY);
        self.passed.clear();
        self.passed.resize(vertices, false);
    }
}
