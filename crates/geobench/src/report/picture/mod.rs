//! A picture of a model, coloured by distance, with isolines.
//!
//! Drawn by a small rasteriser of our own: orthographic view, depth buffer, smooth shading, four samples per
//! pixel. The picture's ground is transparent, so that it stands on light and dark pages alike.

mod camera;
mod raster;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use geobench_mesh::{Mesh, VertexId};

use super::chart::width_of;
use super::document::{Plot, slug};
use super::svg::{Svg, px};
use crate::exec::limits::DecompressionLimit;
use crate::exec::model::{self, LoadedModel, ModelRef};
use crate::measure::number::grouped;
use crate::registry;
use crate::schema::ResultFile;
use crate::table::distance_formats;
use camera::Camera;

/// Width and height of the picture in the units of the drawing.
const SIZE: [f64; 2] = [480.0, 400.0];

/// Pixels for each unit.
const DENSITY: f64 = 1.5;

/// About as many isolines as are drawn.
const ISOLINES: f64 = 24.0;

/// Largest model for which a picture is drawn unasked.
const MOST_FACES: u64 = 1_000_000;

/// A model coloured by distance.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    png: Vec<u8>,
    /// Where the source is seen, if it is.
    source: Option<[f64; 2]>,
    /// The distance at the bright end of the ramp.
    farthest: f64,
    /// The distance from isoline to isoline.
    step: f64,
}

/// Which picture a report is to have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// None.
    None,
    /// One of the first model that can be made again.
    Any,
    /// One of this model, from this source or that of its first cell.
    Of {
        /// Its name in the result.
        model: String,
        /// The source.
        source: Option<u32>,
    },
}

impl std::str::FromStr for Wanted {
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

/// Why there is no picture of a model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The result has no such model.
    #[error("--picture {name}: the result has no such model; it has {}", models.join(", "))]
    Unknown {
        /// The name.
        name: String,
        /// Those that there are.
        models: Vec<String>,
    },
    /// The model cannot be loaded any more.
    #[error("no picture of {name}: {problem}")]
    Unloadable {
        /// The name.
        name: String,
        /// Why not.
        problem: String,
    },
    /// What lies there now is another model.
    #[error("no picture of {name}: {path} is not what was measured, its hash differs")]
    Changed {
        /// The name.
        name: String,
        /// Where it was looked for.
        path: String,
    },
    /// It has no such vertex.
    #[error("no picture of {name}: vertex {source_vertex} does not exist or has no face")]
    NoSource {
        /// The name.
        name: String,
        /// The source.
        source_vertex: u32,
    },
}

/// The picture that `wanted` asks for from a model of `result`.
///
/// # Errors
///
/// When a model was named and there is no picture of it. Nothing is an error of a model that was
/// not asked for.
pub(crate) fn plot(
    result: &ResultFile,
    wanted: &Wanted,
    limit: DecompressionLimit,
    prefix: &str,
) -> Result<Option<Plot>, PictureError> {
    match wanted {
        Wanted::None => Ok(None),
        Wanted::Of { model, source } => {
            if result.models.iter().all(|m| m.name != *model) {
                return Err(PictureError::Unknown {
                    name: model.clone(),
                    models: result.models.iter().map(|m| m.name.clone()).collect(),
                });
            }
            of_model(result, model, *source, limit, prefix).map(Some)
        }
        Wanted::Any => Ok(result
            .models
            .iter()
            .filter(|m| m.faces.is_some_and(|faces| faces <= MOST_FACES))
            .find_map(|m| of_model(result, &m.name, None, limit, prefix).ok())),
    }
}

