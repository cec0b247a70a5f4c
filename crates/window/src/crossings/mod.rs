//! Crossing triangles by several windows at a time.
//!
//! The child of a window that passes the apex on one side, the left child of one that covers it,
//! and the limits of the vertex filter depend on the window and its triangle alone. They are
//! therefore computed before the window leaves the queue, for the next [`LANES`] windows together,
//! in structures of arrays. One instruction then handles two windows, or four with AVX2. Crossed
//! one by one, a window takes 600 instructions, most of them here; [`Crossings`] takes a sixth. The
//! formulas are those of [`Crossing`](crate::Crossing).
//!
//! All instruction sets do the same operations in the same order and precision. Results do not
//! depend on the processor.

mod children;

use geobench_mesh::{HalfEdgeId, VertexId};

use self::children::{ExitSide, measure};
use crate::crossing::entry;
use crate::frame::{ExitEdge, Faces, HalfEdge};
use crate::simd::{Instructions, Lanes, Simd, SimdProgram};
use crate::window::{Window, greater, less, norm};

pub use self::children::CrossedChild;

/// Number of windows that are crossed together.
pub const LANES: usize = 8;

/// One number for each window.
type Row = [f64; LANES];

/// Up to [`LANES`] windows that have entered triangles, and their children.
///
/// ```
/// use geobench_mesh::{HalfEdgeId, Mesh};
/// use geobench_window::{Crossings, Faces, Window};
///
/// let faces = Faces::new(&Mesh::generate("terrain,n=8,seed=1")?);
/// let h = HalfEdgeId::new(0);
/// let (b1, px) = (faces.length(h), 0.5 * faces.length(h));
/// let mut crossings = Crossings::default();
/// crossings.add(h, &Window { b0: 0.0, b1, px, py: -1.0, sigma: 0.0 });
/// crossings.cross(&faces);
/// assert!(crossings.child(0).label >= 1.0 && crossings.apex_distance(0) > 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct Crossings {
    len: usize,
    simd: Simd,
    /// The half-edges through which the windows enter.
    entrances: [HalfEdgeId; LANES],
    exit_edges: [ExitEdge; LANES],
    apices: [VertexId; LANES],
    entering: Entering,
    leaving: Leaving,
}

/// The windows, as they enter.
#[derive(Clone, Debug, Default)]
struct Entering {
    b0: Row,
    b1: Row,
    px: Row,
    py: Row,
    sigma: Row,
}

/// Their children.
#[derive(Clone, Debug, Default, PartialEq)]
struct Leaving {
    b0: Row,
    b1: Row,
    px: Row,
    py: Row,
    /// Positive where the apex is covered.
    apex_covered: Row,
    apex_distance: Row,
    label: Row,
    /// See [`CrossedChild::is_beaten`].
    limits: [Row; 3],
}

impl Default for Crossings {
    /// Uses the widest instructions of this processor.
    fn default() -> Self {
        Self::new(Instructions::detect())
    }
}

impl Crossings {
    /// An empty batch, crossed with `instructions`, or narrower ones if the processor lacks them.
    pub fn new(instructions: Instructions) -> Self {
        Self {
            len: 0,
            // AVX-512 is of no use here.
            simd: Simd::new(instructions.min(Instructions::Avx2)),
            entrances: [HalfEdgeId::new(0); LANES],
            exit_edges: [ExitEdge::NONE; LANES],
            apices: [VertexId::new(0); LANES],
            entering: Entering::default(),
            leaving: Leaving::default(),
        }
    }

    /// Number of windows.
    #[inline]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no window.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Removes all windows.
    #[inline]
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Makes all lanes those of a half-edge that every mesh has: half-edges may be removed.
    pub(crate) fn forget(&mut self) {
        self.clear();
        self.entrances = [HalfEdgeId::new(0); LANES];
    }

    /// Adds `window`, which enters through `h`.
    ///
    /// # Panics
    ///
    /// If there are [`LANES`] already.
    #[inline]
    pub fn add(&mut self, h: HalfEdgeId, window: &Window) {
        let lane = self.len;
        self.entrances[lane] = h;
        self.entering.b0[lane] = window.b0;
        self.entering.b1[lane] = window.b1;
        self.entering.px[lane] = window.px;
        self.entering.py[lane] = window.py;
        self.entering.sigma[lane] = window.sigma;
        self.len += 1;
    }

