//! The table of all algorithms and their parameters.
//!
//! Only this crate knows which algorithms exist. The benchmark reaches a solver through
//! [`Selection::build`] and the [`Solver`] trait. The table has one file per family. A new
//! algorithm is one entry in such a file. A new family is a file and a line in [`algorithms`].
//!
//! It is a crate of its own because the machine code of all solvers is made here: a change of the
//! benchmark does not repeat that.
//!
//! ```
//! use geobench_mesh::Mesh;
//! use geobench_registry::select_one;
//!
//! let mesh = Mesh::generate("sphere,subdiv=2")?;
//! let mut solver = select_one("fwp-mmp{kmax=5000}")?.build(&mesh);
//! assert_eq!(solver.solve(&[0.into()])?.distances[0], 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::sync::LazyLock;

use geobench_mesh::Mesh;
use geobench_voronoi::FieldSolver;
use geobench_window::continuous::{Continuous, Policy};
use geobench_window::queue::Discipline;
use geobench_window::{Counter, Solver};
use serde::Serialize;

mod approx;
mod certificate;
mod ch;
#[cfg(feature = "failing-algorithms")]
mod failing;
mod fwp;
mod graphs;
mod mmp;
mod parameter;
mod program;
mod select;
mod voronoi;
mod vtp;

pub use certificate::{CERTIFICATE, certificate, proven_bounds};
pub use parameter::{Allowed, MOST_THREADS, Numbers, Parameter, SimdChoice, Value, Values};
pub use program::{Call, PLACEHOLDERS, Program, Programs, Protocol, Provenance};
pub use select::{Selection, distinct, select, select_one};

/// An invalid value from the command line or a file. The message quotes the value and names the
/// allowed ones.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct UsageError(pub String);

/// All algorithms, in the order of tables.
pub fn algorithms() -> &'static [Algorithm] {
    static ALL: LazyLock<Vec<Algorithm>> = LazyLock::new(|| {
        [
            mmp::FAMILY,
            ch::FAMILY,
            fwp::FAMILY,
            vtp::FAMILY,
            voronoi::FAMILY,
            mmp::FAST,
            ch::FAST,
            vtp::FAST,
            approx::FAMILY,
            graphs::FAMILY,
        ]
        .concat()
    });
    &ALL
}

/// Algorithms that are selected by name only: certified distances and, for tests, failing
/// algorithms.
fn by_name_only() -> impl Iterator<Item = &'static Algorithm> {
    #[cfg(feature = "failing-algorithms")]
    let failing = failing::FAMILY;
    #[cfg(not(feature = "failing-algorithms"))]
    let failing = &[];
    certificate::CERTIFIED.iter().chain(failing)
}

/// The algorithm for distances and paths on `mesh` where none is named: the fastest on one thread.
pub fn usual(mesh: &Mesh) -> Selection {
    let algorithm = if mesh.has_junctions() {
        &mmp::FAST[0]
    } else {
        &vtp::FAST[0]
    };
    Selection::new(algorithm, Values::default())
}

/// The name of the algorithm whose sources may be curves.
pub const OF_CURVES: &str = "mmp";

/// Checks that sources of `selection` may be curves.
///
/// # Errors
///
/// If they are points only.
pub fn check_curves(selection: &Selection) -> Result<(), UsageError> {
    let label = selection.label();
    if label == OF_CURVES {
        return Ok(());
    }
    let message = format!("sources of {label} are points; {OF_CURVES} starts from curves");
    Err(UsageError(message))
}

/// The algorithm of this name, be it one that is selected by name only.
pub fn find(name: &str) -> Option<&'static Algorithm> {
    let mut all = algorithms().iter().chain(by_name_only());
    all.find(|algorithm| algorithm.name == name)
}

/// A solver that takes one window at a time, with its threshold and vector instructions.
fn single<W: Policy, Q: Discipline, const RELAYS: bool>(
    solver: Continuous<W, Q, RELAYS>,
    mesh: &Mesh,
    values: &Values,
) -> Box<dyn Solver>
where
    Continuous<W, Q, RELAYS>: Solver + 'static,
{
    let solver = solver.with_threshold(parameter::threshold_width(mesh, values));
    Box::new(solver.with_instructions(values.instructions()))
}

/// Sets up a solver for Voronoi diagrams of a mesh with these parameter values.
pub type BuildField = fn(&Mesh, &Values) -> Box<dyn FieldSolver>;

