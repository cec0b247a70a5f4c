//! What is known around an edge at which a window arrives.

use crate::filter::{is_beaten_across, is_beaten_from_ends};
use crate::frame::Frame;
use crate::window::Window;

/// Which child of a crossing a window is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// It left through AC.
    Left,
    /// It left through CB.
    Right,
}

/// The edge of a half-edge at which a window arrives, and the distances known around it.
///
/// All of it belongs to the face that the window comes from too, so that a crossing gathers it
/// without touching the face beyond.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Length of the half-edge.
    pub length: f64,
    /// Distance known at its tail.
    pub tail: f64,
    /// Distance known at its head.
    pub head: f64,
    /// The third vertex of the face that the window has crossed; `None` if it comes from that
    /// vertex.
    pub behind: Option<Behind>,
}

/// The vertex of the crossed face that is not on the edge.
#[derive(Clone, Copy, Debug)]
pub struct Behind {
    /// Its position in the frame of the half-edge, below it.
    pub position: [f64; 2],
    /// The distance known there.
    pub distance: f64,
    /// Which child of the crossing the window is.
    pub side: Side,
}

impl Edge {
    /// The edge A → C by which a window leaves a face to the left; `distances` are those of the
    /// face's A, B and C.
    #[inline]
    pub(super) fn left(frame: &Frame, distances: [f64; 3]) -> Self {
        let [a, b, c] = distances;
        let [ux, uy] = frame.left;
        Self {
            length: frame.la,
            tail: a,
            head: c,
            behind: Some(Behind {
                position: [frame.l * ux, -frame.l * uy],
                distance: b,
                side: Side::Left,
            }),
        }
    }

    /// The edge C → B by which a window leaves a face to the right.
    #[inline]
    pub(super) fn right(frame: &Frame, distances: [f64; 3]) -> Self {
        let [a, b, c] = distances;
        let [vx, vy] = frame.right;
        Self {
            length: frame.lb,
            tail: c,
            head: b,
            behind: Some(Behind {
                // v̂·(A - C) and v̂×(A - C).
                position: [
                    -vx * frame.cx - vy * frame.cy,
                    vy * frame.cx - vx * frame.cy,
                ],
                distance: a,
                side: Side::Right,
            }),
        }
    }

    /// The vertex filter: whether a path through one of the vertices around beats all of `w`, which
    /// arrives at this edge.
    #[inline]
    pub fn beats(&self, w: &Window) -> bool {
        is_beaten_from_ends(w, self.length, self.tail, self.head)
            || self.behind.is_some_and(|behind| {
                let end = match behind.side {
                    Side::Left => w.b0,
                    Side::Right => w.b1,
                };
                is_beaten_across(w, end, behind.position, behind.distance)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The triangle A (0, 0), B (5, 0), C (1.8, 2.4), right-angled at C.
    #[test]
    fn the_vertex_behind_stands_where_it_does_in_the_triangle() {
        let frame = Frame {
            l: 5.0,
            la: 3.0,
            lb: 4.0,
            cx: 1.8,
            cy: 2.4,
            left: [0.6, 0.8],
            right: [0.8, -0.6],
        };
        let close = |edge: Edge, length: f64, [tail, head]: [f64; 2], at: [f64; 2], d: f64| {
            let behind = edge.behind.unwrap();
            assert_eq!((edge.length, edge.tail, edge.head), (length, tail, head));
            assert_eq!(behind.distance, d);
            let [x, y] = behind.position;
            assert!((x - at[0]).abs() + (y - at[1]).abs() < 1e-15, "{x} {y}");
        };
        let distances = [10.0, 20.0, 30.0];
        close(
            Edge::left(&frame, distances),
            3.0,
            [10.0, 30.0],
            [3.0, -4.0],
            20.0,
        );
        close(
            Edge::right(&frame, distances),
            4.0,
            [30.0, 20.0],
            [0.0, -3.0],
            10.0,
        );
    }
}
