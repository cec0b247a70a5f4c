//! The point of a surface nearest to a position.

use crate::frames::longest_side;
use crate::ids::{FaceId, VertexId};
use crate::mesh::{Mesh, diagonal_of};
use crate::point::{PointError, SurfacePoint};
use crate::vector::{cross, dot, norm, sub};

/// Most faces of a leaf of the tree.
const LEAF: usize = 4;

/// Finds the points of a surface nearest to positions, by a tree of boxes around faces that is
/// built once.
///
/// ```
/// use geobench_mesh::{Mesh, NearestPoint};
///
/// let mesh = Mesh::generate("cube,n=2")?; // From -1 to 1.
/// let nearest = NearestPoint::new(&mesh)?;
/// let (point, distance) = nearest.to([0.25, 0.5, 3.5])?;
/// assert_eq!(distance, 2.5);
/// assert_eq!(mesh.position_of(&point), Some([0.25, 0.5, 1.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct NearestPoint {
    mesh: Mesh,
    /// The faces, ordered so that those of a box are contiguous.
    faces: Vec<FaceId>,
    /// The tree in preorder: a box of more than [`LEAF`] faces is followed by the tree of its first
    /// half.
    boxes: Vec<Box3>,
    /// Vertices in no face, which may be nearest as well.
    isolated: Vec<VertexId>,
}

/// An axis-aligned box with its content.
#[derive(Clone, Copy, Debug)]
struct Box3 {
    low: [f64; 3],
    high: [f64; 3],
    /// The range of its faces in `faces`.
    faces: [usize; 2],
    /// The index of the box of its second half; `None` for a leaf.
    second: Option<usize>,
}

impl Box3 {
    /// A lower bound, also under rounding, of the distances from `position` to the faces in the
    /// box.
    fn distance(&self, position: [f64; 3]) -> f64 {
        let outside = |i: usize| {
            (self.low[i] - position[i])
                .max(position[i] - self.high[i])
                .max(0.0)
        };
        length([0, 1, 2].map(outside)) * (1.0 - 8.0 * f64::EPSILON)
    }
}

/// The length of a vector, without overflow.
fn length([x, y, z]: [f64; 3]) -> f64 {
    libm::hypot(libm::hypot(x, y), z)
}

impl NearestPoint {
    /// Builds the tree, in O(n log n) time.
    ///
    /// # Errors
    ///
    /// If the mesh has no positions.
    pub fn new(mesh: &Mesh) -> Result<Self, PointError> {
        if mesh.positions().is_empty() {
            return Err(PointError::NoPositions);
        }
        let is_isolated = |&v: &VertexId| mesh.outgoing(v).is_empty() && !mesh.is_copy(v);
        let isolated = mesh.vertices().filter(is_isolated);
        let mut nearest = Self {
            mesh: mesh.clone(),
            faces: mesh.faces().collect(),
            boxes: Vec::new(),
            isolated: isolated.collect(),
        };
        if !nearest.faces.is_empty() {
            nearest.add_box(0, nearest.faces.len());
        }
        Ok(nearest)
    }

    fn corners(&self, face: FaceId) -> [[f64; 3]; 3] {
        let positions = self.mesh.positions();
        self.mesh.face_vertices(face).map(|v| positions[v.index()])
    }

    /// Adds the box of a range of faces, and the boxes below it. The recursion depth is the binary
    /// logarithm of the number of faces.
    fn add_box(&mut self, first: usize, end: usize) -> usize {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &face in &self.faces[first..end] {
            for corner in self.corners(face) {
                low = [0, 1, 2].map(|i| corner[i].min(low[i]));
                high = [0, 1, 2].map(|i| corner[i].max(high[i]));
            }
        }
        let place = self.boxes.len();
        self.boxes.push(Box3 {
            low,
            high,
            faces: [first, end],
            second: None,
        });
        if end - first > LEAF {
            let widths = [0, 1, 2].map(|i| high[i] - low[i]);
            let axis = crate::point::largest(widths);
            let positions = self.mesh.positions();
            let middle = |face: FaceId| -> f64 {
                let corners = self.mesh.face_vertices(face);
                corners
                    .iter()
                    .map(|v| positions[v.index()][axis] / 3.0)
                    .sum()
            };
            let half = first.midpoint(end);
            let by_middle =
                |a: &FaceId, b: &FaceId| middle(*a).total_cmp(&middle(*b)).then(a.cmp(b));
            self.faces[first..end].select_nth_unstable_by(half - first, by_middle);
            self.add_box(first, half);
            let second = self.add_box(half, end);
            self.boxes[place].second = Some(second);
        }
        place
    }

