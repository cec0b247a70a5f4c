//! A mesh under construction, and operations on it.

use std::collections::{HashMap, HashSet};
use std::f64::consts::FRAC_PI_2;

use crate::model::{Geometry, Model};
use crate::random::Random;
use crate::transform::shuffled;

/// Positions and faces, possibly with defects.
#[derive(Clone, Debug, Default)]
pub(super) struct Draft {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) faces: Vec<[u32; 3]>,
}

impl From<Model> for Draft {
    fn from(model: Model) -> Self {
        let positions = match model.geometry {
            Geometry::Positions(positions) => positions,
            Geometry::Lengths(_) => Vec::new(),
        };
        Self {
            positions,
            faces: model.triangles,
        }
    }
}

impl Draft {
    /// Keeps the first `most` faces, and the vertices that they use.
    pub(super) fn limit(&mut self, most: usize) {
        if self.faces.len() > most {
            self.faces.truncate(most);
            self.drop_unused_vertices();
        }
    }

    fn drop_unused_vertices(&mut self) {
        let mut used = vec![false; self.positions.len()];
        for &v in self.faces.as_flattened() {
            used[v as usize] = true;
        }
        let mut numbers = vec![0; self.positions.len()];
        let mut positions = Vec::new();
        for (v, used) in used.into_iter().enumerate() {
            numbers[v] = positions.len() as u32;
            if used {
                positions.push(self.positions[v]);
            }
        }
        self.positions = positions;
        for v in self.faces.as_flattened_mut() {
            *v = numbers[*v as usize];
        }
    }

    /// The largest extent along an axis.
    pub(super) fn size(&self) -> f64 {
        let side = |axis: usize| {
            let along = self.positions.iter().map(|p| p[axis]);
            let start = (f64::INFINITY, f64::NEG_INFINITY);
            let (least, most) = along.fold(start, |(a, b), x| (a.min(x), b.max(x)));
            most - least
        };
        [0, 1, 2].map(side).into_iter().fold(0.0, f64::max)
    }

    pub(super) fn scale(&mut self, factors: [f64; 3]) {
        self.place(|p| [0, 1, 2].map(|i| p[i] * factors[i]));
    }

    pub(super) fn translate(&mut self, by: [f64; 3]) {
        self.place(|p| [0, 1, 2].map(|i| p[i] + by[i]));
    }

    /// Rounds coordinates to multiples of 2^-`bits` of the size.
    pub(super) fn round(&mut self, bits: u32) {
        let size = self.size();
        if size > 0.0 {
            let step = 2.0_f64.powi(size.log2().floor() as i32 - bits.cast_signed() - 1);
            self.place(|p| p.map(|x| (x / step).round() * step));
        }
    }

    pub(super) fn place(&mut self, mut at: impl FnMut([f64; 3]) -> [f64; 3]) {
        for position in &mut self.positions {
            *position = at(*position);
        }
    }

    /// A random side: its face, and the corners of the face, starting with those of the side.
    pub(super) fn random_side(&self, random: &mut Random) -> (usize, [u32; 3]) {
        let face = random.below(self.faces.len() as u32) as usize;
        let mut corners = self.faces[face];
        corners.rotate_left(random.below(3) as usize);
        (face, corners)
    }

    /// The face with a side from `a` to `b`, and its third corner.
    fn face_with(&self, a: u32, b: u32) -> Option<(usize, u32)> {
        let third = |&[p, q, r]: &[u32; 3]| match (a, b) {
            side if side == (p, q) => Some(r),
            side if side == (q, r) => Some(p),
            side if side == (r, p) => Some(q),
            _ => None,
        };
        let mut faces = self.faces.iter().enumerate();
        faces.find_map(|(f, corners)| Some((f, third(corners)?)))
    }

    pub(super) fn between(&self, a: u32, b: u32, part: f64) -> [f64; 3] {
        let [a, b] = [a, b].map(|v| self.positions[v as usize]);
        [0, 1, 2].map(|i| a[i] + part * (b[i] - a[i]))
    }

    pub(super) fn add(&mut self, position: [f64; 3]) -> u32 {
        self.positions.push(position);
        self.positions.len() as u32 - 1
    }

    /// Inserts vertices on edges and cuts the faces on both sides.
    pub(super) fn split_edges(&mut self, count: u32, random: &mut Random) {
        for _ in 0..count {
            let (face, [a, b, c]) = self.random_side(random);
            let place = self.between(a, b, random.part());
            self.split_side(face, [a, b, c], place);
        }
    }

    /// Inserts a vertex on the edge from `a` to `b`, if there is one.
    pub(super) fn split_edge(&mut self, [a, b]: [u32; 2], part: f64) {
        let place = self.between(a, b, part);
        if let Some((face, c)) = self.face_with(a, b) {
            self.split_side(face, [a, b, c], place);
        } else if let Some((face, c)) = self.face_with(b, a) {
            self.split_side(face, [b, a, c], place);
        }
    }

