//! The ICH algorithm: continuous Dijkstra on windows that are filtered and split, never kept.
//!
//! Xin and Wang, "Improving Chen and Han's algorithm on the discrete geodesic problem" (2009),
//! improve the sequence tree of Chen and Han (1990) in two ways: a window is dropped when a path
//! through a known vertex beats all of it ([`geobench_window::is_beaten_from_ends`]), and windows
//! are taken by their least distance. Of all windows that cover the apex of a triangle from one
//! of its half-edges only the best may have two children ("one angle, one split"). Nothing but
//! the queue and a record for each angle and vertex is stored: memory is the peak of the queue.
//!
//! Time is O(n² log n) for n faces in the worst case, space O(n).

mod angle;
mod splitting;
mod tree;

use geobench_mesh::Mesh;
use geobench_window::continuous::Continuous;
use geobench_window::queue::Priority;

pub use splitting::Splitting;

/// ICH (ICH2 of the paper) on one mesh: filter, one angle one split, least distance first.
pub type Ich<'m> = Continuous<'m, Splitting, Priority>;

/// Sets ICH up for `mesh`; O(faces).
pub fn ich(mesh: &Mesh) -> Ich<'_> {
    Continuous::new(mesh, Splitting::new(mesh), Priority::default())
}
