//! The whole crossing of a triangle by one window, for algorithms that take one window at a time.
//!
//! The ray to the apex C meets the half-edge at D0/e, where D0 = cy·px - py·cx and e = cy - py. The
//! division is avoided: the sign of s·e - D0 tells the side on which the ray through s leaves, and
//! its value is the numerator of the right exit.

use crate::frame::{Exit, Frame, Side};
use crate::precision::PLACE;
use crate::window::{Window, greater, less, norm};

/// A window that has entered a triangle, before its children are computed.
///
/// ```
/// use geobench_mesh::{HalfEdgeId, Mesh};
/// use geobench_window::{Crossing, Faces, Side, Window};
///
/// // A triangle over the edge from (0, 0) to (2, 0), and a neighbour on its left.
/// let mesh = Mesh::new(
///     vec![[0.0; 3], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
///     vec![[0, 1, 2], [2, 3, 0]],
/// )?;
/// let faces = Faces::new(&mesh);
/// let h = HalfEdgeId::new(0);
/// // The source lies 1 below the middle of the edge.
/// let window = Window { b0: 0.0, b1: 2.0, px: 1.0, py: -1.0, sigma: 0.0 };
/// let view = faces.face_view(h);
/// let crossing = Crossing::new(&view.frame, &window);
/// assert!(crossing.covers_apex() && crossing.straight_distance() == 2.0);
///
/// let exit = view.exit(Side::Left);
/// let child = crossing.left_child(&exit).expect("rays that leave on the left");
/// assert!((child.b1 - exit.length).abs() < 1e-15);
/// // Distances are those of the same source.
/// assert!((child.distance(exit.length) - 2.0).abs() < 1e-15);
/// assert!(faces.corners(exit.half_edge.expect("a neighbour")).contains(&3.into()));
/// # Ok::<(), geobench_mesh::InvalidMesh>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Crossing<'a> {
    frame: &'a Frame,
    window: &'a Window,
    /// D0.
    offset: f64,
    /// e, the height of the apex above the source.
    height: f64,
    /// s·e - D0 at both ends of the window: negative where a ray leaves through AC, positive where
    /// it leaves through CB.
    sides: [f64; 2],
}

impl<'a> Crossing<'a> {
    /// The crossing of the triangle of `frame` by `window`, which has entered it.
    #[inline]
    pub fn new(frame: &'a Frame, window: &'a Window) -> Self {
        let offset = frame.cy * window.px - window.py * frame.cx;
        let height = frame.cy - window.py;
        Self {
            frame,
            window,
            offset,
            height,
            sides: [window.b0 * height - offset, window.b1 * height - offset],
        }
    }

    /// Whether any ray leaves through AC.
    #[inline]
    pub fn goes_left(&self) -> bool {
        self.sides[0] < 0.0
    }

    /// Whether any ray leaves through CB.
    #[inline]
    pub fn goes_right(&self) -> bool {
        self.sides[1] > 0.0
    }

    /// Whether the window sees the apex and has rays on both sides of it.
    #[inline]
    pub fn covers_apex(&self) -> bool {
        // Few windows cover the apex, but half of all go left. A single branch on both tests is
        // predictable.
        less(-self.sides[0], self.sides[1]) > 0.0
    }

    /// The abscissa at which the ray to the apex meets the half-edge, inside the window or not.
    #[inline]
    pub fn separation(&self) -> f64 {
        self.offset / self.height
    }

    /// The fraction of the half-edge at which the ray to the apex meets it. NaN if rounding leaves
    /// it undetermined, because the apex and the source are both too close to the half-edge.
    #[inline]
    pub fn entry(&self) -> f64 {
        entry(self.offset, self.height, self.window.px, self.frame.l)
    }

    /// Length of the straight path to the apex. The window contains that path if it
    /// [covers](Self::covers_apex) the apex.
    #[inline]
    pub fn straight_distance(&self) -> f64 {
        self.window.sigma + self.squared_straight().sqrt()
    }

    /// Length of the shortest path to the apex of a window that leaves through `exit` alone: bent
    /// at the end of the window nearer to the straight path.
    ///
    /// This is the length of a real path, and must be offered as well as the straight one: it
    /// carries a distance past a vertex that is hit exactly.
    #[inline]
    pub fn bent_distance(&self, exit: &Exit) -> f64 {
        let w = self.window;
        let bend = exit.is_left * w.b1 + exit.is_right * w.b0;
        w.distance(bend) + norm(self.frame.cx - bend, self.frame.cy)
    }

    /// Square of the length of the straight path from the (pseudo-)source to the apex, whether or
    /// not the window covers it.
    #[inline]
    pub fn squared_straight(&self) -> f64 {
        let x = self.frame.cx - self.window.px;
        x * x + self.height * self.height
    }

    /// The side on which the window leaves; the left one if it leaves on both.
    #[inline]
    pub fn side(&self) -> Side {
        if self.goes_left() {
            Side::Left
        } else {
            Side::Right
        }
    }

    /// The child of a window that leaves through `exit` alone, in the frame of the neighbour's
    /// half-edge; `None` if its interval is empty.
    #[inline]
    pub fn only_child(&self, exit: &Exit) -> Option<Window> {
        let turn = ExitTurn::new(self, exit);
        turn.window(
            greater(turn.leaving(self.window.b0, self.sides[0]), 0.0),
            less(turn.leaving(self.window.b1, self.sides[1]), exit.length),
        )
    }

