//! Exact geodesic distances on triangle meshes.
//!
//! A [`Mesh`] is read from a file, built from arrays or made by a generator.
//! [`Distances::distances_from`] returns the length of the shortest path over the surface from a
//! vertex to every vertex:
//!
//! ```
//! use geodesics::{Distances, Mesh};
//!
//! // A unit square, cut in two along a diagonal.
//! let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
//! let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]])?;
//! let distances: Vec<f64> = mesh.distances_from(1)?;
//! assert!((distances[3] - 2.0_f64.sqrt()).abs() < 1e-12); // Across the diagonal edge.
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Distances::path`] returns such a path, as points on vertices and edges:
//!
//! ```
//! use geodesics::{Distances, Mesh};
//!
//! let mesh = Mesh::generate("grid,n=8")?;
//! let path = mesh.path(0, 17)?.expect("the grid is in one piece");
//! let line: Vec<[f64; 3]> = path.polyline(&mesh);
//! assert_eq!(line[0], mesh.positions()[0]);
//! assert_eq!(path.edges().count() + 2, line.len()); // It passes no vertex on its way.
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Distances::isolines`] returns the points at given distances, as arcs of circles in faces:
//!
//! ```
//! use geodesics::{Distances, Mesh};
//!
//! let mesh = Mesh::generate("sphere,subdiv=3")?;
//! let isolines = mesh.isolines(0, &[0.5, 1.5])?;
//! let equator = &isolines[1].lines[0];
//! assert!(equator.closed && (equator.length() - 6.2).abs() < 0.1);
//! // Chords at most a thousandth from the arcs.
//! let line: Vec<[f64; 3]> = equator.polyline(&mesh, 1e-3);
//! assert_eq!(line.first(), line.last());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! For several queries keep a solver. It is set up once for a mesh, owns its data, and solves for
//! one source after another, or for the nearest of several:
//!
//! ```
//! use geodesics::{Mesh, Solver, VtpFast};
//!
//! let mesh = Mesh::generate("torus,faces=2000")?; // Or `Mesh::read("bunny.ply")?`.
//! let mut solver = VtpFast::new(&mesh);
//! let one = solver.distances_from(0)?;
//! let nearest_of_two = solver.distances_from([0, 500])?;
//! assert!(nearest_of_two[500] == 0.0 && one[500] > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Sources need not be vertices. A [`SurfacePoint`] is at a vertex, on an edge or in a face. It can
//! be the point nearest to a position in space:
//!
//! ```
//! use geodesics::{Distances, Mesh, SurfacePoint, SurfaceSolver};
//!
//! let mesh = Mesh::generate("sphere,subdiv=2")?;
//! let inside = mesh.point_in_face(7.into(), [0.2, 0.3, 0.5])?;
//! let (pole, off) = mesh.nearest_point([0.0, 0.0, 2.0])?;
//! assert!(off >= 1.0);
//! let distances = mesh.distances_from([inside, pole])?; // From the nearer one.
//! assert_eq!(distances.len(), mesh.vertex_count());
//!
//! // A solver that is set up once starts and ends anywhere, as fast as at vertices.
//! let mut solver = SurfaceSolver::new(&mesh);
//! let path = solver.path(inside, pole)?.expect("the sphere is in one piece");
//! let between = solver.distances_to(inside, pole, f64::INFINITY)?[0];
//! assert!((path.length - between).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A source can be a [`Curve`]: a polyline on the surface, a loop, a border. Distances are exact
//! from every point of it:
//!
//! ```
//! use geodesics::{Curve, Mesh, Stop, distances_from_curves};
//!
//! let mesh = Mesh::generate("grid,n=4")?;
//! let from = |curves: &[Curve]| {
//!     distances_from_curves(&mesh, curves, f64::INFINITY, &Stop::default())
//! };
//! let border: Vec<f64> = from(&mesh.borders())?;
//! assert!((border[12] - 2.0).abs() < 1e-12); // In the middle of the grid.
//!
//! let inside = mesh.point_in_face(0.into(), [0.2, 0.3, 0.5])?;
//! let corner = mesh.face_vertices(0.into())[2];
//! let line = from(&[Curve::new([inside, corner.into()])])?;
//! assert_eq!(line[corner.index()], 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Diagram`] divides the surface among several sources. [`Certificate`] proves the error of
//! distances:
//!
//! ```
//! use geodesics::{Certificate, Diagram, FieldSolver, Mesh, WindowVtp};
//!
//! let mesh = Mesh::generate("grid,n=4")?;
//! let corners = [0.into(), 24.into()];
//! let mut solver = WindowVtp::new(&mesh);
//! let diagram = Diagram::new(&solver.field(&corners)?, corners.len());
//! assert!((diagram.cells()[0].area - 8.0).abs() < 1e-12);
//! assert!(Certificate::of(&mesh, &corners)?.relative() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`remesh`] builds a mesh with evenly spread vertices:
//!
//! ```
//! use geodesics::{Mesh, Quality, RemeshOptions, remesh};
//!
//! let mesh = Mesh::generate("sphere,subdiv=4")?;
//! let options = RemeshOptions { sites: 100, lloyd: 3, seed: 0 };
//! let even = remesh(&mesh, &options)?.mesh;
//! assert_eq!(even.face_count(), 2 * 100 - 4);
//! assert!(Quality::of(&even).least_angle > 30.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Contents
//!
//! * [`Mesh`]: reading, building and querying meshes. [`io`] reads and writes files, [`generate`]
//!   makes models, [`Mesh::from_soup`] reports every defect that it finds or repairs.
//! * [`SurfaceSolver`], a solver for points anywhere on the surface; [`DistanceField`], the
//!   distance of every point after one solve, with paths, gradients and isolines.
//! * [`VtpFast`], the fastest solver, and [`Pvtp`], the same on several threads.
//! * [`solvers`]: all solvers, with the names of the papers.
//! * [`Paths`]: the shortest paths to many vertices, from one run of a solver. [`line()`]: the
//!   straightest geodesic in a given direction.
//! * [`Diagram`]: geodesic Voronoi diagrams. [`remesh`]: new meshes; [`Quality`] and
//!   [`SurfaceDeviation`] measure them. [`Certificate`]: proofs of distances.
//! * [`Solver`]: the interface of all solvers. It also counts windows and samples phases.
//! * [`mesh`](mod@mesh), [`window`], [`mmp`], [`ich`], [`fwp`], [`vtp`], [`paths`], [`isolines`],
//!   [`voronoi`], [`certify`]: the crates of the suite, with the parts from which solvers are
//!   built. What is in these modules only may change in any version; what is at the root changes
//!   with the version of the crate.
//! * [`approx`]: approximate solvers for comparison, such as fast marching; the heat method with
//!   the feature `heat`.
//!
//! # Accuracy, errors and time
//!
//! * Distances are exact up to rounding, about 1e-12 of their size. They are never NaN. They are
//!   infinite where no path leads.
//! * Vertex numbers are those of the file, from 0. [`Weld`] makes vertices at one place one vertex;
//!   a copy has the distance of the vertex that stands for it.
//! * Boundaries, several components, isolated and pinched vertices, edges with more than two faces
//!   and surfaces that cannot be oriented are supported. On the last two the MMP and CH kinds run;
//!   other solvers return a [`SolveError`].
//! * A source that is not on the mesh, or no source at all, is a [`SolveError`]. A point that does
//!   not exist is a [`PointError`].
//! * The time of a solve grows with the number of windows, up to the power 1.5 of the number of
//!   faces: some 20 ms for 20,000 faces, one to several seconds for a million.

