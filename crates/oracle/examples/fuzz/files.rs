//! Failures as files for `geobench verify`.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use geobench_mesh::io as mesh_io;

use crate::case::{Case, Expected, Failure, FailureKind, Limited};

/// The comment before the sources in a file.
const SOURCES: &str = "# sources:";

/// The comment in a file on which windows are limited.
const LIMITED: [(Limited, &str); 2] = [
    (Limited::All, "# windows: bounded"),
    (Limited::NearestFirst, "# windows: bounded if nearest first"),
];

/// The comment before the seed of a change of the mesh.
const TRANSFORM: &str = "# transform:";

/// An algorithm and the defect of its answer.
pub(crate) type AlgorithmFailure = (String, Failure);

/// Writes `NAME.obj` to `folder`. For a single source, also writes the right distances beside it,
/// where `verify` finds them.
pub(crate) fn write(
    folder: &Path,
    name: &str,
    origin: &str,
    case: &Case,
    expected: &Expected,
    failures: &[AlgorithmFailure],
) -> io::Result<PathBuf> {
    fs::create_dir_all(folder)?;
    let path = folder.join(format!("{name}.obj"));
    let mut out = BufWriter::new(File::create(&path)?);
    writeln!(out, "# {origin}")?;
    for (algorithm, failure) in failures {
        writeln!(out, "# {algorithm}: {failure}")?;
    }
    writeln!(out, "{}", command(name, case, failures))?;
    let sources: Vec<String> = case.sources.iter().map(u32::to_string).collect();
    writeln!(out, "{SOURCES} {}", sources.join(" "))?;
    if let Some((_, comment)) = LIMITED.iter().find(|(kind, _)| *kind == case.limited) {
        writeln!(out, "{comment}")?;
    }
    if let Some(seed) = case.transform {
        writeln!(out, "{TRANSFORM} {seed}")?;
    }
    mesh_io::write_obj(&mut out, &case.vertices, &case.faces)?;
    out.flush()?;
    if let [source] = case.sources[..] {
        let mut text = "vertex,distance\n".to_owned();
        for (vertex, distance) in expected.iter().enumerate() {
            let _ = writeln!(text, "{vertex},{:?}", distance.unwrap_or(f64::INFINITY));
        }
        fs::write(folder.join(format!("{name}.s{source}.csv")), text)?;
    }
    Ok(path)
}

/// The command line that reproduces the failure.
fn command(name: &str, case: &Case, failures: &[AlgorithmFailure]) -> String {
    let algorithms: Vec<&str> = failures.iter().map(|(name, _)| name.as_str()).collect();
    let algorithms = algorithms.join(",");
    // `verify` takes one source at a time and compares distances only.
    let counted = |(_, failure): &AlgorithmFailure| {
        use FailureKind::{Path, Proof, Transform, Work};
        matches!(failure.kind, Work | Path | Transform | Proof)
    };
    match case.sources[..] {
        [source] if !failures.iter().any(counted) => {
            format!("# geobench verify {name}.obj --source {source} --algo '{algorithms}'")
        }
        _ => format!(
            "# cargo run --release -p geobench-oracle --example fuzz -- \
             --again {name}.obj --algo '{algorithms}'"
        ),
    }
}

/// Reads a file of [`write`]. The source is 0 in a file that names none.
pub(crate) fn read(path: &Path) -> io::Result<Case> {
    let soup = mesh_io::read(path).map_err(io::Error::other)?;
    let text = fs::read_to_string(path)?;
    let after = |what| text.lines().find_map(|line| line.strip_prefix(what));
    let named = after(SOURCES);
    let numbers = named.unwrap_or("0").split_whitespace();
    let sources = numbers.map(str::parse).collect::<Result<_, _>>();
    let has_line = |comment| text.lines().any(|line| line == comment);
    let limited = LIMITED.iter().find(|(_, comment)| has_line(*comment));
    Ok(Case {
        vertices: soup.positions,
        faces: soup.triangles,
        sources: sources.map_err(io::Error::other)?,
        limited: limited.map_or(Limited::None, |(kind, _)| *kind),
        transform: after(TRANSFORM).and_then(|seed| seed.trim().parse().ok()),
    })
}
