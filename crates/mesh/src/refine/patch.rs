//! One face split at points on its sides and inside it.

use crate::frames::at_least_a_sliver;
use crate::ids::{FaceId, VertexId};
use crate::mesh::Mesh;
use crate::point::largest;

/// Sine of an angle that counts as 0 in tests for collinearity: far above the rounding of a
/// determinant, and far below any angle that matters.
const STRAIGHT: f64 = 1e-13;

/// By how much the two angles opposite an edge must exceed π in sum before the edge is flipped.
const FLIP_SLACK: f64 = 1e-9;

/// The shape of a face, from which distances between its points follow.
///
/// Points are barycentric coordinates. A vector between two points is the sum of two edges of the
/// face at one of its corners, times [differences](difference) of coordinates. Differences are
/// exact for close points. The relative error of a vector is therefore small, however short it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct BarycentricShape {
    lengths: [f64; 3],
    twice_area: f64,
    /// `edges[k]` runs from corner k to corner k + 1, in the frame of the shortest edge. In this
    /// frame all three have small relative errors.
    edges: [[f64; 2]; 3],
}

impl BarycentricShape {
    pub(super) fn new(mesh: &Mesh, face: FaceId) -> Self {
        let lengths = mesh.side_lengths(face);
        let apexes = mesh.apexes(face);
        let base = largest(lengths.map(|l| -l));
        let [x, y] = apexes[base];
        let mut edges = [[0.0; 2]; 3];
        edges[base] = [lengths[base], 0.0];
        edges[(base + 1) % 3] = [x - lengths[base], y];
        edges[(base + 2) % 3] = [-x, -y];
        Self {
            lengths,
            twice_area: apexes[0][1] * lengths[0],
            edges,
        }
    }

    pub(super) fn longest(&self) -> f64 {
        self.lengths[largest(self.lengths)]
    }

    /// The vector from point `p` to point `q`.
    fn vector(&self, p: [f64; 3], q: [f64; 3]) -> [f64; 2] {
        let all = difference(p, q);
        let others = |base: usize| ((base + 1) % 3, (base + 2) % 3);
        // Of the three sums for the vector, the one with the smallest terms has the least error.
        let size = |base: usize| {
            let (next, last) = others(base);
            all[next].abs() * self.lengths[base] + all[last].abs() * self.lengths[last]
        };
        let base = largest([0, 1, 2].map(|k| -size(k)));
        let (next, last) = others(base);
        let (there, home) = (self.edges[base], self.edges[last]);
        [0, 1].map(|i| all[next] * there[i] - all[last] * home[i])
    }

    /// The distance of two points.
    pub(super) fn distance(&self, p: [f64; 3], q: [f64; 3]) -> f64 {
        let [x, y] = self.vector(p, q);
        libm::hypot(x, y)
    }
}

/// The coordinates of `q` minus those of `p`, with an error relative to the largest of the three
/// differences. The one with the greatest rounding error follows from the other two.
fn difference(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    let base = largest([0, 1, 2].map(|k| p[k].max(q[k])));
    let mut all = [0, 1, 2].map(|k| q[k] - p[k]);
    all[base] = -(all[(base + 1) % 3] + all[(base + 2) % 3]);
    all
}

/// The area of a triangle as a fraction of that of the face, and the scale of its error: the
/// product of two of its sides in barycentric coordinates.
fn oriented([p, q, r]: [[f64; 3]; 3]) -> (f64, f64) {
    let size = |[x, y, z]: [f64; 3]| x.abs().max(y.abs()).max(z.abs());
    let (u, v, w) = (difference(p, q), difference(q, r), difference(r, p));
    // From the two shorter sides, whose product has the smallest error.
    let (s, t) = match largest([u, v, w].map(size)) {
        0 => (v, w),
        1 => (w, u),
        _ => (u, v),
    };
    // The coordinates of a vector have the sum 0, so any two of them give the area.
    let products = [0, 1, 2].map(|k| {
        let next = (k + 1) % 3;
        [s[k] * t[next], s[next] * t[k]]
    });
    let [a, b] = products[largest(products.map(|[a, b]| -(a.abs() + b.abs())))];
    (a - b, size(s) * size(t))
}

