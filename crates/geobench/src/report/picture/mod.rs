//! A picture of a model, coloured by distance, with isolines.
//!
//! A small rasteriser draws it: orthographic view, depth buffer, smooth shading, four samples per
//! pixel. The background is transparent, for light and dark pages.

pub(crate) mod plot;
mod raster;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use geobench_mesh::{Mesh, VertexId};

use super::chart::nice;
use super::svg::{Svg, px, width_of};
use crate::exec::model::LoadedModel;
use crate::table::distance_formats;
use raster::Camera;

/// Width and height of the picture in the units of the drawing.
const SIZE: [f64; 2] = [480.0, 400.0];

/// Pixels for each unit.
const DENSITY: f64 = 1.5;

/// Approximate number of isolines.
const ISOLINES: f64 = 24.0;

/// A model coloured by distance.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    png: Vec<u8>,
    /// The place of the source, if visible.
    source: Option<[f64; 2]>,
    /// The distance at the bright end of the ramp.
    farthest: f64,
    /// The distance between isolines.
    step: f64,
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
        let step = step(farthest, ISOLINES);
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

    /// The colour scale, with distances.
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
                    // A little wider than its part, so that no background shows between stripes.
                    (
                        "width",
                        px(width / STRIPES as f64 + if k + 1 < STRIPES { 1.0 } else { 0.0 }),
                    ),
                    ("height", "10".to_owned()),
                    ("fill", format!("#{r:02x}{g:02x}{b:02x}")),
                ],
            );
        }
        let every = step(self.farthest, 4.0);
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

/// A round distance, about [`ISOLINES`] of which make up the farthest.
fn step(farthest: f64, parts: f64) -> f64 {
    if farthest <= 0.0 {
        return 1.0;
    }
    nice(farthest / parts)
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
    use crate::exec::model::ModelRef;
    use crate::registry;

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
