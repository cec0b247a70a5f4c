//! The checks of validation.

use std::borrow::Cow;

use crate::defect::{Defect, DefectKind, LONGEST_EDGE, SHORTEST_EDGE};
use crate::disjoint_sets::DisjointSets;
use crate::edges::{Edge, EdgeGroups};
use crate::frames::{apexes_from_lengths, apexes_from_positions, distance, is_flat};
use crate::mesh::NO_TWIN;
use crate::orient::orient;

/// Relative excess that a side may have over the sum of the others. Rounding can break the triangle
/// inequality in lengths computed for a triangle without area.
const INEQUALITY_SLACK: f64 = 1e-12;

/// The source of the edge lengths.
#[derive(Clone, Copy)]
pub(crate) enum Metric<'a> {
    Positions(&'a [[f64; 3]]),
    Lengths(&'a [[f64; 3]]),
}

/// The triangles with three different vertices that exist.
pub(crate) struct Usable<'a> {
    pub(crate) triangles: Cow<'a, [[u32; 3]]>,
    /// The index of each in the soup; `None` if all of the soup's triangles are usable.
    pub(crate) places: Option<Vec<u32>>,
}

/// Drops triangles that name missing or repeated vertices.
fn usable_triangles<'a>(
    vertex_count: usize,
    triangles: &'a [[u32; 3]],
    metric: Metric<'_>,
    file_faces: &[u32],
    defects: &mut Vec<Defect>,
) -> Usable<'a> {
    let mut left_out = Vec::new();
    for (i, &[a, b, c]) in triangles.iter().enumerate() {
        let exists = |v: u32| (v as usize) < vertex_count;
        if exists(a) && exists(b) && exists(c) && a != b && b != c && c != a {
            continue;
        }
        left_out.push(i as u32);
        let face = file_faces.get(i).map_or(i as u32, |&face| face);
        for vertex in [a, b, c] {
            if !exists(vertex) {
                defects.push(Defect::IndexOutOfRange {
                    face,
                    vertex,
                    vertex_count: vertex_count as u32,
                });
            }
        }
        if a == b || b == c || c == a {
            let vertex = if a == b || a == c { a } else { b };
            defects.push(match metric {
                Metric::Positions(_) => Defect::CollapsedFace { face, vertex },
                // Edges of any length may join a vertex to itself.
                Metric::Lengths(_) => Defect::RepeatedVertex { face, vertex },
            });
        }
    }
    if left_out.is_empty() {
        return Usable {
            triangles: Cow::Borrowed(triangles),
            places: None,
        };
    }
    let mut left_out = left_out.into_iter().peekable();
    let places: Vec<u32> = (0..triangles.len() as u32)
        .filter(|&i| left_out.next_if_eq(&i).is_none())
        .collect();
    Usable {
        triangles: places.iter().map(|&i| triangles[i as usize]).collect(),
        places: Some(places),
    }
}

/// The state that the checks share. Half-edges and corners are numbered over usable triangles.
pub(crate) struct Inspection<'a> {
    vertex_count: usize,
    metric: Metric<'a>,
    pub(crate) usable: Usable<'a>,
    file_faces: &'a [u32],
    pub(crate) defects: Vec<Defect>,
    /// The other half-edge along each edge, where there is exactly one.
    pub(crate) mates: Vec<u32>,
    /// Length of each half-edge; NaN where a position is not finite.
    pub(crate) lengths: Vec<[f64; 3]>,
}

impl<'a> Inspection<'a> {
    /// Drops unusable triangles. Runs no other check yet.
    pub(crate) fn new(
        vertex_count: usize,
        triangles: &'a [[u32; 3]],
        metric: Metric<'a>,
        file_faces: &'a [u32],
    ) -> Self {
        let mut defects = Vec::new();
        let usable = usable_triangles(vertex_count, triangles, metric, file_faces, &mut defects);
        Self {
            vertex_count,
            metric,
            usable,
            file_faces,
            defects,
            mates: Vec::new(),
            lengths: Vec::new(),
        }
    }