/// The neighbour across an edge of a triangle of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PatchNeighbour {
    /// This triangle, across its edge with this number.
    Inside(usize, usize),
    /// None: the edge is a part of this side of the face.
    Side(usize),
}

/// A triangle of a patch: three points, and the neighbours across the edges from each to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct PatchTriangle {
    pub(super) corners: [usize; 3],
    pub(super) neighbours: [PatchNeighbour; 3],
}

/// A point of a patch.
#[derive(Clone, Copy, Debug)]
struct PatchPoint {
    barycentric: [f64; 3],
    vertex: u32,
    /// Its rank on its side, counted from the tail. Corners have ranks on two sides.
    rank: usize,
}

/// Lengths and apexes of a triangle.
pub(super) struct Frames {
    pub(super) lengths: [f64; 3],
    pub(super) apexes: [[f64; 2]; 3],
}

/// A split face: the Delaunay triangulation of its corners and points, in its own plane.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    shape: BarycentricShape,
    points: Vec<PatchPoint>,
    triangles: Vec<PatchTriangle>,
    /// Number of points on each side.
    on_sides: [usize; 3],
    /// Flips left. The limit ensures termination despite rounding.
    flips_left: usize,
}

impl Patch {
    /// The face before any split.
    pub(super) fn new(mesh: &Mesh, face: FaceId) -> Self {
        let corners = mesh.face_vertices(face).map(VertexId::raw);
        let point = |k: usize| {
            let mut barycentric = [0.0; 3];
            barycentric[k] = 1.0;
            PatchPoint {
                barycentric,
                vertex: corners[k],
                rank: 0,
            }
        };
        Self {
            shape: BarycentricShape::new(mesh, face),
            points: [0, 1, 2].map(point).to_vec(),
            triangles: vec![PatchTriangle {
                corners: [0, 1, 2],
                neighbours: [0, 1, 2].map(PatchNeighbour::Side),
            }],
            on_sides: [0; 3],
            flips_left: 0,
        }
    }

    pub(super) fn triangles(&self) -> &[PatchTriangle] {
        &self.triangles
    }

    /// The vertex of the mesh at `point`.
    pub(super) fn vertex(&self, point: usize) -> u32 {
        self.points[point].vertex
    }

    /// The rank, from the tail on, of the part of `side` that is edge `k` of `triangle`.
    pub(super) fn rank_of_edge(&self, triangle: &PatchTriangle, k: usize, side: usize) -> usize {
        let tail = triangle.corners[k];
        if tail == side {
            0
        } else {
            self.points[tail].rank
        }
    }

    /// Lengths and apexes of `triangle`; `part` gives the length of a part of a side of the face.
    pub(super) fn shape_of(
        &self,
        triangle: &PatchTriangle,
        part: impl Fn(usize, usize) -> f64,
    ) -> Frames {
        let corners = triangle.corners.map(|p| self.points[p].barycentric);
        let edges = [0, 1, 2].map(|k| self.shape.vector(corners[k], corners[(k + 1) % 3]));
        let lengths = [0, 1, 2].map(|k| match triangle.neighbours[k] {
            PatchNeighbour::Side(side) => part(side, self.rank_of_edge(triangle, k, side)),
            // Both triangles of an edge measure it in the same direction.
            PatchNeighbour::Inside(..) => {
                let (p, q) = (triangle.corners[k], triangle.corners[(k + 1) % 3]);
                let [p, q] = [p.min(q), p.max(q)].map(|p| self.points[p].barycentric);
                self.shape.distance(p, q)
            }
        });
        let twice_area = oriented(corners).0.max(0.0) * self.shape.twice_area;
        let twice_area = at_least_a_sliver(twice_area, lengths);
        let apexes = [0, 1, 2].map(|k| {
            let (edge, back) = (edges[k], edges[(k + 2) % 3]);
            let x = -(edge[0] * back[0] + edge[1] * back[1]) / lengths[k];
            [x, twice_area / lengths[k]]
        });
        Frames { lengths, apexes }
    }

