//! The data of a page's 3D view of a model (`assets/surface.js`).

use std::collections::HashMap;
use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use geobench_export::distances::{RAMP, UNREACHED};
use geobench_mesh::{Mesh, VertexId};
use serde::Serialize;

use geobench_export::picture::{Scene, bounds};

/// The most faces of the view. Larger models are decimated.
const MOST_FACES: usize = 200_000;

/// The largest quantised value of a coordinate and of a distance.
const STEPS: f64 = 65_534.0;

/// The quantised distance of an unreachable vertex.
const NEVER: u32 = 65_535;

/// A model with distances and paths.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct SurfaceView {
    kind: &'static str,
    vertices: usize,
    faces: usize,
    /// The number of faces of the model, which is more than `faces` if it was decimated.
    of: usize,
    /// The least corner of the bounding box.
    low: [f64; 3],
    /// The longest side of the bounding box.
    extent: f64,
    /// The distance at the bright end of the ramp.
    farthest: f64,
    /// The distance between isolines.
    step: f64,
    source: [f64; 3],
    /// The initial view: the directions to the right, up and towards the viewer.
    axes: [[f64; 3]; 3],
    ramp: [[u8; 3]; 9],
    unreached: [u8; 3],
    /// The number of points of each exact isoline. If empty, the view draws interpolated isolines.
    isolines: Vec<usize>,
    paths: Vec<SurfacePath>,
    /// Coordinates, distances, corners and isolines; see [`encode`].
    data: String,
}

/// A shortest path from the source.
#[derive(Clone, Debug, Serialize)]
pub(super) struct SurfacePath {
    target: u32,
    length: f64,
    points: Vec<[f64; 3]>,
}

impl SurfacePath {
    /// The path to `target` of this length through `points`.
    pub(super) fn new(target: VertexId, length: f64, points: Vec<[f64; 3]>) -> Self {
        Self {
            target: target.raw(),
            length,
            points,
        }
    }

    pub(super) fn points(&self) -> Vec<[f64; 3]> {
        self.points.clone()
    }
}

/// Triangles with a distance for each vertex.
#[derive(Clone, Debug, Default, PartialEq)]
struct Triangles {
    positions: Vec<[f64; 3]>,
    distances: Vec<f64>,
    corners: Vec<[u32; 3]>,
}

impl SurfaceView {
    /// The view of a scene with its isolines and `paths`, initially as seen by the camera with
    /// `axes`. O(vertices + faces), times about 12 if the model is decimated.
    pub(super) fn new(
        scene: &Scene<'_>,
        axes: [[f64; 3]; 3],
        [farthest, step]: [f64; 2],
        paths: Vec<SurfacePath>,
    ) -> Self {
        let mesh = scene.mesh;
        let triangles = reduced(whole(mesh, scene.distances), MOST_FACES);
        let (low, high) = bounds(mesh.positions());
        let extent = (0..3).map(|k| high[k] - low[k]).fold(1e-300, f64::max);
        Self {
            kind: "surface",
            vertices: triangles.positions.len(),
            faces: triangles.corners.len(),
            of: mesh.face_count(),
            low,
            extent,
            farthest,
            step,
            source: scene.sources.first().copied().unwrap_or_default(),
            axes,
            ramp: RAMP,
            unreached: UNREACHED,
            isolines: scene.isolines.iter().map(Vec::len).collect(),
            paths,
            data: encode(&triangles, scene.isolines, low, extent, farthest),
        }
    }

    /// The number of faces of the view, if the model was decimated.
    pub(super) fn decimated(&self) -> Option<usize> {
        (self.faces < self.of).then_some(self.faces)
    }
}

fn whole(mesh: &Mesh, distances: &[f64]) -> Triangles {
    Triangles {
        positions: mesh.positions().to_vec(),
        distances: distances.to_vec(),
        corners: mesh
            .faces()
            .map(|f| mesh.face_vertices(f).map(VertexId::raw))
            .collect(),
    }
}

/// `triangles`, decimated to at most `most` faces by vertex clustering. A binary search finds the
/// finest grid that leaves few enough faces.
fn reduced(triangles: Triangles, most: usize) -> Triangles {
    if triangles.corners.len() <= most {
        return triangles;
    }
    let (mut coarse, mut fine) = (1_u32, 4096);
    let mut best = Triangles::default();
    while coarse < fine {
        let middle = (coarse + fine).div_ceil(2);
        let found = clustered(&triangles, middle);
        if found.corners.len() <= most {
            coarse = middle;
            best = found;
        } else {
            fine = middle - 1;
        }
    }
    best
}

