//! The rasteriser: camera, triangles, lines and PNG output.

use geobench_mesh::vector::{cross, dot, unit};
use geobench_mesh::{Mesh, VertexId};

use super::View;
use super::paint::Paint;
use crate::distances;

/// Samples per pixel in each direction.
const SAMPLES: usize = 2;

/// The direction of the light: from behind the viewer, left and above.
const LIGHT: [f64; 3] = [-0.35, 0.55, 0.76];

/// The cosine of 40 degrees. A corner is shaded flat if the normals of its face and its vertex
/// differ by more.
const SHARP: f64 = 0.766;

/// The part of the surface that is visible at a sample.
#[derive(Clone, Copy, Debug)]
struct ScreenSample {
    /// The depth in samples, which grows towards the viewer; minus infinity without a surface.
    depth: f32,
    /// The geodesic distance from the source; infinite if unreachable.
    distance: f32,
    /// The brightness, from 0 to 1.
    light: f32,
    /// The colour that replaces that of the distance.
    paint: Option<[u8; 3]>,
}

const NOTHING: ScreenSample = ScreenSample {
    depth: f32::NEG_INFINITY,
    distance: 0.0,
    light: 0.0,
    paint: None,
};

/// A picture.
#[derive(Clone, Debug)]
pub(super) struct Image {
    size: [usize; 2],
    /// Red, green, blue and opacity of every pixel.
    pixels: Vec<[u8; 4]>,
    samples: Vec<ScreenSample>,
}

/// Renders `mesh` as `camera` sees it. Colours show distances from 0 to `farthest`, with isolines
/// at multiples of `step`, unless `paint` gives colours. O(faces + samples covered by their
/// bounding boxes).
pub(super) fn render(
    mesh: &Mesh,
    distances: &[f64],
    paint: Option<&Paint>,
    camera: &Camera,
    [farthest, step]: [f64; 2],
) -> Image {
    let view = camera.enlarged(SAMPLES);
    let mut samples = vec![NOTHING; view.size[0] * view.size[1]];
    let seen: Vec<[f64; 3]> = mesh.positions().iter().map(|&p| view.project(p)).collect();
    let smooth = vertex_normals(mesh);
    for face in mesh.faces() {
        let corners = mesh.face_vertices(face).map(VertexId::index);
        let flat = unit(face_normal(corners.map(|v| mesh.positions()[v])));
        let light = corners.map(|v| {
            let normal = if dot(smooth[v], flat) > SHARP {
                smooth[v]
            } else {
                flat
            };
            brightness(view.turn(normal))
        });
        let whole = ViewTriangle {
            corners: corners.map(|v| seen[v]),
            distances: corners.map(|v| distances[v]),
            light,
            paint: paint.and_then(|paint| paint.of_face(face)),
        };
        match paint.and_then(|paint| paint.parts(face)) {
            None => whole.fill(&mut samples, view.size),
            Some(parts) => {
                for (corners, colour) in parts {
                    whole.part(*corners, *colour).fill(&mut samples, view.size);
                }
            }
        }
    }
    let pixels = resolve(&samples, camera.size, |at| {
        colour(&samples, view.size, at, farthest, step)
    });
    Image {
        size: camera.size,
        pixels,
        samples,
    }
}

/// The normal of each vertex: the mean of the normals of its faces, weighted by area.
fn vertex_normals(mesh: &Mesh) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; mesh.vertex_count()];
    for face in mesh.faces() {
        let corners = mesh.face_vertices(face).map(VertexId::index);
        let normal = face_normal(corners.map(|v| mesh.positions()[v]));
        for v in corners {
            for k in 0..3 {
                sums[v][k] += normal[k];
            }
        }
    }
    sums.into_iter().map(unit).collect()
}

/// The brightness of a surface with this normal. Both sides have the same brightness.
fn brightness(normal: [f64; 3]) -> f64 {
    let towards = if normal[2] < 0.0 {
        normal.map(|x| -x)
    } else {
        normal
    };
    0.55 + 0.45 * dot(towards, unit(LIGHT)).max(0.0)
}

/// A triangle in view coordinates.
#[derive(Clone, Copy, Debug)]
struct ViewTriangle {
    corners: [Vector; 3],
    distances: [f64; 3],
    light: [f64; 3],
    paint: Option<[u8; 3]>,
}