    /// The left child of a window that covers the apex.
    #[inline]
    pub fn left_child(&self, exit: &Exit) -> Option<Window> {
        let turn = ExitTurn::new(self, exit);
        let b0 = turn.leaving(self.window.b0, self.sides[0]);
        turn.window(greater(b0, 0.0), exit.length)
    }

    /// The right child of a window that covers the apex.
    #[inline]
    pub fn right_child(&self, exit: &Exit) -> Option<Window> {
        let turn = ExitTurn::new(self, exit);
        let b1 = turn.leaving(self.window.b1, self.sides[1]);
        turn.window(0.0, less(b1, exit.length))
    }
}

/// Height of the apex above the source, relative to the half-edge and the abscissa of the source,
/// below which [`entry`] is undetermined. The entry errs by the error of the source's ordinate over
/// this height. At the limit that is a billionth of the half-edge.
const BLURRED: f64 = 2.5 * PLACE * 1e9;

/// The fraction of a half-edge of length `l` at which the ray to the apex meets it: `offset` over
/// `height`, in units of `l`, for a source with abscissa `px`. NaN if it is undetermined.
#[inline]
pub(crate) fn entry(offset: f64, height: f64, px: f64, l: f64) -> f64 {
    if height < BLURRED * (l + px.abs()) {
        f64::NAN
    } else {
        offset / height / l
    }
}

/// The length of the path to an apex that crosses its half-edge at `entry`. By its window the
/// length is `d`. The half-edge is `l` long; `ends` are the distances of its tail and its head,
/// `sides` the distances from these to the apex.
///
/// A path through one of the two vertices is no shorter than the distance of the vertex plus the
/// side from there. A window places its source to some ulps of the half-edge. If the half-edge is
/// far longer than all distances around, this error is not small beside them, and `d` may be less
/// than the distance of the vertex, which comes from shorter edges and is more exact. Then the
/// length is that distance plus the side, if they exceed `d` by no more than the error.
///
/// ```
/// use geobench_window::length_past_end;
///
/// // A needle of length 1: its tip is 1e-17 wide, and 1e-9 from the source.
/// let (d, tail) = (0.99999997e-9, 1e-9);
/// let sides = [1e-17, 1.0];
/// assert_eq!(length_past_end(d, 0.0, 1.0, [tail, 1.0], sides), 1e-9 + 1e-17);
/// // A path that does not pass the tip, and two whose difference is not of rounding.
/// assert_eq!(length_past_end(d, 0.1, 1.0, [tail, 1.0], sides), d);
/// assert_eq!(length_past_end(d, 0.0, 1.0, [2e-9, 1.0], sides), d);
/// assert_eq!(length_past_end(d, 0.0, 1.0, [tail, 1.0], [1e-9, 1.0]), d);
/// ```
#[inline]
pub fn length_past_end(d: f64, entry: f64, l: f64, ends: [f64; 2], sides: [f64; 2]) -> f64 {
    let end = if entry <= 0.0 {
        0
    } else if entry >= l {
        1
    } else {
        return d;
    };
    let length = ends[end] + sides[end];
    if ends[end] > d && length - d <= PLACE * l {
        length
    } else {
        d
    }
}

/// The change of frame from the entrance to an exit.
struct ExitTurn<'a> {
    crossing: &'a Crossing<'a>,
    exit: &'a Exit,
    /// The source in the frame of the exit: (û·p', û×p'), where û is the unit vector along the exit
    /// and p' the source relative to the start of the exit.
    source: [f64; 2],
}

impl<'a> ExitTurn<'a> {
    #[inline]
    fn new(crossing: &'a Crossing<'a>, exit: &'a Exit) -> Self {
        let (frame, w) = (crossing.frame, crossing.window);
        let [ux, uy] = exit.direction;
        let x = w.px - exit.is_right * frame.cx;
        let y = w.py - exit.is_right * frame.cy;
        Self {
            crossing,
            exit,
            source: [ux * x + uy * y, ux * y - uy * x],
        }
    }

    /// The distance from the start of the exit at which the ray through abscissa `s` crosses it.
    /// `side` is s·e - D0.
    ///
    /// The ray divides the exit as n : m. On the left n = -py·s, on the right n = -py·(l - s); both
    /// are measured from the end that the exit shares with the half-edge. m = |s·e - D0| is
    /// measured from C. Neither is negative, so their sum has no cancellation, however close the
    /// source is to the half-edge.
    #[inline]
    fn leaving(&self, s: f64, side: f64) -> f64 {
        let (exit, crossing) = (self.exit, self.crossing);
        let from_corner = exit.is_left * s + exit.is_right * (crossing.frame.l - s);
        let (n, m) = (-crossing.window.py * from_corner, side.abs());
        exit.length * (exit.is_left * n + exit.is_right * m) / (n + m)
    }

    #[inline]
    fn window(&self, b0: f64, b1: f64) -> Option<Window> {
        let [px, py] = self.source;
        let window = Window {
            b0,
            b1,
            px,
            py: -py.abs(),
            sigma: self.crossing.window.sigma,
        };
        (b0 < b1).then_some(window)
    }
}