mod certificate;
mod surface_solver;

pub use geobench_approx as approx;
pub use geobench_certify as certify;
pub use geobench_fwp as fwp;
pub use geobench_ich as ich;
pub use geobench_isolines as isolines;
pub use geobench_mesh as mesh;
pub use geobench_mmp as mmp;
pub use geobench_paths as paths;
pub use geobench_voronoi as voronoi;
pub use geobench_vtp as vtp;
pub use geobench_window as window;

use geobench_mmp::mmp_fast;

pub use certificate::{Certificate, CertificateError, Judgement, OriginalFailure};
pub use geobench_certify::FailurePlace;
pub use geobench_isolines::{
    CircleArc, DistanceField, FieldError, Isoline, Line, QueryError, TooManyLevels,
};
pub use geobench_mesh::{
    Curve, CurveError, InvalidMesh, Mesh, MeshError, NearestPoint, Place, PointError, Refined,
    SurfacePoint, TriangleSoup, VertexId, Weld, WeldError, generate, io,
};
pub use geobench_mmp::{CurveSourceError, distances_from_curves};
pub use geobench_paths::{LineError, Path, PathError, PathPlace, Paths, line};
pub use geobench_voronoi::{
    Diagram, Dual, FieldSolver, Quality, RemeshError, RemeshOptions, Remeshed, SurfaceDeviation,
    WindowVtp, remesh,
};
pub use geobench_vtp::{Pvtp, VtpFast};
pub use geobench_window::{Goal, Solution, SolveError, Solver, Sources, Stop};
pub use surface_solver::SurfaceSolver;

