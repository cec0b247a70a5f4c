//! Quality of the triangles of a mesh, and deviation of two surfaces.

use geobench_mesh::{Mesh, NearestPoint, PointError, SplitMix64, VertexId};

/// The shapes of the triangles of a mesh.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_voronoi::Quality;
///
/// // An isosceles right triangle.
/// let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let quality = Quality::of(&Mesh::new(positions, vec![[0, 1, 2]])?);
/// assert!((quality.least_angle - 45.0).abs() < 1e-12 && quality.below_30 == 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// The least angle, in degrees.
    pub least_angle: f64,
    /// The mean over the triangles of their least angles, in degrees.
    pub mean_least_angle: f64,
    /// The share of all angles that are below 30 degrees, from 0 to 1.
    pub below_30: f64,
    /// The mean aspect of the triangles: longest edge times half the perimeter, over 2·√3 times the
    /// area; 1 if all are equilateral. Triangles without area are left out, as in
    /// [`MeshMeasures::anisotropy`](geobench_mesh::MeshMeasures::anisotropy).
    pub mean_aspect: f64,
    /// The greatest aspect.
    pub worst_aspect: f64,
}

impl Quality {
    /// Measures `mesh`; O(faces).
    pub fn of(mesh: &Mesh) -> Self {
        let (mut least, mut sum_of_least, mut narrow) = (f64::INFINITY, 0.0, 0_usize);
        let (mut sum_of_aspects, mut worst, mut solid) = (0.0, 1.0_f64, 0_usize);
        for face in mesh.faces() {
            let apexes = mesh.apexes(face);
            let angles = apexes.map(|[x, y]| libm::atan2(y, x).to_degrees());
            let of_face = angles.into_iter().fold(f64::INFINITY, f64::min);
            least = least.min(of_face);
            sum_of_least += of_face;
            narrow += angles.iter().filter(|&&angle| angle < 30.0).count();
            let lengths = mesh.side_lengths(face);
            let longest = lengths.into_iter().fold(0.0, f64::max);
            let area = 0.5 * lengths[0] * apexes[0][1];
            let half = 0.5 * lengths.iter().sum::<f64>();
            let aspect = half * longest / (2.0 * 3.0_f64.sqrt() * area);
            if aspect < FLAT {
                sum_of_aspects += aspect;
                worst = worst.max(aspect);
                solid += 1;
            }
        }
        let faces = mesh.face_count().max(1) as f64;
        Self {
            least_angle: if least.is_finite() { least } else { 0.0 },
            mean_least_angle: sum_of_least / faces,
            below_30: narrow as f64 / (3.0 * faces),
            mean_aspect: if solid > 0 {
                sum_of_aspects / solid as f64
            } else {
                1.0
            },
            worst_aspect: worst,
        }
    }
}

/// The aspect from which the area of a triangle is 0 up to rounding.
const FLAT: f64 = 1e14;

/// Distances of the points of one surface from another, estimated by samples, in the units of the
/// meshes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceDeviation {
    /// The greatest distance of a sample: a lower bound of the greatest distance.
    pub greatest: f64,
    /// The mean distance over the area.
    pub mean: f64,
}

impl SurfaceDeviation {
    /// The distances in space from points of `from` to the nearest points of `to`. The points are
    /// `samples` points spread over the faces by area and, for the greatest distance only, all
    /// vertices in faces.
    ///
    /// The one-sided Hausdorff distance is at least [`greatest`](Self::greatest); the two-sided one
    /// is the greater of both directions.
    ///
    /// # Errors
    ///
    /// If one of the meshes has no positions.
    pub fn between(from: &Mesh, to: &Mesh, samples: usize) -> Result<Self, PointError> {
        let nearest = NearestPoint::new(to)?;
        let positions = from.positions();
        if positions.is_empty() {
            return Err(PointError::NoPositions);
        }
        let mut greatest = 0.0_f64;
        for v in from.vertices().filter(|&v| !from.outgoing(v).is_empty()) {
            greatest = greatest.max(nearest.to(positions[v.index()])?.1);
        }
        let mut ends = Vec::with_capacity(from.face_count());
        let mut area = 0.0;
        for face in from.faces() {
            let h = face.half_edge(0);
            area += from.length(h) * from.apex(h)[1];
            ends.push(area);
        }
        let mut random = SplitMix64::new(1);
        let mut sum = 0.0;
        for i in 0..samples {
            // One point in each of as many equal parts of the area.
            let at = area * (i as f64 + random.unit()) / samples as f64;
            let face = ends.partition_point(|&end| end <= at).min(ends.len() - 1);
            let corners = from.face_vertices(geobench_mesh::FaceId::new(face as u32));
            let [a, b, c] = corners.map(VertexId::index).map(|v| positions[v]);
            let (root, t) = (random.unit().sqrt(), random.unit());
            let weights = [1.0 - root, root * (1.0 - t), root * t];
            let point =
                [0, 1, 2].map(|k| weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k]);
            let (_, distance) = nearest.to(point)?;
            greatest = greatest.max(distance);
            sum += distance;
        }
        Ok(Self {
            greatest,
            mean: sum / samples.max(1) as f64,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equilateral_triangles_are_best() {
        let mesh = Mesh::generate("icosahedron").or_else(|_| Mesh::generate("sphere,subdiv=0"));
        let quality = Quality::of(&mesh.unwrap());
        assert!((quality.least_angle - 60.0).abs() < 1e-9, "{quality:?}");
        assert!((quality.mean_aspect - 1.0).abs() < 1e-12, "{quality:?}");
        assert_eq!(quality.below_30, 0.0);
    }

    #[test]
    fn parallel_squares_are_apart_by_their_distance() {
        let square = |z: f64, size: f64| {
            let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
            let positions = corners.map(|[x, y]| [size * x, size * y, z]).to_vec();
            Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
        };
        let (small, large) = (square(0.0, 1.0), square(0.5, 2.0));
        let there = SurfaceDeviation::between(&small, &large, 100).unwrap();
        assert_eq!((there.greatest, there.mean), (0.5, 0.5));
        let back = SurfaceDeviation::between(&large, &small, 1000).unwrap();
        // The far corner, which is a vertex.
        assert!((back.greatest - 2.25_f64.sqrt()).abs() < 1e-12);
        assert!(back.mean > 0.5 && back.mean < back.greatest);
    }
}
