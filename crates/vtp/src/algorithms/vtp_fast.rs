//! VTP with every improvement that keeps it exact.
//!
//! The same algorithm as [`vtp`](super::vtp), the filter, rules 1, 2 and 3, built of the same
//! parts. Its distances differ from those of the others by rounding only, and are the same bits on
//! every processor. What can be switched, in [`FastOptions`]:
//!
//! * **Vector instructions** (`simd`). As in all algorithms of the family a list is a structure of
//!   arrays, and a few short kernels work on four (AVX2) or eight (AVX-512) windows at once; chosen
//!   when the program runs. The kernels are written once, over registers with any number of lanes,
//!   one included.
//! * **Fewer checks** (`pairs`). Rules 2 and 3 cost more than most of what they save: they are
//!   applied to a pseudo-random one in eight of the lists of 17 windows or more, which leaves a
//!   fifth more windows and takes a fifth less time. Neighbours are all compared at once, and only
//!   where they overlap.
//! * **Vertices in buckets** (`bucket`). All vertices within a quarter of a mean edge length have
//!   their turns together, which takes no heap and lets many lists cross in a row.
//! * **Windows into the shadow** (`shadow`). A shortest path that bends at a vertex leaves it
//!   opposite to where it came from; so a vertex sends windows only into a wedge as wide as its
//!   angle exceeds 2π, one face or two instead of all.
//! * **Windows made one again** (`reunite`). A flat vertex parts a window into two that come
//!   together again behind it, side by side, with one source image; they go on as one. A plane
//!   takes one window to a half-edge so, instead of one for each vertex that the source sees. Where
//!   fewer than an eighth of the vertices is flat nothing is looked for, and nothing paid.
//! * **An order of its own** (`renumber`). Vertices and faces are renumbered breadth first, so that
//!   a wavefront finds its faces near each other in memory.
//!
//! Without a switch: windows that come from both sides of a face share one list, in the order in
//! which they come; neighbours apart from each other are not compared; the vertex filter takes
//! windows from vertices before they wait. And in the whole family, since nothing is lost by it: a
//! face is a record of two cache lines; the sides on which the ends of a window pass the apex take
//! signs and no division; both ends of a child take one division together; the shortest path to the
//! apex is found without a branch on each window. Here improved distances take effect some thousand
//! crossings later, too.
//!
//! **Cost.** As [`vtp`](super::vtp): time O(n²) for n faces in the worst case, space O(n).
//! **Keeps** the windows of the wavefront, 40 bytes each, and 160 bytes for each face. **Choose
//! it** whenever distances at the vertices are wanted.

pub use crate::fast::{Options as FastOptions, VtpFast};
