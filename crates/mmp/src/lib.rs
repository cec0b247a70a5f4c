//! The MMP algorithm: continuous Dijkstra on windows that are kept on half-edges and trimmed
//! against each other where they tie.
//!
//! Mitchell, Mount and Papadimitriou, "The discrete geodesic problem" (1987), in the form that
//! Surazhsky et al., "Fast exact and approximate geodesics on meshes" (2005), section 3, made
//! practical. The intervals of the windows on one half-edge never overlap: a new window is
//! compared with those it meets, and each keeps the range on which it is shorter. In the paper every window is
//! stored until the end, so that afterwards the distance is known along every edge; memory is the
//! number of windows, O(n²) in the worst case and about n^1.5 in practice ([`Keep::All`]). Distances of vertices do not
//! need that: the windows of an edge are given up once the wave is past it ([`Keep::Wavefront`], the default), which
//! leaves a twentieth of them on the horse and stores as many in all.
//!
//! Time is O(n² log n) for n faces in the worst case.
//!
//! Nearest first, one window at a time, is [`mmp`]. What comes out depends on the order in nothing but the number of windows tried, so
//! that where a queue has no opinion the windows of one half-edge can be [taken together](ByList), in half of the time.
//!
//! # A limit
//!
//! Where vertices lie in one place, joined by faces of no area that are cut into several, distances
//! behind them can come out too long. Such a vertex stands on an edge of a further face, and its
//! window holds rays of all directions at that one point, while a window that comes along the edge
//! ties with it there and beyond without having these rays: trimming compares the distances on the
//! edge, and cannot tell which of the two must go on. The CH and VTP families, which do not compare
//! along the edge, are not affected; nor are single faces of no area.

mod blocks;
mod by_list;
mod division;
mod duel;
mod forgetting;
mod insertion;
mod lists;
mod trimming;
mod wedge;

use geobench_mesh::Mesh;
use geobench_window::continuous::Continuous;
use geobench_window::queue::Priority;

pub use by_list::{ByList, NearLists};
pub use forgetting::Keep;
pub use trimming::{Carrier, Trimming};

/// An algorithm of the MMP family that takes windows by least distance.
pub type Mmp<'m> = Continuous<'m, Trimming, Priority>;

/// Sets MMP up for `mesh`, with windows on half-edges; O(faces).
pub fn mmp(mesh: &Mesh) -> Mmp<'_> {
    Continuous::new(
        mesh,
        Trimming::new(mesh, Carrier::HalfEdge),
        Priority::new(mesh),
    )
}

/// MMP that takes the windows of a half-edge together: nearest list first, and with its nearest window those that are further by
/// up to `slack` mean edge lengths; O(faces).
///
/// The answers and the trimming are those of [`mmp`], which takes one window at a time in the order of distance. At a slack of 1 it has
/// 0.3 to 1 % more windows, and takes half of its time on scans.
pub fn mmp_by_list(mesh: &Mesh, slack: f64) -> ByList<'_, NearLists> {
    ByList::new(mesh, NearLists::new(mesh, slack))
}

/// Sets the edge-based variant of MMP up for `mesh`; O(faces).
///
/// It stores fewer windows than [`mmp`], and needs more work for each.
pub fn mmp_edge(mesh: &Mesh) -> Mmp<'_> {
    Continuous::new(
        mesh,
        Trimming::new(mesh, Carrier::Edge),
        Priority::new(mesh),
    )
}
