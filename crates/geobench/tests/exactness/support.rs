//! Meshes, solvers and comparisons for all tests of the suite.

use std::any::Any;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};

use geobench_mesh::{Mesh, Tolerance, VertexId};
use geobench_oracle::Model;
use geobench_registry::{Algorithm, Selection, select};
use geobench_window::Solver;

#[path = "../../../oracle/tests/support/mesh.rs"]
mod oracle_mesh;

/// The tolerance for rounding in all but the hardest comparisons.
pub(crate) const ROUNDING: f64 = 1e-12;

/// The tolerance for differences from independent programs.
pub(crate) const AGREEMENT: f64 = 1e-9;

/// The algorithms that claim to be exact, and further variants of them.
pub(crate) const EXACT: &str = "exact,vtp-fast{simd=avx2},vtp-fast{simd=scalar},vtp-fast{pairs=1},\
    pvtp{threads=2},pch{threads=2},mmp{turn=list},fwp-mmp{turn=list,filter=vertices,lists=evict}";

/// Further variants, which run only on small meshes.
const ON_SMALL: &str = "mmp{queue=fifo},mmp{lists=evict},mmp-edge{lists=evict},\
    mmp{turn=list,slack=0.1,filter=vertices},mmp{turn=list,lists=evict},\
    fwp-mmp{lists=evict},fwp-mmp{turn=list},lc-mmp{turn=list},\
    lc-mmp{turn=list,filter=vertices,lists=evict},vtp-mmp{turn=list},\
    vtp-mmp{turn=list,filter=vertices,lists=evict}";

/// The exact algorithms, ready to be built.
pub(crate) fn exact_algorithms() -> Vec<Selection> {
    select(EXACT).unwrap_or_else(|error| panic!("{error}"))
}

/// Whether `algorithm` can finish a mesh with this many faces within `budget` windows. CH
/// propagates about 3n² windows.
pub(crate) fn can_finish(algorithm: &Algorithm, faces: usize, budget: f64) -> bool {
    let n = faces as f64;
    match algorithm.name {
        "ch" => 3.0 * n.powi(2) <= budget,
        _ => true,
    }
}

/// A solver on a named mesh.
pub(crate) struct Run<'m> {
    /// The algorithm.
    pub(crate) selection: Selection,
    model: &'m str,
    solver: Box<dyn Solver>,
}

/// Every exact algorithm that can finish on the small mesh `mesh`, set up for it.
pub(crate) fn exact_runs<'m>(model: &'m str, mesh: &Mesh) -> Vec<Run<'m>> {
    let faces = mesh.face_count();
    let others = select(ON_SMALL).unwrap_or_else(|error| panic!("{error}"));
    let algorithms = exact_algorithms().into_iter().chain(others);
    let algorithms = algorithms.filter(|a| can_finish(a.algorithm(), faces, 1e5));
    algorithms.map(|a| Run::new(a, model, mesh)).collect()
}

impl<'m> Run<'m> {
    /// Sets `selection` up for `mesh`.
    pub(crate) fn new(selection: Selection, model: &'m str, mesh: &Mesh) -> Self {
        Self {
            solver: selection.build(mesh),
            selection,
            model,
        }
    }

    /// The solver itself.
    pub(crate) fn solver(&mut self) -> &mut dyn Solver {
        self.solver.as_mut()
    }

    /// The distances from the nearest of `sources`.
    ///
    /// # Panics
    ///
    /// When the solver fails or panics. The message names the place.
    pub(crate) fn distances(&mut self, sources: &[u32]) -> Vec<f64> {
        let ids: Vec<_> = sources.iter().copied().map(VertexId::new).collect();
        let answer = catch_unwind(AssertUnwindSafe(|| self.solver.solve(&ids)));
        let complaint = match answer {
            Ok(Ok(solution)) => return solution.distances,
            Ok(Err(refused)) => refused.to_string(),
            Err(panic) => format!("panic: {}", panic_message(panic.as_ref())),
        };
        panic!("{}: {complaint}", self.at(sources));
    }

    /// Whether two runs may differ like this. Serial algorithms must give the same bits. Several
    /// threads find the same paths in a random order, so rounding may differ.
    pub(crate) fn may_give(&self, a: &[f64], b: &[f64]) -> bool {
        if self.selection.threads() == 1 {
            return a == b;
        }
        let mut pairs = a.iter().zip(b);
        a.len() == b.len() && pairs.all(|(a, b)| a == b || (a - b).abs() <= ROUNDING * b)
    }

