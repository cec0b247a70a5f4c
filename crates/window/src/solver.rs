//! The interface between callers and algorithms.

use std::borrow::Cow;
use std::collections::HashSet;
use std::fmt;

use geobench_mesh::{Mesh, Splice, VertexId};

use crate::connected::reach_over_edges;
use crate::counters::{Counter, Counters};
use crate::goal::{Goal, Until};
use crate::origins::Origins;
use crate::phases::{PhaseProbe, PhaseSampler};
use crate::probe::{Count, Probe};
use crate::wavefront::Fronts;

/// The result of a run.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Solution {
    /// Geodesic distance of every vertex from the nearest source, in the units of the mesh and
    /// the order of its vertices; infinite where no path leads. Never NaN.
    pub distances: Vec<f64>,
    /// Number of vertices, sources aside, whose distance an approximate algorithm found negative,
    /// and set to 0.
    pub negative: usize,
}

impl Solution {
    /// A solution with these distances, none of which was negative.
    pub const fn new(distances: Vec<f64>) -> Self {
        Self {
            distances,
            negative: 0,
        }
    }
}

/// Why a solve fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// The list of sources is empty.
    #[error("no source is given; name at least one vertex")]
    NoSource,
    /// A source is not a vertex of the mesh.
    #[error(
        "source vertex {vertex} does not exist: the mesh has {vertices} vertices, numbered from 0"
    )]
    NoSuchVertex {
        /// The vertex asked for.
        vertex: VertexId,
        /// Number of vertices of the mesh.
        vertices: usize,
    },
    /// A target is not a vertex of the mesh.
    #[error(
        "target vertex {vertex} does not exist: the mesh has {vertices} vertices, numbered from 0"
    )]
    NoSuchTarget {
        /// The vertex asked for.
        vertex: VertexId,
        /// Number of vertices of the mesh.
        vertices: usize,
    },
    /// The algorithm does not record where paths come from.
    #[error(
        "this algorithm traces no paths; choose an exact one that does, such as vtp-fast or mmp"
    )]
    NoPaths,
    /// The mesh has edges with more than two faces, and the algorithm is not known to be exact
    /// there.
    #[error("edges with more than two faces: use mmp-fast")]
    EdgesOfManyFaces,
    /// The mesh cannot be oriented, and the algorithm is not known to be exact there.
    #[error("a surface that cannot be oriented: use mmp-fast")]
    NotOrientable,
    /// The mesh has edges with more than two faces, and no diagram continues there.
    #[error(
        "edges with more than two faces, which Voronoi diagrams and remeshing do not cross: split \
         the surface there (give each sheet vertices of its own, which --weld would join), or use \
         the commands distance, path or isolines, whose usual algorithm crosses them"
    )]
    DiagramAtManyFaces,
    /// The mesh cannot be oriented, and diagrams need an orientation.
    #[error(
        "a surface that cannot be oriented, on which Voronoi diagrams and remeshing do not work: \
         cut it open (give both sides of a cut vertices of their own, which --weld would join), or \
         use the commands distance, path or isolines, whose usual algorithm solves it"
    )]
    DiagramNotOrientable,
    /// A source or target is a point that this mesh does not have.
    #[error("a source or target is no point of this mesh; ask this mesh for its points")]
    NoSuchPoint,
    /// Set-up did not find the memory for the factors of the solver's matrices.
    #[error(
        "there is no memory for the factors of the matrices of this mesh; choose another algorithm"
    )]
    NoFactor,
    /// The system did not start the threads of a parallel algorithm.
    #[error("the system does not start {threads} threads; ask for fewer, or raise its limits")]
    NoThreads {
        /// Number of threads asked for.
        threads: usize,
    },
    /// The distances could not be certified.
    #[error(
        "an error of 1e{exponent} of a distance is not excluded; `geobench certify` says where"
    )]
    NotCertified {
        /// The relative error is at most 10 to this power.
        exponent: i32,
    },
}

impl SolveError {
    /// What keeps an algorithm that crosses no [junctions](Mesh::junction) from solving `mesh`;
    /// `None` if it has none.
    pub fn at_junctions(mesh: &Mesh) -> Option<Self> {
        if mesh.has_edges_of_many_faces() {
            Some(Self::EdgesOfManyFaces)
        } else {
            mesh.has_junctions().then_some(Self::NotOrientable)
        }
    }

