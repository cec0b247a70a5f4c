//! Disciplines that cost less than a priority queue: buckets in rounds (FWP), label correcting, and
//! the vertex order of VTP.
//!
//! The distances of a window algorithm do not depend on the order in which it takes its windows (Xu
//! et al. 2015, proposition 1). Every window that provides a shortest path descends from such
//! windows only, and none of these is deleted. The order decides how many windows are propagated
//! without need. Nearest first propagates the fewest, and costs O(log k) for each in a heap of a
//! hundred thousand entries, larger than the caches. First in, first out costs O(1) and propagates
//! several times as many. The disciplines of this crate cost O(1) and propagate nearly as few as
//! nearest first.
//!
//! Each is a [`Discipline`](geobench_window::queue::Discipline), which works with any policy:
//!
//! | discipline | algorithms | source | takes next | memory beside the policy's |
//! |---|---|---|---|---|
//! | [`Buckets`] | [`fwp_mmp`], [`fwp_ch`] | Xu et al. 2015, section 4 | at least K of the nearest, in rounds | 24 bytes for each window or list that waits, 12 for each bucket that the wavefront spans |
//! | [`LabelCorrecting`] | [`lc_mmp`], [`lc_ch`] | Bertsekas 1993; Xu et al. 2015, section 7.4 | one below the mean, roughly | 16 bytes for each window or list that waits |
//! | [`VertexOrder`] | [`vtp_mmp`], [`vtp_ch`] | Qin et al. 2016, section 6.2 | windows around the nearest vertex | 24 bytes for each window or list that waits, 12 for each half-edge, 4 for each face |
//!
//! The MMP kinds take windows one at a time, without a filter, and store all of them, as their
//! papers do ([`Trimming`]). Each has a batched form, such as [`fwp_mmp_batched`], which propagates
//! the due windows of a half-edge together ([`Batched`]), and can filter and evict windows. The CH
//! kinds use the policy of ICH ([`Splitting`]).
//!
//! # Which one to choose
//!
//! * Buckets are the choice of Xu et al. and have a bound: O(n²) windows for n vertices of bounded
//!   degree, in O(n² log n) time with MMP's lists and O(n²) with ICH's records (proposition 2).
//! * Label correcting needs no width and no limit. It has no such bound: there are meshes on which
//!   it propagates Ω(n³) windows. The papers compare with it.
//! * Vertex order keeps only vertices in order. It separates the effect of VTP's schedule from that
//!   of its rules: the schedule alone saves time, but no windows.
//!
//! [VTP](https://doi.org/10.1145/2897824.2925930) itself, which compares whole lists of windows, is
//! faster than all of them; see `geobench-vtp`.
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
use geobench_mmp::{Batched, Carrier, Trimming};
use geobench_window::VertexFilter;
use geobench_window::continuous::Continuous;

pub use buckets::{BatchSize, BucketOptions, Buckets};
pub use label_correcting::{LabelCorrecting, LabelCorrectingOptions};
pub use vertex_order::VertexOrder;

/// Sets up FWP-MMP for `mesh`: windows are stored and trimmed on half-edges, and taken one at a
/// time from buckets in rounds; O(faces).
///
/// Time O(n² log n) (proposition 2 of Xu et al. 2015), space O(n²).
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
pub fn fwp_mmp(mesh: &Mesh, options: BucketOptions) -> Continuous<Trimming, Buckets> {
    Continuous::new(mesh, trimming(mesh), Buckets::new(mesh, options))
}

/// [`fwp_mmp`] with the due windows of a half-edge propagated together; O(faces).
///
/// The rounds are those of [`fwp_mmp`], except that a window that arrives at a list before the list
/// is taken in the same round does not wait for the next round. That makes more rounds.
///
/// ```
/// use geobench_fwp::{BucketOptions, fwp_mmp_batched};
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let distances = fwp_mmp_batched(&mesh, BucketOptions::default()).distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12); // Across the whole grid.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fwp_mmp_batched(mesh: &Mesh, options: BucketOptions) -> Batched<Buckets> {
    Batched::new(mesh, Buckets::new(mesh, options).of_lists())
}

