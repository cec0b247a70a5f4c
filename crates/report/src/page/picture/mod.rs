//! The picture of a report: chooses the model, and computes distances, isolines and paths.

use std::fmt::Display;
use std::fs;
use std::path::Path;

use geobench_export::picture::{Picture, Scene, short, step};
use geobench_harness::exec::limits::DecompressionLimit;
use geobench_harness::exec::model::{self, ModelRef};
use geobench_harness::measure::number::grouped;
use geobench_harness::schema::ResultFile;
use geobench_isolines::DistanceField;
use geobench_mesh::generate::Spec;
use geobench_mesh::{Mesh, VertexId, Weld};
use geobench_paths::Paths;
use geobench_registry::UsageError;
use geobench_vtp::VtpFast;
use geobench_window::Goal;

/// Approximate number of isolines.
const ISOLINES: f64 = 24.0;

/// The most faces of a model that is drawn without being asked for.
const MOST_FACES: u64 = 1_000_000;

/// The most faces of a model that is drawn with exact isolines. At this size they take about a
/// second.
const MOST_FACES_WITH_WINDOWS: usize = 60_000;

/// The largest file of a model that is drawn.
const MOST_BYTES: u64 = 1 << 32;

/// The number of shortest paths that are drawn.
const PATHS: usize = 5;

/// A picture of a model.
#[derive(Clone, Debug)]
pub(crate) struct ModelPicture {
    /// The name of the model.
    pub(crate) model: String,
    /// What is drawn, in words.
    pub(crate) caption: String,
    pub(crate) flat: Picture,
}

/// The model that is drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PictureChoice {
    /// No picture.
    None,
    /// The first model that can be loaded again.
    Any,
    /// This model, from this source or else from the source of its first cell.
    Of {
        /// Its name in the result.
        model: String,
        /// The source, as the index of a vertex.
        source: Option<u32>,
    },
}

impl std::str::FromStr for PictureChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "none" {
            return Ok(Self::None);
        }
        let (model, source) = match text.rsplit_once(':') {
            Some((model, source)) if source.chars().all(|c| c.is_ascii_digit()) => {
                let number = source
                    .parse()
                    .map_err(|_| format!("`{source}` is no vertex number"))?;
                (model, Some(number))
            }
            _ => (text, None),
        };
        if model.is_empty() {
            return Err("name a model, or none".to_owned());
        }
        Ok(Self::Of {
            model: model.to_owned(),
            source,
        })
    }
}

/// The picture of a model of `result` that `wanted` asks for; `None` if no model can be drawn.
///
/// # Errors
///
/// When `wanted` names a model that does not exist or cannot be drawn.
pub(crate) fn picture(
    result: &ResultFile,
    wanted: &PictureChoice,
    limit: DecompressionLimit,
) -> Result<Option<ModelPicture>, UsageError> {
    match wanted {
        PictureChoice::None => Ok(None),
        PictureChoice::Of { model, source } => {
            if result.models.iter().all(|m| m.name != *model) {
                let known: Vec<&str> = result.models.iter().map(|m| m.name.as_str()).collect();
                return Err(UsageError(format!(
                    "--picture {model}: the result has no such model; it has {}",
                    known.join(", ")
                )));
            }
            of_model(result, model, *source, limit).map(Some)
        }
        PictureChoice::Any => Ok(result
            .models
            .iter()
            .filter(|m| m.faces.is_some_and(|faces| faces <= MOST_FACES))
            .find_map(|m| of_model(result, &m.name, None, limit).ok())),
    }
}

/// Checks that a model that a result file names is a regular file of a usual size. A result file
/// may come from anywhere, and a pipe or a device would never end.
fn check_file(path: &Path) -> Result<(), String> {
    let shown = path.display();
    let found = fs::metadata(path).map_err(|error| format!("{shown}: {error}"))?;
    if found.is_file() && found.len() <= MOST_BYTES {
        return Ok(());
    }
    Err(format!("{shown} is not a file of a usual size"))
}

