//! Disciplines between first in first out and a priority queue, for windows taken one by one or
//! list by list.
//!
//! What a window algorithm answers does not depend on the order in which it takes its windows (Xu
//! et al. 2015, proposition 1): every window that provides a shortest path descends from such
//! windows only, and none of these is ever discarded. What depends on the order is how many windows
//! are tried in vain. Nearest first tries the fewest and pays O(log k) for each, in a heap of a
//! hundred thousand entries that no cache holds; first in first out pays nothing and tries several
//! times as many. The disciplines of this crate pay O(1) and try nearly as few.
//!
//! Each is a [`Discipline`](geobench_window::queue::Discipline), and knows nothing of what it
//! orders. Under MMP, which can take the windows of a half-edge together ([`ByList`]) or one by one
//! ([`Trimming`]), and under the policy of ICH ([`Splitting`]) it makes these algorithms:
//!
//! | discipline | algorithms | source | takes next | memory beside the policy's |
//! |---|---|---|---|---|
//! | [`Buckets`] | [`fwp_mmp`], [`fwp_mmp_by_window`], [`fwp_ch`] | Xu et al. 2015, section 4 | the K nearest, roughly, in rounds | 24 bytes for each window or list that waits, 12 for each bucket that the wavefront spans |
//! | [`LabelCorrecting`] | [`lc_mmp`], [`lc_mmp_by_window`], [`lc_ch`] | Bertsekas 1993; Xu et al. 2015, section 7.4 | one below the mean, roughly | 16 bytes for each window or list that waits |
//! | [`VertexOrder`] | [`vtp_mmp`], [`vtp_ch`] | Qin et al. 2016, section 6.2 | windows around the nearest vertex | 24 bytes for each window or list that waits, 12 for each half-edge, 4 for each face |
//!
//! Nearest first by lists is [`NearLists`](geobench_mmp::NearLists).
//!
//! # Which one to choose
//!
//! * Buckets are the authors' choice where windows are taken one by one, and have the bound to show
//!   for it: O(n²) windows for n vertices of bounded degree, in O(n² log n) time with MMP's lists
//!   and O(n²) with ICH's records (proposition 2).
//! * Label correcting needs no width and no limit to be set. It has no such bound: there are meshes
//!   on which it takes Ω(n³) windows. It is here because the papers compare with it.
//! * Vertex order keeps the fewest things in order. It separates what VTP owes to its schedule from
//!   what it owes to its rules: the schedule alone saves time and no windows.
//!
//! [`vtp`](https://doi.org/10.1145/2897824.2925930) itself, which compares whole lists of windows,
//! is faster than any of them.
//!
//! References: Xu, Wang, Liu, Liu and He, "Fast wavefront propagation (FWP) for computing exact
//! geodesic distances on meshes" (2015); Bertsekas, "A simple and fast label correcting algorithm
//! for shortest paths" (1993); Qin, Han, Yu, Yu and Zhang, "Fast and exact discrete geodesic
//! computation based on triangle-oriented wavefront propagation" (2016).

mod buckets;
mod label_correcting;
#[cfg(test)]
mod test_support;
mod vertex_order;
mod weights;

use geobench_ich::Splitting;
use geobench_mesh::Mesh;
use geobench_mmp::{ByList, Carrier, Trimming};
use geobench_window::VertexFilter;
use geobench_window::continuous::Continuous;

pub use buckets::{BatchSize, BucketOptions, Buckets};
pub use label_correcting::{LabelCorrecting, LabelCorrectingOptions};
pub use vertex_order::VertexOrder;

/// FWP-MMP for `mesh`: windows filtered, kept and trimmed on half-edges, taken from buckets in
/// rounds, those of one half-edge together; O(faces).
///
/// Time O(n² log n), space O(n²) (proposition 2 of Xu et al. 2015). The rounds are the same as with
/// [windows one by one](fwp_mmp_by_window), up to windows that come to a list before its turn,
/// which make a fourth more of them on the horse, and to those that are filtered: with the filter
/// it makes seven tenths more; within a round the paper leaves the order open.
///
/// ```
/// use geobench_fwp::{BatchSize, BucketOptions, fwp_mmp};
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let batch = BatchSize::Adaptive { max: 5000 };
/// let mut solver = fwp_mmp(&mesh, BucketOptions { batch, ..BucketOptions::default() });
/// assert_eq!(solver.distances_from(5)?[5], 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fwp_mmp(mesh: &Mesh, options: BucketOptions) -> ByList<Buckets> {
    ByList::new(mesh, Buckets::new(mesh, options).of_lists())
}

/// FWP-MMP with windows taken one by one, first in first out, as
/// [`mmp_by_window`](geobench_mmp::mmp_by_window) takes them from another queue; O(faces).
pub fn fwp_mmp_by_window(mesh: &Mesh, options: BucketOptions) -> Continuous<Trimming, Buckets> {
    Continuous::new(mesh, trimming(mesh), Buckets::new(mesh, options))
}

/// FWP-CH for `mesh`: windows filtered and not kept, taken from buckets in rounds; O(faces).
///
/// Time O(n²), space O(n) beside the windows that wait (proposition 2 of Xu et al. 2015).
pub fn fwp_ch(mesh: &Mesh, options: BucketOptions) -> Continuous<Splitting, Buckets> {
    Continuous::new(mesh, splitting(mesh), Buckets::new(mesh, options))
}

/// LC-MMP for `mesh`: windows filtered, kept and trimmed on half-edges, those of one half-edge
/// together in a label correcting queue; O(faces).
///
/// Without a bound on time that means anything; space O(n²).
pub fn lc_mmp(mesh: &Mesh, options: LabelCorrectingOptions) -> ByList<LabelCorrecting> {
    ByList::new(mesh, LabelCorrecting::new(options))
}

/// LC-MMP with windows taken one by one; O(faces).
pub fn lc_mmp_by_window(
    mesh: &Mesh,
    options: LabelCorrectingOptions,
) -> Continuous<Trimming, LabelCorrecting> {
    Continuous::new(mesh, trimming(mesh), LabelCorrecting::new(options))
}

/// LC-CH for `mesh`: windows filtered and not kept, in a label correcting queue; O(faces).
///
/// Without a bound on time that means anything; space O(n) beside the windows that wait.
pub fn lc_ch(
    mesh: &Mesh,
    options: LabelCorrectingOptions,
) -> Continuous<Splitting, LabelCorrecting> {
    Continuous::new(mesh, splitting(mesh), LabelCorrecting::new(options))
}

/// VTP-MMP for `mesh`: windows filtered, kept and trimmed on half-edges, whole lists released
/// around the nearest vertex; O(faces).
///
/// It needs about the time of [`fwp_mmp`] or less, and space O(n²).
pub fn vtp_mmp(mesh: &Mesh) -> ByList<VertexOrder> {
    ByList::new(mesh, VertexOrder::new(mesh))
}

/// VTP-CH for `mesh`: windows filtered and not kept, released around the nearest vertex; O(faces).
///
/// It needs about the time of [`fwp_ch`], and space O(n) beside the windows that wait.
pub fn vtp_ch(mesh: &Mesh) -> Continuous<Splitting, VertexOrder> {
    Continuous::new(mesh, splitting(mesh), VertexOrder::new(mesh))
}

fn trimming(mesh: &Mesh) -> Trimming {
    Trimming::new(mesh, Carrier::HalfEdge)
}

fn splitting(mesh: &Mesh) -> Splitting {
    Splitting::new(mesh, VertexFilter::On)
}