    fn split_side(&mut self, face: usize, [a, b, c]: [u32; 3], place: [f64; 3]) {
        let middle = self.add(place);
        if let Some((other, d)) = self.face_with(b, a) {
            self.faces[other] = [b, middle, d];
            self.faces.push([middle, a, d]);
        }
        self.faces[face] = [a, middle, c];
        self.faces.push([middle, b, c]);
    }

    /// Inserts vertices on edges, or beside them by `height` of the edge, and cuts the faces on one
    /// side only. The face between the new vertex and the edge has little area or none.
    pub(super) fn insert_on_edges(&mut self, count: u32, height: f64, random: &mut Random) {
        for _ in 0..count {
            let (face, [a, b, c]) = self.random_side(random);
            let mut place = self.between(a, b, random.part());
            let [start, end] = [a, b].map(|v| self.positions[v as usize]);
            let length = (0..3)
                .map(|i| (end[i] - start[i]).abs())
                .fold(0.0, f64::max);
            for (x, by) in place.iter_mut().zip(random.in_ball()) {
                *x += by * height * length;
            }
            let middle = self.add(place);
            self.faces[face] = [a, middle, c];
            self.faces.extend([[middle, b, c], [a, b, middle]]);
        }
    }

    pub(super) fn flip_edges(&mut self, count: u32, random: &mut Random) {
        for _ in 0..count {
            let (face, [a, b, c]) = self.random_side(random);
            let Some((other, d)) = self.face_with(b, a) else {
                continue;
            };
            if c == d || self.face_with(c, d).is_some() || self.face_with(d, c).is_some() {
                continue;
            }
            self.faces[face] = [c, d, b];
            self.faces[other] = [d, c, a];
        }
    }

    /// Moves one end of an edge almost to the other.
    pub(super) fn shorten_edges(&mut self, count: u32, random: &mut Random) {
        for _ in 0..count {
            let (_, [a, b, _]) = self.random_side(random);
            let part = random.magnitude(-16, -2);
            self.positions[a as usize] = self.between(b, a, part);
        }
    }

