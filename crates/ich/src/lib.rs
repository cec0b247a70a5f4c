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
mod parallel;
mod splitting;
mod tree;

use geobench_mesh::Mesh;
use geobench_window::VertexFilter;
use geobench_window::continuous::Continuous;
use geobench_window::queue::{Fifo, Priority};

pub use parallel::Pch;
pub use splitting::Splitting;

/// CH on one mesh: no filter, breadth first.
pub type Ch = Continuous<Splitting, Fifo>;

/// An algorithm of the CH family that takes windows by least distance.
pub type Ich = Continuous<Splitting, Priority>;

/// Sets up the algorithm of Chen and Han for `mesh`; O(faces).
///
/// The sequence tree grows level by level, and to as many levels as the mesh has faces, since
/// nothing but one angle, one split ends a branch. It is for small meshes: some 10,000 faces take
/// half a minute and 300 million windows.
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

/// Sets up ICH1 of Xin and Wang for `mesh`, the algorithm of Chen and Han with the vertex filter;
/// O(faces).
///
/// It needs no priority queue, and takes one to three times the windows of [`ich`].
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

/// Sets up ICH, which is ICH2 of Xin and Wang, for `mesh`: the filter, and windows by least
/// distance; O(faces).
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
    Continuous::new(
        mesh,
        Splitting::new(mesh, VertexFilter::On),
        Priority::new(mesh),
    )
}