    /// Window `lane`, as it enters.
    pub(crate) fn window(&self, lane: usize) -> Window {
        let w = &self.entering;
        Window {
            b0: w.b0[lane],
            b1: w.b1[lane],
            px: w.px[lane],
            py: w.py[lane],
            sigma: w.sigma[lane],
        }
    }

    /// Crosses all windows.
    #[inline]
    pub fn cross(&mut self, faces: &Faces) {
        // Lanes without a window are crossed as well. Their results are never read.
        let simd = self.simd;
        simd.run(CrossAll {
            crossings: self,
            faces,
        });
    }

    /// Whether window `lane` sees the apex and has rays on both sides of it.
    #[inline]
    pub fn covers_apex(&self, lane: usize) -> bool {
        self.leaving.apex_covered[lane] > 0.0
    }

    /// The apex of the triangle that window `lane` crosses.
    #[inline]
    pub(crate) fn apex(&self, lane: usize) -> VertexId {
        self.apices[lane]
    }

    /// Length of the shortest path of window `lane` to the apex: straight if the window covers the
    /// apex, else bent at the end of the window nearer to the straight path.
    #[inline]
    pub fn apex_distance(&self, lane: usize) -> f64 {
        self.leaving.apex_distance[lane]
    }

    /// The child of window `lane`; the left one if it covers the apex.
    #[inline]
    pub fn child(&self, lane: usize) -> CrossedChild {
        let out = &self.leaving;
        let [tail, head, behind] = &out.limits;
        CrossedChild {
            exit_edge: self.exit_edges[lane],
            window: Window {
                b0: out.b0[lane],
                b1: out.b1[lane],
                px: out.px[lane],
                py: out.py[lane],
                sigma: self.entering.sigma[lane],
            },
            label: out.label[lane],
            limits: [tail[lane], head[lane], behind[lane]],
        }
    }

    /// The fraction of the half-edge at which the ray to the apex meets it, for window `lane`,
    /// which covers the apex. See [`Crossing::entry`](crate::Crossing::entry).
    #[inline]
    pub fn entry(&self, lane: usize, faces: &Faces) -> f64 {
        let entrance = faces.half_edge(self.entrances[lane]);
        let [offset, height] = self.ray(lane, entrance);
        entry(offset, height, self.entering.px[lane], entrance.length)
    }

    /// The right child of window `lane`, which covers the apex.
    #[inline]
    pub fn right_child(&self, lane: usize, faces: &Faces) -> CrossedChild {
        let w = &self.entering;
        let entrance = faces.half_edge(self.entrances[lane]);
        let [offset, height] = self.ray(lane, entrance);
        let (l, [cx, cy]) = (entrance.length, entrance.apex);
        let exit = faces.half_edge(entrance.exits[1]);
        let (length, inverse) = (exit.length, exit.inverse_length);
        let (ux, uy) = (entrance.apex_from_head * inverse, -cy * inverse);
        let (x, y) = (w.px[lane] - cx, w.py[lane] - cy);
        let (px, across) = (ux * x + uy * y, ux * y - uy * x);
        let (n, m) = (
            -w.py[lane] * (l - w.b1[lane]),
            (w.b1[lane] * height - offset).abs(),
        );
        let end = length * m / (n + m);
        let window = Window {
            b0: 0.0,
            b1: less(end, length),
            px,
            py: -across.abs(),
            sigma: w.sigma[lane],
        };
        let edge = ExitSide {
            left: 0.0,
            right: 1.0,
            length,
            behind: exit.apex_below(),
        };
        let (label, limits) = measure(&window, &edge);
        CrossedChild {
            exit_edge: exit.exit_edge,
            window,
            label,
            limits,
        }
    }

    /// D0 and e of [`Crossing`](crate::Crossing), for window `lane`.
    #[inline]
    fn ray(&self, lane: usize, entrance: &HalfEdge) -> [f64; 2] {
        let (px, py) = (self.entering.px[lane], self.entering.py[lane]);
        let [cx, cy] = entrance.apex;
        [cy * px - py * cx, cy - py]
    }

