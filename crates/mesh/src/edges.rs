//! Half-edges sorted into undirected edges, in linear time.

/// The half-edges of a list of triangles, grouped by the pair of vertices they join.
///
/// Half-edge `3 * t + k` runs from corner `k` of triangle `t` to the next corner. A group has one
/// member at a boundary, two inside a surface, more where the surface is not a manifold.
pub(crate) struct EdgeGroups {
    /// `(larger vertex, half-edge)`, bucketed by the smaller vertex and sorted within a bucket.
    entries: Vec<(u32, u32)>,
    /// Where the bucket of each smaller vertex starts in `entries`.
    starts: Vec<u32>,
}

impl EdgeGroups {
    /// Sorts the half-edges of `triangles`; every vertex must be less than `vertex_count`.
    ///
    /// Takes O(n + Σ k log k) time, k being the number of edges at a vertex.
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

    /// Each edge once: its smaller vertex, its larger vertex, and its half-edges in rising order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (u32, u32, impl Iterator<Item = u32>)> {
        self.starts.windows(2).enumerate().flat_map(|(low, range)| {
            self.entries[range[0] as usize..range[1] as usize]
                .chunk_by(|x, y| x.0 == y.0)
                .map(move |group| (low as u32, group[0].0, group.iter().map(|e| e.1)))
        })
    }
}