fn of_model(
    result: &ResultFile,
    name: &str,
    source: Option<u32>,
    limit: DecompressionLimit,
    prefix: &str,
) -> Result<Plot, PictureError> {
    let unloadable = |problem: String| PictureError::Unloadable {
        name: name.to_owned(),
        problem,
    };
    let record = result.models.iter().find(|m| m.name == name);
    let record = record.ok_or_else(|| unloadable("it is not in the result".to_owned()))?;
    let found = model::collect(std::slice::from_ref(&record.path));
    let [model]: [ModelRef; 1] = found
        .map_err(|error| unloadable(error.to_string()))?
        .try_into()
        .map_err(|_| unloadable(format!("{} is a directory", record.path)))?;
    let loaded = model
        .load_within(limit)
        .map_err(|error| unloadable(error.to_string()))?;
    if record.sha256.is_none() || loaded.record.sha256 != record.sha256 {
        return Err(PictureError::Changed {
            name: name.to_owned(),
            path: record.path.clone(),
        });
    }
    let first = || result.cells.iter().find(|c| c.model == name)?.source;
    let source = source.or_else(first).unwrap_or(0);
    let no_source = || PictureError::NoSource {
        name: name.to_owned(),
        source_vertex: source,
    };
    let vertex = VertexId::new(source);
    if source as usize >= loaded.mesh.vertex_count() || loaded.mesh.outgoing(vertex).is_empty() {
        return Err(no_source());
    }
    let solver = registry::select_one("vtp").map_err(|error| unloadable(error.to_string()))?;
    let distances = solver
        .build(&loaded.mesh)
        .solve(&[vertex])
        .map_err(|error| unloadable(error.to_string()))?
        .distances;
    let picture = Picture::draw_model(&loaded, &distances, vertex)
        .ok_or_else(|| unloadable("it has no coordinates".to_owned()))?;
    Ok(Plot {
        id: format!("{prefix}-picture-{}", slug(name)),
        title: format!("Distances on {name}"),
        caption: format!(
            "From vertex {source} ({}), an isoline every {} units; {} vertices, {} faces, computed anew by vtp.",
            if picture.source.is_some() {
                "white dot"
            } else {
                "on the far side"
            },
            short(picture.step),
            grouped(loaded.measures.vertices as u64),
            grouped(loaded.measures.faces as u64),
        ),
        chart: super::chart::Chart::Picture(picture),
    })
}

impl Picture {
    fn draw_model(model: &LoadedModel, distances: &[f64], source: VertexId) -> Option<Self> {
        let mesh: &Mesh = &model.mesh;
        if mesh.positions().len() != mesh.vertex_count() || mesh.face_count() == 0 {
            return None;
        }
        let farthest = distances
            .iter()
            .copied()
            .filter(|d| d.is_finite())
            .fold(0.0, f64::max);
        let step = step(farthest);
        let size = SIZE.map(|s| (s * DENSITY) as usize);
        let camera = Camera::choose(mesh, source, size);
        let image = raster::render(mesh, distances, &camera, farthest, step);
        let seen = image
            .sees(mesh.positions()[source.index()], &camera)
            .map(|at| at.map(|x| x / DENSITY));
        Some(Self {
            png: image.png(),
            source: seen,
            farthest,
            step,
        })
    }

    /// The picture alone, as a PNG file.
    pub(crate) fn png(&self) -> &[u8] {
        &self.png
    }

    /// Draws it and returns width and height.
    pub(crate) fn draw(&self, svg: &mut Svg) -> [f64; 2] {
        let [width, height] = SIZE;
        let data = format!("data:image/png;base64,{}", STANDARD.encode(&self.png));
        svg.leaf(
            "image",
            &[("href", data), ("width", px(width)), ("height", px(height))],
        );
        if let Some([x, y]) = self.source {
            for (radius, colour) in [(5.0, "#000"), (3.6, "#fff")] {
                svg.leaf(
                    "circle",
                    &[
                        ("cx", px(x)),
                        ("cy", px(y)),
                        ("r", px(radius)),
                        ("fill", colour.to_owned()),
                    ],
                );
            }
        }
        self.draw_ramp(svg, height + 8.0);
        [width, height + 46.0]
    }