    /// The place of a failure, for messages.
    pub(crate) fn at(&self, sources: &[u32]) -> String {
        format!(
            "{}, {}, from {sources:?}",
            self.model,
            self.selection.label()
        )
    }
}

fn panic_message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("without a message")
}

/// The mesh of a test model, as the library builds it.
///
/// # Panics
///
/// When the mesh is refused. The message has the reason.
pub(crate) fn mesh_of(model: &Model) -> Mesh {
    oracle_mesh::mesh_of(model).unwrap_or_else(|refused| panic!("{}: {refused}", model.name))
}

/// Collected failures, so that one run of a test reports all of them.
#[derive(Default)]
pub(crate) struct Failures {
    lines: Vec<String>,
}

impl Failures {
    /// Adds the failure `line` unless `holds`.
    pub(crate) fn unless(&mut self, holds: bool, line: impl FnOnce() -> String) {
        if !holds {
            self.lines.push(line());
        }
    }

    /// Adds a failure if two fields differ by more than `tolerance`, relative to the expected
    /// value. It names the worst vertex.
    ///
    /// Every value may also differ by the rounding of the greatest value, which is less than the
    /// [rule](Tolerance) allows on all but extreme fields. For example, two vertices in one place,
    /// at distance 0, may get the distance 1e-17.
    pub(crate) fn compare(
        &mut self,
        at: impl Fn() -> String,
        found: &[f64],
        expected: impl IntoIterator<Item = (usize, f64)>,
        tolerance: f64,
    ) {
        let expected: Vec<(usize, f64)> = expected.into_iter().collect();
        let finite = expected.iter().map(|&(_, d)| d).filter(|d| d.is_finite());
        let rule = Tolerance::with_scales(vec![finite.fold(0.0, f64::max)])
            .with_relative(tolerance)
            .with_rounding(1e-15);
        let mut worst = (0.0, None);
        let mut count = 0;
        for (vertex, expected) in expected {
            let Some(&found) = found.get(vertex) else {
                self.lines.push(format!("{}: no vertex {vertex}", at()));
                return;
            };
            let difference = (found - expected).abs();
            if rule.is_right(vertex, found, expected) {
                continue;
            }
            count += 1;
            let size = if difference.is_nan() {
                f64::INFINITY
            } else {
                difference / expected
            };
            if worst.1.is_none() || size > worst.0 {
                worst = (size, Some((vertex, found, expected)));
            }
        }
        if let (size, Some((vertex, found, expected))) = worst {
            self.lines.push(format!(
                "{}: {count} vertices differ, the worst is {vertex}: {found} instead of {expected}, by {size:.1e}",
                at()
            ));
        }
    }

    /// Compares two whole fields.
    pub(crate) fn compare_all(
        &mut self,
        at: impl Fn() -> String,
        found: &[f64],
        expected: &[f64],
        tolerance: f64,
    ) {
        self.unless(found.len() == expected.len(), || {
            format!(
                "{}: {} distances for {} vertices",
                at(),
                found.len(),
                expected.len()
            )
        });
        self.compare(at, found, expected.iter().copied().enumerate(), tolerance);
    }

    /// Adds the failures of another list.
    pub(crate) fn extend(&mut self, other: Self) {
        self.lines.extend(other.lines);
    }

    /// Fails the test if there are failures.
    pub(crate) fn report(self) {
        if let Err(text) = self.result() {
            panic!("{text}");
        }
    }

    /// All failures, if there are any.
    pub(crate) fn result(self) -> Result<(), String> {
        const SHOWN: usize = 60;
        if self.lines.is_empty() {
            return Ok(());
        }
        let mut text = format!("{} failures:", self.lines.len());
        for line in self.lines.iter().take(SHOWN) {
            let _ = write!(text, "\n  {line}");
        }
        if self.lines.len() > SHOWN {
            let _ = write!(text, "\n  and {} more", self.lines.len() - SHOWN);
        }
        Err(text)
    }
}

/// The result of `f`. A panic is added to the failures, so that the other checks still run.
pub(crate) fn caught<T>(failures: &mut Failures, f: impl FnOnce() -> T) -> Option<T> {
    match catch_unwind(AssertUnwindSafe(f)) {
        Ok(value) => Some(value),
        Err(panic) => {
            failures
                .lines
                .push(panic_message(panic.as_ref()).to_owned());
            None
        }
    }
}