    /// Leaves out second copies of faces, unless both alone share all their edges, which is a
    /// two-sided surface. Returns whether there are any.
    pub(crate) fn leave_out_repeated_faces(&mut self, edges: &EdgeGroups) -> bool {
        // Copies with equal positions have equal lengths.
        let Metric::Positions(_) = self.metric else {
            return false;
        };
        let mut copies: Vec<u32> = Vec::new();
        for edge in edges.iter().filter(|edge| edge.side_count() > 2) {
            for (t, first) in self.repeated_faces(&edge) {
                let (face, first) = (self.face(t), self.face(first));
                // Parts of one polygon can be equal.
                if face != first {
                    self.defects.push(Defect::RepeatedFace { face, first });
                }
                copies.push(t);
            }
        }
        if copies.is_empty() {
            return false;
        }
        copies.sort_unstable();
        let is_kept = |t: &u32| copies.binary_search(t).is_err();
        let count = self.usable.triangles.len() as u32;
        let kept: Vec<u32> = (0..count).filter(is_kept).collect();
        let triangles = kept.iter().map(|&t| self.usable.triangles[t as usize]);
        self.usable = Usable {
            triangles: triangles.collect(),
            places: Some(kept.iter().map(|&t| self.place(t)).collect()),
        };
        true
    }

    /// The index in the soup of usable triangle `t`.
    fn place(&self, t: u32) -> u32 {
        self.usable
            .places
            .as_ref()
            .map_or(t, |places| places[t as usize])
    }

    /// The number in the file of the face of usable triangle `t`.
    fn face(&self, t: u32) -> u32 {
        let place = self.place(t);
        self.file_faces
            .get(place as usize)
            .map_or(place, |&face| face)
    }

    /// The file's faces along `edge`, without repeats.
    fn faces_along(&self, edge: &Edge<'_>) -> Vec<u32> {
        let mut faces: Vec<u32> = edge.half_edges().map(|h| self.face(h / 3)).collect();
        faces.sort_unstable();
        faces.dedup();
        faces
    }

    /// Finds vertices without finite coordinates or without faces, and models without vertices or
    /// faces. `copies` are vertices for which others stand.
    pub(crate) fn check_vertices(&mut self, triangles: &[[u32; 3]], copies: &[[u32; 2]]) {
        if self.vertex_count == 0 {
            self.defects.push(Defect::NoVertices);
        }
        let is_left_out = |defect: &Defect| defect.kind() == DefectKind::CollapsedFace;
        let all_left_out = self.usable.triangles.is_empty() && self.defects.iter().all(is_left_out);
        if triangles.is_empty() || all_left_out {
            self.defects.push(Defect::NoFaces);
            return;
        }
        let mut in_some_face = vec![false; self.vertex_count];
        let collapses = |[a, b, c]: [u32; 3]| a == b || b == c || c == a;
        for &triangle in triangles.iter().filter(|t| !collapses(**t)) {
            for v in triangle {
                if let Some(seen) = in_some_face.get_mut(v as usize) {
                    *seen = true;
                }
            }
        }
        let mut copies = copies.iter().map(|copy| copy[0]).peekable();
        for (vertex, seen) in in_some_face.into_iter().enumerate() {
            let vertex = vertex as u32;
            if !seen && copies.next_if_eq(&vertex).is_none() {
                self.defects.push(Defect::IsolatedVertex { vertex });
            }
            if let Metric::Positions(positions) = self.metric
                && !positions[vertex as usize].iter().all(|x| x.is_finite())
            {
                self.defects.push(if seen {
                    Defect::NonFiniteCoordinate { vertex }
                } else {
                    Defect::UnplacedVertex { vertex }
                });
            }
        }
    }