/// A registered algorithm. Its JSON form is the output of `geobench algos`.
#[derive(Clone, Copy, Debug, Serialize)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a property of its own"
)]
pub struct Algorithm {
    /// Its name, in lower case.
    pub name: &'static str,
    /// The family, such as `vtp-family`, which `--algo` can select as a whole.
    pub family: &'static str,
    /// Whether it is a form of our own, made for speed, and not the algorithm of a paper.
    pub fast: bool,
    /// Whether its distances are exact up to rounding, at the default parameters. Approximate
    /// algorithms are compared with the reference, but the tolerance does not apply.
    pub exact: bool,
    /// The paper that describes it: authors, year, section.
    pub paper: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
    /// Worst-case time and space; n is the number of faces.
    pub complexity: &'static str,
    /// Its queue: `heap`, `calendar`, `buckets`, `fifo`, `label-correcting` or `none`. A parameter
    /// of this name takes its place.
    pub queue: &'static str,
    /// How windows cross triangles: one by one (`single`), several at a time before they leave the
    /// queue (`joint`), or all that wait on an edge (`list`); `none` without windows.
    pub crossing: &'static str,
    /// Data that it keeps in memory during the run and at its end.
    pub keeps: &'static str,
    /// When to choose it.
    pub choose: &'static str,
    /// How it differs from its paper at the default parameters; `docs/algorithms` gives the
    /// reasons.
    pub departs: &'static str,
    /// The counter of windows from which its memory is computed as in the papers: windows stored at
    /// the end for algorithms that keep every window, windows alive at the peak for the others.
    #[serde(skip)]
    pub memory_counter: Counter,
    /// For an algorithm that is slower by orders of magnitude: the number of faces that it solves
    /// in about a minute. `verify` skips it on larger models unless it is selected by name.
    #[serde(skip)]
    pub comfortable_faces: Option<u64>,
    /// Whether a run ends once the distances of its goal are final. Other algorithms run to
    /// completion.
    #[serde(skip)]
    pub ends_early: bool,
    /// Whether paths cross the [junctions](Mesh::junction) of a mesh: edges with more than two
    /// faces, and those where a surface that cannot be oriented contradicts itself. Otherwise a run
    /// on such a mesh is an error.
    pub crosses_junctions: bool,
    /// Proven bound on the relative error of its distances with these parameter values, rounding
    /// aside; `None` without one.
    #[serde(skip)]
    pub error_bound: fn(&Values) -> Option<f64>,
    /// Sets up a solver for Voronoi diagrams, if the algorithm keeps the windows that these take.
    #[serde(skip)]
    pub field: Option<BuildField>,
    /// Its parameters, in the order of labels, `name{key=value}`.
    pub parameters: &'static [Parameter],
    /// Sets up a solver for a mesh with these parameter values. Set-up is not part of the time of a
    /// solve.
    #[serde(skip)]
    pub build: fn(&Mesh, &Values) -> Box<dyn Solver>,
}

impl Algorithm {
    /// [`queue`](Self::queue) and [`crossing`](Self::crossing), unless they are parameters.
    pub fn facts(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let parameters = self.parameters;
        let facts = [("queue", self.queue), ("crossing", self.crossing)];
        facts
            .into_iter()
            .filter(move |(name, _)| parameters.iter().all(|parameter| parameter.name != *name))
    }

    /// Defaults of an exact algorithm that keeps only the windows of the wavefront. For the tables
    /// of this module.
    const EXACT: Self = Self {
        name: "",
        family: "",
        paper: "",
        fast: false,
        exact: true,
        summary: "",
        departs: "",
        complexity: "time O(n^2), space O(n^2)",
        queue: "heap",
        crossing: "single",
        keeps: "the windows of the wavefront",
        choose: "",
        memory_counter: Counter::PeakWindows,
        comfortable_faces: None,
        ends_early: true,
        crosses_junctions: false,
        error_bound: |_| None,
        field: None,
        parameters: &[parameter::THRESHOLD],
        build: |_, _| panic!("this algorithm has no solver"),
    };

    /// Defaults of an approximate algorithm; for the tables of this module.
    const APPROXIMATE: Self = Self {
        family: "approximate",
        exact: false,
        crossing: "none",
        parameters: &[],
        ..Self::EXACT
    };
}
