//! The named algorithms: combinations of the four choices of [`ListPropagation`].

use geobench_mesh::Mesh;

use crate::{
    AcrossTheFace, AllPairs, AnyExit, EveryPath, ListPropagation, NearestFace, NearestVertex,
    Neighbours, NoPairs, OneAngleTwoSides, OrderFree, OrderPreserving, TrimmedNeighbours,
};

/// VTP (Qin et al. 2016, sections 4 and 5.2): the faces around the nearest vertex join the
/// traversed area, and lists are pruned by the vertex filter and rules 1, 2 and 3.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_vtp::Vtp;
/// use geobench_window::Solver;
///
/// let mut solver = Vtp::new(&Mesh::generate("terrain,n=8,seed=1")?);
/// for source in 0..3 {
///     assert_eq!(solver.distances_from(source)?[source as usize], 0.0);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Time O(n²) apart from the queue of vertices, space O(n²) for n faces.
///
/// Two steps differ from the paper:
///
/// * **Rule 1.** Proposition 4.1 drops a window's whole side by comparing separating points. That
///   is unsound where intervals overlap: taken literally, it gives wrong distances at 1,040 of
///   49,970 vertices of one scan. Here a window is cut where the best path to the apex enters the
///   triangle. It loses the rest only if that path provably crosses all of it.
/// * **Rules 2 and 3.** All neighbours are compared at once, before any cut. Then those are
///   compared that a deletion has made adjacent, until no window is deleted. The paper traverses
///   the list from one end. Every cut is justified by a real path, also if the winner is cut later,
///   so both forms are exact.
pub type Vtp = ListPropagation<NearestVertex, OrderFree, Neighbours, OneAngleTwoSides>;

/// [`Vtp`] with order-preserving secondary merges (Qin et al. 2016, section 5.1).
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_vtp::{Opvtp, Vtp};
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let [a, b] = [Opvtp::new(&mesh).distances_from(5)?, Vtp::new(&mesh).distances_from(5)?];
/// assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= 1e-12 * b));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type Opvtp = ListPropagation<NearestVertex, OrderPreserving, Neighbours, OneAngleTwoSides>;

/// FTP (Qin et al. 2016, section 5.1): as [`Vtp`], but one face joins at a time, the one whose far
/// vertex the waiting windows reach on the shortest path.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_vtp::Ftp;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let distances = Ftp::new(&mesh).distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12); // Across the whole grid.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type Ftp = ListPropagation<NearestFace, OrderFree, Neighbours, OneAngleTwoSides>;

/// [`Ftp`] with order-preserving secondary merges.
pub type Opftp = ListPropagation<NearestFace, OrderPreserving, Neighbours, OneAngleTwoSides>;

/// The edge-based algorithm of chapter 5 of the transfer report that preceded the paper: as
/// [`Vtp`], and no ray crosses the shortest path across the face that came through one of its other
/// edges.
///
/// The report has no vertex filter. Without one, windows that run back behind the wavefront meet no
/// others and need not end. So this form has the filter as well.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_vtp::EdgeBased;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let distances = EdgeBased::new(&mesh).distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type EdgeBased = ListPropagation<NearestVertex, OrderFree, Neighbours, AcrossTheFace>;

/// As [`Vtp`], but compares every pair of windows, and every path to a vertex of the face (Qin et
/// al. 2016, section 6.2, and cases 1 to 12 of section 3). Takes O(k²) for a list of k windows, and
/// O(n³) in all for n faces.
///
/// Cases 8 and 10 as printed delete more than is proved. They have the form of rule 1 in [`Vtp`].
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_vtp::{Vtp, VtpExhaustive};
/// use geobench_window::{Counter, Solver};
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let (_, of_all) = VtpExhaustive::new(&mesh).count(&[5.into()])?;
/// let (_, of_neighbours) = Vtp::new(&mesh).count(&[5.into()])?;
/// assert!(of_all.get(Counter::Propagated) <= of_neighbours.get(Counter::Propagated));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type VtpExhaustive = ListPropagation<NearestVertex, OrderFree, AllPairs, EveryPath>;

/// As [`Vtp`], but neighbours are also cut at their tie points, as in MMP (Qin et al. 2016, section
/// 6.2).
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_vtp::VtpTrimming;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let distances = VtpTrimming::new(&mesh).distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type VtpTrimming =
    ListPropagation<NearestVertex, OrderFree, TrimmedNeighbours, OneAngleTwoSides>;

/// [`Vtp`] without rule 1, for ablation (Qin et al. 2016, section 6.2): each window is tried at
/// both exits.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_vtp::{Vtp, VtpNoRule1};
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let [a, b] = [VtpNoRule1::new(&mesh).distances_from(5)?, Vtp::new(&mesh).distances_from(5)?];
/// assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= 1e-12 * b));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type VtpNoRule1 = ListPropagation<NearestVertex, OrderFree, Neighbours, AnyExit>;

/// [`Vtp`] without rules 2 and 3, for ablation (Qin et al. 2016, section 6.2): no two windows are
/// compared.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_vtp::{Vtp, VtpNoRules23};
/// use geobench_window::{Counter, Solver};
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let (_, without) = VtpNoRules23::new(&mesh).count(&[5.into()])?;
/// let (_, with) = Vtp::new(&mesh).count(&[5.into()])?;
/// assert!(without.get(Counter::Propagated) >= with.get(Counter::Propagated));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type VtpNoRules23 = ListPropagation<NearestVertex, OrderFree, NoPairs, OneAngleTwoSides>;

/// Constructors without type parameters, so that the code of the named algorithms is made in this
/// crate ([`CompiledRuns`](geobench_window::CompiledRuns)).
macro_rules! set_up {
    ($($algorithm:ident)*) => {$(
        impl $algorithm {
            /// Sets up for `mesh`; O(faces).
            pub fn new(mesh: &Mesh) -> Self {
                Self::with_choices(mesh)
            }
        }
    )*};
}

set_up!(Vtp Opvtp Ftp Opftp EdgeBased VtpExhaustive VtpTrimming VtpNoRule1 VtpNoRules23);