    /// Pairs half-edges, measures edges, and finds the defects of both.
    pub(crate) fn check_edges(&mut self, edges: &EdgeGroups) {
        let triangle_count = self.usable.triangles.len();
        self.mates = vec![NO_TWIN; 3 * triangle_count];
        self.lengths = vec![[f64::NAN; 3]; triangle_count];
        for edge in edges.iter() {
            match edge.pair() {
                Some([a, b]) => {
                    self.mates[a as usize] = b;
                    self.mates[b as usize] = a;
                }
                None if edge.side_count() > 2 => {
                    self.defects.push(Defect::NonManifoldEdge {
                        vertices: [edge.low, edge.high],
                        faces: self.faces_along(&edge),
                    });
                }
                None => {}
            }
            self.measure(&edge);
            self.find_duplicate_faces(&edge);
        }
    }

    /// Sets the length of all half-edges along `edge`. It is computed once, so that all get the
    /// same bits.
    fn measure(&mut self, edge: &Edge<'_>) {
        let vertices = [edge.low, edge.high];
        let length = match self.metric {
            Metric::Positions(positions) => {
                let ends = vertices.map(|v| positions[v as usize]);
                if !ends.as_flattened().iter().all(|x| x.is_finite()) {
                    return;
                }
                let length = distance(ends[0], ends[1]);
                if length.is_finite() && length > 0.0 {
                    length
                } else {
                    // The square of the length overflows or vanishes, but the report needs the
                    // length.
                    let [dx, dy, dz] = [0, 1, 2].map(|i| ends[1][i] - ends[0][i]);
                    libm::hypot(libm::hypot(dx, dy), dz)
                }
            }
            Metric::Lengths(lengths) => {
                let given = |h: u32| {
                    let t = self.place(h / 3) as usize;
                    lengths[t][h as usize % 3]
                };
                let mut sides = edge.half_edges();
                let first = sides.next().unwrap_or_default();
                let length = given(first);
                if let Some(other) = sides.find(|&h| given(h).to_bits() != length.to_bits()) {
                    let faces = [first, other].map(|h| self.face(h / 3));
                    let lengths = [length, given(other)];
                    self.defects.push(Defect::UnequalLengths {
                        vertices,
                        lengths,
                        faces,
                    });
                }
                length
            }
        };
        if !(SHORTEST_EDGE..=LONGEST_EDGE).contains(&length) {
            self.defects
                .push(Defect::LengthOutOfRange { vertices, length });
            return;
        }
        for h in edge.half_edges() {
            self.lengths[h as usize / 3][h as usize % 3] = length;
        }
    }

    /// Finds faces along `edge` with the same three vertices. The faces' other edges find them
    /// again. The report drops repeats.
    fn find_duplicate_faces(&mut self, edge: &Edge<'_>) {
        for (t, first) in self.repeated_faces(edge) {
            let (face, first) = (self.face(t), self.face(first));
            // Parts of one polygon can be equal.
            if face != first {
                self.defects.push(Defect::DuplicateFace { face, first });
            }
        }
    }

    /// The usable triangles along `edge` with the same vertices as an earlier one, each with the
    /// first of them.
    fn repeated_faces(&self, edge: &Edge<'_>) -> Vec<(u32, u32)> {
        let tails = self.usable.triangles.as_flattened();
        let apex = |h: u32| tails[h as usize / 3 * 3 + (h as usize + 2) % 3];
        if let Some([a, b]) = edge.pair()
            && apex(a) != apex(b)
        {
            return Vec::new();
        }
        let mut sides: Vec<(u32, u32)> = edge.half_edges().map(|h| (apex(h), h / 3)).collect();
        sides.sort_unstable();
        let mut repeated = Vec::new();
        for same in sides.chunk_by(|x, y| x.0 == y.0) {
            repeated.extend(same[1..].iter().map(|side| (side.1, same[0].1)));
        }
        repeated
    }

