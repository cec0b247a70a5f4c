//! Approximate forms of window algorithms, with a bound of the error.

use geobench_fwp::VertexOrder;
use geobench_ich::Splitting;
use geobench_mesh::Mesh;
use geobench_mmp::{Carrier, Retention, Trimming};
use geobench_window::VertexFilter;
use geobench_window::continuous::Continuous;
use geobench_window::queue::{Discipline, HeapQueue};

/// [`mmp_approx`] on one mesh: MMP with windows replaced by vertices, taken from a heap unless `Q`
/// is another queue.
pub type MmpApprox<Q = HeapQueue> = Continuous<Trimming, Q, true>;

/// [`avtp`] on one mesh: ICH in the order of VTP, with windows replaced by vertices.
pub type Avtp = Continuous<Splitting, VertexOrder, true>;

/// Sets up MMP for `mesh` with distances that are at most 1 + `epsilon` times the exact ones, and
/// never less; O(faces).
///
/// Every vertex sends windows, and is preferred to the windows that passed it, as
/// [`Continuous::relaying`] defines. The number of windows on an edge then depends on `epsilon`
/// and does not grow with the distance. Windows that the wavefront has passed are evicted.
///
/// ```
/// use geobench_approx::mmp_approx;
/// use geobench_mesh::Mesh;
/// use geobench_mmp::mmp;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("terrain,n=20,seed=1")?;
/// let [near, exact] = [mmp_approx(&mesh, 0.01).distances_from(0)?, mmp(&mesh).distances_from(0)?];
/// for (d, exact) in near.into_iter().zip(exact) {
///     assert!(exact * (1.0 - 1e-12) <= d && d <= exact * (1.01 + 1e-12));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn mmp_approx(mesh: &Mesh, epsilon: f64) -> MmpApprox {
    mmp_approx_from(mesh, epsilon, HeapQueue::default())
}

/// [`mmp_approx`] with windows taken from `queue`; O(faces).
pub fn mmp_approx_from<Q: Discipline>(mesh: &Mesh, epsilon: f64, queue: Q) -> MmpApprox<Q> {
    let policy = Trimming::new(mesh, Carrier::HalfEdge).retaining(Retention::Wavefront);
    Continuous::relaying(mesh, policy, queue, epsilon)
}

/// Sets up an approximate form of VTP-CH for `mesh`, with the bound of [`mmp_approx`]; O(faces).
pub fn avtp(mesh: &Mesh, epsilon: f64) -> Avtp {
    let policy = Splitting::new(mesh, VertexFilter::On);
    Continuous::relaying(mesh, policy, VertexOrder::new(mesh), epsilon)
}
