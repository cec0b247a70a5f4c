//! The nearest sources of each vertex, from one run per source.

use geobench_mesh::Tolerance;
use geobench_voronoi::NO_SOURCE;

/// The nearest sources of every vertex, as a bit set per vertex. Ties count as nearest.
#[derive(Debug)]
pub(super) struct NearestSources {
    /// Words of 64 bits per vertex.
    words: usize,
    bits: Vec<u64>,
}

impl NearestSources {
    /// Empty sets for these numbers of vertices and sources.
    pub(super) fn new(vertices: usize, sources: usize) -> Self {
        let words = sources.div_ceil(64);
        Self {
            words,
            bits: vec![0; vertices * words],
        }
    }

    /// Adds a source to the set of each vertex that it reaches, where its distance exceeds the
    /// least one by at most what `rule` allows. `distances` are those from this source, for all
    /// vertices. `least` has vertices with their distances from the nearest source.
    pub(super) fn add(
        &mut self,
        source: usize,
        distances: &[f64],
        least: &[(usize, f64)],
        rule: &Tolerance,
    ) {
        for &(v, least) in least {
            let is_near = distances
                .get(v)
                .is_some_and(|&d| d.is_finite() && d <= least + rule.allowed(v, least));
            if is_near {
                self.bits[v * self.words + source / 64] |= 1 << (source % 64);
            }
        }
    }

    /// The vertices whose label is not one of their nearest sources. The right label of a vertex
    /// that no source reaches is [`NO_SOURCE`].
    pub(super) fn wrong<'s>(&'s self, labels: &'s [u32]) -> impl Iterator<Item = usize> + 's {
        let near = self.bits.chunks_exact(self.words);
        let wrong = near.zip(labels).map(|(near, &label)| {
            if label == NO_SOURCE {
                return near.iter().any(|&word| word != 0);
            }
            let word = near.get(label as usize / 64);
            word.is_none_or(|word| word & (1 << (label % 64)) == 0)
        });
        wrong
            .enumerate()
            .filter(|(_, wrong)| *wrong)
            .map(|(v, _)| v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_is_that_of_any_nearest_source() {
        let mut nearest = NearestSources::new(3, 70);
        let least = [(0, 0.0), (1, 2.0), (2, f64::INFINITY)];
        let rule = Tolerance::relative(1e-9);
        nearest.add(3, &[0.0, 2.0, f64::INFINITY], &least, &rule);
        nearest.add(69, &[4.0, 2.0 + 1e-9, f64::INFINITY], &least, &rule);
        let wrong = |labels: [u32; 3]| nearest.wrong(&labels).collect::<Vec<_>>();
        assert!(wrong([3, 3, NO_SOURCE]).is_empty());
        assert!(wrong([3, 69, NO_SOURCE]).is_empty());
        assert_eq!(wrong([69, 0, 3]), [0, 1, 2]);
        assert_eq!(wrong([NO_SOURCE, 200, NO_SOURCE]), [0, 1]);
    }
}
