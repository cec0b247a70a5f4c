//! A solver for points anywhere on the surface.

use geobench_mesh::{Insertion, Mesh, Refined, SurfacePoint};
use geobench_paths::{Path, PathError, Paths, Through};
use geobench_window::{Goal, SolveError, Solver, at_points};

use crate::{Points, not_on_the_mesh, usual_solver};

/// Sets up an algorithm for a mesh.
type SetUp = Box<dyn Fn(&Mesh) -> Box<dyn Solver> + Send>;

/// A solver for sources and targets anywhere on the surface, set up once.
///
/// Points on edges and in faces are inserted into the data of the solver for a run, and removed
/// after it. A run takes as long as one between vertices. A solver that cannot do so is set up anew
/// for each such run: [`SaddleVertexGraph`](crate::approx::SaddleVertexGraph) and
/// [`Vsp`](crate::approx::Vsp) where their documentation says so.
///
/// ```
/// use geodesics::{Mesh, SurfaceSolver};
///
/// let mesh = Mesh::generate("torus,faces=2000")?;
/// let mut solver = SurfaceSolver::new(&mesh);
/// let a = mesh.point_in_face(7.into(), [0.2, 0.3, 0.5])?;
/// let b = mesh.point_in_face(900.into(), [0.6, 0.1, 0.3])?;
/// let from_a: Vec<f64> = solver.distances_from(a)?;
/// let between = solver.distances_to(a, b, f64::INFINITY)?[0];
/// let path = solver.path(a, b)?.expect("the torus is in one piece");
/// assert!((path.length - between).abs() < 1e-12 && from_a.len() == mesh.vertex_count());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SurfaceSolver {
    mesh: Mesh,
    solver: Box<dyn Solver>,
    set_up: SetUp,
}

impl SurfaceSolver {
    /// Sets up [`VtpFast`](crate::VtpFast), or [`mmp_fast`](crate::solvers::mmp_fast) on a mesh
    /// with [junctions](Mesh::junction); O(faces).
    pub fn new(mesh: &Mesh) -> Self {
        Self::with(mesh, usual_solver)
    }

    /// Sets up another algorithm, as `|mesh| Box::new(mmp(mesh))`. `set_up` is called again for
    /// runs at points that the solver cannot insert.
    pub fn with(mesh: &Mesh, set_up: impl Fn(&Mesh) -> Box<dyn Solver> + Send + 'static) -> Self {
        Self {
            mesh: mesh.clone(),
            solver: set_up(mesh),
            set_up: Box::new(set_up),
        }
    }

    /// Distances of all vertices from the nearest of `sources`, in the order and the units of the
    /// mesh; infinite where no path leads.
    ///
    /// # Errors
    ///
    /// If there is no source, or one that is not on the mesh.
    pub fn distances_from(&mut self, sources: impl Points) -> Result<Vec<f64>, SolveError> {
        self.distances_within(sources, f64::INFINITY)
    }

    /// Distances of all vertices from the nearest of `sources`, as far as they are at most
    /// `radius`; others are infinite. The search ends at the radius.
    ///
    /// # Errors
    ///
    /// As [`distances_from`](Self::distances_from).
    pub fn distances_within(
        &mut self,
        sources: impl Points,
        radius: f64,
    ) -> Result<Vec<f64>, SolveError> {
        let vertices = self.mesh.vertex_count();
        let goal = Goal::everything().within(radius);
        let insertion = self.insertion(&sources.into_points())?;
        let solution = self.at(insertion, |solver, refined| {
            solver.solve_until(&refined.vertices, &goal)
        })?;
        let mut distances = solution.distances;
        distances.truncate(vertices);
        Ok(distances)
    }

    /// Distances of `targets`, in their order, from the nearest of `sources`; infinite beyond
    /// `radius` and where no path leads. The search ends when all are known.
    ///
    /// # Errors
    ///
    /// As [`distances_from`](Self::distances_from), or if a target is not on the mesh.
    pub fn distances_to(
        &mut self,
        sources: impl Points,
        targets: impl Points,
        radius: f64,
    ) -> Result<Vec<f64>, SolveError> {
        let sources = sources.into_points();
        let points = [&sources[..], &targets.into_points()].concat();
        let insertion = self.insertion(&points)?;
        self.at(insertion, |solver, refined| {
            let (from, to) = refined.vertices.split_at(sources.len());
            let goal = Goal::targets(to.iter().copied()).within(radius);
            let found = solver.solve_until(from, &goal)?.distances;
            Ok(to.iter().map(|v| found[v.index()]).collect())
        })
    }

    /// The shortest path from the nearest of `sources` to `target`; `None` if no path leads there.
    ///
    /// # Errors
    ///
    /// As [`distances_to`](Self::distances_to). [`SolveError::NoPaths`] if the algorithm traces no
    /// paths.
    pub fn path(
        &mut self,
        sources: impl Points,
        target: impl Into<SurfacePoint>,
    ) -> Result<Option<Path>, PathError> {
        let mut points = sources.into_points();
        points.push(target.into());
        let insertion = self.insertion(&points)?;
        let is_refined = !insertion.is_empty();
        self.at(insertion, |solver, refined| {
            let Some((&to, from)) = refined.vertices.split_last() else {
                return Err(SolveError::NoSource.into());
            };
            let paths = Paths::find(solver, &refined.mesh, from, &Goal::targets([to]))?;
            let path = paths.to(to)?;
            Ok(path.map(|path| {
                if is_refined {
                    path.of_original(refined)
                } else {
                    path
                }
            }))
        })
    }

