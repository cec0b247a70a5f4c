//! `geobench certify`.

use std::fmt::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use geobench_certify::{Bound, FailurePlace};
use geobench_export::json_lines;
use geobench_harness::exec::expected::Expected;
use geobench_mesh::threads::Threads;
use geobench_mesh::{Mesh, VertexId};
use geodesics::{Certificate, Judgement, OriginalFailure};
use serde::Serialize;

use geobench_harness::plan::suite::options::{ThreadsOption, ToleranceOption};

use crate::args::{FormatOption, MODELS_HELP};
use crate::isolation::ReadingOptions;
use crate::points::{LocatedPoints, SourcesOptions};
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(
    after_help = MODELS_HELP,
    mut_arg("tolerance", |tolerance| tolerance.help(
        "Largest error that passes, as a fraction of each distance [default: 1e-9]"
    )),
    mut_arg("threads", |threads| threads.help(
        "Threads that read the model and share the proof [default: 1]"
    )),
)]
pub(crate) struct CertifyOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    model: String,

    #[command(flatten)]
    sources: SourcesOptions,

    /// Distances to prove, of any program: lines `vertex,distance` [default: those of mmp]
    #[arg(long, value_name = "FILE")]
    distances: Option<PathBuf>,

    /// Accept a file that lacks vertices
    #[arg(long, requires = "distances")]
    partial: bool,

    #[command(flatten)]
    tolerance: ToleranceOption,

    #[command(flatten)]
    threads: ThreadsOption,

    #[command(flatten)]
    reading: ReadingOptions,

    #[command(flatten)]
    format: FormatOption<CertificateFormat>,
}

/// Form of a certificate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum CertificateFormat {
    #[default]
    Text,
    Json,
}

pub(crate) fn certify(options: &CertifyOptions) -> anyhow::Result<Verdict> {
    let threads = Threads::start(options.threads.number())?;
    let model = options.reading.model(&options.model)?;
    let mesh = &threads.run(|| options.reading.mesh(&model, false))?;
    let points = LocatedPoints::new(mesh, &options.sources.all()?, None, &model.path)?;
    points.tell(mesh, false);
    // The file is read before the long computation, so that an unreadable file is reported at once.
    let given = options.distances.as_ref().map(|path| {
        let label = &points.sources[0].0;
        Expected::File(path.clone()).find(path, None, label, mesh.vertex_count())
    });
    let given = given.transpose()?;
    let sources = points.source_vertices();
    let refined = &points.refined.mesh;
    let tolerance = options.tolerance.number();
    let proof = threads.run(|| Certificate::within(refined, &sources, tolerance))?;
    let given = given.map_or_else(
        || {
            proof
                .distances
                .iter()
                .copied()
                .take(mesh.vertex_count())
                .enumerate()
                .collect()
        },
        |field| field.distances,
    );
    let certificate = CertificateDocument::new(mesh, &points, &proof, &given, options);
    let text = match options.format.chosen() {
        CertificateFormat::Text => certificate.text(&model.name, options.tolerance.number()),
        CertificateFormat::Json => json_lines(&certificate)?,
    };
    terminal::print(&text)?;
    Ok(Verdict::of(certificate.certified))
}

/// The result of the command, in the form of its JSON output.
#[derive(Serialize)]
struct CertificateDocument {
    schema: &'static str,
    certified: bool,
    /// Bound of the absolute error of all distances, in the units of the model; null if infinite.
    /// `relative` is a bound of the relative error.
    absolute: Option<f64>,
    relative: Option<f64>,
    faces: usize,
    vertices: usize,
    /// Number of vertices whose distances were proven or compared.
    compared: usize,
    /// Number of envelope pieces on all edges, which measures the size of the proof.
    pieces: usize,
    failures: Vec<FailureRecord>,
    /// Further lines of the text output.
    #[serde(skip)]
    details: Vec<String>,
}

#[derive(Serialize)]
struct FailureRecord {
    face: Option<u32>,
    /// End vertices of the edge of `face` at which distances are too long.
    edge: Option<[u32; 2]>,
    vertex: Option<u32>,
    /// Whether the distance is proven wrong, by this amount at least. Else it is not proven right,
    /// and an error of this amount is not excluded.
    wrong: bool,
    /// In the units of the model; null if infinite.
    violation: Option<f64>,
}

impl FailureRecord {
    const fn of_vertex(v: usize, wrong: bool, violation: f64) -> Self {
        Self {
            face: None,
            edge: None,
            vertex: Some(v as u32),
            wrong,
            violation: if violation.is_finite() {
                Some(violation)
            } else {
                None
            },
        }
    }

    /// A place at which the proof of the field of `mmp` fails.
    fn of_proof(failure: &OriginalFailure, mesh: &Mesh) -> Self {
        let (face, vertex) = match failure.place {
            FailurePlace::Face(face) => (Some(mesh.file_triangle(face)), None),
            FailurePlace::Vertex(v) => (None, Some(v.raw())),
        };
        Self {
            face,
            edge: failure.edge.map(|ends| ends.map(VertexId::raw)),
            vertex,
            wrong: false,
            violation: Some(failure.violation).filter(|v| v.is_finite()),
        }
    }