/// All exact solvers, named as in their papers and in the benchmark.
///
/// Each follows its paper. `mmp_fast`, [`VtpFast`] and [`Pvtp`] are faster forms, and
/// `..._batched` propagates the windows of a half-edge together. They differ in time, memory and
/// the number of windows. `docs/algorithms` has a page for each.
///
/// ```
/// use geodesics::solvers::{BucketOptions, Vtp, fwp_ch, ich, mmp};
/// use geodesics::{Mesh, Solver};
///
/// let mesh = Mesh::generate("sphere,subdiv=2")?;
/// let solvers: [Box<dyn Solver>; 4] = [
///     Box::new(mmp(&mesh)),
///     Box::new(ich(&mesh)),
///     Box::new(fwp_ch(&mesh, BucketOptions::default())),
///     Box::new(Vtp::new(&mesh)),
/// ];
/// let pole = |mut solver: Box<dyn Solver>| solver.solve(&[0.into()]).map(|s| s.distances[3]);
/// let found = solvers.into_iter().map(pole).collect::<Result<Vec<_>, _>>()?;
/// assert!(found.iter().all(|d| (d - found[0]).abs() < 1e-12 * d));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub mod solvers {
    pub use geobench_fwp::{
        BatchSize, BucketOptions, LabelCorrectingOptions, fwp_ch, fwp_mmp, fwp_mmp_batched, lc_ch,
        lc_mmp, lc_mmp_batched, vtp_ch, vtp_mmp, vtp_mmp_batched,
    };
    pub use geobench_ich::{Pch, ch, ich, ich_fast, ich1};
    pub use geobench_mmp::{Retention, mmp, mmp_batched, mmp_edge, mmp_fast};
    pub use geobench_vtp::{
        EdgeBased, FastOptions, Ftp, Opftp, Opvtp, Pvtp, Vtp, VtpExhaustive, VtpFast, VtpNoRule1,
        VtpNoRules23, VtpTrimming,
    };
    pub use geobench_window::simd::Instructions;
}

/// One point of a surface or several: a vertex number, a [`VertexId`], a [`SurfacePoint`], or an
/// array or slice of any of these.
pub trait Points {
    /// The points.
    fn into_points(self) -> Vec<SurfacePoint>;
}

macro_rules! points {
    ($point:ty) => {
        impl Points for $point {
            fn into_points(self) -> Vec<SurfacePoint> {
                vec![self.into()]
            }
        }
    };
    ($list:ty, $($generics:tt)*) => {
        impl<$($generics)*> Points for $list {
            fn into_points(self) -> Vec<SurfacePoint> {
                self.iter().map(|&v| v.into()).collect()
            }
        }
    };
}

points!(u32);
points!(VertexId);
points!(SurfacePoint);
points!([P; N], P: Copy + Into<SurfacePoint>, const N: usize);
points!(&[P; N], P: Copy + Into<SurfacePoint>, const N: usize);
points!(&[P], P: Copy + Into<SurfacePoint>);
points!(&Vec<P>, P: Copy + Into<SurfacePoint>);