    /// The diagonal of the bounding box of the surface; 0 without faces.
    pub fn diagonal(&self) -> f64 {
        let whole = self.boxes.first();
        whole.map_or(0.0, |whole| diagonal_of([whole.low, whole.high]))
    }

    /// The point of the surface nearest to `position`, and its distance from there. Of several
    /// nearest points the one in the face with the lowest number is returned.
    ///
    /// Takes O(log n) time for n faces as a rule, and O(n) at worst.
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite.
    pub fn to(&self, position: [f64; 3]) -> Result<(SurfacePoint, f64), PointError> {
        if let Some(&value) = position.iter().find(|x| !x.is_finite()) {
            return Err(PointError::Position { value });
        }
        let mut best = (f64::INFINITY, FaceId::new(u32::MAX), [0.0; 3]);
        self.search(position, |face| {
            let (distance, weights) = nearest_in_triangle(self.corners(face), position);
            if distance < best.0 || distance == best.0 && face < best.1 {
                best = (distance, face, weights);
            }
            best.0
        });
        let from = |v: VertexId| length(sub(self.mesh.positions()[v.index()], position));
        let lone = self.isolated.iter().map(|&v| (from(v), v));
        if let Some((distance, vertex)) = lone.min_by(|a, b| a.0.total_cmp(&b.0))
            && distance < best.0
        {
            return Ok((vertex.into(), distance));
        }
        let (distance, face, weights) = best;
        Ok((self.mesh.point_in_face(face, weights)?, distance))
    }

    /// The vertex nearest to `position`, and its distance from there. Of several nearest ones the
    /// one with the lowest number is returned.
    ///
    /// ```
    /// use geobench_mesh::{Mesh, NearestPoint};
    ///
    /// let mesh = Mesh::generate("cube,n=2")?;
    /// let nearest = NearestPoint::new(&mesh)?;
    /// let (vertex, distance) = nearest.vertex_to([1.0, 1.0, 1.5])?;
    /// assert_eq!((mesh.positions()[vertex.index()], distance), ([1.0; 3], 0.5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite, or the mesh has no vertex.
    pub fn vertex_to(&self, position: [f64; 3]) -> Result<(VertexId, f64), PointError> {
        if let Some(&value) = position.iter().find(|x| !x.is_finite()) {
            return Err(PointError::Position { value });
        }
        let from = |v: VertexId| length(sub(self.mesh.positions()[v.index()], position));
        let mut best = (f64::INFINITY, VertexId::new(u32::MAX));
        let mut offer = |v: VertexId| {
            let offer = (from(v), v);
            if offer.0 < best.0 || offer.0 == best.0 && v < best.1 {
                best = offer;
            }
            best.0
        };
        self.isolated.iter().for_each(|&v| {
            offer(v);
        });
        self.search(position, |face| {
            let distances = self.mesh.face_vertices(face).map(&mut offer);
            distances[2]
        });
        match best {
            (distance, vertex) if distance < f64::INFINITY => Ok((vertex, distance)),
            _ => Err(PointError::NoPositions),
        }
    }

    /// Visits all faces nearer to `position` than the least distance that `visit` has returned,
    /// those of near boxes first.
    fn search(&self, position: [f64; 3], mut visit: impl FnMut(FaceId) -> f64) {
        let mut least = f64::INFINITY;
        let mut open = Vec::new();
        if !self.boxes.is_empty() {
            open.push((self.boxes[0].distance(position), 0));
        }
        while let Some((bound, place)) = open.pop() {
            if bound > least {
                continue;
            }
            let node = &self.boxes[place];
            if let Some(second) = node.second {
                let mut halves =
                    [place + 1, second].map(|half| (self.boxes[half].distance(position), half));
                // The nearer half is searched first.
                if halves[0].0 < halves[1].0 {
                    halves.swap(0, 1);
                }
                open.extend(halves);
                continue;
            }
            for &face in &self.faces[node.faces[0]..node.faces[1]] {
                least = visit(face);
            }
        }
    }
}

