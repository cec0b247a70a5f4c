//! Pictures of a model, coloured by distance, with isolines.
//!
//! A small rasteriser draws the surface: orthographic view, depth buffer, smooth shading, four
//! samples per pixel. The background is transparent, for light and dark pages.

// Positions and sizes are never negative here.
#![allow(clippy::cast_sign_loss)]

mod numbers;
mod paint;
mod raster;
mod scale;
mod view;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use geobench_mesh::{Mesh, VertexId};

use crate::svg::{self, Svg, px};
use raster::{Camera, Image, LineStyle};
use scale::ColourBar;

pub use numbers::{nice, short, step};
pub use paint::Paint;
pub use raster::bounds;
pub use view::View;

/// Width and height of a picture, in units of the drawing.
const SIZE: [f64; 2] = [scale::WIDTH, 400.0];

/// Pixels per unit of the drawing.
const DENSITY: f64 = 1.5;

/// The bytes of an image within a drawing, if fewer colours can achieve them.
const MOST_EMBEDDED: usize = 180_000;

/// Points of a line that are nearer to the one before, in units of the drawing, are left out.
const NEAR: f64 = 0.5;

/// The most sources that are marked in full size. The marks of more sources are smaller.
const FULL_MARKS: f64 = 30.0;

/// Half the width of isolines and of paths, in units.
const ISOLINE: f64 = 0.45;
const PATH: f64 = 1.1;

/// The colours of isolines and of paths.
const ISOLINE_COLOUR: [u8; 3] = [24, 24, 30];
const PATH_COLOUR: [u8; 3] = [214, 40, 57];

/// The content of a picture.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// The model.
    pub mesh: &'a Mesh,
    /// The distances of all vertices, by which the surface is coloured. Entries beyond the number
    /// of vertices are ignored.
    pub distances: &'a [f64],
    /// The colours of the faces; replaces the colours of distances.
    pub paint: Option<&'a Paint>,
    /// Points on the surface that are marked. The camera is chosen so that the first one is
    /// visible, if possible.
    pub sources: &'a [[f64; 3]],
    /// Thin lines on the surface.
    pub isolines: &'a [Vec<[f64; 3]>],
    /// Thick lines on the surface.
    pub paths: &'a [Vec<[f64; 3]>],
    /// The distances of isolines, which the colour scale marks; round distances if empty.
    pub levels: &'a [f64],
    /// The direction of view; `None` for the one that shows most.
    pub view: Option<View>,
}

impl<'a> Scene<'a> {
    /// A surface without lines and sources.
    pub const fn new(mesh: &'a Mesh, distances: &'a [f64]) -> Self {
        Self {
            mesh,
            distances,
            paint: None,
            sources: &[],
            isolines: &[],
            paths: &[],
            levels: &[],
            view: None,
        }
    }

    /// The picture as a file: PNG, or SVG with vector lines, and a colour scale below.
    ///
    /// # Errors
    ///
    /// When the mesh has no coordinates or no faces.
    pub fn draw(&self, png: bool, model: &str, what: &str) -> anyhow::Result<Vec<u8>> {
        let picture = Picture::new(self, f64::INFINITY);
        let picture = picture.ok_or_else(|| no_surface(model))?;
        Ok(picture.file(png, &format!("{what} on {model}")))
    }

    /// The picture as a file, with a picture of `after` from the same direction on its right.
    ///
    /// # Errors
    ///
    /// When one of the meshes has no coordinates or no faces.
    pub fn draw_beside(
        &self,
        after: &Scene<'_>,
        png: bool,
        model: &str,
        what: &str,
    ) -> anyhow::Result<Vec<u8>> {
        let before = Picture::new(self, f64::INFINITY);
        let mut before = before.ok_or_else(|| no_surface(model))?;
        let after = Picture::from(after, f64::INFINITY, Some(&before.camera));
        let after = after.ok_or_else(|| no_surface(model))?;
        before.join(after);
        Ok(before.file(png, &format!("{what} of {model}")))
    }
}

fn no_surface(model: &str) -> anyhow::Error {
    anyhow::anyhow!("{model}: a mesh without coordinates or faces cannot be drawn")
}

/// A drawn scene.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The surface without lines.
    image: Image,
    /// The positions of the visible sources, in units of the drawing.
    sources: Vec<[f64; 2]>,
    /// The visible parts of lines, in units of the drawing.
    isolines: Vec<Vec<[f64; 2]>>,
    paths: Vec<Vec<[f64; 2]>>,
    /// The distance at the bright end of the colour ramp; `None` if the scene is painted.
    farthest: Option<f64>,
    /// The colour scale, if the surface is coloured by distance.
    scale: Option<ColourBar>,
    camera: Camera,
}