impl ViewTriangle {
    /// The part of the triangle whose corners have these barycentric coordinates.
    fn part(&self, corners: [[f64; 3]; 3], colour: [u8; 3]) -> Self {
        let blend = |of: [f64; 3]| corners.map(|weights| dot(weights, of));
        let axes = [0, 1, 2].map(|k| blend(self.corners.map(|corner| corner[k])));
        Self {
            corners: [0, 1, 2].map(|i| [0, 1, 2].map(|k| axes[k][i])),
            // Not blended: an infinite distance would give NaN at corners where its weight is 0.
            // Painted parts need no distances.
            distances: [0.0; 3],
            light: blend(self.light),
            paint: Some(colour),
        }
    }

    /// Writes the samples at which the triangle is nearer than the surface drawn before.
    fn fill(self, samples: &mut [ScreenSample], [width, height]: [usize; 2]) {
        let Self {
            corners,
            distances,
            light,
            paint,
        } = self;
        let [a, b, c] = corners;
        let side = |from: [f64; 3], to: [f64; 3], x: f64, y: f64| {
            (to[0] - from[0]) * (y - from[1]) - (to[1] - from[1]) * (x - from[0])
        };
        let area = side(a, b, c[0], c[1]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let range = |k: usize, size: usize| {
            let low = a[k].min(b[k]).min(c[k]).floor().max(0.0) as usize;
            let high = a[k].max(b[k]).max(c[k]).ceil().max(0.0) as usize;
            low..high.saturating_add(1).min(size)
        };
        let blend = |shares: [f64; 3], of: [f64; 3]| dot(shares, of);
        for row in range(1, height) {
            for column in range(0, width) {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let shares = [
                    side(b, c, x, y) / area,
                    side(c, a, x, y) / area,
                    side(a, b, x, y) / area,
                ];
                // The tolerance avoids gaps between neighbouring triangles.
                if shares.iter().any(|share| *share < -1e-9) {
                    continue;
                }
                let depth = blend(shares, corners.map(|corner| corner[2])) as f32;
                let sample = &mut samples[column + width * row];
                if depth > sample.depth {
                    *sample = ScreenSample {
                        depth,
                        distance: blend(shares, distances) as f32,
                        light: blend(shares, light) as f32,
                        paint,
                    };
                }
            }
        }
    }
}

/// The colour of a sample, if a surface is visible.
fn colour(
    samples: &[ScreenSample],
    [width, height]: [usize; 2],
    [column, row]: [usize; 2],
    farthest: f64,
    step: f64,
) -> Option<[f64; 3]> {
    let sample = samples[column + width * row];
    if sample.depth == f32::NEG_INFINITY {
        return None;
    }
    let light = f64::from(sample.light);
    if let Some(paint) = sample.paint {
        return Some(paint.map(|part| f64::from(part) * light));
    }
    let distance = f64::from(sample.distance);
    if !distance.is_finite() {
        return Some(distances::UNREACHED.map(|part| f64::from(part) * light));
    }
    let band = |sample: &ScreenSample| (f64::from(sample.distance) / step).floor();
    // An isoline separates two neighbouring samples of different bands. Their depths must be close,
    // so that both lie on the same part of the surface.
    let near = width.max(height) as f32 * 0.01;
    let crosses = |c: usize, r: usize| {
        let other = &samples[c + width * r];
        (other.depth - sample.depth).abs() < near
            && other.distance.is_finite()
            && band(other) != band(&sample)
    };
    let isoline = (column + 1 < width && crosses(column + 1, row))
        || (row + 1 < height && crosses(column, row + 1))
        || (column > 0 && crosses(column - 1, row))
        || (row > 0 && crosses(column, row - 1));
    let ink = if isoline { 0.45 } else { 1.0 };
    let share = if farthest > 0.0 {
        distance / farthest
    } else {
        0.0
    };
    Some(distances::colour(share).map(|part| f64::from(part) * light * ink))
}

/// The pixels of a picture, each the mean of the colours of its samples.
fn resolve(
    samples: &[ScreenSample],
    [width, height]: [usize; 2],
    colour: impl Fn([usize; 2]) -> Option<[f64; 3]>,
) -> Vec<[u8; 4]> {
    debug_assert_eq!(samples.len(), width * height * SAMPLES * SAMPLES);
    let pixel = |column: usize, row: usize| {
        let mut sum = [0.0; 3];
        let mut count = 0_u32;
        for dy in 0..SAMPLES {
            for dx in 0..SAMPLES {
                if let Some(colour) = colour([column * SAMPLES + dx, row * SAMPLES + dy]) {
                    count += 1;
                    for k in 0..3 {
                        sum[k] += colour[k];
                    }
                }
            }
        }
        if count == 0 {
            return [0; 4];
        }
        let [r, g, b] = sum.map(|part| level(part / f64::from(count)));
        let opacity = level(255.0 * f64::from(count) / (SAMPLES * SAMPLES) as f64);
        [r, g, b, opacity]
    };
    let rows = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
    rows.map(|(column, row)| pixel(column, row)).collect()
}

fn level(part: f64) -> u8 {
    part.round().clamp(0.0, 255.0) as u8
}

impl Image {
    /// The picture as a PNG file.
    pub(super) fn png(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let [width, height] = self.size.map(|s| s as u32);
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        // Writing to memory cannot fail, and the sizes agree.
        if let Ok(mut writer) = encoder.write_header() {
            let _ = writer.write_image_data(self.pixels.as_flattened());
        }
        bytes
    }

