//! The CH family: CH, ICH1, ICH and PCH, which filter and split windows and do not store them.
//!
//! Chen and Han (1990) grow a sequence tree of windows. Of all windows that cover the apex of a
//! triangle from one of its half-edges, only the best may have two children ("one angle, one
//! split"). Xin and Wang, "Improving Chen and Han's algorithm on the discrete geodesic problem"
//! (2009), improve it in two ways. A window is dropped if a path through a known vertex beats all
//! of its rays ([`geobench_window::is_beaten_from_ends`]). Windows are taken by their least
//! distance. Only the queue and a record for each angle and vertex are stored, so memory is the
//! peak of the queue.
//!
//! # Example
//!
//! [`ich_fast`] finds the distances of all vertices; every function returns a solver that is set up
//! once:
//!
//! ```
//! use geobench_ich::ich_fast;
//! use geobench_mesh::Mesh;
//! use geobench_window::Solver;
//!
//! let mesh = Mesh::generate("sphere,subdiv=3")?;
//! let mut solver = ich_fast(&mesh);
//! let from_pole = solver.distances_from(0)?;
//! let nearest_of_two = solver.distances_from([0, 100])?;
//! let mut pairs = nearest_of_two.iter().zip(&from_pole);
//! assert!(pairs.all(|(both, one)| *both <= one + 1e-12));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Which one
//!
//! | function | windows are taken | time and space in the worst case |
//! |---|---|---|
//! | [`ch`] | breadth first, none is filtered | O(n²), O(n) |
//! | [`ich1`] | breadth first, filtered | O(n²), O(n) |
//! | [`ich`] | by least distance, filtered | O(n² log n), O(n²) |
//! | [`ich_fast`] | the same, eight at a time from a calendar queue | the same |
//! | [`Pch`] | the same, many at a time on several threads | the same |
//!
//! n is the number of faces. [`Splitting`] is the policy of all but [`Pch`]: what happens to a
//! window. The order is a [`Discipline`] of `geobench_window`, so that `geobench-fwp` makes FWP-CH
//! and LC-CH of the same policy. All find the same distances, exact up to rounding.

mod angle;
mod parallel;
mod route;
mod splitting;
mod tree;

use geobench_mesh::Mesh;
use geobench_window::VertexFilter;
use geobench_window::continuous::Continuous;
use geobench_window::queue::{CalendarQueue, Discipline, Fifo, HeapQueue};

pub use parallel::Pch;
pub use splitting::Splitting;

/// CH or ICH1: windows are taken breadth first.
pub type Ch = Continuous<Splitting, Fifo>;

/// ICH: windows are taken by least distance, from a heap unless `Q` is another queue.
pub type Ich<Q = HeapQueue> = Continuous<Splitting, Q>;

/// ICH with every improvement of time.
pub type IchFast = Continuous<Splitting<true>, CalendarQueue>;

/// Sets up the algorithm of Chen and Han for `mesh`; O(faces).
///
/// The sequence tree grows level by level, to as many levels as the mesh has faces, because only
/// one angle, one split ends a branch. It is for small meshes: some 10,000 faces take half a minute
/// and 300 million windows. Time O(n²), space O(n) for n faces.
///
/// ```
/// use geobench_ich::ch;
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let distances = ch(&mesh).distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12); // Across the whole grid.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn ch(mesh: &Mesh) -> Ch {
    Continuous::new(
        mesh,
        Splitting::new(mesh, VertexFilter::Off),
        Fifo::default(),
    )
}

/// Sets up ICH1 of Xin and Wang (2009) for `mesh`: the algorithm of Chen and Han with the vertex
/// filter; O(faces).
///
/// It needs no priority queue, and propagates one to three times as many windows as [`ich`]. Time
/// O(n²), space O(n) for n faces.
///
/// ```
/// use geobench_ich::ich1;
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let distances = ich1(&mesh).distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12); // Across the whole grid.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn ich1(mesh: &Mesh) -> Ch {
    Continuous::new(
        mesh,
        Splitting::new(mesh, VertexFilter::On),
        Fifo::default(),
    )
}

/// Sets up ICH for `mesh`, which is ICH2 of Xin and Wang (2009): the vertex filter, and windows by
/// least distance; O(faces).
///
/// Time O(n² log n), space O(n²) for n faces.
///
/// ```
/// use geobench_ich::ich;
/// use geobench_mesh::Mesh;
/// use geobench_window::{Counter, Solver};
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let mut solver = ich(&mesh);
/// let (solution, counters) = solver.count(&[5.into()])?;
/// assert_eq!(solution.distances[5], 0.0);
/// assert!(counters.get(Counter::Filtered) > Some(0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn ich(mesh: &Mesh) -> Ich {
    ich_from(mesh, HeapQueue::default())
}

/// [`ich`] with windows taken from `queue`; O(faces).
pub fn ich_from<Q: Discipline>(mesh: &Mesh, queue: Q) -> Ich<Q> {
    Continuous::new(mesh, Splitting::new(mesh, VertexFilter::On), queue)
}

/// Sets up [`ich`] for `mesh` with a calendar queue, and with windows that cross their triangles
/// eight at a time; O(faces).
///
/// The windows are those of [`ich`], in less than half the time; the bounds are the same.
///
/// ```
/// use geobench_ich::{ich, ich_fast};
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let (_, paper) = ich(&mesh).count(&[5.into()])?;
/// let (_, fast) = ich_fast(&mesh).count(&[5.into()])?;
/// assert!(fast.iter().eq(paper.iter()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn ich_fast(mesh: &Mesh) -> IchFast {
    Continuous::new(
        mesh,
        Splitting::new(mesh, VertexFilter::On).jointly(),
        CalendarQueue::new(mesh),
    )
}