    /// The body of [`cross`](Self::cross).
    #[inline(always)]
    #[allow(clippy::inline_always)] // It is compiled for the instructions of its caller.
    fn run(&mut self, faces: &Faces) {
        let w = &self.entering;
        let (mut l, mut cx, mut cy) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let mut cx_from_head = [0.0; LANES];
        for i in 0..LANES {
            let entrance = faces.half_edge(self.entrances[i]);
            l[i] = entrance.length;
            [cx[i], cy[i]] = entrance.apex;
            cx_from_head[i] = entrance.apex_from_head;
        }
        // s·e - D0 at both ends, and the side on which the window leaves.
        let (mut side0, mut side1, mut is_right) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let offset = cy[i] * w.px[i] - w.py[i] * cx[i];
            let height = cy[i] - w.py[i];
            side0[i] = w.b0[i] * height - offset;
            side1[i] = w.b1[i] * height - offset;
            is_right[i] = if side0[i] < 0.0 { 0.0 } else { 1.0 };
            self.leaving.apex_covered[i] = less(-side0[i], side1[i]);
        }
        let (mut length, mut inverse) = ([0.0; LANES], [0.0; LANES]);
        let (mut behind_x, mut behind_y) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let entrance = faces.half_edge(self.entrances[i]);
            let exit = faces.half_edge(entrance.exits[usize::from(side0[i] >= 0.0)]);
            length[i] = exit.length;
            inverse[i] = exit.inverse_length;
            [behind_x[i], behind_y[i]] = exit.apex_below();
            self.exit_edges[i] = exit.exit_edge;
            self.apices[i] = entrance.exit_edge.corners[2];
        }
        let out = &mut self.leaving;
        for i in 0..LANES {
            let covered = out.apex_covered[i] > 0.0;
            let right = is_right[i];
            let left = 1.0 - right;
            let (b0, b1, sigma) = (w.b0[i], w.b1[i], w.sigma[i]);
            // The unit vector along the exit, and the source seen along it from where it begins.
            let ux = (left * cx[i] + right * cx_from_head[i]) * inverse[i];
            let uy = (left - right) * cy[i] * inverse[i];
            let (x, y) = (w.px[i] - right * cx[i], w.py[i] - right * cy[i]);
            let (px, across) = (ux * x + uy * y, ux * y - uy * x);
            // The two parts into which the ray of each end divides the exit; see `Crossing`.
            let (n0, m0) = (-w.py[i] * (left * b0 + right * (l[i] - b0)), side0[i].abs());
            let (n1, m1) = (-w.py[i] * (left * b1 + right * (l[i] - b1)), side1[i].abs());
            let start = length[i] * (left * n0 + right * m0) / (n0 + m0);
            let end = length[i] * (left * n1 + right * m1) / (n1 + m1);
            // A window that covers the apex fills the left exit up to its end.
            let end = if covered {
                length[i]
            } else {
                less(end, length[i])
            };
            // The shortest path to the apex bends at that end, or at the source itself.
            let bend = left * b1 + right * b0;
            let [bend_x, bend_y] = [
                if covered { w.px[i] } else { bend },
                if covered { w.py[i] } else { 0.0 },
            ];
            out.apex_distance[i] = sigma
                + norm(bend_x - w.px[i], bend_y - w.py[i])
                + norm(cx[i] - bend_x, cy[i] - bend_y);
            let window = Window {
                b0: greater(start, 0.0),
                b1: end,
                px,
                py: -across.abs(),
                sigma,
            };
            let edge = ExitSide {
                left,
                right,
                length: length[i],
                behind: [behind_x[i], behind_y[i]],
            };
            let (label, limits) = measure(&window, &edge);
            out.b0[i] = window.b0;
            out.b1[i] = window.b1;
            out.px[i] = window.px;
            out.py[i] = window.py;
            out.label[i] = label;
            for (row, limit) in out.limits.iter_mut().zip(limits) {
                row[i] = limit;
            }
        }
    }
}

/// Crosses all windows, vectorised by the compiler for the instruction set of `run`.
struct CrossAll<'a> {
    crossings: &'a mut Crossings,
    faces: &'a Faces,
}

impl SimdProgram for CrossAll<'_> {
    type Output = ();

    #[inline(always)]
    #[allow(clippy::inline_always)] // It is compiled for the instructions of its caller.
    fn run<L: Lanes>(self, _: L::Token) {
        self.crossings.run(self.faces);
    }
}

#[cfg(test)]
mod tests;