    /// The picture as a PNG file of at most `most` bytes, if levels of colours in steps of up to 16
    /// achieve that. Only noisy pictures are larger, in which the steps are not seen.
    pub(super) fn png_within(&self, most: usize) -> Vec<u8> {
        let mut png = self.png();
        for step in [4_u8, 8, 16] {
            if png.len() <= most {
                break;
            }
            let level = |level: u8| (level / step) * step + step / 2;
            let pixel = |[r, g, b, a]: &[u8; 4]| [level(*r), level(*g), level(*b), *a];
            let coarser = Self {
                size: self.size,
                pixels: self.pixels.iter().map(pixel).collect(),
                samples: Vec::new(),
            };
            png = coarser.png();
        }
        png
    }

    /// This picture with another one of the same height on its right.
    pub(super) fn beside(&self, right: &Self) -> Self {
        let [width, height] = self.size;
        let rows = self.pixels.chunks(width.max(1));
        let rows = rows.zip(right.pixels.chunks(right.size[0].max(1)));
        Self {
            size: [width + right.size[0], height],
            pixels: rows.flat_map(|(a, b)| a.iter().chain(b).copied()).collect(),
            samples: Vec::new(),
        }
    }

    /// Adds transparent rows below.
    pub(super) fn add_rows(&mut self, rows: usize) {
        self.size[1] += rows;
        self.pixels.resize(self.size[0] * self.size[1], [0; 4]);
    }

    /// Fills the rectangle between left, top, right and bottom, in pixels.
    pub(super) fn rectangle(&mut self, ends: [f64; 4], [r, g, b]: [u8; 3]) {
        let [left, top, right, bottom] = ends.map(|x| x.round().max(0.0) as usize);
        let [width, height] = self.size;
        for row in top..bottom.min(height) {
            self.pixels[row * width..][left.min(width)..right.min(width)].fill([r, g, b, 255]);
        }
    }

    /// Frees the samples, which only [`sees`](Self::sees) needs.
    pub(super) fn forget_samples(&mut self) {
        self.samples = Vec::new();
    }

    /// Its width in pixels.
    pub(super) const fn width(&self) -> usize {
        self.size[0]
    }

    /// The pixel of a point of the surface, unless the point is hidden.
    pub(super) fn sees(&self, position: [f64; 3], camera: &Camera) -> Option<[f64; 2]> {
        let view = camera.enlarged(SAMPLES);
        let [x, y, depth] = view.project(position);
        let [width, height] = view.size;
        let (column, row) = (x as usize, y as usize);
        if column >= width || row >= height {
            return None;
        }
        let front = f64::from(self.samples[column + width * row].depth);
        // The tolerance is needed because the depth is that of the centre of the sample.
        let slack = width.max(height) as f64 * 0.01;
        (depth > front - slack).then(|| [x, y].map(|t| t / SAMPLES as f64))
    }
}

/// The style of lines drawn into an image. The half width is in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineStyle {
    pub(super) half_width: f64,
    pub(super) colour: [u8; 3],
}