impl Picture {
    /// Draws a scene. Interpolated isolines are drawn at multiples of `step`; an infinite step
    /// draws none. `None` if the mesh has no coordinates or no faces, or if vertices lack
    /// distances.
    pub fn new(scene: &Scene<'_>, step: f64) -> Option<Self> {
        Self::from(scene, step, None)
    }

    /// As [`new`](Self::new), seen by `camera` if one is given.
    fn from(scene: &Scene<'_>, step: f64, camera: Option<&Camera>) -> Option<Self> {
        let mesh = scene.mesh;
        if mesh.positions().len() != mesh.vertex_count() || mesh.face_count() == 0 {
            return None;
        }
        let distances = scene.distances.get(..mesh.vertex_count())?;
        let finite = distances.iter().copied().filter(|d| d.is_finite());
        let farthest = finite.fold(0.0, f64::max);
        let size = SIZE.map(|s| (s * DENSITY) as usize);
        let first = scene.sources.first().copied().unwrap_or_default();
        let camera = match (camera, scene.view) {
            (Some(camera), _) => camera.clone(),
            (None, Some(view)) => Camera::from(mesh, view, size),
            (None, None) => Camera::choose(mesh, nearest_vertex(mesh, first), size),
        };
        let mut image = raster::render(mesh, distances, scene.paint, &camera, [farthest, step]);
        let units = |at: [f64; 2]| at.map(|x| x / DENSITY);
        let visible = |lines: &[Vec<[f64; 3]>]| -> Vec<Vec<[f64; 2]>> {
            let parts = lines.iter().flat_map(|line| image.visible(line, &camera));
            parts
                .map(|part| part.into_iter().map(units).collect())
                .collect()
        };
        let (isolines, paths) = (visible(scene.isolines), visible(scene.paths));
        let seen = scene
            .sources
            .iter()
            .filter_map(|&at| image.sees(at, &camera));
        let sources = seen.map(units).collect();
        image.forget_samples();
        let is_coloured = scene.paint.is_none();
        Some(Self {
            image,
            sources,
            isolines,
            paths,
            farthest: is_coloured.then_some(farthest),
            scale: is_coloured.then(|| ColourBar::new(farthest, scene.levels)),
            camera,
        })
    }

    /// The distance at the bright end of the colour ramp; `None` if the scene is painted.
    pub const fn farthest(&self) -> Option<f64> {
        self.farthest
    }

    /// Whether one of the sources is visible.
    pub fn shows_a_source(&self) -> bool {
        !self.sources.is_empty()
    }

    /// The directions to the right, up and towards the viewer.
    pub fn axes(&self) -> [[f64; 3]; 3] {
        self.camera.axes()
    }

    /// Puts another picture on the right of this one.
    fn join(&mut self, right: Self) {
        let shift = self.width();
        self.image = self.image.beside(&right.image);
        let moved = |[x, y]: [f64; 2]| [x + shift, y];
        self.sources.extend(right.sources.into_iter().map(moved));
        for (lines, more) in [
            (&mut self.isolines, right.isolines),
            (&mut self.paths, right.paths),
        ] {
            let more = more.into_iter();
            lines.extend(more.map(|line| line.into_iter().map(moved).collect::<Vec<_>>()));
        }
    }

    /// The width in units of the drawing.
    fn width(&self) -> f64 {
        self.image.width() as f64 / DENSITY
    }

    /// The radii of the black and the white disc of a source's mark. They shrink if there are many
    /// sources.
    fn radii(&self) -> [f64; 2] {
        let scale = (FULL_MARKS / self.sources.len().max(1) as f64).sqrt();
        [5.0, 3.6].map(|radius| radius * scale.clamp(0.16, 1.0))
    }

    /// The picture as a file.
    fn file(self, png: bool, title: &str) -> Vec<u8> {
        if png {
            return self.png();
        }
        let mut inside = Svg::default();
        let size = self.draw(&mut inside);
        svg::drawing("picture", title, "", size, &inside.finish(), true).into_bytes()
    }

    /// The picture as a PNG file.
    pub fn png(&self) -> Vec<u8> {
        let mut image = self.image.clone();
        let pixels = |line: &Vec<[f64; 2]>| line.iter().map(|at| at.map(|x| x * DENSITY)).collect();
        let inks = [
            (&self.isolines, ISOLINE, ISOLINE_COLOUR),
            (&self.paths, PATH + 0.9, [255; 3]),
            (&self.paths, PATH, PATH_COLOUR),
        ];
        for (lines, half_width, colour) in inks {
            let lines: Vec<Vec<[f64; 2]>> = lines.iter().map(pixels).collect();
            let half_width = half_width * DENSITY;
            image.draw(&lines, LineStyle { half_width, colour });
        }
        let [outer, inner] = self.radii();
        for (radius, colour) in [(outer, [0; 3]), (inner, [255; 3])] {
            let dots: Vec<Vec<[f64; 2]>> = self
                .sources
                .iter()
                .map(|&at| pixels(&vec![at, at]))
                .collect();
            let half_width = radius * DENSITY;
            image.draw(&dots, LineStyle { half_width, colour });
        }
        if let Some(scale) = &self.scale {
            image.add_rows((scale::HEIGHT * DENSITY) as usize);
            scale.paint(&mut image, SIZE[1], DENSITY);
        }
        image.png()
    }