    fn text(&self) -> String {
        let place = match (self.face, self.vertex) {
            (Some(face), _) => format!("face {face}"),
            (None, Some(vertex)) => format!("vertex {vertex}"),
            (None, None) => "nowhere".to_owned(),
        };
        match (self.wrong, self.violation) {
            (true, Some(by)) => format!("{place}: wrong by at least {by:.1e}"),
            (true, None) => format!(
                "{place}: wrong: not a number, or infinite where a path leads, or finite where none does"
            ),
            (false, Some(by)) => {
                format!("{place}: cannot be proven: an error of {by:.1e} is not excluded")
            }
            (false, None) => format!("{place}: cannot be proven"),
        }
    }
}

/// Maximum number of failures in the text output.
const SHOWN: usize = 10;

impl CertificateDocument {
    /// Judges the distances `given`, with their vertices.
    fn new(
        mesh: &Mesh,
        points: &LocatedPoints,
        proof: &Certificate,
        given: &[(usize, f64)],
        options: &CertifyOptions,
    ) -> Self {
        let tolerance = options.tolerance.number();
        let greatest = |error: fn(&Certificate, usize, f64) -> f64| {
            let errors = given.iter().map(|&(v, d)| error(proof, v, d));
            Some(errors.fold(0.0, f64::max)).filter(|x| x.is_finite())
        };
        let (long, short) = (&proof.too_long, &proof.too_short);
        let mut details = vec![
            format!("mmp: not too long by more than {}", shown(long)),
            format!("mmp: not too short by more than {}", shown(short)),
        ];
        let mut compared: Vec<usize> = given.iter().map(|&(v, _)| v).collect();
        compared.sort_unstable();
        compared.dedup();
        let (compared, vertices) = (compared.len(), mesh.vertex_count());
        let share = 100.0 * compared as f64 / vertices as f64;
        let unreachable = given.iter().filter(|(_, d)| d.is_infinite()).count();
        details.push(format!(
            "{compared} of {vertices} vertices compared, {share:.3} %; {unreachable} unreachable"
        ));
        let is_complete = options.partial || compared == vertices;
        if !is_complete {
            details.push("vertices are missing; --partial allows it".to_owned());
        }
        let mut judged: Vec<FailureRecord> = given
            .iter()
            .filter_map(|&(v, d)| match proof.judge(v, d, tolerance) {
                Judgement::Right => None,
                Judgement::Wrong(by) => Some(FailureRecord::of_vertex(v, true, by)),
                Judgement::Unproven(by) => Some(FailureRecord::of_vertex(v, false, by)),
            })
            .collect();
        let size = |record: &FailureRecord| record.violation.unwrap_or(f64::INFINITY);
        judged.sort_by(|a, b| b.wrong.cmp(&a.wrong).then(size(b).total_cmp(&size(a))));
        let certified = is_complete && judged.is_empty();
        let mut failures = Vec::new();
        // The places tell more than the vertices behind them.
        if proof.relative() > tolerance {
            let of_proof = long.failures.iter().chain(&short.failures);
            let of_proof = of_proof.map(|f| OriginalFailure::new(f, &points.refined, mesh));
            failures.extend(of_proof.map(|f| FailureRecord::of_proof(&f, mesh)));
            judged.retain(|record| record.wrong);
        }
        judged.append(&mut failures);
        Self {
            schema: "geobench-certificate/1",
            certified,
            absolute: greatest(Certificate::error),
            relative: greatest(Certificate::relative_error),
            faces: mesh.face_count(),
            vertices,
            compared,
            pieces: long.pieces,
            failures: judged,
            details,
        }
    }

    fn text(&self, model: &str, tolerance: f64) -> String {
        let number = |x: Option<f64>| x.map_or("infinity".to_owned(), |x| format!("{x:.1e}"));
        let (absolute, relative) = (number(self.absolute), number(self.relative));
        let is_within = self.relative.is_some_and(|relative| relative <= tolerance);
        let mut text = if self.certified {
            format!("{model}: certified to {absolute}, {relative} of each distance\n")
        } else if is_within {
            format!("{model}: not certified: distances are missing\n")
        } else if self.failures.iter().any(|failure| failure.wrong) {
            format!("{model}: not certified: distances are wrong\n")
        } else {
            format!(
                "{model}: not certified: cannot be proven; an error of {absolute}, {relative} of a \
                 distance, is not excluded, and {tolerance:.1e} is allowed\n"
            )
        };
        for detail in &self.details {
            let _ = writeln!(text, "  {detail}");
        }
        for failure in self.failures.iter().take(SHOWN) {
            let _ = writeln!(text, "  {}", failure.text());
        }
        if self.failures.len() > SHOWN {
            let _ = writeln!(text, "  and {} more", self.failures.len() - SHOWN);
        }
        text
    }
}

/// The absolute and the relative bound.
fn shown(bound: &Bound) -> String {
    format!(
        "{:.1e}, {:.1e} of a distance",
        bound.absolute, bound.relative
    )
}
