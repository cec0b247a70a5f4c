//! `geobench certify`.

use std::fmt::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use geobench_certify::{Bound, FailurePlace};
use geobench_export::json_lines;
use geobench_harness::exec::expected::Expected;
use geobench_harness::exec::model;
use geobench_mesh::threads::Threads;
use geobench_mesh::{Mesh, VertexId};
use geodesics::{Certificate, Comparison, OriginalFailure};
use serde::Serialize;

use crate::args::{MODELS_HELP, threads, tolerance};
use crate::isolation::ReadingOptions;
use crate::points::{Points, SourcesOptions};
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
pub(crate) struct CertifyOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    model: String,

    #[command(flatten)]
    sources: SourcesOptions,

    /// Distances to prove, of any program: lines `vertex,distance`, for all vertices or some
    /// [default: those of mmp]
    #[arg(long, value_name = "FILE")]
    distances: Option<PathBuf>,

    /// Largest error that passes, as a fraction of each distance
    #[arg(long, value_name = "T", allow_negative_numbers = true, default_value_t = 1e-9, value_parser = tolerance)]
    tolerance: f64,

    /// Threads that read the model and share the proof
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 1, value_parser = threads())]
    threads: u32,

    #[command(flatten)]
    reading: ReadingOptions,

    /// Form of the answer on standard output
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t = CertificateFormat::Text)]
    format: CertificateFormat,
}

/// Form of a certificate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum CertificateFormat {
    #[default]
    Text,
    Json,
}

pub(crate) fn certify(options: &CertifyOptions) -> anyhow::Result<Verdict> {
    let threads = Threads::start(options.threads as usize)?;
    let model = model::only(&options.model)?;
    let mesh = &threads.run(|| model.mesh_within(options.reading))?;
    let points = Points::new(mesh, &options.sources.all()?, None, &model.path)?;
    if options.format == CertificateFormat::Text {
        points.print_notes()?;
    }
    // The file is read before the long computation, so that an unreadable file is reported at once.
    let given = options.distances.as_ref().map(|path| {
        let label = &points.sources[0].0;
        Expected::File(path.clone()).find(path, label, mesh.vertex_count())
    });
    let given = given.transpose()?;
    let sources = points.source_vertices();
    let proof = threads.run(|| Certificate::of(&points.refined.mesh, &sources))?;
    let compared = given.map(|field| proof.compare(field.distances));
    let certificate =
        CertificateDocument::new(mesh, &points, &proof, compared.as_ref(), options.tolerance);
    let text = match options.format {
        CertificateFormat::Text => certificate.text(&model.name, options.tolerance),
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
    /// Amount of the violation, in the units of the model; null if infinite.
    violation: Option<f64>,
}

/// Maximum number of failures in the text output.
const SHOWN: usize = 10;

impl CertificateDocument {
    fn new(
        mesh: &Mesh,
        points: &Points,
        proof: &Certificate,
        compared: Option<&Comparison>,
        tolerance: f64,
    ) -> Self {
        let (long, short) = (&proof.too_long, &proof.too_short);
        let (mut absolute, mut relative) = (proof.absolute(), proof.relative());
        let mut details = vec![
            format!("not too long by more than {}", shown(long)),
            format!("not too short by more than {}", shown(short)),
        ];
        let mut failures: Vec<FailureRecord> = [long, short]
            .into_iter()
            .filter(|bound| bound.relative > tolerance)
            .flat_map(|bound| &bound.failures)
            .map(|failure| {
                let failure = OriginalFailure::new(failure, &points.refined, mesh);
                let (face, vertex) = match failure.place {
                    FailurePlace::Face(face) => (Some(face.raw()), None),
                    FailurePlace::Vertex(v) => (None, Some(v.raw())),
                };
                FailureRecord {
                    face,
                    edge: failure.edge.map(|ends| ends.map(VertexId::raw)),
                    vertex,
                    violation: Some(failure.violation).filter(|v| v.is_finite()),
                }
            })
            .collect();
        if let Some(compared) = compared {
            absolute += compared.absolute;
            relative += compared.relative;
            details.push(format!(
                "the file differs from these distances by up to {:.1e}, {:.1e} of a distance",
                compared.absolute, compared.relative
            ));
            let wrong = proof.wrong(compared, tolerance);
            failures.extend(wrong.map(|(v, by)| FailureRecord {
                face: None,
                edge: None,
                vertex: u32::try_from(v).ok(),
                violation: Some(by).filter(|by| by.is_finite()),
            }));
        }
        Self {
            schema: "geobench-certificate/1",
            certified: relative <= tolerance,
            absolute: Some(absolute).filter(|x| x.is_finite()),
            relative: Some(relative).filter(|x| x.is_finite()),
            faces: mesh.face_count(),
            pieces: long.pieces,
            failures,
            details,
        }
    }

    fn text(&self, model: &str, tolerance: f64) -> String {
        let number = |x: Option<f64>| x.map_or("infinity".to_owned(), |x| format!("{x:.1e}"));
        let (absolute, relative) = (number(self.absolute), number(self.relative));
        let mut text = if self.certified {
            format!("{model}: certified to {absolute}, {relative} of each distance\n")
        } else {
            format!(
                "{model}: not certified: an error of {absolute}, {relative} of a distance, is not \
                 excluded; {tolerance:.1e} is allowed\n"
            )
        };
        for detail in &self.details {
            let _ = writeln!(text, "  {detail}");
        }
        for failure in self.failures.iter().take(SHOWN) {
            let place = match (failure.face, failure.vertex) {
                (Some(face), _) => format!("face {face}"),
                (None, Some(vertex)) => format!("vertex {vertex}"),
                (None, None) => continue,
            };
            let by = failure
                .violation
                .map_or("without bound".to_owned(), |v| format!("by {v:.1e}"));
            let _ = writeln!(text, "  {place}: wrong {by}");
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