    /// Draws the picture and returns its width and height.
    pub fn draw(&self, svg: &mut Svg) -> [f64; 2] {
        let (width, height) = (self.width(), SIZE[1]);
        let data = format!(
            "data:image/png;base64,{}",
            STANDARD.encode(self.image.png_within(MOST_EMBEDDED))
        );
        svg.leaf(
            "image",
            &[("href", data), ("width", px(width)), ("height", px(height))],
        );
        let white = [255; 3];
        draw_lines(svg, &self.isolines, ISOLINE, ISOLINE_COLOUR);
        draw_lines(svg, &self.paths, PATH + 0.9, white);
        draw_lines(svg, &self.paths, PATH, PATH_COLOUR);
        let [outer, inner] = self.radii();
        for [x, y] in &self.sources {
            for (radius, colour) in [(outer, "#000"), (inner, "#fff")] {
                svg.leaf(
                    "circle",
                    &[
                        ("cx", px(*x)),
                        ("cy", px(*y)),
                        ("r", px(radius)),
                        ("fill", colour.to_owned()),
                    ],
                );
            }
        }
        let Some(scale) = &self.scale else {
            return [width, height];
        };
        scale.draw(svg, height);
        [width, height + scale::HEIGHT]
    }
}

/// Draws lines of a colour.
fn draw_lines(svg: &mut Svg, lines: &[Vec<[f64; 2]>], half_width: f64, [r, g, b]: [u8; 3]) {
    for line in lines {
        let mut kept: Vec<[f64; 2]> = Vec::new();
        for (i, at) in line.iter().enumerate() {
            let is_near = |last: &[f64; 2]| (at[0] - last[0]).hypot(at[1] - last[1]) < NEAR;
            if i + 1 == line.len() || !kept.last().is_some_and(is_near) {
                kept.push(*at);
            }
        }
        let points = kept.iter().map(|[x, y]| format!("{},{}", px(*x), px(*y)));
        let attributes = [
            ("points", points.collect::<Vec<_>>().join(" ")),
            ("fill", "none".to_owned()),
            ("stroke", format!("#{r:02x}{g:02x}{b:02x}")),
            ("stroke-width", format!("{:.1}", 2.0 * half_width)),
            ("stroke-linejoin", "round".to_owned()),
        ];
        svg.leaf("polyline", &attributes);
    }
}

/// The vertex with a face that is nearest to a point in space.
fn nearest_vertex(mesh: &Mesh, to: [f64; 3]) -> VertexId {
    let apart = |v: &VertexId| {
        let p = mesh.positions()[v.index()];
        (0..3).map(|k| (p[k] - to[k]).powi(2)).sum::<f64>()
    };
    let used = mesh.vertices().filter(|&v| !mesh.outgoing(v).is_empty());
    let nearest = used.min_by(|a, b| apart(a).total_cmp(&apart(b)));
    nearest.unwrap_or(VertexId::new(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use geobench_vtp::VtpFast;
    use geobench_window::Solver;

    #[test]
    fn a_source_that_faces_the_viewer_is_seen_and_farther_is_brighter() {
        let mesh = &Mesh::generate("sphere,subdiv=3").unwrap();
        let vertex = VertexId::new(0);
        let distances = VtpFast::new(mesh).solve(&[vertex]).unwrap().distances;
        // The edge at the source is visible. The same edge scaled by 0.5 is hidden inside the
        // sphere.
        let next = mesh.head(mesh.outgoing(vertex)[0]);
        let edge = [vertex, next].map(|v| mesh.positions()[v.index()]);
        let scene = Scene {
            sources: &edge[..1],
            isolines: &[edge.to_vec()],
            paths: &[edge.map(|at| at.map(|x| 0.5 * x)).to_vec()],
            ..Scene::new(mesh, &distances)
        };
        let picture = Picture::new(&scene, 0.2).unwrap();
        assert_eq!(picture.sources.len(), 1);
        assert_eq!((picture.isolines.len(), picture.paths.len()), (1, 0));
        assert!(picture.png().starts_with(b"\x89PNG"));
        assert!((picture.farthest.unwrap() - std::f64::consts::PI).abs() < 0.05);
        let again = Picture::new(&scene, 0.2).unwrap();
        assert_eq!(picture.png(), again.png(), "the same picture every time");
    }
}