    /// Adds a vertex on a side. Vertices nearer to the tail of the side must be added before.
    pub(super) fn add_on_side(&mut self, side: usize, [tail, head]: [f64; 2], vertex: u32) {
        self.on_sides[side] += 1;
        let mut barycentric = [0.0; 3];
        barycentric[side] = tail;
        barycentric[(side + 1) % 3] = head;
        let rank = self.on_sides[side];
        let last = (side + 1) % 3;
        // The last part of the side is the one that ends at its head.
        let found = self.triangles.iter().enumerate().find_map(|(t, triangle)| {
            let is_last = |&k: &usize| {
                triangle.neighbours[k] == PatchNeighbour::Side(side)
                    && triangle.corners[(k + 1) % 3] == last
            };
            (0..3).find(is_last).map(|k| (t, k))
        });
        let Some((t, k)) = found else {
            unreachable!("every side has a last part");
        };
        let p = self.push(barycentric, vertex, rank);
        let PatchTriangle {
            corners,
            neighbours,
        } = turned(&self.triangles[t], k);
        let [a, b, c] = corners;
        let new = self.triangles.len();
        self.triangles.push(PatchTriangle {
            corners: [p, b, c],
            neighbours: [
                PatchNeighbour::Side(side),
                neighbours[1],
                PatchNeighbour::Inside(t, 1),
            ],
        });
        self.triangles[t] = PatchTriangle {
            corners: [a, p, c],
            neighbours: [
                PatchNeighbour::Side(side),
                PatchNeighbour::Inside(new, 2),
                neighbours[2],
            ],
        };
        self.relink(&[t, new]);
        self.improve(vec![(t, 2), (new, 1), (t, 1)]);
    }

    /// Adds a vertex inside the face.
    pub(super) fn add_inside(&mut self, barycentric: [f64; 3], vertex: u32) {
        let (t, doubtful) = self.locate(barycentric);
        let p = self.push(barycentric, vertex, 0);
        if let Some(k) = doubtful
            && let PatchNeighbour::Inside(u, m) = self.triangles[t].neighbours[k]
        {
            self.split_edge(t, k, u, m, p);
        } else {
            self.split_triangle(t, p);
        }
    }

    fn push(&mut self, barycentric: [f64; 3], vertex: u32, rank: usize) -> usize {
        self.points.push(PatchPoint {
            barycentric,
            vertex,
            rank,
        });
        // The Delaunay triangulation of n points is some n² flips away from any other.
        self.flips_left = 16 + self.points.len() * self.points.len();
        self.points.len() - 1
    }

    fn barycentric(&self, points: [usize; 3]) -> [[f64; 3]; 3] {
        points.map(|p| self.points[p].barycentric)
    }

    /// The triangle that contains a point, and its edge on which the point lies, if any.
    fn locate(&self, point: [f64; 3]) -> (usize, Option<usize>) {
        let mut best = (0, 0, f64::NEG_INFINITY);
        for (t, triangle) in self.triangles.iter().enumerate() {
            // The sine of the angle by which the point is inside the edge, least over the edges.
            let inside = |k: usize| {
                let ends = [triangle.corners[k], triangle.corners[(k + 1) % 3]];
                let [a, b] = ends.map(|p| self.points[p].barycentric);
                let (area, size) = oriented([a, b, point]);
                if size > 0.0 { area / size } else { 0.0 }
            };
            let sines = [0, 1, 2].map(inside);
            let k = largest(sines.map(|s| -s));
            if sines[k] > best.2 {
                best = (t, k, sines[k]);
            }
        }
        let (t, k, sine) = best;
        (t, (sine <= STRAIGHT).then_some(k))
    }

    fn split_triangle(&mut self, t: usize, p: usize) {
        let PatchTriangle {
            corners: [a, b, c],
            neighbours: [ab, bc, ca],
        } = self.triangles[t];
        let u = self.triangles.len();
        let v = u + 1;
        self.triangles[t] = PatchTriangle {
            corners: [a, b, p],
            neighbours: [
                ab,
                PatchNeighbour::Inside(u, 2),
                PatchNeighbour::Inside(v, 1),
            ],
        };
        self.triangles.push(PatchTriangle {
            corners: [b, c, p],
            neighbours: [
                bc,
                PatchNeighbour::Inside(v, 2),
                PatchNeighbour::Inside(t, 1),
            ],
        });
        self.triangles.push(PatchTriangle {
            corners: [c, a, p],
            neighbours: [
                ca,
                PatchNeighbour::Inside(t, 2),
                PatchNeighbour::Inside(u, 1),
            ],
        });
        self.relink(&[t, u, v]);
        self.improve(vec![(t, 0), (u, 0), (v, 0)]);
    }