    /// The colours with the distances that they stand for.
    fn draw_ramp(&self, svg: &mut Svg, y: f64) {
        const STRIPES: usize = 64;
        let (left, width) = (60.0, SIZE[0] - 120.0);
        for k in 0..STRIPES {
            let share = k as f64 / (STRIPES - 1) as f64;
            let [r, g, b] = distance_formats::colour(share);
            svg.leaf(
                "rect",
                &[
                    ("x", px(left + width * k as f64 / STRIPES as f64)),
                    ("y", px(y)),
                    // A little wider than its part, so that no ground shows between stripes.
                    (
                        "width",
                        px(width / STRIPES as f64 + if k + 1 < STRIPES { 1.0 } else { 0.0 }),
                    ),
                    ("height", "10".to_owned()),
                    ("fill", format!("#{r:02x}{g:02x}{b:02x}")),
                ],
            );
        }
        let every = step_for(self.farthest, 4.0);
        let mut last = f64::NEG_INFINITY;
        for k in 0..8 {
            let value = f64::from(k) * every;
            if value > self.farthest * 1.0001 {
                break;
            }
            let x = left
                + width
                    * if self.farthest > 0.0 {
                        value / self.farthest
                    } else {
                        0.0
                    };
            let text = short(value);
            if x - width_of(&text) < last {
                continue;
            }
            last = x;
            svg.line("axis", [x, y + 10.0], [x, y + 14.0]);
            svg.text([x, y + 25.0], "m", &text);
        }
        svg.text([left + width + 8.0, y + 9.0], "q", "distance");
    }
}

/// The distance from isoline to isoline: a round number.
fn step(farthest: f64) -> f64 {
    step_for(farthest, ISOLINES)
}

fn step_for(farthest: f64, parts: f64) -> f64 {
    if farthest <= 0.0 {
        return 1.0;
    }
    let raw = farthest / parts;
    let power = libm::exp10(libm::log10(raw).floor());
    let factors = [1.0, 2.0, 2.5, 5.0, 10.0];
    let nearest = factors.into_iter().find(|f| f * power >= raw);
    nearest.unwrap_or(10.0) * power
}

/// A round number in few characters.
fn short(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e6).contains(&value) {
        return format!("{value:.1e}");
    }
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_named_by_model_and_source() {
        let of = |model: &str, source| {
            Ok(Wanted::Of {
                model: model.to_owned(),
                source,
            })
        };
        assert_eq!("none".parse(), Ok(Wanted::None));
        assert_eq!("horse".parse(), of("horse", None));
        assert_eq!("horse:17".parse(), of("horse", Some(17)));
        assert_eq!("torus,faces=50:0".parse(), of("torus,faces=50", Some(0)));
        assert_eq!("C:\\m.obj".parse(), of("C:\\m.obj", None));
        assert!(":3".parse::<Wanted>().is_err());
        assert!("horse:99999999999".parse::<Wanted>().is_err());
    }

    #[test]
    fn a_source_that_faces_the_viewer_is_seen_and_farther_is_brighter() {
        let model = ModelRef::generated("gen:sphere,subdiv=3")
            .unwrap()
            .load()
            .unwrap();
        let vertex = VertexId::new(0);
        let solver = registry::select_one("vtp").unwrap();
        let distances = solver
            .build(&model.mesh)
            .solve(&[vertex])
            .unwrap()
            .distances;
        let picture = Picture::draw_model(&model, &distances, vertex).unwrap();
        assert!(picture.source.is_some());
        assert!(picture.png.starts_with(b"\x89PNG"));
        assert!((picture.farthest - std::f64::consts::PI).abs() < 0.05);
        assert_eq!(picture.step, 0.2);
        let again = Picture::draw_model(&model, &distances, vertex).unwrap();
        assert_eq!(picture.png, again.png, "the same picture every time");
    }
}