impl Image {
    /// The visible parts of a line on the surface, in pixels.
    pub(super) fn visible(&self, line: &[[f64; 3]], camera: &Camera) -> Vec<Vec<[f64; 2]>> {
        let mut parts = Vec::new();
        let mut part: Vec<[f64; 2]> = Vec::new();
        let mut end = |part: &mut Vec<[f64; 2]>| {
            let part = std::mem::take(part);
            if part.len() > 1 {
                parts.push(part);
            }
        };
        for pair in line.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|p| camera.project(p));
            let steps = ((b[0] - a[0]).hypot(b[1] - a[1]) * 2.0).ceil().max(1.0);
            for i in 0..=steps as u32 {
                let t = f64::from(i) / steps;
                let at = std::array::from_fn(|k| pair[0][k] + t * (pair[1][k] - pair[0][k]));
                let Some(seen) = self.sees(at, camera) else {
                    end(&mut part);
                    continue;
                };
                // About one point per pixel is enough.
                let is_new = part.last().is_none_or(|last| {
                    let moved = (seen[0] - last[0]).hypot(seen[1] - last[1]);
                    moved > 0.3 && (moved > 1.0 || i == 0 || f64::from(i) == steps)
                });
                if is_new {
                    part.push(seen);
                }
            }
        }
        end(&mut part);
        parts
    }

    /// Draws lines, in pixels, over the picture.
    pub(super) fn draw(&mut self, lines: &[Vec<[f64; 2]>], ink: LineStyle) {
        let [width, height] = self.size;
        let mut cover = vec![0.0_f64; width * height];
        let reach = ink.half_width + 1.0;
        for [a, b] in lines
            .iter()
            .flat_map(|line| line.windows(2).map(|w| [w[0], w[1]]))
        {
            let range = |k: usize, size: usize| {
                let low = (a[k].min(b[k]) - reach).floor().max(0.0) as usize;
                let high = (a[k].max(b[k]) + reach).ceil().max(0.0) as usize;
                low..high.min(size)
            };
            let along = [b[0] - a[0], b[1] - a[1]];
            let size = along[0] * along[0] + along[1] * along[1];
            for row in range(1, height) {
                for column in range(0, width) {
                    let way = [column as f64 + 0.5 - a[0], row as f64 + 0.5 - a[1]];
                    let t = (way[0] * along[0] + way[1] * along[1]) / size.max(1e-300);
                    let t = t.clamp(0.0, 1.0);
                    let off = (way[0] - t * along[0]).hypot(way[1] - t * along[1]);
                    let share = (ink.half_width + 0.5 - off).clamp(0.0, 1.0);
                    let cover = &mut cover[column + width * row];
                    *cover = cover.max(share);
                }
            }
        }
        for (pixel, share) in self.pixels.iter_mut().zip(cover) {
            if share > 0.0 {
                for (part, ink) in pixel.iter_mut().zip(ink.colour) {
                    *part = level(f64::from(*part) * (1.0 - share) + f64::from(ink) * share);
                }
                pixel[3] = pixel[3].max(level(255.0 * share));
            }
        }
    }
}

type Vector = [f64; 3];

/// An orthographic view.
#[derive(Clone, Debug)]
pub(super) struct Camera {
    /// Orthonormal directions to the right, up, and towards the viewer.
    axes: [Vector; 3],
    /// The centre of the view along the first two axes.
    middle: [f64; 2],
    /// Pixels per unit of the model.
    scale: f64,
    /// Width and height in pixels.
    pub(super) size: [usize; 2],
}

/// The share of the picture's size that the model may fill.
const FILL: f64 = 0.96;

/// Cells per side of the grid on which views are compared.
const GRID: usize = 96;

