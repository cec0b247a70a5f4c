//! Who gets which part of the wavefront.

use std::ops::Range;

/// Vertices for each thread below which a round is not worth dividing anew.
const FEWEST: usize = 4;

/// How much the last round counts when the load of the next one is estimated.
const LATEST: f64 = 0.5;

/// By what factor the load of a vertex may differ from the mean: more would be the system's doing, which had
/// something else to do.
const MOST: f64 = 4.0;

/// Cuts the vertices of a round into ranges of their numbers, one for each thread, of about the same load.
///
/// Numbers follow a space-filling curve, so that a range is a part of the surface in one piece or a few, and
/// the parts of one round and the next are nearly the same. What a vertex brings with it is known after its
/// turn only; so a range counts for its number of vertices times what its thread took for each in the last
/// rounds. Every thread makes the same cuts from the same figures. That these are times, which
/// vary, does not matter: what comes of a round is the same whoever does what.
#[derive(Clone, Debug)]
pub(super) struct Split {
    /// Where each range but the first begins.
    cuts: Vec<u32>,
    /// Estimated load of a vertex in each range.
    densities: Vec<f64>,
    /// Vertices in each range.
    counts: Vec<usize>,
}

impl Split {
    pub(super) fn new(vertices: usize, threads: usize) -> Self {
        let cut = |t: usize| (vertices as u64 * t as u64 / threads as u64) as u32;
        Self {
            cuts: (1..threads).map(cut).collect(),
            densities: vec![1.0; threads],
            counts: vec![0; threads],
        }
    }

    /// Learns the loads that came of the last round.
    pub(super) fn learn(&mut self, loads: impl Iterator<Item = u64>) {
        let (mut total, mut vertices) = (0.0, 0);
        let mut latest = Vec::with_capacity(self.counts.len());
        for (load, &count) in loads.zip(&self.counts) {
            latest.push(load as f64);
            total += load as f64;
            vertices += count;
        }
        if vertices == 0 || total == 0.0 {
            return;
        }
        let mean = total / vertices as f64;
        for ((density, &count), load) in self.densities.iter_mut().zip(&self.counts).zip(latest) {
            if count > 0 {
                // Relative to the mean, since rounds differ.
                let latest = (load / count as f64 / mean).clamp(1.0 / MOST, MOST);
                *density += LATEST * (latest - *density);
            }
        }
    }

    /// Cuts anew for the vertices of a round, of which there is at least one, in any order; returns whether
    /// there are enough of them.
    pub(super) fn cut(&mut self, vertices: &mut [u32]) -> bool {
        let threads = self.densities.len();
        self.counts.fill(0);
        if vertices.len() < FEWEST * threads {
            return false;
        }
        for v in &*vertices {
            let range = self.cuts.partition_point(|cut| cut <= v);
            self.counts[range] += 1;
        }
        let ranks = self.ranks();
        let (mut rest, mut end) = (vertices, self.counts.iter().sum::<usize>());
        for (t, rank) in ranks.into_iter().enumerate().rev() {
            let rank = rank.min(end - 1);
            let (before, cut, _) = rest.select_nth_unstable(rank);
            self.cuts[t] = *cut;
            self.counts[t + 1] = end - rank;
            (rest, end) = (before, rank);
            if end == 0 {
                self.cuts[..t].fill(*cut);
                self.counts[1..=t].fill(0);
                break;
            }
        }
        self.counts[0] = end;
        true
    }

    /// How many vertices shall come before each cut.
    #[allow(clippy::cast_sign_loss)] // No load is negative.
    fn ranks(&self) -> Vec<usize> {
        let loads = || self.counts.iter().zip(&self.densities);
        let load: f64 = loads().map(|(&n, density)| n as f64 * density).sum();
        let threads = self.densities.len();
        let rank = |t: usize| {
            let mut wanted = load * t as f64 / threads as f64;
            let mut rank = 0;
            for (&n, density) in loads() {
                let here = n as f64 * density;
                if here >= wanted {
                    return rank + (wanted / density).round().clamp(0.0, n as f64) as usize;
                }
                wanted -= here;
                rank += n;
            }
            rank
        };
        (1..threads).map(rank).collect()
    }

    /// The numbers of the vertices that `thread` gets.
    pub(super) fn range(&self, thread: usize) -> Range<u32> {
        let start = if thread == 0 {
            0
        } else {
            self.cuts[thread - 1]
        };
        start..self.cuts.get(thread).copied().unwrap_or(u32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(split: &Split, vertices: &[u32], threads: usize) -> Vec<usize> {
        let mut counts = Vec::new();
        for thread in 0..threads {
            let range = split.range(thread);
            counts.push(vertices.iter().filter(|v| range.contains(v)).count());
        }
        counts
    }

    #[test]
    fn every_vertex_is_in_one_range_and_ranges_are_of_one_size() {
        for threads in [1, 2, 3, 7] {
            let mut split = Split::new(1000, threads);
            for first in [0, 400, 900] {
                let mut vertices: Vec<u32> = (first..first + 70).rev().collect();
                assert!(split.cut(&mut vertices));
                let counts = counts(&split, &vertices, threads);
                assert_eq!(counts.iter().sum::<usize>(), 70, "{counts:?}");
                assert!(
                    counts.iter().all(|n| n.abs_diff(70 / threads) <= 1),
                    "{counts:?}"
                );
            }
        }
    }

    #[test]
    fn whoever_takes_longer_gets_less() {
        let mut split = Split::new(1000, 2);
        let mut vertices: Vec<u32> = (450..550).collect();
        let mut last = 50;
        for _ in 0..3 {
            assert!(split.cut(&mut vertices));
            let counts = counts(&split, &vertices, 2);
            assert!(counts[0] <= last, "{counts:?}");
            last = counts[0];
            split.learn([3 * counts[0] as u64, counts[1] as u64].into_iter());
        }
        assert!((20..40).contains(&last), "{last}");
    }

    #[test]
    fn few_vertices_stay_where_they_are() {
        let mut split = Split::new(1000, 2);
        assert!(!split.cut(&mut [1, 2, 3]));
        assert_eq!((split.range(0), split.range(1)), (0..500, 500..u32::MAX));
        split.learn([9, 1].into_iter());
        assert_eq!(split.densities, [1.0; 2]);
    }
}