    /// Splits the triangles `t` and `u` at a point of the edge between them.
    fn split_edge(&mut self, t: usize, k: usize, u: usize, m: usize, p: usize) {
        let first = turned(&self.triangles[t], k);
        let second = turned(&self.triangles[u], m);
        let [a, b, c] = first.corners;
        let d = second.corners[2];
        let (v, w) = (self.triangles.len(), self.triangles.len() + 1);
        self.triangles[t] = PatchTriangle {
            corners: [a, p, c],
            neighbours: [
                PatchNeighbour::Inside(w, 0),
                PatchNeighbour::Inside(v, 2),
                first.neighbours[2],
            ],
        };
        self.triangles.push(PatchTriangle {
            corners: [p, b, c],
            neighbours: [
                PatchNeighbour::Inside(u, 0),
                first.neighbours[1],
                PatchNeighbour::Inside(t, 1),
            ],
        });
        self.triangles[u] = PatchTriangle {
            corners: [b, p, d],
            neighbours: [
                PatchNeighbour::Inside(v, 0),
                PatchNeighbour::Inside(w, 2),
                second.neighbours[2],
            ],
        };
        self.triangles.push(PatchTriangle {
            corners: [p, a, d],
            neighbours: [
                PatchNeighbour::Inside(t, 0),
                second.neighbours[1],
                PatchNeighbour::Inside(u, 1),
            ],
        });
        self.relink(&[t, u, v, w]);
        self.improve(vec![(t, 2), (v, 1), (u, 2), (w, 1)]);
    }

    /// Updates the neighbours of these triangles to refer to them.
    fn relink(&mut self, changed: &[usize]) {
        for &t in changed {
            for k in 0..3 {
                if let PatchNeighbour::Inside(u, m) = self.triangles[t].neighbours[k] {
                    self.triangles[u].neighbours[m] = PatchNeighbour::Inside(t, k);
                }
            }
        }
    }

    /// Flips edges that are not Delaunay, starting with these.
    fn improve(&mut self, mut edges: Vec<(usize, usize)>) {
        while let Some((t, k)) = edges.pop() {
            let PatchNeighbour::Inside(u, m) = self.triangles[t].neighbours[k] else {
                continue;
            };
            let first = turned(&self.triangles[t], k);
            let second = turned(&self.triangles[u], m);
            let [a, b, c] = first.corners;
            let d = second.corners[2];
            if self.flips_left == 0
                || self.angle([c, a, b]) + self.angle([d, b, a])
                    <= std::f64::consts::PI + FLIP_SLACK
                || !self.is_upright([a, d, c])
                || !self.is_upright([d, b, c])
            {
                continue;
            }
            self.flips_left -= 1;
            self.triangles[t] = PatchTriangle {
                corners: [a, d, c],
                neighbours: [
                    second.neighbours[1],
                    PatchNeighbour::Inside(u, 2),
                    first.neighbours[2],
                ],
            };
            self.triangles[u] = PatchTriangle {
                corners: [d, b, c],
                neighbours: [
                    second.neighbours[2],
                    first.neighbours[1],
                    PatchNeighbour::Inside(t, 1),
                ],
            };
            self.relink(&[t, u]);
            edges.extend([(t, 0), (t, 2), (u, 0), (u, 1)]);
        }
    }

    fn is_upright(&self, corners: [usize; 3]) -> bool {
        let (area, size) = oriented(self.barycentric(corners));
        area > STRAIGHT * size
    }

    /// The angle at the first of three corners.
    fn angle(&self, corners: [usize; 3]) -> f64 {
        let all = self.barycentric(corners);
        let [u, v] = [all[1], all[2]].map(|q| self.shape.vector(all[0], q));
        let twice_area = oriented(all).0 * self.shape.twice_area;
        libm::atan2(twice_area, u[0] * v[0] + u[1] * v[1])
    }
}

/// `triangle` with its corner `k` as the first one.
fn turned(triangle: &PatchTriangle, k: usize) -> PatchTriangle {
    PatchTriangle {
        corners: [0, 1, 2].map(|i| triangle.corners[(k + i) % 3]),
        neighbours: [0, 1, 2].map(|i| triangle.neighbours[(k + i) % 3]),
    }
}