/// Vertex clustering on a grid with `cells` cells along the longest side. The vertices of a cell
/// are merged into one, at the mean of their positions and with the mean of their finite distances.
fn clustered(triangles: &Triangles, cells: u32) -> Triangles {
    let (low, high) = bounds(&triangles.positions);
    let extent = (0..3).map(|k| high[k] - low[k]).fold(1e-300, f64::max);
    let side = extent * (1.0 + 1e-9) / f64::from(cells);
    let mut numbers: HashMap<[u32; 3], u32> = HashMap::new();
    let mut merged = Triangles::default();
    // For each cell: the number of vertices, and of those with a finite distance.
    let mut counts: Vec<[f64; 2]> = Vec::new();
    let mut cell_of = Vec::with_capacity(triangles.positions.len());
    for (position, distance) in triangles.positions.iter().zip(&triangles.distances) {
        let cell = std::array::from_fn(|k| ((position[k] - low[k]) / side) as u32);
        let number = *numbers.entry(cell).or_insert_with(|| {
            merged.positions.push([0.0; 3]);
            merged.distances.push(0.0);
            counts.push([0.0; 2]);
            counts.len() as u32 - 1
        });
        let at = number as usize;
        for (sum, x) in merged.positions[at].iter_mut().zip(position) {
            *sum += x;
        }
        counts[at][0] += 1.0;
        if distance.is_finite() {
            merged.distances[at] += distance;
            counts[at][1] += 1.0;
        }
        cell_of.push(number);
    }
    for (at, [all, reached]) in counts.into_iter().enumerate() {
        merged.positions[at] = merged.positions[at].map(|x| x / all);
        merged.distances[at] = match reached {
            0.0 => f64::INFINITY,
            _ => merged.distances[at] / reached,
        };
    }
    let faces = triangles
        .corners
        .iter()
        .map(|face| face.map(|v| cell_of[v as usize]));
    merged.corners = faces
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect();
    // Of the faces that have become equal, one is kept.
    let sorted = |face: &[u32; 3]| {
        let mut face = *face;
        face.sort_unstable();
        face
    };
    merged.corners.sort_by_key(sorted);
    merged.corners.dedup_by_key(|face| sorted(face));
    merged
}

/// Packs the numbers of a view, compressed by zlib and encoded in base64.
///
/// The planes are, in this order: the x, y and z coordinates of the vertices, their distances, the
/// corners of the faces, and the x, y and z coordinates of the points of all isolines. Corners are
/// `u32`. All others are `u16`, quantised relative to the bounding box or to the farthest distance.
/// Each plane holds the differences of successive numbers: first the low bytes of all, then the
/// next bytes.
fn encode(
    triangles: &Triangles,
    isolines: &[Vec<[f64; 3]>],
    low: [f64; 3],
    extent: f64,
    farthest: f64,
) -> String {
    let mut bytes = Vec::new();
    let step = |share: f64| (share * STEPS).round().clamp(0.0, STEPS) as u32;
    let coordinates = |bytes: &mut Vec<u8>, points: &[[f64; 3]]| {
        for k in 0..3 {
            let places = points.iter().map(|p| step((p[k] - low[k]) / extent));
            differences(bytes, &places.collect::<Vec<u32>>(), 2);
        }
    };
    coordinates(&mut bytes, &triangles.positions);
    let distances = triangles.distances.iter();
    let plane = distances.map(|distance| match distance {
        d if !d.is_finite() => NEVER,
        d => step(d / farthest.max(1e-300)),
    });
    differences(&mut bytes, &plane.collect::<Vec<u32>>(), 2);
    differences(&mut bytes, triangles.corners.as_flattened(), 4);
    coordinates(&mut bytes, &isolines.concat());
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    // Writing to memory cannot fail.
    let _ = encoder.write_all(&bytes);
    STANDARD.encode(encoder.finish().unwrap_or_default())
}

/// Appends a plane: the differences of successive numbers, wrapped to `width` bytes, first the low
/// bytes of all.
fn differences(bytes: &mut Vec<u8>, numbers: &[u32], width: usize) {
    for byte in 0..width {
        let mut last = 0_u32;
        for number in numbers {
            bytes.push(number.wrapping_sub(last).to_le_bytes()[byte]);
            last = *number;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_models_are_decimated_and_keep_their_shape() {
        let mesh = Mesh::generate("sphere,subdiv=4").unwrap();
        let distances = vec![1.5; mesh.vertex_count()];
        let triangles = whole(&mesh, &distances);
        let faces = triangles.corners.len();
        assert_eq!(reduced(triangles.clone(), faces), triangles);
        let fewer = reduced(triangles, 1000);
        assert!(
            (500..=1000).contains(&fewer.corners.len()),
            "{}",
            fewer.corners.len()
        );
        assert!(fewer.distances.iter().all(|d| *d == 1.5));
        for position in &fewer.positions {
            let radius = position.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!((0.9..=1.0 + 1e-9).contains(&radius), "{radius}");
        }
        let vertices = fewer.positions.len() as u32;
        assert!(fewer.corners.as_flattened().iter().all(|v| *v < vertices));
    }

    #[test]
    fn numbers_are_read_as_they_were_written() {
        use std::io::Read;
        let triangles = Triangles {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.5]],
            distances: vec![0.0, f64::INFINITY, 2.0],
            corners: vec![[0, 2, 1]],
        };
        let text = encode(&triangles, &[vec![[0.0; 3], [2.0; 3]]], [0.0; 3], 2.0, 2.0);
        let packed = STANDARD.decode(text).unwrap();
        let mut bytes = Vec::new();
        flate2::read::ZlibDecoder::new(&packed[..])
            .read_to_end(&mut bytes)
            .unwrap();
        assert_eq!(bytes.len(), 4 * 3 * 2 + 3 * 4 + 2 * 3 * 2);
        let plane = |start: usize, count: usize, width: usize| -> Vec<u32> {
            let mut last = 0_u32;
            let number = |i: usize| {
                (0..width)
                    .map(|b| u32::from(bytes[start + b * count + i]) << (8 * b))
                    .sum::<u32>()
            };
            (0..count)
                .map(|i| {
                    last = last.wrapping_add(number(i));
                    if width == 2 {
                        last &= 0xffff;
                    }
                    last
                })
                .collect()
        };
        assert_eq!(plane(0, 3, 2), [0, 32_767, 0]);
        assert_eq!(plane(18, 3, 2), [0, NEVER, 65_534]);
        assert_eq!(plane(24, 3, 4), [0, 2, 1]);
        assert_eq!(plane(36, 2, 2), [0, 65_534]);
    }
}
