//! Windows crossing triangles several at a time.
//!
//! What a window that passes the apex on one side leaves, and what is compared with distances on the way, depends on the
//! window and its triangle alone. So it can be computed before the window's turn has come, for all [`LANES`] windows
//! that come next and in structures of arrays, which lets one instruction do it for two windows or, with AVX2, for four. A
//! crossing one by one takes 600 instructions for each window, most of them here; [`Crossings`] takes a third of
//! that. The formulas are those of [`Passage`](crate::Passage).
//!
//! Both programs do the same operations in the same order on numbers of the same precision, so that results
//! do not depend on the processor.

mod dispatch;

use geobench_mesh::{FaceId, HalfEdgeId, VertexId};

use crate::frame::{EXITS, Faces, NEXT, PREV};
use crate::window::{Window, greater, less, norm};

/// How many windows cross together.
pub const LANES: usize = 8;

/// How much shorter than a window's a path through a vertex must be, relatively, to beat it: as in [the
/// filter](crate::is_beaten_from_ends).
const MARGIN: f64 = 1.0 - 1e-14;

/// One number for each window.
type Row = [f64; LANES];

/// Where a window leaves a triangle that does not cover the apex.
#[derive(Clone, Copy, Debug)]
pub struct Outlet {
    /// The neighbour's half-edge; `u32::MAX` at the boundary.
    twin: u32,
    /// Where the edge begins, where it ends, and the third vertex of the triangle.
    pub corners: [VertexId; 3],
    /// The apex, which is one of the edge's ends.
    pub apex: VertexId,
}

impl Outlet {
    const NONE: Self = Self {
        twin: u32::MAX,
        corners: [VertexId::new(0); 3],
        apex: VertexId::new(0),
    };

    /// The neighbour's half-edge; `None` at the boundary.
    #[inline]
    pub fn half_edge(&self) -> Option<HalfEdgeId> {
        (self.twin != u32::MAX).then(|| HalfEdgeId::new(self.twin))
    }
}

/// Up to [`LANES`] windows that have entered triangles, and what they leave.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct Crossings {
    len: usize,
    program: dispatch::Program,
    /// The faces, and the corners at which the half-edges start through which the windows come.
    faces: [FaceId; LANES],
    corners: [u32; LANES],
    outlets: [Outlet; LANES],
    entering: Entering,
    leaving: Leaving,
}

/// The windows.
#[derive(Clone, Debug, Default)]
struct Entering {
    b0: Row,
    b1: Row,
    px: Row,
    py: Row,
    sigma: Row,
}

/// What the windows leave.
#[derive(Clone, Debug, Default, PartialEq)]
struct Leaving {
    b0: Row,
    b1: Row,
    px: Row,
    py: Row,
    /// Positive where the apex is covered.
    apex_covered: Row,
    bent: Row,
    label: Row,
    /// Of the outlet's corners, see [`Crossings::is_beaten`].
    limits: [Row; 3],
}

impl Default for Crossings {
    fn default() -> Self {
        Self {
            len: 0,
            program: dispatch::Program::best(),
            faces: [FaceId::new(0); LANES],
            corners: [0; LANES],
            outlets: [Outlet::NONE; LANES],
            entering: Entering::default(),
            leaving: Leaving::default(),
        }
    }
}

impl Crossings {
    /// Number of windows.
    #[inline]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no window.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Forgets the windows.
    #[inline]
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds `window`, which enters through `h`.
    ///
    /// # Panics
    ///
    /// If there are [`LANES`] already.
    #[inline]
    pub fn add(&mut self, h: HalfEdgeId, window: &Window) {
        let lane = self.len;
        self.faces[lane] = h.face();
        self.corners[lane] = h.corner();
        self.entering.b0[lane] = window.b0;
        self.entering.b1[lane] = window.b1;
        self.entering.px[lane] = window.px;
        self.entering.py[lane] = window.py;
        self.entering.sigma[lane] = window.sigma;
        self.len += 1;
    }

    /// Takes all windows across their triangles.
    #[inline]
    pub fn cross(&mut self, faces: &Faces) {
        // What lies in lanes without a window is crossed as well, and never asked for.
        self.program.run(self, faces);
    }

    /// Whether window `lane` sees the apex and has rays on both sides of it. If so, none of what
    /// follows has a meaning.
    #[inline]
    pub fn covers_apex(&self, lane: usize) -> bool {
        self.leaving.apex_covered[lane] > 0.0
    }

    /// By which edge window `lane` leaves.
    #[inline]
    pub fn outlet(&self, lane: usize) -> &Outlet {
        &self.outlets[lane]
    }

    /// Length of the path to the apex, bent at the end of window `lane` that is nearer to the straight path.
    #[inline]
    pub fn bent_distance(&self, lane: usize) -> f64 {
        self.leaving.bent[lane]
    }

