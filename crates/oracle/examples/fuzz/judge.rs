//! Compares the answer of an algorithm with that of the oracle.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use geobench_mesh::{Mesh, TriangleSoup, VertexId};
use geobench_oracle::{DoubleDouble, Model, Search, rounded, search};
use geobench_registry::{Selection, select_one};
use geobench_window::{Counter, precision};

use crate::case::{Case, Expected, Failure, FailureKind, Skip, Verdict};
use crate::variants;

/// Largest relative error of a right distance.
const TOLERANCE: f64 = 1e-9;

/// Largest error of a right distance, as a fraction of the largest distance.
const FLOOR: f64 = 1e-13;

/// The limit of the windows of an algorithm, as a multiple of those of `mmp-fast`, where work is
/// bounded.
pub(crate) const MOST_WORK: u64 = 10;

/// A number of windows that is small on any mesh.
const LITTLE_WORK: u64 = 200;

/// Limit of the oracle's beams for one case. They take some tenths of a second; thousands are
/// usual.
const MOST_BEAMS: u64 = 100_000;

/// Largest difference between two searches of the oracle, as a fraction of the largest right
/// distance.
const AGREEMENT: f64 = 1e-3;

/// The mesh of `case` for the algorithms.
pub(crate) fn mesh(case: &Case) -> Result<Mesh, Skip> {
    let soup = TriangleSoup::new(case.vertices.clone(), case.faces.clone());
    let built = catch_unwind(|| Mesh::from_soup(soup));
    match built {
        Ok(Ok((mesh, _))) => Ok(mesh),
        Ok(Err(_)) => Err(Skip::Refused),
        Err(_) => Err(Skip::MeshPanics),
    }
}

/// The right distances.
pub(crate) fn expected(case: &Case, mesh: &Mesh) -> Result<Expected, Skip> {
    // The mesh has its faces oriented consistently.
    let faces = mesh
        .faces()
        .map(|f| mesh.face_vertices(f).map(VertexId::raw));
    let model = Model::new("", case.vertices.clone(), faces.collect());
    let surface = model.surface::<DoubleDouble>();
    let plan = Search::pruned(MOST_BEAMS);
    let found = search(&surface, &case.sources, plan).map_err(|_| Skip::GaveUp)?;
    let found = rounded(&found);
    // Additional lines from vertices where no path bends must not change distances.
    let check = Search::pruned(MOST_BEAMS).from_everywhere();
    if let Ok(other) = search(&surface, &case.sources, check) {
        let other = rounded(&other);
        let slack = AGREEMENT * FLOOR * largest(&found);
        let mut pairs = found.iter().zip(&other);
        let agree = |(a, b): (&f64, &f64)| {
            a == b || (a - b).abs() <= AGREEMENT * TOLERANCE * a.min(*b) + slack
        };
        if !pairs.all(agree) {
            return Err(Skip::Unsure);
        }
    }
    Ok(found
        .into_iter()
        .map(|d| d.is_finite().then_some(d))
        .collect())
}

fn largest(distances: &[f64]) -> f64 {
    let finite = distances.iter().copied().filter(|d| d.is_finite());
    finite.fold(0.0, f64::max)
}

/// Number of windows that `mmp-fast` propagates.
pub(crate) fn work_of_mmp(case: &Case, mesh: &Mesh) -> Option<u64> {
    let mmp = select_one("mmp-fast").ok()?;
    let count = || mmp.build(mesh).count(&sources(case)).ok();
    let (_, counters) = catch_unwind(AssertUnwindSafe(count)).ok()??;
    counters.get(Counter::Propagated)
}

fn sources(case: &Case) -> Vec<VertexId> {
    case.sources.iter().copied().map(VertexId::new).collect()
}

/// The verdict on `selection` for `case`. `work` is that of `mmp-fast`, if work is bounded.
pub(crate) fn judge(
    selection: &Selection,
    case: &Case,
    mesh: &Mesh,
    expected: &Expected,
    work: Option<u64>,
) -> Verdict {
    if !variants::can_finish(selection, mesh.face_count()) {
        return Verdict::LeftOut;
    }
    let failed = |kind, text: String| Verdict::Failed(Failure { kind, text });
    let sources = sources(case);
    let run = || {
        let mut solver = selection.build(mesh);
        let solution = solver.solve(&sources)?;
        let counted = work.map(|_| solver.count(&sources)).transpose()?;
        Ok::<_, geobench_window::SolveError>((solution, counted))
    };
    let (solution, counted) = match catch_unwind(AssertUnwindSafe(run)) {
        Ok(Ok(answer)) => answer,
        Ok(Err(error)) => return failed(FailureKind::Panic, error.to_string()),
        Err(panic) => return failed(FailureKind::Panic, message(panic.as_ref())),
    };
    let distances = &solution.distances;
    if let Some(failure) = compare(distances, expected, 0.0) {
        let doubt = precision::doubt(mesh, distances);
        let is_told = doubt.is_some_and(|d| compare(distances, expected, d.bound).is_none());
        return if is_told {
            Verdict::InDoubt
        } else {
            Verdict::Failed(failure)
        };
    }
    if variants::is_bounded(selection)
        && let (Some(of_mmp), Some((_, counters))) = (work, counted)
        && let Some(windows) = counters.get(Counter::Propagated)
        && windows > MOST_WORK * of_mmp.max(LITTLE_WORK)
    {
        let text = format!("{windows} windows, mmp-fast takes {of_mmp}");
        return failed(FailureKind::Work, text);
    }
    Verdict::Right
}

fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("a panic without a message").to_owned()
}

/// The worst difference that exceeds `doubt`, if any.
fn compare(found: &[f64], expected: &Expected, doubt: f64) -> Option<Failure> {
    if found.len() != expected.len() {
        return Some(Failure {
            kind: FailureKind::Panic,
            text: format!("{} distances for {} vertices", found.len(), expected.len()),
        });
    }
    let furthest = expected.iter().flatten().copied().fold(0.0, f64::max);
    let mut worst: Option<(f64, Failure)> = None;
    for (vertex, (&found, expected)) in found.iter().zip(expected).enumerate() {
        let expected = expected.unwrap_or(f64::INFINITY);
        let difference = (found - expected).abs();
        // In this form NaN is a failure, and two infinities are equal.
        if found == expected || difference <= TOLERANCE * expected + FLOOR * furthest + doubt {
            continue;
        }
        let kind = if found < expected {
            FailureKind::TooShort
        } else if found == f64::INFINITY {
            FailureKind::Lost
        } else {
            FailureKind::TooLong
        };
        let size = if difference.is_finite() {
            difference / expected.max(furthest * TOLERANCE)
        } else {
            f64::INFINITY
        };
        if worst.as_ref().is_none_or(|(w, _)| size > *w) {
            let text = format!("vertex {vertex}: {found:?} instead of {expected:?}");
            worst = Some((size, Failure { kind, text }));
        }
    }
    worst.map(|(_, failure)| failure)
}
