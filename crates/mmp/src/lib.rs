//! The MMP algorithm: continuous Dijkstra on windows that are kept on half-edges and trimmed
//! against each other where they tie.
//!
//! Mitchell, Mount and Papadimitriou, "The discrete geodesic problem" (1987), in the form that
//! Surazhsky et al., "Fast exact and approximate geodesics on meshes" (2005), section 3, made
//! practical. The intervals of the windows on one half-edge never overlap: a new window is compared
//! with those it meets, and each keeps the range on which it is shorter. In the paper every window
//! is stored until the end, so that afterwards the distance is known along every edge; memory is
//! the number of windows, O(n²) in the worst case and about n^1.5 in practice ([`Keep::All`]).
//! Distances of vertices do not need that: the windows of an edge are given up once the wave is
//! past it ([`Keep::Wavefront`], the default), which leaves a twentieth of them on the horse and
//! stores as many in all.
//!
//! MMP compares every window that comes to an edge with those that are there. [`ByList`] drops
//! beforehand, as ICH does, those that a path through an end of the edge beats
//! ([`ByList::filtering`]): on the horse a twelfth of all propagations is saved so, on models of
//! some thousands of faces with many saddles a third, and with them a third of the time.
//!
//! Answers do not depend on the order in which windows are taken, only the number of windows tried
//! does. With the nearest window [`mmp`] takes those of its half-edge that are little further,
//! which no paper does, as [`ByList`] does under any queue; [`mmp_by_window`] takes one at a time,
//! strictly nearest first, as the papers have it: without the filter 0.3 to 1 % fewer windows, in
//! two to four times the time on scans. In that order time is O(n² log n) for n faces in the worst
//! case; for a slack no bound has been shown.

mod blocks;
mod by_list;
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

/// MMP on windows that have their turns one by one, the nearest of all first.
pub type MmpByWindow = Continuous<Trimming, Priority>;

/// Sets MMP up for `mesh`, with windows filtered, kept on half-edges, and those of one half-edge
/// taken together; O(faces).
///
/// The list with the nearest window has its turn, and what lies up to [a mean
/// edge](NearLists::SLACK) further goes with it. Space is O(n²) for n faces.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_mmp::mmp;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let mut solver = mmp(&mesh);
/// let distances = solver.distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12); // Across the whole grid.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn mmp(mesh: &Mesh) -> ByList<NearLists> {
    mmp_with_slack(mesh, NearLists::SLACK)
}

/// [`mmp`] whose turns take windows that are further than the nearest one of their half-edge by up
/// to `slack` mean edge lengths; O(faces).
///
/// The answers and the trimming are those of [`mmp_by_window`]. At a slack of 1 there are, without
/// the [filter](ByList::filtering), 0.3 to 1 % more windows in half of the time on scans; at 0 the
/// order is that of [`mmp_by_window`] but for windows equally near, and takes 1.1 to 1.8 times as
/// long. A negative slack and NaN count as 0.
pub fn mmp_with_slack(mesh: &Mesh, slack: f64) -> ByList<NearLists> {
    ByList::new(mesh, NearLists::new(mesh, slack))
}

/// Sets MMP up for `mesh` as its papers describe it, with windows taken one by one, the nearest of
/// all first; O(faces).
pub fn mmp_by_window(mesh: &Mesh) -> MmpByWindow {
    Continuous::new(
        mesh,
        Trimming::new(mesh, Carrier::HalfEdge),
        Priority::new(mesh),
    )
}

/// Sets the edge-based variant of MMP up for `mesh`, with windows taken one by one; O(faces).
///
/// It stores fewer windows than [`mmp_by_window`], and needs more work for each.
pub fn mmp_edge(mesh: &Mesh) -> MmpByWindow {
    Continuous::new(
        mesh,
        Trimming::new(mesh, Carrier::Edge),
        Priority::new(mesh),
    )
}