    /// What window `lane` leaves, in the frame of the neighbour's half-edge; `None` if it is too narrow to have a
    /// width.
    #[inline]
    pub fn child(&self, lane: usize) -> Option<Window> {
        let Leaving { b0, b1, px, py, .. } = &self.leaving;
        let window = Window {
            b0: b0[lane],
            b1: b1[lane],
            px: px[lane],
            py: py[lane],
            sigma: self.entering.sigma[lane],
        };
        (window.b0 < window.b1).then_some(window)
    }

    /// The [least distance](Window::min_distance) of that child.
    #[inline]
    pub fn label(&self, lane: usize) -> f64 {
        self.leaving.label[lane]
    }

    /// Whether a path through one of the outlet's corners, whose distances these are, beats every ray of the child: the
    /// vertex filter of Xin and Wang 2009, theorem 3.2.
    ///
    /// Each of the three tests has its distance on the left alone, and a bound on the right that does not depend on any.
    #[inline]
    #[allow(clippy::needless_bitwise_bool)] // Hardly any window is beaten: one branch for all three.
    pub fn is_beaten(&self, lane: usize, distances: [f64; 3]) -> bool {
        let [tail, head, behind] = &self.leaving.limits;
        (distances[0] < tail[lane]) | (distances[1] < head[lane]) | (distances[2] < behind[lane])
    }

    /// The program behind [`cross`](Self::cross).
    #[inline(always)]
    #[allow(clippy::inline_always)] // It is compiled for the instructions of its caller.
    fn run(&mut self, faces: &Faces) {
        let w = &self.entering;
        let (mut l, mut cx, mut cy) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let (face, k) = (faces.record(self.faces[i]), self.corners[i] as usize);
            l[i] = face.length[k];
            cx[i] = face.apex_x[k];
            cy[i] = face.twice_area * face.inverse_length[k];
        }
        // s·e - D0 at both ends, and on which side the window leaves.
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
            let (face, k) = (faces.record(self.faces[i]), self.corners[i] as usize);
            let e = EXITS[k][usize::from(side0[i] >= 0.0)];
            length[i] = face.length[e];
            inverse[i] = face.inverse_length[e];
            behind_x[i] = face.length[e] - face.apex_x[e];
            behind_y[i] = face.twice_area * face.inverse_length[e];
            self.outlets[i] = Outlet {
                twin: face.twin[e],
                corners: [face.vertex[NEXT[e]], face.vertex[e], face.vertex[PREV[e]]],
                apex: face.vertex[PREV[k]],
            };
        }
        let out = &mut self.leaving;
        for i in 0..LANES {
            let right = is_right[i];
            let left = 1.0 - right;
            let (b0, b1, sigma) = (w.b0[i], w.b1[i], w.sigma[i]);
            // The unit vector along the exit, and the source seen along it from where it begins.
            let ux = ((left - right) * cx[i] + right * l[i]) * inverse[i];
            let uy = (left - right) * cy[i] * inverse[i];
            let (x, y) = (w.px[i] - right * cx[i], w.py[i] - right * cy[i]);
            let (px, across) = (ux * x + uy * y, ux * y - uy * x);
            let (depth, shift) = (-left * w.py[i], right * l[i]);
            let start = (depth * b0 + right * side0[i]) / -(across + uy * (b0 - shift));
            let end = (depth * b1 + right * side1[i]) / -(across + uy * (b1 - shift));
            // A window that covers the apex fills the left exit up to its end.
            let end = if out.apex_covered[i] > 0.0 { length[i] } else { less(end, length[i]) };
            let (start, py) = (greater(start, 0.0), less(across, 0.0));
            let bend = left * b1 + right * b0;
            out.bent[i] = sigma + norm(bend - w.px[i], w.py[i]) + norm(cx[i] - bend, cy[i]);
            let (from_start, from_end) = (norm(start - px, py), norm(end - px, py));
            let at_start = (sigma + from_start) * MARGIN;
            let at_end = (sigma + from_end) * MARGIN;
            let (far, at_far) = (left * start + right * end, left * at_start + right * at_end);
            out.limits[0][i] = at_end - end;
            out.limits[1][i] = at_start - (length[i] - start);
            out.limits[2][i] = at_far - norm(far - behind_x[i], behind_y[i]);
            // The nearest point is the foot of the source, or the end beyond which that lies.
            let nearest = if px > end { from_end } else { -py };
            out.label[i] = sigma + if px < start { from_start } else { nearest };
            out.b0[i] = start;
            out.b1[i] = end;
            out.px[i] = px;
            out.py[i] = py;
        }
    }
}

#[cfg(test)]
mod tests;
