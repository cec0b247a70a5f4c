//! Certificates of distances as records: of model files, of the zoo and of the slivers.
//!
//! ```sh
//! cargo run --release -p geodesics --example certificates -- MODEL... > record.json
//! cargo run --release -p geodesics --example certificates -- --table record.json
//! ```
//!
//! `scripts/certificates` keeps the record and puts the table into `results/certificates.md`;
//! the test `certificates` compares both.

use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use geobench_mesh::{Mesh, TriangleSoup};
use geobench_oracle::{Geometry, zoo};
use geodesics::certify::{Bound, FailurePlace};
use geodesics::{Certificate, Solver};

#[expect(dead_code, reason = "the proof does not need the right distances")]
#[path = "../../../oracle/examples/fuzz/slivers.rs"]
mod slivers;
mod table;

use table::{Line, Record, TOLERANCE, table};

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
    geodesics::mmp::mmp(mesh).distances_from(source)?;
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
            FailurePlace::Face(face) => format!("face {face}: {by:.1e}"),
            FailurePlace::Vertex(vertex) => format!("vertex {vertex}: {by:.1e}"),
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
