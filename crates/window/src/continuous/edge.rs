//! The distances around an edge at which a window arrives.

use crate::filter::{is_beaten_across, is_beaten_from_ends};
use crate::frame::Exit;
use crate::window::Window;

/// The edge at which a window arrives, with the known distances of the vertices around it.
///
/// All fields come from the face that the window has crossed. Building the view therefore loads
/// nothing of the face that the window is about to enter.
#[derive(Clone, Copy, Debug)]
pub struct EdgeView {
    /// Length of the half-edge.
    pub length: f64,
    /// Distance known at its tail.
    pub tail: f64,
    /// Distance known at its head.
    pub head: f64,
    /// The third vertex of the face that the window has crossed.
    pub behind: Behind,
}

/// The vertex of the crossed face that is not on the edge.
#[derive(Clone, Copy, Debug)]
pub struct Behind {
    /// Its position in the frame of the half-edge, below it.
    pub position: [f64; 2],
    /// Its known distance. Infinite if the window starts at this vertex: a vertex does not compete
    /// with its own windows.
    pub distance: f64,
    /// As in [`Exit`].
    pub(super) is_left: f64,
    pub(super) is_right: f64,
}

impl EdgeView {
    /// The view of `exit`, through which a window leaves a face. `distances` are those of the
    /// exit's corners: tail, head and third vertex.
    #[inline]
    pub fn behind(exit: &Exit, distances: [f64; 3]) -> Self {
        let [tail, head, distance] = distances;
        Self {
            length: exit.length,
            tail,
            head,
            behind: Behind {
                position: exit.behind,
                distance,
                is_left: exit.is_left,
                is_right: exit.is_right,
            },
        }
    }

    /// The same edge in the frame of a half-edge of the opposite direction.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let [x, y] = self.behind.position;
        Self {
            tail: self.head,
            head: self.tail,
            behind: Behind {
                position: [self.length - x, y],
                is_left: self.behind.is_right,
                is_right: self.behind.is_left,
                ..self.behind
            },
            ..*self
        }
    }

    /// Whether a path through one of the three vertices is shorter than every ray of `w`, which
    /// arrives at this edge. This is the vertex filter, theorem 3.2 of Xin and Wang 2009.
    #[inline]
    pub fn beats(&self, w: &Window) -> bool {
        let Behind {
            position,
            distance,
            is_left,
            is_right,
        } = self.behind;
        let end = is_left * w.b0 + is_right * w.b1;
        is_beaten_from_ends(w, self.length, self.tail, self.head)
            || is_beaten_across(w, end, position, distance)
    }
}