fn of_model(
    result: &ResultFile,
    name: &str,
    source: Option<u32>,
    limit: DecompressionLimit,
) -> Result<ModelPicture, UsageError> {
    let error = |problem: &dyn Display| UsageError(format!("no picture of {name}: {problem}"));
    let record = result.models.iter().find(|m| m.name == name);
    let record = record.ok_or_else(|| error(&"it is not in the result"))?;
    let check = |path: &Path| check_file(path).map_err(|problem| error(&problem));
    if record.path == "-" {
        return Err(error(&"it came from standard input"));
    }
    if !Spec::is_spec(&record.path) {
        check(Path::new(&record.path))?;
    }
    let found = model::collect(std::slice::from_ref(&record.path));
    let [model]: [ModelRef; 1] = found
        .map_err(|e| error(&e))?
        .try_into()
        .map_err(|_| error(&format!("{} is a directory", record.path)))?;
    model.source_file().map_or(Ok(()), check)?;
    let weld = record.weld.map(Weld::within).transpose();
    let model = model.welded(weld.map_err(|e| error(&e))?);
    let loaded = model.load(limit).map_err(|e| error(&e))?;
    if record.sha256.is_none() || loaded.record.sha256 != record.sha256 {
        let problem = format!("{} is not what was measured, its hash differs", record.path);
        return Err(error(&problem));
    }
    let mut cells = result.cells.iter().filter(|c| c.model == name);
    let first = || cells.find_map(|c| c.source.as_ref()?.vertex());
    let source = source.or_else(first).unwrap_or(0);
    let vertex = loaded.mesh.kept_vertex(VertexId::new(source));
    if source as usize >= loaded.mesh.vertex_count() || loaded.mesh.outgoing(vertex).is_empty() {
        let problem = format!("vertex {source} does not exist or has no face");
        return Err(error(&problem));
    }
    let mesh = &loaded.mesh;
    let mut solver = VtpFast::new(mesh);
    let paths =
        Paths::find(&mut solver, mesh, vertex, &Goal::everything()).map_err(|e| error(&e))?;
    let distances = paths.distances();
    let finite = distances.iter().copied().filter(|d| d.is_finite());
    let step = step(finite.fold(0.0, f64::max), ISOLINES);
    // Exact isolines need all windows, which take much memory. Large models get the isolines of the
    // linear interpolation between vertices.
    let is_exact = loaded.measures.faces <= MOST_FACES_WITH_WINDOWS;
    let isolines = if is_exact {
        isolines(mesh, vertex, step)
    } else {
        Vec::new()
    };
    let far = far_vertices(mesh, distances);
    let lines = far
        .iter()
        .filter_map(|&v| Some(paths.to(v).ok()??.polyline(mesh)));
    let lines: Vec<Vec<[f64; 3]>> = lines.collect();
    let scene = Scene {
        sources: mesh
            .positions()
            .get(vertex.index()..=vertex.index())
            .unwrap_or_default(),
        isolines: &isolines,
        paths: &lines,
        ..Scene::new(mesh, distances)
    };
    let drawn_step = if is_exact { f64::INFINITY } else { step };
    let flat = Picture::new(&scene, drawn_step).ok_or_else(|| error(&"it has no coordinates"))?;
    Ok(ModelPicture {
        model: name.to_owned(),
        caption: format!(
            "From vertex {source} ({}), an isoline every {} units{}, and shortest paths to {} far vertices; {} vertices, {} faces, computed anew.",
            if flat.shows_a_source() {
                "white dot"
            } else {
                "on the far side"
            },
            short(step),
            if is_exact {
                ""
            } else {
                ", interpolated between vertices"
            },
            lines.len(),
            grouped(loaded.measures.vertices as u64),
            grouped(loaded.measures.faces as u64),
        ),
        flat,
    })
}

/// The exact isolines at multiples of `step`; empty if they cannot be computed.
fn isolines(mesh: &Mesh, source: VertexId, step: f64) -> Vec<Vec<[f64; 3]>> {
    let Ok(field) = DistanceField::new(mesh, &[source.into()]) else {
        return Vec::new();
    };
    let isolines = field.isolines(&field.levels_every(step).unwrap_or_default());
    let lines = isolines.iter().flat_map(|isoline| &isoline.lines);
    lines.map(|line| line.polyline(mesh, 0.01 * step)).collect()
}

/// Up to [`PATHS`] targets of paths: first the farthest vertex, then vertices beyond half its
/// distance, each chosen to be as far as possible in space from those before.
fn far_vertices(mesh: &Mesh, distances: &[f64]) -> Vec<VertexId> {
    let reached = mesh.vertices().filter(|v| distances[v.index()].is_finite());
    let by_distance =
        |a: &VertexId, b: &VertexId| distances[a.index()].total_cmp(&distances[b.index()]);
    let Some(farthest) = reached.clone().max_by(by_distance) else {
        return Vec::new();
    };
    let half = 0.5 * distances[farthest.index()];
    let mut far = vec![farthest];
    // For each vertex: the squared distance in space from the nearest chosen one.
    let mut apart = vec![f64::INFINITY; distances.len()];
    while far.len() < PATHS {
        let last = mesh.positions()[far[far.len() - 1].index()];
        for (apart, p) in apart.iter_mut().zip(mesh.positions()) {
            *apart = apart.min((0..3).map(|k| (p[k] - last[k]).powi(2)).sum());
        }
        let others = reached.clone().filter(|v| distances[v.index()] > half);
        let next = others.max_by(|a, b| apart[a.index()].total_cmp(&apart[b.index()]));
        match next {
            Some(v) if apart[v.index()] > 0.0 => far.push(v),
            _ => break,
        }
    }
    far
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_named_by_model_and_source() {
        let of = |model: &str, source| {
            Ok(PictureChoice::Of {
                model: model.to_owned(),
                source,
            })
        };
        assert_eq!("none".parse(), Ok(PictureChoice::None));
        assert_eq!("horse".parse(), of("horse", None));
        assert_eq!("horse:17".parse(), of("horse", Some(17)));
        assert_eq!("torus,faces=50:0".parse(), of("torus,faces=50", Some(0)));
        assert_eq!("C:\\m.obj".parse(), of("C:\\m.obj", None));
        assert!(":3".parse::<PictureChoice>().is_err());
        assert!("horse:99999999999".parse::<PictureChoice>().is_err());
    }
}