impl Mesh {
    /// The point of the surface nearest to `position`, and its distance from there, in O(n log n)
    /// time. For more than one position use a [`NearestPoint`].
    ///
    /// # Errors
    ///
    /// If the mesh has no positions or a coordinate is not finite.
    pub fn nearest_point(&self, position: [f64; 3]) -> Result<(SurfacePoint, f64), PointError> {
        NearestPoint::new(self)?.to(position)
    }
}

/// The distance from a position to a triangle, and the barycentric coordinates of the nearest
/// point: the foot of the perpendicular if it is inside, else the nearest point of a side.
fn nearest_in_triangle(corners: [[f64; 3]; 3], position: [f64; 3]) -> (f64, [f64; 3]) {
    let mut best = (f64::INFINITY, [1.0, 0.0, 0.0]);
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        let (t, rest) = along(a, b, position);
        let mut weights = [0.0; 3];
        weights[k] = rest;
        weights[(k + 1) % 3] = t;
        let point = if t <= 0.5 {
            [0, 1, 2].map(|i| a[i] + t * (b[i] - a[i]))
        } else {
            [0, 1, 2].map(|i| b[i] + rest * (a[i] - b[i]))
        };
        let distance = length(sub(point, position));
        if distance < best.0 {
            best = (distance, weights);
        }
    }
    if let Some(inside) = foot(corners, position)
        && inside.0 < best.0
    {
        return inside;
    }
    best
}

/// The point of the segment from `a` to `b` nearest to `position`: its fractions of the way from
/// `a` and from `b`, each accurate near its end.
fn along(a: [f64; 3], b: [f64; 3], position: [f64; 3]) -> (f64, f64) {
    let edge = sub(b, a);
    let scale = length(edge);
    let unit = edge.map(|x| x / scale);
    let from_a = dot(sub(position, a), unit) / scale;
    let from_b = -dot(sub(position, b), unit) / scale;
    if from_a <= 0.0 {
        (0.0, 1.0)
    } else if from_b <= 0.0 {
        (1.0, 0.0)
    } else if from_a < from_b {
        (from_a, 1.0 - from_a)
    } else {
        (1.0 - from_b, from_b)
    }
}

