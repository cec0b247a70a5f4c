//! Compares the answer of an algorithm with that of the oracle.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use geobench_mesh::{Mesh, Tolerance, TriangleSoup, VertexId, tolerance};
use geobench_oracle::{DoubleDouble, Model, Search, rounded, search};
use geobench_registry::{Selection, select_one};
use geobench_window::{Counter, Goal, SolveError, precision};
use geodesics::{Certificate, Paths};

use crate::case::{Case, Expected, Failure, FailureKind, Reference, Skip, Verdict};
use crate::{judged, variants};

/// The limit of the windows of an algorithm, as a multiple of those of `mmp-fast`, where they are
/// [limited](crate::case::Limited).
pub(crate) const MOST_WORK: u64 = 10;

/// A number of windows that is small on any mesh.
const LITTLE_WORK: u64 = 200;

/// Limit of the oracle's beams for one case. They take some tenths of a second; thousands are
/// usual.
const MOST_BEAMS: u64 = 100_000;

/// Relative error of distances along which paths are judged, and their rounding, as a fraction of
/// the scale.
const EXACT: f64 = 1e-12;
const ROUNDING: f64 = 1e-15;

/// Most paths to trace for one case.
const MOST_PATHS: usize = 400;

/// Largest difference between two searches of the oracle, as a fraction of what is right.
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

/// The right distances, and where they are from.
pub(crate) fn expected(case: &Case, mesh: &Mesh) -> Result<(Expected, Reference), Skip> {
    let finite = |d: f64| d.is_finite().then_some(d);
    let (distances, reference) = match by_oracle(case, mesh) {
        Err(Skip::GaveUp) if case.is_large() => large(case, mesh)?,
        found => (found?, Reference::Oracle),
    };
    Ok((distances.into_iter().map(finite).collect(), reference))
}

/// The distances of a mesh that is too large for the oracle.
fn large(case: &Case, mesh: &Mesh) -> Result<(Vec<f64>, Reference), Skip> {
    let sources = sources(case);
    let proof = catch_unwind(|| Certificate::of(mesh, &sources[..]));
    if let Ok(Ok(proof)) = proof
        && proof.relative() <= tolerance::RELATIVE
    {
        return Ok((proof.distances, Reference::Certificate));
    }
    let fields = variants::JUDGES.iter().filter_map(|name| {
        let solve = || select_one(name).ok()?.build(mesh).solve(&sources).ok();
        Some(catch_unwind(AssertUnwindSafe(solve)).ok()??.distances)
    });
    let fields: Vec<Vec<f64>> = fields.collect();
    let agreeing = |field: &&Vec<f64>| {
        let rule = Tolerance::on(mesh, field);
        let field: Expected = field.iter().copied().map(Some).collect();
        let others = fields.iter();
        others
            .filter(|other| compare(other, &field, &rule, 0.0).is_none())
            .count()
    };
    let found = fields.iter().max_by_key(agreeing).ok_or(Skip::GaveUp)?;
    Ok((found.clone(), Reference::Agreement))
}

fn by_oracle(case: &Case, mesh: &Mesh) -> Result<Vec<f64>, Skip> {
    let surface = model(case, mesh).surface::<DoubleDouble>();
    let plan = Search::pruned(MOST_BEAMS);
    let sources = kept_sources(case, mesh);
    let found = search(&surface, &sources, plan).map_err(|_| Skip::GaveUp)?;
    let mut found = rounded(&found);
    mesh.fill_copies(&mut found);
    // Additional lines from vertices where no path bends must not change distances.
    let check = Search::pruned(MOST_BEAMS).from_everywhere();
    if let Ok(other) = search(&surface, &sources, check) {
        let mut other = rounded(&other);
        mesh.fill_copies(&mut other);
        let rule = Tolerance::on(mesh, &found);
        let mut pairs = found.iter().zip(&other).enumerate();
        let agree = |(v, (a, b)): (usize, (&f64, &f64))| {
            a == b || (a - b).abs() <= AGREEMENT * rule.allowed(v, a.min(*b))
        };
        if !pairs.all(agree) {
            return Err(Skip::Unsure);
        }
    }
    Ok(found)
}

/// The case with its faces oriented consistently.
fn model(case: &Case, mesh: &Mesh) -> Model {
    let faces = mesh
        .faces()
        .map(|f| mesh.face_vertices(f).map(VertexId::raw));
    Model::new("", case.vertices.clone(), faces.collect())
}