    /// As [`at_junctions`](Self::at_junctions), for diagrams.
    pub fn diagram_at_junctions(mesh: &Mesh) -> Option<Self> {
        Self::at_junctions(mesh).map(|error| match error {
            Self::EdgesOfManyFaces => Self::DiagramAtManyFaces,
            _ => Self::DiagramNotOrientable,
        })
    }

    /// Distances whose relative error may be up to `relative`.
    pub fn not_certified(relative: f64) -> Self {
        // An infinite error becomes the greatest exponent of an `f64`.
        let exponent = relative.log10().ceil().min(308.0) as i32;
        Self::NotCertified { exponent }
    }
}

/// One source or several: a number, a [`VertexId`], or an array or slice of either.
///
/// ```
/// use geobench_mesh::VertexId;
/// use geobench_window::Sources;
///
/// let [a, b] = [3, 17].map(VertexId::new);
/// assert_eq!(3.into_vertices(), [a]);
/// assert_eq!([3, 17].into_vertices(), [a, b]);
/// assert_eq!((&[a, b]).into_vertices(), [a, b]);
/// ```
pub trait Sources {
    /// The sources as vertices.
    fn into_vertices(self) -> Vec<VertexId>;
}

macro_rules! sources {
    ($source:ty) => {
        impl Sources for $source {
            fn into_vertices(self) -> Vec<VertexId> {
                vec![self.into()]
            }
        }
    };
    ($list:ty, $($generics:tt)*) => {
        impl<$($generics)*> Sources for $list {
            fn into_vertices(self) -> Vec<VertexId> {
                self.iter().map(|&v| v.into()).collect()
            }
        }
    };
}

sources!(u32);
sources!(VertexId);
sources!([V; N], V: Copy + Into<VertexId>, const N: usize);
sources!(&[V; N], V: Copy + Into<VertexId>, const N: usize);
sources!(&[V], V: Copy + Into<VertexId>);
sources!(&Vec<V>, V: Copy + Into<VertexId>);

