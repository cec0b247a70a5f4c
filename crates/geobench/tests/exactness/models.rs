//! Real models: compares every algorithm with the others and with independent programs.
//!
//! The models and the distances are beside the project, in `shared/models` and `shared/expected`.
//! The environment variable `GEOBENCH_SHARED` names another directory. Missing files are skipped
//! with a message on standard error.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

use geobench_mesh::{Mesh, io as mesh_io};
use geobench_oracle::Random;
use geobench_registry::Selection;
use rayon::prelude::*;

use crate::support::{AGREEMENT, Failures, Run, can_finish, caught, exact_algorithms};

/// The number of random sources of each model, in addition to those with expected distances.
const RANDOM_SOURCES: usize = 10;

/// The same for the short test of a [`LARGE`] model.
const RANDOM_SOURCES_OF_LARGE: usize = 2;

/// The models that the distances in `shared/expected` belong to.
const MODELS: [&str; 9] = [
    "cow.off",
    "cube20.obj",
    "grid60.obj",
    "horse.obj",
    "igea.ply",
    "int80.obj",
    "spot.obj",
    "stanford-bunny.obj",
    "suzanne.obj",
];

fn shared() -> PathBuf {
    env::var_os("GEOBENCH_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    )
}

/// Reports on standard error what is not tested. Bypasses the capture of test output, which would
/// hide it.
fn skip(what: &Path) {
    let _ = writeln!(
        io::stderr(),
        "SKIPPED: {} is missing; set GEOBENCH_SHARED to the folder with models/ and expected/",
        what.display()
    );
}

/// Distances of one model and source from independent programs, for all or some vertices.
struct Expected {
    source: u32,
    distances: Vec<(usize, f64)>,
}

/// The expected distances of the model called `stem`, from all files `stem.sSOURCE.csv`.
fn expected(stem: &str) -> io::Result<Vec<Expected>> {
    let mut all = Vec::new();
    for entry in fs::read_dir(shared().join("expected"))? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let source = name
            .strip_prefix(stem)
            .and_then(|rest| rest.strip_prefix(".s"));
        let source = source.and_then(|rest| rest.strip_suffix(".csv"));
        let Some(source) = source.and_then(|number| number.parse().ok()) else {
            continue;
        };
        let text = fs::read_to_string(&path)?;
        let pair = |line: &str| {
            let (vertex, distance) = line.split_once(',')?;
            Some((vertex.parse().ok()?, distance.parse().ok()?))
        };
        let distances = text.lines().skip(1).map(pair).collect::<Option<_>>();
        let damaged = || io::Error::other(format!("{} is damaged", path.display()));
        all.push(Expected {
            source,
            distances: distances.ok_or_else(damaged)?,
        });
    }
    all.sort_by_key(|e| e.source);
    Ok(all)
}

fn load(path: &Path) -> Mesh {
    let soup = mesh_io::read(path).unwrap_or_else(|error| panic!("{error}"));
    let (mesh, _) = Mesh::from_soup(soup).unwrap_or_else(|error| panic!("{error}"));
    mesh
}

/// On models with more faces, the short test runs only [`CORE`] from every source.
const LARGE: usize = 50_000;

/// On models with more faces, the short test runs only [`CORE`].
const HUGE: usize = 200_000;

/// The algorithms whose components make up all others.
const CORE: [&str; 5] = ["mmp", "ich", "vtp", "vtp-fast", "pvtp"];

/// Which algorithms run from which sources.
#[derive(Clone, Copy, PartialEq)]
enum Extent {
    /// All algorithms from all sources. On [`LARGE`] models, algorithms outside [`CORE`] run only
    /// from the first source with distances of other programs; on [`HUGE`] ones, they do not run.
    Short,
    /// All algorithms from all sources, which takes most of an hour on two cores.
    Full,
}

/// Runs the algorithms from the sources of a model, two at a time on two cores.
fn check(model: &str, extent: Extent, failures: &mut Failures) {
    let path = shared().join("models").join(model);
    if !path.exists() {
        skip(&path);
        return;
    }
    let stem = model.split('.').next().unwrap_or(model);
    let expected = expected(stem).unwrap_or_default();
    if expected.is_empty() {
        skip(&shared().join("expected").join(format!("{stem}.s*.csv")));
    }
    let mesh = load(&path);
    let is_short_for = |faces| extent == Extent::Short && mesh.face_count() > faces;
    let random_sources = if is_short_for(LARGE) {
        RANDOM_SOURCES_OF_LARGE
    } else {
        RANDOM_SOURCES
    };
    let mut random = Random::new(mesh.face_count() as u64);
    let mut sources: Vec<u32> = expected.iter().map(|e| e.source).collect();
    sources.extend((0..random_sources).map(|_| random.below(mesh.vertex_count() as u32)));
    let mut algorithms = exact_algorithms();
    algorithms.retain(|selection| can_finish(selection.algorithm(), mesh.face_count(), 1e8));
    let takes_part = |source: u32, selection: &Selection| {
        let is_first = expected.first().is_some_and(|e| e.source == source);
        let is_core = CORE.contains(&selection.algorithm().name);
        is_core || !is_short_for(HUGE) && (is_first || !is_short_for(LARGE))
    };
    let cells: Vec<_> = sources
        .iter()
        .flat_map(|&source| algorithms.iter().map(move |selection| (source, selection)))
        .filter(|&(source, selection)| takes_part(source, selection))
        .collect();
    let solve = |&(source, selection): &(u32, &Selection)| {
        let mut failures = Failures::default();
        let mut run = Run::new(selection.clone(), model, &mesh);
        let found = caught(&mut failures, || run.distances(&[source]));
        (source, run.at(&[source]), found, failures)
    };
    let answers: Vec<_> = cells.par_iter().map(solve).collect();
    for of_source in answers.chunk_by(|x, y| x.0 == y.0) {
        let source = of_source[0].0;
        let first = of_source.iter().find_map(|(_, _, found, _)| found.as_ref());
        for (_, at, found, _) in of_source {
            let (Some(found), Some(first)) = (found, first) else {
                continue;
            };
            failures.compare_all(|| format!("{at}, and the first"), found, first, AGREEMENT);
            for e in expected.iter().filter(|e| e.source == source) {
                let known = e.distances.iter().copied();
                failures.compare(|| format!("{at}, and others"), found, known, AGREEMENT);
            }
        }
    }
    for (_, _, _, of_cell) in answers {
        failures.extend(of_cell);
    }
}

fn check_all(extent: Extent) {
    let mut models: Vec<String> = MODELS.map(str::to_owned).into();
    match fs::read_dir(shared().join("models")) {
        Ok(entries) => models.extend(
            entries
                .filter_map(Result::ok)
                .filter(|entry| mesh_io::is_mesh_file(&entry.path()))
                .map(|entry| entry.file_name().to_string_lossy().into_owned()),
        ),
        Err(_) => skip(&shared().join("models")),
    }
    models.sort();
    models.dedup();
    let mut failures = Failures::default();
    for model in models {
        let mut of_model = Failures::default();
        let _ = caught(&mut failures, || check(&model, extent, &mut of_model));
        failures.extend(of_model);
    }
    failures.report();
}

#[test]
fn every_model_agrees_among_algorithms_and_with_other_programs() {
    check_all(Extent::Short);
}

#[test]
#[ignore = "takes most of an hour: every algorithm from every source of every model"]
fn every_algorithm_agrees_from_every_source() {
    check_all(Extent::Full);
}
