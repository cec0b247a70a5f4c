//! The VTP algorithm: whole lists of windows cross triangles together.
//!
//! Qin, Han, Yu, Yu and Zhang, "Fast and exact discrete geodesic computation based on
//! triangle-oriented wavefront propagation" (2016). Instead of taking windows one by one, the
//! algorithm grows a *traversed area* of faces around the vertices in the order of their
//! distances. The windows that wait to enter a face through one of its half-edges form a list;
//! once the face is in the area the list crosses it as a whole, which brings windows together that
//! can be compared pair by pair:
//!
//! * the vertex filter drops windows that a path through a known vertex beats
//!   ([`geobench_window::is_beaten_from_ends`]);
//! * rules 2 and 3 compare neighbours in a list, from one and from two edges;
//! * rule 1 ("one angle, two sides") sends each window to one side of the best path to the apex.
//!
//! Nothing is kept but the wavefront. Time is O(n²) for n faces in the worst case, apart from the
//! queue of vertices; space O(n).
//!
//! # Rule 1 is not the printed one
//!
//! Proposition 4.1 of the paper drops a window's whole side by comparing separating points. Where
//! intervals overlap this is unsound: taken literally it gives wrong distances at 1,040 of
//! 49,970 vertices of one scan (by up to 8e-5 of the distance), at a few on others, and none on
//! many. Here a window is cut where the best path to the apex enters the triangle, and loses the
//! rest only if that path provably crosses all of it.

mod lists;
mod orient;
mod pairs;
mod sides;
mod vtp;

pub use vtp::Vtp;
