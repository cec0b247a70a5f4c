//! `geobench certify`.

use std::fmt::Write;

use anyhow::{Context, bail};
use geobench_certify::{Bound, Claim, PathPoint, Place, WindowData};
use geobench_mesh::{HalfEdgeId, Mesh, VertexId};
use geobench_mmp::{Mmp, mmp, windows_of};
use geobench_paths::{Path as ShortestPath, Paths, Place as PathPlace};
use geobench_window::Goal;
use serde::Serialize;

use super::Verdict;
use super::args::{CertificateFormat, CertifyOptions};
use super::terminal;
use crate::exec::expected::Expected;
use crate::exec::model;

pub(super) fn certify(options: &CertifyOptions) -> anyhow::Result<Verdict> {
    let models = model::collect(std::slice::from_ref(&options.model))?;
    let [model] = &models[..] else {
        bail!(
            "{}: holds {} models; name one of them",
            options.model,
            models.len()
        );
    };
    let loaded = model.load_within(options.reading)?;
    let mesh = &loaded.mesh;
    let mut sources = Vec::new();
    for spec in &options.source {
        let found = spec.vertices(mesh.vertex_count());
        sources.extend(found.with_context(|| model.path.clone())?);
    }
    let proof = Proof::of(mesh, &sources)?;
    let compared = match &options.distances {
        None => None,
        Some(path) => {
            let file = Expected::File(path.clone());
            let field = file.find(path, &sources[0].raw().into(), mesh.vertex_count())?;
            Some(Comparison::of(&field.distances, &proof.distances))
        }
    };
    let certificate = Certificate::new(mesh, &proof, compared.as_ref(), options.tolerance);
    let text = match options.format {
        CertificateFormat::Text => certificate.text(&model.name, options.tolerance),
        CertificateFormat::Json => {
            let mut text = serde_json::to_string_pretty(&certificate)?;
            text.push('\n');
            text
        }
    };
    terminal::print(&text)?;
    Ok(if certificate.certified {
        Verdict::Passed
    } else {
        Verdict::Failed
    })
}

/// Distances of `mmp`, and how much they may be wrong.
struct Proof {
    distances: Vec<f64>,
    too_long: Bound,
    too_short: Bound,
}

impl Proof {
    fn of(mesh: &Mesh, sources: &[VertexId]) -> anyhow::Result<Self> {
        let mut solver: Mmp = mmp(mesh);
        let paths = Paths::find(&mut solver, mesh, sources, &Goal::everything())?;
        let distances = paths.distances().to_vec();
        let claim = Claim::new(mesh, sources, &distances)?;
        let too_long = claim.not_too_long(|h| window_data(&solver, h));
        drop(solver);
        let too_short = claim.not_too_short(|v| paths.to(v).ok().flatten().map(points));
        Ok(Self {
            distances,
            too_long,
            too_short,
        })
    }
}

fn window_data(solver: &Mmp, h: HalfEdgeId) -> impl Iterator<Item = WindowData> {
    windows_of(solver, h).map(|w| WindowData {
        interval: [w.b0, w.b1],
        image: w.source(),
        sigma: w.sigma,
    })
}

fn points(path: ShortestPath) -> Vec<PathPoint> {
    let point = |place: PathPlace| match place {
        PathPlace::Vertex(v) => Some(PathPoint::Vertex(v)),
        PathPlace::Edge { ends, t } => Some(PathPoint::Edge(ends, t)),
        // A path between vertices has none inside faces.
        PathPlace::Face => None,
    };
    path.points
        .into_iter()
        .filter_map(|p| point(p.place))
        .collect()
}

/// Distances of a file beside the proven ones.
struct Comparison {
    absolute: f64,
    relative: f64,
    /// Vertices and differences, largest first.
    differences: Vec<(usize, f64)>,
}

impl Comparison {
    fn of(given: &[(usize, f64)], proven: &[f64]) -> Self {
        let difference = |&(v, d): &(usize, f64)| {
            let by = if d == proven[v] {
                0.0
            } else {
                (d - proven[v]).abs()
            };
            (v, by)
        };
        let mut differences: Vec<(usize, f64)> = given.iter().map(difference).collect();
        differences.sort_by(|a, b| b.1.total_cmp(&a.1));
        let relative = |&(v, by): &(usize, f64)| if by > 0.0 { by / proven[v] } else { 0.0 };
        Self {
            absolute: differences.first().map_or(0.0, |d| d.1),
            relative: differences.iter().map(relative).fold(0.0, f64::max),
            differences,
        }
    }
}

/// What is printed.
#[derive(Serialize)]
struct Certificate {
    schema: &'static str,
    certified: bool,
    /// Bounds of the error of all distances; null if infinite.
    absolute: Option<f64>,
    relative: Option<f64>,
    faces: usize,
    pieces: usize,
    failures: Vec<Failure>,
    #[serde(skip)]
    details: Vec<String>,
}

#[derive(Serialize)]
struct Failure {
    face: Option<u32>,
    vertex: Option<u32>,
    /// Null if infinite.
    violation: Option<f64>,
}

/// Failures that are printed as text.
const SHOWN: usize = 10;

impl Certificate {
    fn new(mesh: &Mesh, proof: &Proof, compared: Option<&Comparison>, tolerance: f64) -> Self {
        let (long, short) = (&proof.too_long, &proof.too_short);
        let mut absolute = long.absolute.max(short.absolute);
        let mut relative = long.relative.max(short.relative);
        let mut details = vec![
            format!("not too long by more than {}", shown(long)),
            format!("not too short by more than {}", shown(short)),
        ];
        let mut failures: Vec<Failure> = [long, short]
            .into_iter()
            .filter(|bound| bound.relative > tolerance)
            .flat_map(|bound| &bound.failures)
            .map(|failure| {
                let (face, vertex) = match failure.place {
                    Place::Face(face) => (Some(face.raw()), None),
                    Place::Vertex(vertex) => (None, Some(vertex.raw())),
                };
                Failure {
                    face,
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
            let beyond = |&&(v, by): &&(usize, f64)| by > tolerance * proof.distances[v];
            let wrong = compared.differences.iter().filter(beyond);
            failures.extend(wrong.map(|&(v, by)| Failure {
                face: None,
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

fn shown(bound: &Bound) -> String {
    format!(
        "{:.1e}, {:.1e} of a distance",
        bound.absolute, bound.relative
    )
}
