//! Half-edges sorted into undirected edges, in linear time.

/// The half-edges of a list of triangles, grouped by the pair of vertices that they join.
///
/// Half-edge `3 * t + k` runs from corner `k` of triangle `t` to the next corner. A group has one
/// member at a boundary, two inside a surface, and more at a non-manifold edge.
pub(crate) struct EdgeGroups {
    /// `(larger vertex, half-edge)`, bucketed by the smaller vertex and sorted within a bucket.
    entries: Vec<(u32, u32)>,
    /// Where the bucket of each smaller vertex starts in `entries`.
    starts: Vec<u32>,
}

/// An undirected edge and its half-edges.
pub(crate) struct Edge<'a> {
    /// The end with the smaller number.
    pub(crate) low: u32,
    /// The end with the larger number.
    pub(crate) high: u32,
    entries: &'a [(u32, u32)],
}

impl EdgeGroups {
    /// Groups the half-edges of `triangles`. Every vertex must be less than `vertex_count`.
    ///
    /// Takes O(n + Σ k log k) time, where k is the number of edges at a vertex.
    pub(crate) fn new(vertex_count: usize, triangles: &[[u32; 3]]) -> Self {
        let ends = |t: &[u32; 3], k: usize| {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            (a.min(b), a.max(b))
        };
        let mut starts = vec![0u32; vertex_count + 1];
        for t in triangles {
            for k in 0..3 {
                starts[ends(t, k).0 as usize + 1] += 1;
            }
        }
        for i in 0..vertex_count {
            starts[i + 1] += starts[i];
        }
        let mut cursor = starts.clone();
        let mut entries = vec![(0, 0); 3 * triangles.len()];
        for (i, t) in triangles.iter().enumerate() {
            for k in 0..3 {
                let (low, high) = ends(t, k);
                let place = &mut cursor[low as usize];
                entries[*place as usize] = (high, (3 * i + k) as u32);
                *place += 1;
            }
        }
        for v in 0..vertex_count {
            entries[starts[v] as usize..starts[v + 1] as usize].sort_unstable();
        }
        Self { entries, starts }
    }

    /// Every edge once, in ascending order of the smaller and then the larger vertex.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Edge<'_>> {
        self.starts.windows(2).enumerate().flat_map(|(low, range)| {
            self.entries[range[0] as usize..range[1] as usize]
                .chunk_by(|x, y| x.0 == y.0)
                .map(move |entries| Edge {
                    low: low as u32,
                    high: entries[0].0,
                    entries,
                })
        })
    }
}

impl Edge<'_> {
    /// Number of triangle sides along the edge, at least 1.
    pub(crate) fn side_count(&self) -> usize {
        self.entries.len()
    }

    /// The half-edges along the edge, in either direction, in ascending order.
    pub(crate) fn half_edges(&self) -> impl Iterator<Item = u32> + Clone {
        self.entries.iter().map(|entry| entry.1)
    }

    /// The two half-edges of an edge inside the surface; `None` at a boundary and at a non-manifold
    /// edge.
    pub(crate) fn pair(&self) -> Option<[u32; 2]> {
        match *self.entries {
            [a, b] => Some([a.1, b.1]),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::EdgeGroups;

    #[test]
    fn groups_name_every_half_edge_once_under_its_ends() {
        // A strip of two triangles with a third one on their common edge.
        let triangles = [[0, 1, 2], [2, 1, 3], [1, 2, 4]];
        let groups = EdgeGroups::new(5, &triangles);
        let found: Vec<(u32, u32, Vec<u32>)> = groups
            .iter()
            .map(|edge| (edge.low, edge.high, edge.half_edges().collect()))
            .collect();
        assert_eq!(
            found,
            [
                (0, 1, vec![0]),
                (0, 2, vec![2]),
                (1, 2, vec![1, 3, 6]),
                (1, 3, vec![4]),
                (1, 4, vec![8]),
                (2, 3, vec![5]),
                (2, 4, vec![7]),
            ]
        );
    }
}
