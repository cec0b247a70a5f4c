//! One wave on one mesh.

use geobench_mesh::{Mesh, Numbering, VertexId};
use geobench_window::simd::{Lanes, Program, Simd};
use geobench_window::{Counter, Probe, Propagate, Solution};

use super::alone::Alone;
use super::options::Options;
use crate::wave::{Field, Wave};

/// VTP for speed, on one mesh; see [the page](crate::algorithms::vtp_fast).
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
    vertex_count: usize,
    options: Options,
    /// Whether windows parted by flat vertices become one again.
    reunites: bool,
    numbering: Numbering,
    field: Alone,
    wave: Wave,
}

impl VtpFast {
    /// Sets up for `mesh`, with every improvement; O(faces).
    pub fn new(mesh: &Mesh) -> Self {
        Self::with_options(mesh, Options::default())
    }

    /// Sets up for `mesh`; O(faces).
    pub fn with_options(mesh: &Mesh, options: Options) -> Self {
        let instructions = options.instructions.or_narrower();
        let mut numbering = if options.renumber {
            Numbering::breadth_first(mesh)
        } else {
            Numbering::same()
        };
        let field = Alone::new(mesh, &numbering);
        numbering.keep_new_vertices();
        Self {
            vertex_count: mesh.vertex_count(),
            options: Options {
                instructions,
                ..options
            },
            reunites: options.reunite && field.surface().has_many_flat_vertices(),
            numbering,
            wave: Wave::new(field.surface(), &options),
            field,
        }
    }

    /// The options in force, with instructions that the processor has.
    pub fn options(&self) -> Options {
        self.options
    }
}

/// A run whose sources have had their turns.
struct Turns<'s, P, const REUNITE: bool> {
    wave: &'s mut Wave,
    field: &'s mut Alone,
    probe: &'s mut P,
}

impl<P: Probe, const REUNITE: bool> Program for Turns<'_, P, REUNITE> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, simd: L::Token) {
        let Self { wave, field, probe } = self;
        loop {
            wave.cross_all::<L, Alone, P, REUNITE>(simd, field, probe);
            let Some(bucket) = wave.buckets.nearest() else {
                break;
            };
            wave.take_turn(field, bucket, probe);
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

    fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        let simd = Simd::new(self.options.instructions);
        let Self { wave, field, .. } = self;
        wave.reset();
        field.reset();
        probe.add(Counter::WindowBytes, 40);
        let new = |&s| self.numbering.new_vertex(s).raw();
        for s in sources.iter().map(new) {
            field.distances[s as usize] = 0.0;
        }
        for s in sources.iter().map(new) {
            wave.start_from(field, s, probe);
        }
        if self.reunites {
            simd.run(Turns::<P, true> { wave, field, probe });
        } else {
            simd.run(Turns::<P, false> { wave, field, probe });
        }
        Solution::new(self.numbering.restore(&self.field.distances))
    }
}