    /// Inserts a smaller triangle into faces, as a hole if `holes`.
    pub(super) fn inset_faces(&mut self, count: u32, holes: bool, random: &mut Random) {
        for _ in 0..count {
            let (face, corners) = self.random_side(random);
            let size = random.magnitude(-12, -1);
            let towards = random.below(4) as usize;
            let points = corners.map(|v| self.positions[v as usize]);
            let centre = match points.get(towards) {
                // Near a corner, but not at it.
                Some(_) => {
                    let weight = |k: usize| if k == towards { 0.75 } else { 0.125 };
                    [0, 1, 2].map(|i| (0..3).map(|k| weight(k) * points[k][i]).sum::<f64>())
                }
                None => [0, 1, 2].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / 3.0),
            };
            let inner = points.map(|p| [0, 1, 2].map(|i| centre[i] + size * (p[i] - centre[i])));
            let inner = inner.map(|p| self.add(p));
            self.faces.swap_remove(face);
            for k in 0..3 {
                let [a, b] = [corners[k], corners[(k + 1) % 3]];
                let [p, q] = [inner[k], inner[(k + 1) % 3]];
                self.faces.extend([[a, b, q], [a, q, p]]);
            }
            if !holes {
                self.faces.push(inner);
            }
        }
    }

    /// Removes faces, but never the last one.
    pub(super) fn remove_faces(&mut self, count: u32, random: &mut Random) {
        for _ in 0..count {
            if self.faces.len() > 1 {
                let (face, _) = self.random_side(random);
                self.faces.swap_remove(face);
            }
        }
    }

    /// Merges two vertices that are not adjacent; the faces of the second are stretched.
    pub(super) fn weld(&mut self, random: &mut Random) {
        let count = self.positions.len() as u32;
        let [kept, gone] = [random.below(count), random.below(count)];
        let both = |face: &[u32; 3]| face.contains(&kept) && face.contains(&gone);
        if kept != gone && !self.faces.iter().any(both) {
            for v in self.faces.as_flattened_mut() {
                if *v == gone {
                    *v = kept;
                }
            }
        }
    }

    pub(super) fn place_beside(&mut self, other: &Self) -> u32 {
        let shift = self.positions.len() as u32;
        self.positions.extend(&other.positions);
        let shifted = other.faces.iter().map(|face| face.map(|v| v + shift));
        self.faces.extend(shifted);
        shift
    }

    /// Joins `other` to this mesh at one vertex.
    pub(super) fn pinch(&mut self, other: &Self, random: &mut Random) {
        let at = random.below(self.positions.len() as u32);
        let other_at = random.below(other.positions.len() as u32);
        let [to, from] = [
            self.positions[at as usize],
            other.positions[other_at as usize],
        ];
        let mut other = other.clone();
        other.translate([0, 1, 2].map(|i| to[i] - from[i]));
        let joint = self.place_beside(&other) + other_at;
        for v in self.faces.as_flattened_mut() {
            if *v == joint {
                *v = at;
            }
        }
        self.drop_unused_vertices();
    }

    /// Permutes vertices and faces, and rotates the corners of faces.
    pub(super) fn renumber(&mut self, random: &mut Random) {
        let numbers = shuffled(self.positions.len(), random);
        let mut positions = self.positions.clone();
        for (&number, &position) in numbers.iter().zip(&self.positions) {
            positions[number as usize] = position;
        }
        self.positions = positions;
        for face in &mut self.faces {
            *face = face.map(|v| numbers[v as usize]);
            face.rotate_left(random.below(3) as usize);
        }
        for i in (1..self.faces.len()).rev() {
            self.faces.swap(i, random.below(i as u32 + 1) as usize);
        }
    }

    /// Cuts every face into four.
    pub(super) fn subdivide(&mut self) {
        let mut middles = HashMap::new();
        let mut faces = Vec::new();
        for [a, b, c] in std::mem::take(&mut self.faces) {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
                *middles
                    .entry((p.min(q), p.max(q)))
                    .or_insert_with(|| self.add(self.between(p.min(q), p.max(q), 0.5)))
            });
            faces.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        self.faces = faces;
    }

    /// Makes a solid of a flat sheet in the plane z = 0: a copy below it by `thickness`, and walls
    /// of `strips` rows of faces along the boundary. A `fillet` above 0 is the radius of the upper
    /// edges.
    pub(super) fn thicken(
        &mut self,
        thickness: f64,
        strips: u32,
        fillet: f64,
        random: &mut Random,
    ) {
        let sides = |face: &[u32; 3]| [0, 1, 2].map(|k| [face[k], face[(k + 1) % 3]]);
        let all: HashSet<[u32; 2]> = self.faces.iter().flat_map(sides).collect();
        let in_order = self.faces.iter().flat_map(sides);
        let boundary: Vec<[u32; 2]> = in_order.filter(|&[a, b]| !all.contains(&[b, a])).collect();
        let mut outward: HashMap<u32, [f64; 2]> = HashMap::new();
        for &[a, b] in &boundary {
            let [p, q] = [a, b].map(|v| self.positions[v as usize]);
            let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
            let length = dx.hypot(dy);
            for v in [a, b] {
                let sum = outward.entry(v).or_default();
                *sum = [sum[0] + dy / length / 2.0, sum[1] - dx / length / 2.0];
            }
        }
        let count = self.positions.len() as u32;
        let beside = |v: u32, p: [f64; 3], by: f64, z: f64| {
            let [x, y] = outward.get(&v).copied().unwrap_or_default();
            [p[0] + by * x, p[1] + by * y, z]
        };
        // Row 0 is the sheet, the last one its copy. The rows between have the vertices of the
        // boundary only.
        let mut rows: Vec<HashMap<u32, u32>> = vec![(0..count).map(|v| (v, v)).collect()];
        for row in 1..=strips {
            let part = f64::from(row) / f64::from(strips);
            let (sin, cos) = (FRAC_PI_2 * part).sin_cos();
            let (by, z) = if row == strips {
                (fillet, -thickness)
            } else if fillet > 0.0 {
                (fillet * sin, fillet * (cos - 1.0))
            } else {
                (0.0, -thickness * part)
            };
            let mut numbers = HashMap::new();
            for v in (0..count).filter(|v| row == strips || outward.contains_key(v)) {
                let place = beside(v, self.positions[v as usize], by, z);
                numbers.insert(v, self.add(place));
            }
            rows.push(numbers);
        }
        let copy = &rows[rows.len() - 1];
        let turned: Vec<[u32; 3]> = self.faces.iter().map(|&[a, b, c]| [b, a, c]).collect();
        let turned = turned.iter().map(|face| face.map(|v| copy[&v]));
        let mut faces: Vec<[u32; 3]> = turned.collect();
        for pair in rows.windows(2) {
            for [a, b] in &boundary {
                let [p, q] = [a, b].map(|v| pair[0][v]);
                let [r, s] = [a, b].map(|v| pair[1][v]);
                faces.extend(if random.coin() {
                    [[q, p, r], [q, r, s]]
                } else {
                    [[q, p, s], [p, r, s]]
                });
            }
        }
        self.faces.extend(faces);
    }
}
