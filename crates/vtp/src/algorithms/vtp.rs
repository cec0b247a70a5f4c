//! VTP: vertex-sorted propagation of whole window lists.
//!
//! Qin et al. 2016, sections 4 and 5.2. The vertices have their turns in the order of their
//! distances; the faces around a vertex join the traversed area together, and the lists that wait
//! for them cross:
//!
//! * the vertex filter drops windows that a path through a known vertex beats;
//! * rules 2 and 3 compare neighbours in a list, from one and from two edges;
//! * rule 1 ("one angle, two sides") sends each window to one side of the best path to the apex.
//!
//! All three are applied when a list is about to cross; what merges on the wavefront is only put
//! one behind the other.
//!
//! # Neighbours meet as they came
//!
//! The paper compares a list from one end to the other, so that a window meets its second neighbour
//! as the first one has left it. Here all neighbours are compared at once, as they came, then those
//! whom a death has brought together, and so on until all of them stay: a cut rests on a path that
//! is real, whatever becomes of the winner. No pair is left out; a window that dies of one
//! neighbour still meets the other. On the horse there are 0.2 % more children than in the paper's
//! order.
//!
//! **Cost.** Time O(n²) for n faces in the worst case, apart from the queue of vertices; space
//! O(n). **Keeps** the windows of the wavefront, nothing at the end. **Choose it** for distances at
//! the vertices: only [`vtp_fast`](super::vtp_fast) is faster.
//!
//! # Rule 1 is not the printed one
//!
//! Proposition 4.1 of the paper drops a window's whole side by comparing separating points. Where
//! intervals overlap this is unsound: taken literally it gives wrong distances at 1,040 of 49,970
//! vertices of one scan (by up to 8e-5 of the distance), at a few on others, and none on many. Here
//! a window is cut where the best path to the apex enters the triangle, and loses the rest only if
//! that path provably crosses all of it.

use crate::{ListPropagation, NearestVertex, Neighbours, OneAngleTwoSides, OrderFree};

/// VTP on one mesh; see [the page](self).
pub type Vtp = ListPropagation<NearestVertex, OrderFree, Neighbours, OneAngleTwoSides>;