/// Distances, paths and isolines of a mesh, for a single query.
pub trait Distances {
    /// Length of the shortest path over the surface from the nearest of `sources` to every vertex,
    /// in the units and the order of the vertices of the mesh; infinite where no path leads.
    ///
    /// Sets up [`VtpFast`] for this one query, which adds about a third to the time; on a mesh with
    /// [junctions](Mesh::junction) [`mmp_fast`].
    ///
    /// # Errors
    ///
    /// If there is no source, or one that is not on the mesh.
    fn distances_from(&self, sources: impl Points) -> Result<Vec<f64>, SolveError>;

    /// The shortest path over the surface from the nearest of `sources` to `target`; `None` if no
    /// path leads there. The search ends when the distance of the target is final. For paths to
    /// several targets take [`Paths`], for several queries a [`SurfaceSolver`].
    ///
    /// ```
    /// use geodesics::{Distances, Mesh};
    ///
    /// let mesh = Mesh::generate("grid,n=4")?;
    /// let middle = mesh.point_in_face(0.into(), [0.25, 0.25, 0.5])?;
    /// let path = mesh.path(middle, 24)?.expect("the grid is in one piece");
    /// assert_eq!(path.points[0].face, Some(0.into()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If there is no source, or a source or the target is not on the mesh.
    fn path(
        &self,
        sources: impl Points,
        target: impl Into<SurfacePoint>,
    ) -> Result<Option<Path>, PathError>;

    /// The lines of points at each distance in `levels` from the nearest of `sources`: one
    /// [`Isoline`] for each level, in their order. A level that is not positive, or greater than
    /// all distances, has no lines.
    ///
    /// This stores all windows of MMP. It takes several times as long as distances of vertices, and
    /// much more memory: about a gigabyte for 300,000 faces. For several queries keep a
    /// [`DistanceField`].
    ///
    /// # Errors
    ///
    /// If there is no source, or one that is not on the mesh.
    fn isolines(&self, sources: impl Points, levels: &[f64]) -> Result<Vec<Isoline>, FieldError>;
}

impl Distances for Mesh {
    fn distances_from(&self, sources: impl Points) -> Result<Vec<f64>, SolveError> {
        let refined = self.with_points(&sources.into_points());
        let refined = refined.map_err(not_on_the_mesh)?;
        let mut solver = usual_solver(&refined.mesh);
        let mut distances = solver.solve(&refined.vertices)?.distances;
        distances.truncate(self.vertex_count());
        Ok(distances)
    }

    fn path(
        &self,
        sources: impl Points,
        target: impl Into<SurfacePoint>,
    ) -> Result<Option<Path>, PathError> {
        let target = target.into();
        if let Some(vertex) = target.vertex().filter(|v| v.index() >= self.vertex_count()) {
            let vertices = self.vertex_count();
            return Err(SolveError::NoSuchTarget { vertex, vertices }.into());
        }
        let mut points = sources.into_points();
        points.push(target);
        let refined = self.with_points(&points).map_err(not_on_the_mesh)?;
        let Some((&to, from)) = refined.vertices.split_last() else {
            return Err(SolveError::NoSource.into());
        };
        let mut solver = usual_solver(&refined.mesh);
        let paths = Paths::find(&mut *solver, &refined.mesh, from, &Goal::targets([to]))?;
        let path = paths.to(to)?;
        if refined.mesh.vertex_count() == self.vertex_count() {
            return Ok(path);
        }
        Ok(path.map(|path| path.of_original(&refined)))
    }

    fn isolines(&self, sources: impl Points, levels: &[f64]) -> Result<Vec<Isoline>, FieldError> {
        Ok(DistanceField::new(self, &sources.into_points())?.isolines(levels))
    }
}

fn usual_solver(mesh: &Mesh) -> Box<dyn Solver> {
    if mesh.has_junctions() {
        Box::new(mmp_fast(mesh))
    } else {
        Box::new(VtpFast::new(mesh))
    }
}

fn not_on_the_mesh(error: PointError) -> SolveError {
    match error {
        PointError::NoSuchVertex { vertex, vertices } => {
            SolveError::NoSuchVertex { vertex, vertices }
        }
        _ => SolveError::NoSuchPoint,
    }
}
