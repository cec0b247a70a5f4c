//! `vtp-fast`: one wavefront on one thread.

// Kernels must be inlined into the functions that enable the instructions.
#![allow(clippy::inline_always)]

mod serial_state;

use geobench_mesh::{Mesh, Numbering, Splice, VertexId};
use geobench_window::simd::{Instructions, Lanes, Simd, SimdProgram};
use geobench_window::{CompiledRuns, Counter, Probe, Propagate, Solution};

use self::serial_state::SerialState;
use crate::wavefront::{SurfaceState, Wavefront};

/// The improvements of [`VtpFast`]. None changes a distance by more than rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FastOptions {
    /// The instructions to use; narrower ones are used if the processor lacks them.
    pub instructions: Instructions,
    /// Rules 2 and 3 are applied to one in this many of the longer lists: to all lists if 1, to
    /// none if 0.
    pub pairs: u32,
    /// Width of a bucket of vertices that are processed together, in mean edge lengths, or in twice
    /// the median if that is less. Must be positive.
    pub bucket: f64,
    /// Whether vertices and faces are renumbered breadth first.
    pub renumber: bool,
    /// Whether pseudo-sources send windows only into the spawn wedge of the path that reached them.
    pub spawn_wedge: bool,
    /// The mean number of windows in a list from which on they stay in unfolded planes; 0: never.
    pub stay: u32,
    /// Whether windows that a flat vertex has split are coalesced behind it. Applies to meshes in
    /// which at least an eighth of the half-edges are opposite to flat vertices.
    pub coalesce: bool,
}

impl Default for FastOptions {
    fn default() -> Self {
        Self {
            instructions: Instructions::detect(),
            pairs: 8,
            bucket: 0.25,
            renumber: true,
            spawn_wedge: true,
            stay: 80,
            coalesce: true,
        }
    }
}

impl FastOptions {
    /// With instructions that the processor has.
    pub(crate) fn available(self) -> Self {
        Self {
            instructions: self.instructions.or_narrower(),
            ..self
        }
    }

    /// The numbers of vertices and faces.
    pub(crate) fn numbering(&self, mesh: &Mesh) -> Numbering {
        if self.renumber {
            Numbering::breadth_first(mesh)
        } else {
            Numbering::same()
        }
    }
}

/// VTP on one thread with every improvement that keeps it exact ([`FastOptions`]), on one mesh.
///
/// See [`Vtp`](crate::Vtp) for the algorithm of the paper. Time and space are those of VTP.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_vtp::{FastOptions, VtpFast};
/// use geobench_window::Solver;
/// use geobench_window::simd::Instructions;
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let best = VtpFast::new(&mesh).distances_from(5)?;
/// let instructions = Instructions::Scalar;
/// let options = FastOptions { instructions, ..FastOptions::default() };
/// let plain = VtpFast::with_options(&mesh, options).distances_from(5)?;
/// assert_eq!(best, plain); // To the bit.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct VtpFast {
    mesh: Mesh,
    options: FastOptions,
    /// Whether windows are coalesced behind flat vertices.
    coalesces: bool,
    numbering: Numbering,
    state: SerialState,
    wavefront: Wavefront,
}

impl VtpFast {
    /// Sets up for `mesh`, with every improvement; O(faces).
    pub fn new(mesh: &Mesh) -> Self {
        Self::with_options(mesh, FastOptions::default())
    }

    /// Sets up for `mesh`; O(faces).
    pub fn with_options(mesh: &Mesh, options: FastOptions) -> Self {
        let mut numbering = options.numbering(mesh);
        let mut state = SerialState::new(mesh, &numbering);
        let stays = options.stay > 0 && state.layout.light_shadows(mesh, &numbering);
        numbering.keep_new_vertices();
        Self {
            mesh: mesh.clone(),
            options: options.available(),
            coalesces: options.coalesce && state.layout().has_many_flat_vertices(),
            numbering,
            wavefront: Wavefront::new(
                state.layout(),
                &FastOptions {
                    stay: if stays { options.stay } else { 0 },
                    ..options
                },
            ),
            state,
        }
    }

    /// The options in use, with instructions that the processor has.
    pub fn options(&self) -> FastOptions {
        self.options
    }
}

/// The propagation of a run, after the sources have sent their windows.
struct RunFromSources<'s, P, const COALESCE: bool> {
    wavefront: &'s mut Wavefront,
    state: &'s mut SerialState,
    numbering: &'s Numbering,
    probe: &'s mut P,
}

impl<P: Probe, const COALESCE: bool> SimdProgram for RunFromSources<'_, P, COALESCE> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, simd: L::Token) {
        let Self {
            wavefront,
            state,
            numbering,
            probe,
        } = self;
        let number = |v| numbering.new_vertex(v).raw();
        loop {
            wavefront.cross_all::<L, SerialState, P, COALESCE>(simd, state, probe);
            let Some(bucket) = wavefront.buckets.nearest() else {
                break;
            };
            if P::STOPS && wavefront.ends(state, bucket, number, probe) {
                wavefront.abandon(state);
                break;
            }
            wavefront.take_turn(state, bucket, probe);
        }
    }
}

impl Propagate for VtpFast {
    fn counters() -> Vec<Counter> {
        vec![
            Counter::Propagated,
            Counter::Parents,
            Counter::Children,
            Counter::Spawned,
            Counter::Filtered,
            Counter::PeakWindows,
            Counter::WindowBytes,
            Counter::QueuePushes,
            Counter::QueuePeak,
            Counter::Iterations,
            Counter::Levels,
            Counter::PseudoSources,
        ]
    }

    fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        let layout = &mut self.state.layout;
        let around = layout.around(&self.mesh, &self.numbering, splice);
        let undo = self.mesh.splice(splice);
        layout.splice(&self.mesh, &self.numbering, splice, &around);
        self.wavefront.splice(layout);
        Some(undo)
    }

    #[inline(never)]
    fn runs(&self) -> CompiledRuns<Self> {
        CompiledRuns::new()
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        let simd = Simd::new(self.options.instructions);
        let Self {
            wavefront, state, ..
        } = self;
        wavefront.reset();
        state.reset();
        probe.add(Counter::WindowBytes, 40);
        let new = |&s| self.numbering.new_vertex(s).raw();
        for s in sources.iter().map(new) {
            state.distances[s as usize] = 0.0;
        }
        for s in sources.iter().map(new) {
            wavefront.start_from(state, s, probe);
        }
        if self.coalesces {
            simd.run(RunFromSources::<P, true> {
                wavefront,
                state,
                numbering: &self.numbering,
                probe,
            });
        } else {
            simd.run(RunFromSources::<P, false> {
                wavefront,
                state,
                numbering: &self.numbering,
                probe,
            });
        }
        let layout = self.state.layout();
        layout.renumber(&self.mesh, &self.numbering, probe);
        Solution::new(self.numbering.restore(&self.state.distances))
    }
}
