//! Certificates of distances as records: of model files, of the zoo and of the slivers.
//!
//! ```sh
//! cargo run --release -p geobench-geodesic --example certificates -- MODEL... > record.json
//! cargo run --release -p geobench-geodesic --example certificates -- --table record.json
//! ```
//!
//! `scripts/certificates` keeps the record and puts the table into `results/certificates.md`.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use geobench_mesh::{Mesh, TriangleSoup};
use geobench_oracle::{Geometry, zoo};
use geodesic::certify::{Bound, Place};
use geodesic::{Certificate, Solver};
use serde::{Deserialize, Serialize};

#[expect(dead_code, reason = "the proof does not need the right distances")]
#[path = "../../oracle/examples/fuzz/slivers.rs"]
mod slivers;

/// The largest error that passes, as a fraction of each distance.
const TOLERANCE: f64 = 1e-9;

#[derive(Serialize, Deserialize)]
struct Record {
    schema: String,
    tolerance: f64,
    certificates: Vec<Line>,
}

/// One certificate.
#[derive(Serialize, Deserialize)]
struct Line {
    /// `models`, `zoo` or `slivers`.
    set: String,
    name: String,
    vertices: usize,
    faces: usize,
    source: Vec<u32>,
    pieces: usize,
    certified: bool,
    /// The greatest distance of a vertex.
    farthest: f64,
    /// By how much a distance may be wrong; null if nothing is proven.
    absolute: Option<f64>,
    /// The same as a fraction of the distance, together and in each direction.
    relative: Option<f64>,
    too_long: Option<f64>,
    too_short: Option<f64>,
    /// The worst place, if it is not certified.
    worst: Option<String>,
    /// Seconds of mmp, and of mmp with its proof.
    solve_seconds: f64,
    seconds: f64,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(io::stderr(), "certificates: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &[String]) -> Result<(), Box<dyn std::error::Error>> {
    let mut out = io::stdout().lock();
    if let [option, file] = arguments
        && option == "--table"
    {
        let record: Record = serde_json::from_slice(&std::fs::read(file)?)?;
        out.write_all(table(&record).as_bytes())?;
        return Ok(());
    }
    let mut certificates = Vec::new();
    for model in arguments {
        let path = Path::new(model);
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        certificates.push(certify("models", &name, &Mesh::read(path)?, &[0])?);
    }
    for model in zoo::small().into_iter().chain(zoo::slow()) {
        let Geometry::Positions(positions) = model.geometry else {
            continue;
        };
        let (mesh, _) = Mesh::from_soup(TriangleSoup::new(positions, model.triangles))?;
        let source = &model.sources[..1];
        certificates.push(certify("zoo", &model.name, &mesh, source)?);
    }
    for sliver in slivers::read()? {
        let (mesh, _) = Mesh::from_soup(TriangleSoup::new(sliver.vertices, sliver.faces))?;
        certificates.push(certify("slivers", &sliver.name, &mesh, &sliver.source)?);
    }
    let record = Record {
        schema: "geobench-certificates/1".to_owned(),
        tolerance: TOLERANCE,
        certificates,
    };
    serde_json::to_writer_pretty(&mut out, &record)?;
    out.write_all(b"\n")?;
    Ok(())
}

fn certify(
    set: &str,
    name: &str,
    mesh: &Mesh,
    source: &[u32],
) -> Result<Line, Box<dyn std::error::Error>> {
    let start = Instant::now();
    geodesic::mmp::mmp(mesh).distances_from(source)?;
    let solve_seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let proof = Certificate::of(mesh, source)?;
    let seconds = start.elapsed().as_secs_f64();
    let finite = |x: f64| Some(x).filter(|x| x.is_finite());
    let certified = proof.relative() <= TOLERANCE;
    let place = |bound: &Bound| {
        let worst = bound.failures.first()?;
        let by = worst.violation;
        Some(match worst.place {
            Place::Face(face) => format!("face {face}: {by:.1e}"),
            Place::Vertex(vertex) => format!("vertex {vertex}: {by:.1e}"),
        })
    };
    let bounds = [&proof.too_long, &proof.too_short];
    let fails = bounds.into_iter().find(|bound| bound.relative > TOLERANCE);
    Ok(Line {
        set: set.to_owned(),
        name: name.to_owned(),
        vertices: mesh.vertex_count(),
        faces: mesh.face_count(),
        source: source.to_vec(),
        pieces: proof.too_long.pieces,
        certified,
        farthest: {
            let distances = proof.distances.iter().copied();
            distances.filter(|d| d.is_finite()).fold(0.0, f64::max)
        },
        absolute: finite(proof.absolute()),
        relative: finite(proof.relative()),
        too_long: finite(proof.too_long.relative),
        too_short: finite(proof.too_short.relative),
        worst: fails.and_then(place),
        solve_seconds,
        seconds,
    })
}

fn table(record: &Record) -> String {
    let shown = |x: Option<f64>| x.map_or("none".to_owned(), |x| format!("{x:.1e}"));
    let mut text = String::from(
        "| model | faces | pieces | too long | too short | time / mmp |\n|---|--:|--:|--:|--:|--:|\n",
    );
    let lines = || record.certificates.iter();
    for line in lines().filter(|line| line.set == "models") {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {:.1} |",
            line.name,
            line.faces,
            line.pieces,
            shown(line.too_long),
            shown(line.too_short),
            line.seconds / line.solve_seconds,
        );
    }
    text.push_str(
        "\n| set | meshes | certified | to 1e-9 of the farthest distance | median error | largest certified |\n|---|--:|--:|--:|--:|--:|\n",
    );
    for set in ["models", "zoo", "slivers"] {
        let all: Vec<&Line> = lines().filter(|line| line.set == set).collect();
        let bound = |line: &&Line| line.relative.unwrap_or(f64::INFINITY);
        let mut errors: Vec<f64> = all.iter().map(bound).collect();
        errors.sort_by(f64::total_cmp);
        let good: Vec<&&Line> = all.iter().filter(|line| line.certified).collect();
        let largest = good.iter().map(|line| bound(line)).fold(0.0, f64::max);
        let median = errors.get(errors.len() / 2).copied();
        let close = all.iter().filter(|line| {
            let absolute = line.absolute.unwrap_or(f64::INFINITY);
            absolute <= TOLERANCE * line.farthest
        });
        let _ = writeln!(
            text,
            "| {set} | {} | {} | {} | {} | {largest:.1e} |",
            all.len(),
            good.len(),
            close.count(),
            shown(median),
        );
    }
    let rest: Vec<&Line> = lines().filter(|line| !line.certified).collect();
    if !rest.is_empty() {
        text.push_str(
            "\n| not certified | too long | too short | worst place |\n|---|--:|--:|---|\n",
        );
    }
    for line in rest {
        let _ = writeln!(
            text,
            "| {} ({}) | {} | {} | {} |",
            line.name,
            line.set,
            shown(line.too_long),
            shown(line.too_short),
            line.worst.as_deref().unwrap_or(""),
        );
    }
    if text.contains("<details>") {
        text.push_str("\n</details>\n");
    }
    text
}