    /// Finds vertices whose corners are not all connected across edges.
    pub(crate) fn check_fans(&mut self, edges: &EdgeGroups) {
        let tails = self.usable.triangles.as_flattened();
        let mut fans = DisjointSets::new(tails.len());
        for edge in edges.iter() {
            let corner_at = |v: u32, h: u32| {
                if tails[h as usize] == v {
                    h
                } else {
                    h / 3 * 3 + (h + 1) % 3
                }
            };
            let mut sides = edge.half_edges();
            if let Some(first) = sides.next() {
                for h in sides {
                    for end in [edge.low, edge.high] {
                        fans.union(corner_at(end, first), corner_at(end, h));
                    }
                }
            }
        }
        let mut counts = vec![0u32; self.vertex_count];
        for (corner, &v) in tails.iter().enumerate() {
            if fans.find(corner as u32) == corner as u32 {
                counts[v as usize] += 1;
            }
        }
        for (vertex, &fans) in counts.iter().enumerate() {
            if fans > 1 {
                let vertex = vertex as u32;
                self.defects.push(Defect::PinchedVertex { vertex, fans });
            }
        }
    }

    /// Finds triangles without area, and lengths that break the triangle inequality.
    pub(crate) fn check_shapes(&mut self) {
        for t in 0..self.usable.triangles.len() {
            let lengths = self.lengths[t];
            if lengths.iter().any(|l| l.is_nan()) {
                continue;
            }
            let face = self.face(t as u32);
            let apex = match self.metric {
                Metric::Positions(positions) => {
                    let corners = self.usable.triangles[t].map(|v| positions[v as usize]);
                    apexes_from_positions(corners, lengths)[0]
                }
                Metric::Lengths(_) => {
                    let longest = lengths.iter().copied().fold(0.0, f64::max);
                    // This order of the terms keeps the small ones.
                    let [a, b, c] = lengths;
                    let excess = [a - b - c, b - c - a, c - a - b]
                        .into_iter()
                        .fold(f64::NEG_INFINITY, f64::max);
                    if excess > INEQUALITY_SLACK * longest {
                        self.defects
                            .push(Defect::TriangleInequality { face, lengths });
                        continue;
                    }
                    apexes_from_lengths(lengths)[0]
                }
            };
            if is_flat(lengths, apex) {
                self.defects.push(Defect::FlatFace { face });
            }
        }
    }

    /// Finds components that share no vertex.
    pub(crate) fn check_components(&mut self) {
        let counts = component_sizes(self.vertex_count, &self.usable.triangles);
        if counts.len() > 1 {
            self.defects
                .push(Defect::SeveralComponents { triangles: counts });
        }
    }

    /// Finds the faces to turn over, and one-sided surfaces.
    pub(crate) fn check_orientation(&mut self) -> Vec<u32> {
        let orientation = orient(&self.usable.triangles, &self.mates);
        for &h in &orientation.contradictions {
            let triangle = self.usable.triangles[h as usize / 3];
            let k = h as usize % 3;
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            let mut faces = [h, self.mates[h as usize]].map(|h| self.face(h / 3));
            faces.sort_unstable();
            self.defects.push(Defect::NotOrientable {
                vertices: [a.min(b), a.max(b)],
                faces,
            });
        }
        for &t in &orientation.flipped {
            let face = self.face(t);
            self.defects.push(Defect::FlippedFace { face });
        }
        orientation.flipped
    }
}

/// The number of triangles of each component, in the order of their first vertices. Components
/// share no vertex.
pub(crate) fn component_sizes(vertex_count: usize, triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut parts = DisjointSets::new(vertex_count);
    for &[a, b, c] in triangles {
        parts.union(a, b);
        parts.union(a, c);
    }
    let mut counts = vec![0u32; vertex_count];
    for &[a, ..] in triangles {
        counts[parts.find(a) as usize] += 1;
    }
    counts.retain(|&count| count > 0);
    counts
}