/// Sets up FWP-CH for `mesh`: windows are filtered and not stored, and taken from buckets in
/// rounds; O(faces).
///
/// Time O(n²) (proposition 2 of Xu et al. 2015), space O(n²).
///
/// ```
/// use geobench_fwp::{BucketOptions, fwp_ch};
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let distances = fwp_ch(&mesh, BucketOptions::default()).distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12); // Across the whole grid.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fwp_ch(mesh: &Mesh, options: BucketOptions) -> Continuous<Splitting, Buckets> {
    Continuous::new(mesh, splitting(mesh), Buckets::new(mesh, options))
}

/// Sets up LC-MMP for `mesh`: windows are stored and trimmed on half-edges, and taken one at a time
/// from a label correcting queue; O(faces).
///
/// No useful bound on time; space O(n²).
///
/// ```
/// use geobench_fwp::{LabelCorrectingOptions, lc_mmp};
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let distances = lc_mmp(&mesh, LabelCorrectingOptions { beta: 1.0 }).distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12); // Across the whole grid.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn lc_mmp(
    mesh: &Mesh,
    options: LabelCorrectingOptions,
) -> Continuous<Trimming, LabelCorrecting> {
    Continuous::new(mesh, trimming(mesh), LabelCorrecting::new(options))
}

/// [`lc_mmp`] with the waiting windows of a half-edge propagated together; O(faces).
pub fn lc_mmp_batched(mesh: &Mesh, options: LabelCorrectingOptions) -> Batched<LabelCorrecting> {
    Batched::new(mesh, LabelCorrecting::new(options))
}

/// Sets up LC-CH for `mesh`: windows are filtered and not stored, and taken from a label correcting
/// queue; O(faces).
///
/// No useful bound on time and space.
///
/// ```
/// use geobench_fwp::{LabelCorrectingOptions, lc_ch};
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let distances = lc_ch(&mesh, LabelCorrectingOptions { beta: 1.0 }).distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12); // Across the whole grid.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn lc_ch(
    mesh: &Mesh,
    options: LabelCorrectingOptions,
) -> Continuous<Splitting, LabelCorrecting> {
    Continuous::new(mesh, splitting(mesh), LabelCorrecting::new(options))
}

/// Sets up VTP-MMP for `mesh`: windows are stored and trimmed on half-edges, released around the
/// nearest vertex, and taken one at a time; O(faces).
///
/// Space O(n²).
///
/// ```
/// use geobench_fwp::vtp_mmp;
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let distances = vtp_mmp(&mesh).distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12); // Across the whole grid.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn vtp_mmp(mesh: &Mesh) -> Continuous<Trimming, VertexOrder> {
    Continuous::new(mesh, trimming(mesh), VertexOrder::new(mesh))
}

/// [`vtp_mmp`] with the windows of a half-edge propagated together; O(faces).
pub fn vtp_mmp_batched(mesh: &Mesh) -> Batched<VertexOrder> {
    Batched::new(mesh, VertexOrder::new(mesh))
}

/// Sets up VTP-CH for `mesh`: windows are filtered and not stored, and released around the nearest
/// vertex; O(faces).
///
/// Takes about the time of [`fwp_ch`]. Space O(n²).
///
/// ```
/// use geobench_fwp::vtp_ch;
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let distances = vtp_ch(&mesh).distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12); // Across the whole grid.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn vtp_ch(mesh: &Mesh) -> Continuous<Splitting, VertexOrder> {
    Continuous::new(mesh, splitting(mesh), VertexOrder::new(mesh))
}

fn trimming(mesh: &Mesh) -> Trimming {
    Trimming::new(mesh, Carrier::HalfEdge)
}

fn splitting(mesh: &Mesh) -> Splitting {
    Splitting::new(mesh, VertexFilter::On)
}