impl Camera {
    /// Chooses the view that shows most of the surface of `mesh`, and the source if possible.
    /// `size` is in pixels. Up is the y-axis, as in most files, or the z-axis if the model is flat
    /// along z. O(directions × vertices).
    pub(super) fn choose(mesh: &Mesh, source: VertexId, size: [usize; 2]) -> Self {
        let positions = mesh.positions();
        let (low, high) = bounds(positions);
        let extent: Vector = std::array::from_fn(|k| high[k] - low[k]);
        let flat = extent[2] < 0.35 * extent[0].min(extent[1]);
        let up = if flat {
            [0.0, 0.0, 1.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        // Flat models are shown from above, upright ones from the side.
        let heights: &[f64] = if flat { &[50.0, 70.0] } else { &[12.0, 32.0] };
        let normal = normal_at(mesh, source);
        let directions = (0..16).flat_map(|k| {
            let turn = (f64::from(k) * 22.5 + 11.0).to_radians();
            heights
                .iter()
                .map(move |height| direction(up, turn, height.to_radians()))
        });
        let mut best = (f64::NEG_INFINITY, [0.0, 0.0, 1.0]);
        for towards in directions {
            let axes = axes(towards, up);
            let score = score(positions, source, &axes, dot(normal, towards));
            if score > best.0 {
                best = (score, towards);
            }
        }
        Self::fitted(positions, axes(best.1, up), size)
    }

    /// The view from a given direction.
    pub(super) fn from(mesh: &Mesh, view: View, size: [usize; 2]) -> Self {
        Self::fitted(mesh.positions(), view.axes(), size)
    }

    fn fitted(positions: &[Vector], axes: [Vector; 3], size: [usize; 2]) -> Self {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for position in positions {
            for k in 0..2 {
                let at = dot(*position, axes[k]);
                low[k] = low[k].min(at);
                high[k] = high[k].max(at);
            }
        }
        let fit = |k: usize| FILL * size[k] as f64 / (high[k] - low[k]).max(1e-300);
        Self {
            axes,
            middle: std::array::from_fn(|k| f64::midpoint(low[k], high[k])),
            scale: fit(0).min(fit(1)),
            size,
        }
    }

    /// The position of a point from the top left corner, and its depth, in pixels.
    pub(super) fn project(&self, position: Vector) -> Vector {
        let [right, up, towards] = self.axes.map(|axis| dot(position, axis));
        [
            (right - self.middle[0]) * self.scale + self.size[0] as f64 / 2.0,
            (self.middle[1] - up) * self.scale + self.size[1] as f64 / 2.0,
            towards * self.scale,
        ]
    }

    /// The directions to the right, up, and towards the viewer.
    pub(super) const fn axes(&self) -> [Vector; 3] {
        self.axes
    }

    /// A direction in the coordinates of the axes.
    pub(super) fn turn(&self, direction: Vector) -> Vector {
        self.axes.map(|axis| dot(direction, axis))
    }

    /// The same view with `times` as many pixels in each direction.
    pub(super) fn enlarged(&self, times: usize) -> Self {
        Self {
            scale: self.scale * times as f64,
            size: self.size.map(|s| s * times),
            ..self.clone()
        }
    }
}

/// The score of a view: the number of grid cells with a visible vertex, more if the source is
/// visible, and more again if the source faces the viewer.
fn score(positions: &[Vector], source: VertexId, axes: &[Vector; 3], facing: f64) -> f64 {
    let (low, high) = bounds(positions);
    let size = (0..3)
        .map(|k| (high[k] - low[k]).powi(2))
        .sum::<f64>()
        .sqrt()
        .max(1e-300);
    let middle: Vector = std::array::from_fn(|k| f64::midpoint(low[k], high[k]));
    let mut nearest = vec![f64::NEG_INFINITY; GRID * GRID];
    let place = |position: &Vector| {
        let offset: Vector = std::array::from_fn(|k| (position[k] - middle[k]) / size);
        let [x, y, z] = axes.map(|axis| dot(offset, axis));
        let cell = |t: f64| (((t + 0.5) * GRID as f64) as usize).min(GRID - 1);
        (cell(x) + GRID * cell(y), z)
    };
    for position in positions {
        let (cell, z) = place(position);
        nearest[cell] = nearest[cell].max(z);
    }
    let covered = nearest.iter().filter(|z| z.is_finite()).count();
    let (cell, z) = place(&positions[source.index()]);
    let seen = facing > 0.1 && z > nearest[cell] - 2.0 / GRID as f64;
    let bonus = if seen { 1.3 + 0.4 * facing } else { 1.0 };
    covered as f64 * bonus
}

/// The direction from the model to the viewer.
fn direction(up: Vector, turn: f64, height: f64) -> Vector {
    // `libm` gives the same view on every machine.
    let (flat, lift) = (libm::cos(height), libm::sin(height));
    let (a, b) = (flat * libm::sin(turn), flat * libm::cos(turn));
    if up[1] > 0.0 {
        [a, lift, b]
    } else {
        [a, -b, lift]
    }
}

/// The directions to the right, up and towards the viewer, for a view from `towards`.
fn axes(towards: Vector, up: Vector) -> [Vector; 3] {
    let right = unit(cross(up, towards));
    [right, cross(towards, right), towards]
}

fn normal_at(mesh: &Mesh, vertex: VertexId) -> Vector {
    let positions = mesh.positions();
    let mut sum = [0.0; 3];
    for &h in mesh.outgoing(vertex) {
        let corners = [mesh.tail(h), mesh.head(h), mesh.apex_vertex(h)];
        let normal = face_normal(corners.map(|v| positions[v.index()]));
        for k in 0..3 {
            sum[k] += normal[k];
        }
    }
    unit(sum)
}

/// The normal of a triangle; its length is twice the area.
pub(super) fn face_normal([a, b, c]: [Vector; 3]) -> Vector {
    let edge = |to: Vector| std::array::from_fn(|k| to[k] - a[k]);
    cross(edge(b), edge(c))
}

/// The least and the greatest coordinates of `positions`.
pub fn bounds(positions: &[Vector]) -> (Vector, Vector) {
    let fold = |start: f64, choose: fn(f64, f64) -> f64| {
        positions.iter().fold([start; 3], |so_far, position| {
            std::array::from_fn(|k| choose(so_far[k], position[k]))
        })
    };
    (
        fold(f64::INFINITY, f64::min),
        fold(f64::NEG_INFINITY, f64::max),
    )
}