/// An algorithm set up for one mesh. Set-up is not timed. A solver can be called for one set of
/// sources after another. It owns its data, so it can be stored beside its mesh, outlive it, and
/// move to another thread.
///
/// ```
/// use geobench_ich::ich;
/// use geobench_mesh::Mesh;
/// use geobench_window::{Counter, Goal, Solver};
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let mut solver = ich(&mesh); // Set-up.
/// let all = solver.distances_from(0)?;
/// let (_, counters) = solver.count(&[0.into()])?;
/// assert!(counters.get(Counter::Propagated) > Some(0));
///
/// // Ends when vertex 1 is final. Distances that are not final then are infinite.
/// let near = solver.solve_until(&[0.into()], &Goal::targets([1]))?;
/// assert!(near.distances[1] == all[1] && near.distances[24].is_infinite());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Solver: Send {
    /// Distances of all vertices from the nearest of `sources`, until everything that `goal` asks
    /// for is final, and what `observer` asks for. Distances that are not final then, or not within
    /// the radius, are infinite. Final distances do not depend on goal and observer, bit for bit.
    ///
    /// A solver that cannot end early solves to the end and applies the radius.
    ///
    /// # Errors
    ///
    /// If `sources` is empty or has a vertex that does not exist, if a target does not exist, or if
    /// set-up did not get the threads or the memory that it needs. [`SolveError::NoPaths`] if the
    /// observer wants origins that the algorithm does not record.
    fn run(
        &mut self,
        sources: &[VertexId],
        goal: &Goal,
        observer: Observer<'_>,
    ) -> Result<Solution, SolveError>;

    /// Makes a change of the mesh in place of a new set-up, between two runs: returns the changed
    /// mesh, and the change that undoes it. `None` if the algorithm cannot, and nothing changes.
    ///
    /// Runs on the changed mesh are those of a solver that is set up for it, except for widths of
    /// buckets and the like, on which no distance depends, and for approximate algorithms, which
    /// define the distances of added vertices themselves. [`at_points`](crate::at_points) runs a
    /// solver with points inserted.
    fn splice(&mut self, splice: &Splice) -> Option<(Mesh, Splice)> {
        let _ = splice;
        None
    }

    /// Distances of all vertices from the nearest of `sources`. This is the call that is timed.
    ///
    /// # Errors
    ///
    /// As [`run`](Solver::run).
    fn solve(&mut self, sources: &[VertexId]) -> Result<Solution, SolveError> {
        self.run(sources, &Goal::everything(), Observer::Nothing)
    }

    /// Distances from the nearest of `sources`, without a [`Solution`]: `distances_from(0)` or
    /// `distances_from([3, 17])`.
    ///
    /// # Errors
    ///
    /// As [`run`](Solver::run).
    fn distances_from(&mut self, sources: impl Sources) -> Result<Vec<f64>, SolveError>
    where
        Self: Sized,
    {
        Ok(self.solve(&sources.into_vertices())?.distances)
    }

    /// [`run`](Solver::run) without an observer.
    ///
    /// # Errors
    ///
    /// As [`run`](Solver::run).
    fn solve_until(&mut self, sources: &[VertexId], goal: &Goal) -> Result<Solution, SolveError> {
        self.run(sources, goal, Observer::Nothing)
    }

    /// As [`solve`](Solver::solve), and counts the events of the run.
    ///
    /// # Errors
    ///
    /// As [`run`](Solver::run).
    fn count(&mut self, sources: &[VertexId]) -> Result<(Solution, Counters), SolveError> {
        let mut counters = Counters::default();
        let solution = self.run(
            sources,
            &Goal::everything(),
            Observer::Counters(&mut counters),
        )?;
        Ok((solution, counters))
    }

    /// As [`solve_until`](Solver::solve_until), and returns the origins of the shortest paths to
    /// all vertices whose distance is finite.
    ///
    /// # Errors
    ///
    /// As [`run`](Solver::run).
    fn trace(
        &mut self,
        sources: &[VertexId],
        goal: &Goal,
    ) -> Result<(Solution, Origins), SolveError> {
        let mut origins = Origins::default();
        let solution = self.run(sources, goal, Observer::Origins(&mut origins))?;
        Ok((solution, origins))
    }
}