    /// The shortest path from the first of `points` to the second, from there to the third, and so
    /// on; if `closed` back to the first. `None` if no path leads from one to the next.
    ///
    /// ```
    /// use geodesics::{Mesh, SurfaceSolver};
    ///
    /// let mesh = Mesh::generate("grid,n=4")?;
    /// let mut solver = SurfaceSolver::new(&mesh);
    /// let around = solver.path_through([0, 4, 24], true)?.expect("the grid is in one piece");
    /// assert!((around.length - (8.0 + 32.0_f64.sqrt())).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`path`](Self::path). [`SolveError::NoSource`] for fewer than two points.
    pub fn path_through(
        &mut self,
        points: impl Points,
        closed: bool,
    ) -> Result<Option<Path>, PathError> {
        let shorten = false;
        self.through(&points.into_points(), Through { closed, shorten })
    }

    /// A locally shortest path: as [`path_through`](Self::path_through), but the path leaves the
    /// points where that makes it [shorter](Path::shortened). An open path keeps its ends. A closed
    /// one becomes a closed geodesic, or a single point if it contracts to that. After Sharp and
    /// Crane (2020).
    ///
    /// ```
    /// use geodesics::{Mesh, SurfaceSolver};
    ///
    /// // A belt around a cube, at one height.
    /// let mesh = Mesh::generate("cube,n=3")?;
    /// let [low, high] = mesh.bounding_box().expect("it has positions");
    /// let at = |x: f64, y: f64, z: f64| {
    ///     let t = [x, y, z];
    ///     let place = [0, 1, 2].map(|k| low[k] + t[k] * (high[k] - low[k]));
    ///     mesh.nearest_point(place).map(|found| found.0)
    /// };
    /// let ways = [at(0.5, 0.0, 0.4)?, at(1.0, 0.5, 0.6)?, at(0.5, 1.0, 0.5)?, at(0.0, 0.5, 0.6)?];
    /// let mut solver = SurfaceSolver::new(&mesh);
    /// let belt = solver.shortened_path(ways, true)?.expect("it is in one piece");
    /// let around = 2.0 * (high[0] - low[0] + high[1] - low[1]);
    /// assert!((belt.length - around).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`path_through`](Self::path_through).
    pub fn shortened_path(
        &mut self,
        points: impl Points,
        closed: bool,
    ) -> Result<Option<Path>, PathError> {
        let shorten = true;
        self.through(&points.into_points(), Through { closed, shorten })
    }

    fn through(
        &mut self,
        points: &[SurfacePoint],
        through: Through,
    ) -> Result<Option<Path>, PathError> {
        if points.len() < 2 {
            return Err(SolveError::NoSource.into());
        }
        let insertion = self.insertion(points)?;
        self.at(insertion, |solver, refined| {
            through.path(refined, &refined.vertices, |[from, to]| {
                Paths::find(solver, &refined.mesh, from, &Goal::targets([to]))?
                    .to(to)
                    .map_err(PathError::from)
            })
        })
    }

    /// The [logarithmic map](Paths::log_map) at `source`: for each vertex the point of the plane at
    /// its distance and in the direction in which a shortest path to it starts; NaN for unreachable
    /// ones. Angles at vertices are those of Polthier and Schmies (1998).
    ///
    /// ```
    /// use geodesics::{Mesh, SurfaceSolver};
    ///
    /// let mesh = Mesh::generate("sphere,subdiv=3")?;
    /// let map = SurfaceSolver::new(&mesh).log_map(0)?;
    /// let farthest = map.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
    /// assert!((farthest - std::f64::consts::PI).abs() < 0.05);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the source is not on the mesh. [`SolveError::NoPaths`] if the algorithm traces no paths.
    pub fn log_map(
        &mut self,
        source: impl Into<SurfacePoint>,
    ) -> Result<Vec<[f64; 2]>, SolveError> {
        let source = source.into();
        let insertion = self.insertion(&[source])?;
        self.at(insertion, |solver, refined| {
            let goal = Goal::everything();
            let paths = Paths::find(solver, &refined.mesh, &refined.vertices, &goal)?;
            Ok(paths.log_map(&source, refined))
        })
    }

    fn insertion(&self, points: &[SurfacePoint]) -> Result<Insertion, SolveError> {
        self.mesh.insertion(points).map_err(not_on_the_mesh)
    }

    fn at<T>(
        &mut self,
        insertion: Insertion,
        run: impl FnOnce(&mut dyn Solver, &Refined) -> T,
    ) -> T {
        at_points(
            &mut *self.solver,
            insertion,
            |mesh| (self.set_up)(mesh),
            run,
        )
    }
}
