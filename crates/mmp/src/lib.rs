//! The MMP algorithm: continuous Dijkstra on windows that are stored on half-edges and trimmed
//! against each other at tie points.
//!
//! Mitchell, Mount and Papadimitriou, "The discrete geodesic problem" (1987), in the form of
//! Surazhsky et al., "Fast exact and approximate geodesics on meshes" (2005), section 3. The
//! windows of one half-edge never overlap: a new window is compared with those it meets, and each
//! keeps the range on which it is shorter.
//!
//! | function | form | stores | filter |
//! |---|---|---|---|
//! | [`mmp`] | one window at a time, nearest first; the papers' algorithm | all windows | none |
//! | [`mmp_edge`] | the same, trimming both half-edges of an edge together (Liu 2013) | all windows | none |
//! | [`mmp_batched`] | all due windows of a half-edge at a time | all windows | none |
//! | [`mmp_fast`] | the same with every improvement of time and memory | the windows around the wavefront | that of ICH |
//!
//! All forms find the same distances, because these do not depend on the order in which windows are
//! taken. Only the number of windows depends on it. [`Trimming`] is the policy of the single form,
//! and [`Batched`] the solver of the other. Each runs under any [`Discipline`];
//! `geobench-fwp` makes its algorithms that way.
//!
//! # Parts
//!
//! * **Retention** ([`Retention`]). The papers store every window until the end, so that the
//!   distance is known along every edge: O(n²) windows in the worst case, about n^1.5 in practice.
//!   Vertex distances do not need them. With [`Retention::Wavefront`] the windows of an edge are
//!   evicted once the wavefront has passed it. On the horse a twentieth of the windows remains.
//! * **Filter** ([`Batched::filtering`]). Drops windows that a path through an end of their edge
//!   beats, as ICH does, before the list is searched. It saves a twelfth of the propagations on the
//!   horse, and a third of propagations and time on models of some thousands of faces with many
//!   saddle vertices.
//! * **Batches** ([`Batched`]). With the windows of a half-edge taken together, a run on a scan
//!   takes a quarter to a half of the time, and propagates 0.3 to 1 % more windows.
//!
//! Nearest first, the time is O(n² log n) for n faces. No bound is known for batches with slack.

mod batched;
mod curves;
mod eviction;
mod single;

use geobench_mesh::Mesh;
use geobench_window::VertexFilter;
use geobench_window::continuous::Continuous;
use geobench_window::queue::{Discipline, HeapQueue};

pub use batched::{Batched, NearestLists};
pub use curves::{CurveSourceError, distances_from_curves};
pub use eviction::Retention;
pub use single::{Carrier, Trimming, windows_of};

/// MMP one window at a time, nearest first, from a heap unless `Q` is another queue.
pub type Mmp<Q = HeapQueue> = Continuous<Trimming, Q>;

/// Sets up MMP for `mesh` as in its papers: windows are taken one at a time, nearest first, trimmed
/// against those of their half-edge, and all stored; O(faces).
///
/// Time O(n² log n), space O(n²) for n faces.
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
pub fn mmp(mesh: &Mesh) -> Mmp {
    mmp_from(mesh, Carrier::HalfEdge, HeapQueue::default())
}

/// Sets up the edge-based variant of [`mmp`] for `mesh`; O(faces).
///
/// It stores fewer windows than [`mmp`], and does more work for each. The bounds are the same.
///
/// ```
/// use geobench_mmp::mmp_edge;
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let distances = mmp_edge(&mesh).distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12); // Across the whole grid.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn mmp_edge(mesh: &Mesh) -> Mmp {
    mmp_from(mesh, Carrier::Edge, HeapQueue::default())
}

/// [`mmp`] or [`mmp_edge`] with windows taken from `queue`; O(faces).
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_mmp::{Carrier, mmp_from};
/// use geobench_window::Solver;
/// use geobench_window::queue::CalendarQueue;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let mut solver = mmp_from(&mesh, Carrier::HalfEdge, CalendarQueue::new(&mesh));
/// assert_eq!(solver.distances_from(0)?[1], 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn mmp_from<Q: Discipline>(mesh: &Mesh, carrier: Carrier, queue: Q) -> Mmp<Q> {
    Continuous::new(mesh, Trimming::new(mesh, carrier), queue)
}

/// Sets up MMP for `mesh` with batches, the filter and eviction; O(faces).
///
/// This is the fastest form, with the least memory. Its distances are those of [`mmp`]. No bound on
/// its time is proven; space O(n²) for n faces.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_mmp::{mmp, mmp_fast};
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("torus,faces=800")?;
/// let [fast, paper] = [mmp_fast(&mesh).distances_from(0)?, mmp(&mesh).distances_from(0)?];
/// assert!(fast.iter().zip(&paper).all(|(a, b)| (a - b).abs() <= 1e-12 * b));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn mmp_fast(mesh: &Mesh) -> Batched<NearestLists> {
    mmp_batched(mesh, NearestLists::SLACK)
        .filtering(VertexFilter::On)
        .retaining(Retention::Wavefront)
}

/// [`mmp`] in batches: the nearest window is propagated together with those of its half-edge that
/// are at most `slack` mean edge lengths further, or less far [where many faces are
/// small](NearestLists::new); O(faces).
///
/// At a slack of 1, the [default](NearestLists::SLACK) of [`mmp_fast`], it propagates 0.3 to 1 %
/// more windows in half the time on scans. At a slack of 0 the order is that of [`mmp`], except for
/// windows at equal distances, and a run takes 1.1 to 1.8 times as long. A negative slack and NaN
/// count as 0.
///
/// ```
/// use geobench_mmp::mmp_batched;
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let distances = mmp_batched(&mesh, 0.5).distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12); // Across the whole grid.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn mmp_batched(mesh: &Mesh, slack: f64) -> Batched<NearestLists> {
    Batched::new(mesh, NearestLists::new(mesh, slack))
}