/// What a run reports beside distances.
#[derive(Debug)]
#[non_exhaustive]
pub enum Observer<'a> {
    /// Nothing. Only such runs are timed.
    Nothing,
    /// The counts of its events.
    Counters(&'a mut Counters),
    /// The windows that wait when the run is at certain distances, the last of which ends it.
    Fronts(&'a mut Fronts),
    /// The origins of the shortest paths.
    Origins(&'a mut Origins),
    /// Samples of its phases.
    Phases(&'a mut PhaseSampler),
}

/// The interface that an algorithm implements: one run, generic over the probe. Every `Propagate`
/// is a [`Solver`].
///
/// ```
/// use geobench_mesh::{Mesh, VertexId};
/// use geobench_window::queue::MinHeap;
/// use geobench_window::{Counter, Probe, Propagate, Solution, Solver};
///
/// /// Paths along edges only: never too short.
/// struct EdgesOnly(Mesh);
///
/// impl Propagate for EdgesOnly {
///     const TRACES: bool = false;
///
///     fn counters() -> Vec<Counter> {
///         vec![Counter::QueuePushes]
///     }
///
///     fn mesh(&self) -> &Mesh {
///         &self.0
///     }
///
///     fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
///         let mut distances = vec![f64::INFINITY; self.0.vertex_count()];
///         let mut queue = MinHeap::default();
///         for &source in sources {
///             distances[source.index()] = 0.0;
///             queue.push(0.0, source);
///         }
///         while let Some((d, v)) = queue.pop() {
///             for (neighbour, length) in self.0.neighbours(v) {
///                 let known = &mut distances[neighbour.index()];
///                 if d + length < *known {
///                     *known = d + length;
///                     queue.push(d + length, neighbour);
///                     probe.add(Counter::QueuePushes, 1);
///                 }
///             }
///         }
///         Solution::new(distances)
///     }
/// }
///
/// let mut solver = EdgesOnly(Mesh::generate("octahedron,subdiv=0")?);
/// assert_eq!(solver.distances_from(0)?, [0.0, 2.0, 1.0, 1.0, 1.0, 1.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Propagate: Send {
    /// Whether a run calls [`Probe::reach`].
    const TRACES: bool = true;

    /// Whether all paths run along edges, so that they are not straight.
    const ALONG_EDGES: bool = false;

    /// Whether paths cross the [junctions](Mesh::junction) of a mesh. A run on a mesh with
    /// junctions is an error otherwise.
    const JUNCTIONS: bool = false;

    /// The counters that this algorithm reports.
    fn counters() -> Vec<Counter>;

    /// The mesh for which it is set up.
    fn mesh(&self) -> &Mesh;

    /// Makes a change of the mesh in place, in all data that a run uses; see [`Solver::splice`].
    /// Returns the one that undoes it, or `None` if the algorithm cannot.
    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        let _ = splice;
        None
    }

    /// Why the algorithm does not solve `mesh`; `None` if it does.
    fn refusal(mesh: &Mesh) -> Option<SolveError> {
        SolveError::at_junctions(mesh).filter(|_| !Self::JUNCTIONS)
    }

    /// Checks that set-up got all that a run needs. Most algorithms need nothing that can fail.
    ///
    /// # Errors
    ///
    /// The missing resource.
    fn check(&self) -> Result<(), SolveError> {
        Ok(())
    }

    /// Distances of all vertices from the nearest of `sources`. These are not empty, exist, and are
    /// no copies. What is found for [copies](Mesh::copies) does not matter.
    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution;

    /// The machine code of all runs. An implementation repeats this default, with
    /// `#[inline(never)]`, to have it in its own crate; see [`CompiledRuns`].
    fn runs(&self) -> CompiledRuns<Self>
    where
        Self: Sized,
    {
        CompiledRuns::new()
    }
}

/// Pointers to [`Propagate::propagate`], compiled for each probe of a [`Solver`].
///
/// The compiler makes the code of a generic function in the crate that names its types. Without
/// these pointers that would be each program that calls a solver, with the program's own settings.
/// A function without type parameters that creates them, such as a constructor of a named
/// algorithm, fixes the crate in which the code is made, so that families of algorithms are
/// compiled side by side, once.
pub struct CompiledRuns<T> {
    solve: fn(&mut T, &[VertexId], &mut ()) -> Solution,
    solve_until: fn(&mut T, &[VertexId], &mut Until<'_, ()>) -> Solution,
    count: fn(&mut T, &[VertexId], &mut Until<'_, Count>) -> Solution,
    trace: fn(&mut T, &[VertexId], &mut Until<'_, Origins>) -> Solution,
    profile: fn(&mut T, &[VertexId], &mut PhaseProbe<'_>) -> Solution,
    profile_until: fn(&mut T, &[VertexId], &mut Until<'_, PhaseProbe<'_>>) -> Solution,
}

impl<T: Propagate> CompiledRuns<T> {
    /// The runs of `T`, compiled in the crate of the function without type parameters that calls
    /// this.
    // Not `const`, not `Default`: both would hide where the code is made.
    #[allow(clippy::new_without_default)]
    pub fn new() -> Self {
        // Closures, since the probes have lifetimes.
        Self {
            solve: |solver, sources, probe| connected(solver, sources, probe),
            solve_until: |solver, sources, probe| connected(solver, sources, probe),
            count: |solver, sources, probe| connected(solver, sources, probe),
            trace: |solver, sources, probe| connected(solver, sources, probe),
            profile: |solver, sources, probe| connected(solver, sources, probe),
            profile_until: |solver, sources, probe| connected(solver, sources, probe),
        }
    }
}

/// A run of `solver`, with [distances over edges](mod@crate::connected) where it found none.
#[inline]
fn connected<T: Propagate, P: Probe>(
    solver: &mut T,
    sources: &[VertexId],
    probe: &mut P,
) -> Solution {
    let mut solution = solver.propagate(sources, probe);
    reach_over_edges(solver.mesh(), &mut solution.distances, probe);
    solution
}

// Derived, these would ask the same of `T`.
impl<T> Clone for CompiledRuns<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for CompiledRuns<T> {}

impl<T> fmt::Debug for CompiledRuns<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("CompiledRuns")
    }
}

impl<T: Propagate> Solver for T {
    fn splice(&mut self, splice: &Splice) -> Option<(Mesh, Splice)> {
        let undo = Propagate::splice(self, splice)?;
        Some((self.mesh().clone(), undo))
    }

    fn run(
        &mut self,
        sources: &[VertexId],
        goal: &Goal,
        observer: Observer<'_>,
    ) -> Result<Solution, SolveError> {
        let mesh = self.mesh().clone();
        check_sources(mesh.vertex_count(), sources)?;
        check_goal(mesh.vertex_count(), goal)?;
        if let Some(error) = T::refusal(&mesh) {
            return Err(error);
        }
        self.check()?;
        let sources = &*distinct(&mesh, sources);
        let goal = &*goal.on(&mesh);
        let runs = self.runs();
        let mut solution = match observer {
            Observer::Nothing if goal.is_everything() => (runs.solve)(self, sources, &mut ()),
            Observer::Nothing => {
                goal.bound((), |probe| (runs.solve_until)(self, sources, probe))
                    .0
            }
            Observer::Counters(counters) => {
                let run = |probe: &mut _| (runs.count)(self, sources, probe);
                let (solution, count) = goal.bound(Count::default(), run);
                *counters = count.counters(&T::counters());
                solution
            }
            Observer::Fronts(fronts) => {
                let probe = Count::watching(std::mem::take(fronts));
                let run = |probe: &mut _| (runs.count)(self, sources, probe);
                let (solution, count) = goal.bound(probe, run);
                *fronts = count.fronts();
                solution
            }
            Observer::Origins(_) if !T::TRACES => return Err(SolveError::NoPaths),
            Observer::Origins(origins) => {
                let probe = Origins::new(mesh.vertex_count(), T::ALONG_EDGES);
                let run = |probe: &mut _| (runs.trace)(self, sources, probe);
                let (solution, found) = goal.bound(probe, run);
                *origins = found;
                solution
            }
            // What a run needs to end early would count to the memory of a whole one.
            Observer::Phases(sampler) if goal.is_everything() => {
                sampler.watch(|probe| (runs.profile)(self, sources, probe))
            }
            Observer::Phases(sampler) => sampler.watch(|probe| {
                goal.bound(*probe, |probe| (runs.profile_until)(self, sources, probe))
                    .0
            }),
        };
        mesh.fill_copies(&mut solution.distances);
        Ok(solution)
    }
}

/// The sources, each once, since some solvers would spawn the windows of each repetition; for
/// copies the vertices that stand for them. Ascending sources are not copied.
fn distinct<'s>(mesh: &Mesh, sources: &'s [VertexId]) -> Cow<'s, [VertexId]> {
    if sources.is_sorted_by(|a, b| a < b) && !sources.iter().any(|&v| mesh.is_copy(v)) {
        return Cow::Borrowed(sources);
    }
    let mut seen = HashSet::new();
    let kept = sources.iter().map(|&v| mesh.kept_vertex(v));
    Cow::Owned(kept.filter(|&v| seen.insert(v)).collect())
}

/// Checks the sources of a run on a mesh with this number of vertices.
///
/// # Errors
///
/// If there is no source, or one is not a vertex of the mesh.
pub fn check_sources(vertices: usize, sources: &[VertexId]) -> Result<(), SolveError> {
    match sources.iter().find(|v| v.index() >= vertices) {
        Some(&vertex) => Err(SolveError::NoSuchVertex { vertex, vertices }),
        None if sources.is_empty() => Err(SolveError::NoSource),
        None => Ok(()),
    }
}

fn check_goal(vertices: usize, goal: &Goal) -> Result<(), SolveError> {
    let mut targets = goal.vertices().unwrap_or(&[]).iter();
    match targets.find(|v| v.index() >= vertices) {
        Some(&vertex) => Err(SolveError::NoSuchTarget { vertex, vertices }),
        None => Ok(()),
    }
}
