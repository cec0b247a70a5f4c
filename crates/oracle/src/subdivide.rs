//! Subdivision of a surface into smaller triangles.

use std::collections::HashMap;

use crate::model::{Geometry, Model};

/// Triangles cut evenly, with the same number of parts on each side.
#[derive(Clone, Debug)]
pub struct Subdivision {
    /// For each vertex, pairs of old vertex and weight, ordered by vertex. The sum of the weights
    /// is the number of parts. Old vertices keep their numbers.
    pub weights: Vec<Vec<(u32, u32)>>,
    /// The small triangles. Side `k` of each is parallel to side `k` of its parent.
    pub triangles: Vec<[u32; 3]>,
    /// For each small triangle, the triangle from which it was cut.
    pub parents: Vec<usize>,
}

/// Cuts each of `triangles` into `parts`² similar ones.
pub fn subdivide(vertex_count: usize, triangles: &[[u32; 3]], parts: u32) -> Subdivision {
    let mut result = Subdivision {
        weights: Vec::new(),
        triangles: Vec::new(),
        parents: Vec::new(),
    };
    let mut numbers = HashMap::new();
    for v in 0..vertex_count as u32 {
        numbers.insert(vec![(v, parts)], v);
        result.weights.push(vec![(v, parts)]);
    }
    for (parent, &[a, b, c]) in triangles.iter().enumerate() {
        // The point i steps towards b and j steps towards c from a.
        let mut point = |i: u32, j: u32| {
            let mut weights = vec![(a, parts - i - j), (b, i), (c, j)];
            weights.retain(|&(_, weight)| weight > 0);
            weights.sort_unstable();
            *numbers.entry(weights).or_insert_with_key(|weights| {
                result.weights.push(weights.clone());
                result.weights.len() as u32 - 1
            })
        };
        for i in 0..parts {
            for j in 0..parts - i {
                let upright = [point(i, j), point(i + 1, j), point(i, j + 1)];
                result.triangles.push(upright);
                result.parents.push(parent);
                if i + j + 2 <= parts {
                    let turned = [point(i + 1, j + 1), point(i, j + 1), point(i + 1, j)];
                    result.triangles.push(turned);
                    result.parents.push(parent);
                }
            }
        }
    }
    result
}

impl Model {
    /// The same surface with each triangle cut into `parts`² similar ones. Old vertices keep their
    /// numbers.
    #[must_use]
    pub fn subdivided(&self, parts: u32) -> Self {
        let cut = subdivide(self.vertex_count, &self.triangles, parts);
        let name = format!("{} / {parts}", self.name);
        match &self.geometry {
            Geometry::Positions(positions) => {
                let place = |weights: &Vec<(u32, u32)>| {
                    let mut sum = [0.0; 3];
                    for &(v, weight) in weights {
                        for (s, x) in sum.iter_mut().zip(positions[v as usize]) {
                            *s += f64::from(weight) * x;
                        }
                    }
                    sum.map(|s| s / f64::from(parts))
                };
                Self::new(name, cut.weights.iter().map(place).collect(), cut.triangles)
            }
            Geometry::Lengths(lengths) => {
                let parts = f64::from(parts);
                let lengths = cut.parents.iter().map(|&t| lengths[t].map(|l| l / parts));
                let lengths = lengths.collect();
                Self::from_lengths(name, cut.weights.len(), cut.triangles, lengths)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_stay_parallel_and_vertices_are_shared() {
        let corners = vec![
            [0.0, 0.0, 0.0],
            [8.0, 0.0, 0.0],
            [0.0, 4.0, 0.0],
            [8.0, 8.0, 0.0],
        ];
        let model = Model::new("two", corners.clone(), vec![[0, 1, 2], [1, 3, 2]]).subdivided(4);
        assert_eq!(model.triangles.len(), 32);
        assert_eq!(model.vertex_count, 25);
        let positions = model.positions().unwrap();
        assert_eq!(positions[..4], corners);
        for triangle in &model.triangles[..16] {
            let [a, b] = [0, 1].map(|k| positions[triangle[k] as usize]);
            assert_eq!([(a[0] - b[0]).abs(), a[1] - b[1]], [2.0, 0.0]);
        }
        model.surface::<f64>();
    }
}