/// The sources of the case; for copies the vertices that stand for them.
fn kept_sources(case: &Case, mesh: &Mesh) -> Vec<u32> {
    let kept = |&source: &u32| mesh.kept_vertex(VertexId::new(source)).raw();
    case.sources.iter().map(kept).collect()
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

/// The verdict on `selection` for `case`. `work` is that of `mmp-fast`, if windows are limited.
pub(crate) fn judge(
    selection: &Selection,
    case: &Case,
    mesh: &Mesh,
    expected: &Expected,
    work: Option<u64>,
) -> Verdict {
    if refuses(selection, mesh) || !variants::can_finish(selection, case) {
        return Verdict::LeftOut;
    }
    let work = work.filter(|_| variants::is_limited(selection, case.limited));
    let sources = sources(case);
    let run = || {
        let mut solver = selection.build(mesh);
        let solution = solver.solve(&sources)?;
        let counted = work.map(|_| solver.count(&sources)).transpose()?;
        Ok::<_, SolveError>((solution, counted))
    };
    let (solution, counted) = match catch_unwind(AssertUnwindSafe(run)) {
        Ok(Ok(answer)) => answer,
        Ok(Err(error)) => return failed(FailureKind::Panic, error.to_string()),
        Err(panic) => return failed(FailureKind::Panic, message(panic.as_ref())),
    };
    let distances = &solution.distances;
    let rule = rule(mesh, expected);
    if let Some(failure) = compare(distances, expected, &rule, 0.0) {
        let doubt = precision::doubt(mesh, distances);
        let is_told = doubt.is_some_and(|d| compare(distances, expected, &rule, d.bound).is_none());
        return if is_told {
            Verdict::InDoubt
        } else {
            Verdict::Failed(failure)
        };
    }
    if let (Some(of_mmp), Some((_, counters))) = (work, counted)
        && let Some(windows) = counters.get(Counter::Propagated)
        && windows > MOST_WORK * of_mmp.max(LITTLE_WORK)
    {
        let text = format!("{windows} windows, mmp-fast takes {of_mmp}");
        return failed(FailureKind::Work, text);
    }
    if !variants::is_plain(selection) {
        return Verdict::Right;
    }
    let more = || {
        paths(selection, case, mesh, expected, &rule)?;
        transformed(selection, case, mesh, expected, &rule)
    };
    match catch_unwind(AssertUnwindSafe(more)) {
        Ok(Ok(())) => Verdict::Right,
        Ok(Err(failure)) => Verdict::Failed(failure),
        Err(panic) => failed(FailureKind::Panic, message(panic.as_ref())),
    }
}

/// Whether the algorithm solves no mesh with such junctions.
fn refuses(selection: &Selection, mesh: &Mesh) -> bool {
    mesh.has_junctions() && !selection.crosses_junctions()
}

fn failed(kind: FailureKind, text: String) -> Verdict {
    Verdict::Failed(Failure { kind, text })
}

/// Traces a path to each vertex, or to some vertices of a large mesh.
///
/// A path is at most 1e-12 longer than its distance, and straight. It can be both only where the
/// distance is as exact, but 1e-9 are [right](Tolerance): then paths are not judged.
fn paths(
    selection: &Selection,
    case: &Case,
    mesh: &Mesh,
    expected: &Expected,
    rule: &Tolerance,
) -> Result<(), Failure> {
    let failed = |text| Failure {
        kind: FailureKind::Path,
        text,
    };
    let mut solver = selection.build(mesh);
    let found = Paths::find(solver.as_mut(), mesh, &sources(case), &Goal::everything());
    let paths = match found {
        Err(SolveError::NoPaths) => return Ok(()),
        found => found.map_err(|error| failed(error.to_string()))?,
    };
    let exact = rule.clone().with_relative(EXACT).with_rounding(ROUNDING);
    let is_inexact = |(v, d): (usize, &f64)| {
        expected[v].is_some_and(|expected| !exact.is_right(v, *d, expected))
    };
    let mut distances = paths.distances().iter().enumerate();
    if distances.any(is_inexact) || precision::doubt(mesh, paths.distances()).is_some() {
        return Ok(());
    }
    let surface = judged::surface(mesh);
    let sources = kept_sources(case, mesh);
    let step = mesh.vertex_count().div_ceil(MOST_PATHS);
    for v in mesh.vertices().step_by(step) {
        let d = paths.distances()[v.index()];
        let wrong = match paths.to(v) {
            Ok(Some(path)) => {
                let judged = judged::judge(&surface, &path, &sources, mesh.kept_vertex(v), d);
                judged.err().map(|flaw| flaw.to_string())
            }
            Ok(None) => (d < f64::INFINITY).then(|| "there is none".to_owned()),
            Err(lost) => Some(lost.to_string()),
        };
        if let Some(wrong) = wrong {
            return Err(failed(format!("to vertex {v}: {wrong}")));
        }
    }
    Ok(())
}

/// Solves the changed mesh of the case.
fn transformed(
    selection: &Selection,
    case: &Case,
    mesh: &Mesh,
    expected: &Expected,
    rule: &Tolerance,
) -> Result<(), Failure> {
    let Some((transform, mut random)) = case.transform() else {
        return Ok(());
    };
    let failed = |text| Failure {
        kind: FailureKind::Transform,
        text: format!("{transform}: {text}"),
    };
    let changed = transform.apply(&model(case, mesh), &mut random);
    let positions = changed.model.positions().unwrap_or_default().to_vec();
    let soup = TriangleSoup::new(positions, changed.model.triangles.clone());
    let changed_mesh = match Mesh::from_soup(soup) {
        // Rounding has made edges of no length, and may have left a vertex without faces.
        Ok((mesh, _)) if mesh.copies().len() > 0 && !changed.is_exact() => return Ok(()),
        Ok((mesh, _)) => mesh,
        Err(refused) if changed.is_exact() => return Err(failed(refused.to_string())),
        Err(_) => return Ok(()),
    };
    // Two faces with the same corners become four at the edge from a point that is inserted on one
    // of their edges to the opposite corner.
    if refuses(selection, &changed_mesh) {
        return Ok(());
    }
    let sources: Vec<VertexId> = changed
        .sources(&kept_sources(case, mesh))
        .into_iter()
        .map(VertexId::new)
        .collect();
    let solution = selection.build(&changed_mesh).solve(&sources);
    let distances = solution
        .map_err(|error| failed(error.to_string()))?
        .distances;
    let doubt = precision::doubt(&changed_mesh, &distances).map_or(0.0, |doubt| doubt.bound);
    let slack = changed.slack() + doubt / changed.factor;
    let mut restored = changed.restored(&distances);
    mesh.fill_copies(&mut restored);
    match compare(&restored, expected, rule, slack) {
        Some(failure) => Err(failed(failure.text)),
        None => Ok(()),
    }
}

/// The verdict on the certificate of the distances. A right bound includes the right distances.
pub(crate) fn judge_certificate(case: &Case, mesh: &Mesh, expected: &Expected) -> Verdict {
    let sources = sources(case);
    let proof = match catch_unwind(|| Certificate::of(mesh, &sources[..])) {
        Ok(Ok(proof)) => proof,
        Ok(Err(error)) => return failed(FailureKind::Panic, error.to_string()),
        Err(panic) => return failed(FailureKind::Panic, message(panic.as_ref())),
    };
    let all = proof.distances.iter().zip(expected).enumerate();
    for (vertex, (&found, expected)) in all {
        let expected = expected.unwrap_or(f64::INFINITY);
        let rounding = 4.0 * f64::EPSILON * expected;
        let is_right = found == expected
            || found - expected <= proof.too_long.absolute + rounding
                && expected - found <= proof.too_short.absolute + rounding;
        if !is_right {
            let (long, short) = (proof.too_long.absolute, proof.too_short.absolute);
            return failed(
                FailureKind::Proof,
                format!(
                    "vertex {vertex}: {found:?} instead of {expected:?}, proven to be at most \
                     {long:e} too long and {short:e} too short"
                ),
            );
        }
    }
    if proof.relative() <= tolerance::RELATIVE {
        Verdict::Right
    } else {
        Verdict::Unproven
    }
}

fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("a panic without a message").to_owned()
}

/// The worst of the distances that are wrong by more than `doubt`, if any.
fn compare(found: &[f64], expected: &Expected, rule: &Tolerance, doubt: f64) -> Option<Failure> {
    if found.len() != expected.len() {
        return Some(Failure {
            kind: FailureKind::Panic,
            text: format!("{} distances for {} vertices", found.len(), expected.len()),
        });
    }
    let mut worst: Option<(f64, Failure)> = None;
    for (vertex, (&found, expected)) in found.iter().zip(expected).enumerate() {
        let expected = expected.unwrap_or(f64::INFINITY);
        let difference = (found - expected).abs();
        if rule.is_right(vertex, found, expected) || difference <= doubt {
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
            difference / rule.allowed(vertex, expected)
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

/// The rule of what is right beside these distances.
fn rule(mesh: &Mesh, expected: &Expected) -> Tolerance {
    let field: Vec<f64> = expected
        .iter()
        .map(|d| d.unwrap_or(f64::INFINITY))
        .collect();
    Tolerance::on(mesh, &field)
}