/// The distance from a position to the plane of a triangle, and the foot of the perpendicular;
/// `None` if the foot is outside the triangle.
fn foot(corners: [[f64; 3]; 3], position: [f64; 3]) -> Option<(f64, [f64; 3])> {
    let edges = [0, 1, 2].map(|k| sub(corners[(k + 1) % 3], corners[k]));
    let lengths = edges.map(length);
    let longest = longest_side(lengths);
    let scale = lengths[longest];
    let edges = edges.map(|edge| edge.map(|x| x / scale));
    // The two shorter edges, as for the area: beside a far vertex, the products of the two longer
    // ones cancel.
    let normal = cross(edges[(longest + 1) % 3], edges[(longest + 2) % 3]);
    let twice_area = norm(normal);
    if twice_area == 0.0 {
        return None;
    }
    let unit = normal.map(|x| x / twice_area);
    let from = corners.map(|corner| sub(position, corner).map(|x| x / scale));
    // The weight of a corner is proportional to the area over the opposite side.
    let mut weights = [0, 1, 2].map(|k| {
        let opposite = (k + 1) % 3;
        dot(cross(edges[opposite], from[opposite]), unit) / twice_area
    });
    if !weights.iter().all(|&w| w > 0.0 && w < 1.0) {
        return None;
    }
    let sum: f64 = weights.iter().sum();
    weights = weights.map(|w| w / sum);
    let base = crate::point::largest(weights);
    Some((dot(from[base], unit).abs() * scale, weights))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SplitMix64;

    /// A number from -1 to 1.
    fn number(random: &mut SplitMix64) -> f64 {
        (random.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    #[test]
    fn a_far_vertex_does_not_tilt_its_face() {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [3e9, 7e9, 5e9]];
        let normal = [0.0, -5.0, 7.0].map(|x| x / 74.0_f64.sqrt());
        let position = [0.53 + normal[0], 0.07 + normal[1], 0.05 + normal[2]];
        for first in 0..3 {
            let corners = [0, 1, 2].map(|k| corners[(first + k) % 3]);
            let (distance, _) = foot(corners, position).unwrap();
            assert!((distance - 1.0).abs() < 1e-14, "{first}: {distance}");
        }
    }

    #[test]
    fn nothing_is_nearer_than_the_nearest_point() {
        for spec in [
            "terrain,n=9,seed=4",
            "torus,faces=300,bump=0.2,seed=1",
            "cube,n=3",
        ] {
            let mesh = Mesh::generate(spec).unwrap();
            let nearest = NearestPoint::new(&mesh).unwrap();
            let mut random = SplitMix64::new(5);
            for _ in 0..200 {
                let position = [0; 3].map(|_| 2.0 * number(&mut random));
                let (point, distance) = nearest.to(position).unwrap();
                let found = mesh.position_of(&point).unwrap();
                assert!(
                    (length(sub(found, position)) - distance).abs() < 1e-12,
                    "{spec}"
                );
                let all = mesh
                    .faces()
                    .map(|face| nearest_in_triangle(nearest.corners(face), position).0);
                assert_eq!(all.fold(f64::INFINITY, f64::min), distance, "{spec}");
                // No point of any face is nearer.
                for _ in 0..200 {
                    let face = FaceId::new(random.below(mesh.face_count()) as u32);
                    let (u, v) = (number(&mut random).abs(), number(&mut random).abs());
                    let (u, v) = if u + v > 1.0 {
                        (1.0 - u, 1.0 - v)
                    } else {
                        (u, v)
                    };
                    let other = mesh.point_in_face(face, [u, v, 1.0 - u - v]).unwrap();
                    let other = mesh.position_of(&other).unwrap();
                    assert!(length(sub(other, position)) >= distance - 1e-12, "{spec}");
                }
            }
        }
    }

    #[test]
    fn vertices_are_nearest_to_themselves_exactly_far_from_the_origin_too() {
        for shift in [0.0, 1e6] {
            let mesh = Mesh::generate("sphere,subdiv=2").unwrap();
            let moved = mesh
                .positions()
                .iter()
                .map(|p| p.map(|x| x + shift))
                .collect();
            let faces = mesh
                .faces()
                .map(|f| mesh.face_vertices(f).map(VertexId::raw))
                .collect();
            let mesh = Mesh::new(moved, faces).unwrap();
            let nearest = NearestPoint::new(&mesh).unwrap();
            for v in mesh.vertices() {
                let (point, distance) = nearest.to(mesh.positions()[v.index()]).unwrap();
                assert_eq!((point.vertex(), distance), (Some(v), 0.0));
            }
        }
    }

    #[test]
    fn flat_faces_isolated_vertices_and_long_ways() {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [9.0, 9.0, 0.0]];
        let mesh = Mesh::new(positions, vec![[0, 2, 1]]).unwrap();
        let (point, distance) = mesh.nearest_point([2.0, 1.0, 0.0]).unwrap();
        assert_eq!(
            (mesh.position_of(&point), distance),
            (Some([2.0, 0.0, 0.0]), 1.0)
        );
        let (point, distance) = mesh.nearest_point([9.0, 8.0, 0.0]).unwrap();
        assert_eq!((point, distance), (3.into(), 1.0));
        let (point, distance) = mesh.nearest_point([-1e200, 0.0, 0.0]).unwrap();
        assert_eq!((point, distance), (0.into(), 1e200));
        for bad in [f64::NAN, f64::INFINITY] {
            let refused = mesh.nearest_point([0.0, bad, 0.0]);
            assert!(matches!(refused, Err(PointError::Position { .. })));
        }
        let (mesh, _) = Mesh::from_lengths(3, &[[0, 1, 2]], &[[1.0; 3]]).unwrap();
        assert_eq!(
            mesh.nearest_point([0.0; 3]).unwrap_err(),
            PointError::NoPositions
        );
    }
}
