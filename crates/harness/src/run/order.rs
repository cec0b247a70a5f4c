//! The order of timed runs.

use geobench_mesh::SplitMix64;

use crate::schema::SourceLabel;

/// The order of the algorithms in each round of timed runs.
///
/// A round has one run of every algorithm. The previous run affects the next one through caches,
/// memory and clock frequency. The orders are therefore the rows of a balanced Latin square (E. J.
/// Williams, Experimental designs balanced for the estimation of residual effects of treatments,
/// 1949). Over all rows, every algorithm has every position equally often and follows every other
/// one equally often. Seed, model and source determine the columns and the first row, so a run can
/// be repeated.
#[derive(Clone, Debug)]
pub(crate) struct RunOrder {
    /// The algorithm for each symbol of the square.
    parts: Vec<usize>,
    /// The rows of the square, in order of use.
    rows: Vec<usize>,
}

impl RunOrder {
    /// The order of `algorithms` algorithms on a model from a source.
    pub(crate) fn new(seed: u64, model: &str, source: &SourceLabel, algorithms: usize) -> Self {
        let source = match source {
            SourceLabel::Vertex(vertex) => vertex.to_le_bytes().to_vec(),
            SourceLabel::Other(text) => text.clone().into_bytes(),
        };
        let bytes = model.bytes().chain(source);
        let seed = bytes.fold(seed, |seed, byte| {
            SplitMix64::new(seed ^ u64::from(byte)).next()
        });
        let mut random = SplitMix64::new(seed);
        // For an odd number of algorithms only the square and its mirror image together are
        // balanced.
        let rows = algorithms * (1 + algorithms % 2);
        Self {
            parts: shuffled(algorithms, &mut random),
            rows: shuffled(rows, &mut random),
        }
    }

    /// Position of an algorithm in `round`, from 0.
    pub(super) fn position(&self, round: usize, algorithm: usize) -> Option<usize> {
        let mut order = self.round(round).into_iter();
        order.position(|other| other == algorithm)
    }

    /// Indices of the algorithms in their order in `round`. Rounds are numbered from 0.
    pub(crate) fn round(&self, round: usize) -> Vec<usize> {
        let n = self.parts.len();
        if n == 0 {
            return Vec::new();
        }
        let row = self.rows[round % self.rows.len()];
        let mut order: Vec<usize> = (0..n)
            // The first row is 0, n - 1, 1, n - 2, ...: each difference of neighbours modulo n
            // occurs once.
            .map(|k| if k % 2 == 0 { k / 2 } else { n - k.div_ceil(2) })
            .map(|part| self.parts[(part + row) % n])
            .collect();
        if row >= n {
            order.reverse();
        }
        order
    }
}

/// The numbers below `n`, shuffled (Fisher and Yates).
fn shuffled(n: usize, random: &mut SplitMix64) -> Vec<usize> {
    let mut all: Vec<usize> = (0..n).collect();
    for i in 0..n {
        all.swap(i, i + random.below(n - i));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_and_every_neighbour_is_had_equally_often() {
        for n in 1..=9 {
            let order = RunOrder::new(7, "horse", &3.into(), n);
            let (rounds, each) = (n * (1 + n % 2), 1 + n % 2);
            let mut places = vec![vec![0; n]; n];
            let mut follows = vec![vec![0; n]; n];
            for round in 0..rounds {
                let order = order.round(round);
                for (place, &algorithm) in order.iter().enumerate() {
                    places[algorithm][place] += 1;
                }
                for pair in order.windows(2) {
                    follows[pair[0]][pair[1]] += 1;
                }
            }
            assert!(places.iter().flatten().all(|&count| count == each), "{n}");
            for (a, row) in follows.iter().enumerate() {
                for (b, &count) in row.iter().enumerate() {
                    assert_eq!(count, if a == b { 0 } else { each }, "{n}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn two_algorithms_alternate_in_going_first() {
        let order = RunOrder::new(1, "cow", &0.into(), 2);
        let first: Vec<usize> = (0..6).map(|round| order.round(round)[0]).collect();
        assert_ne!(first[0], first[1]);
        assert_eq!(first[..2], first[2..4]);
        assert_eq!(first[..2], first[4..]);
    }

    #[test]
    fn the_order_follows_from_seed_model_and_source_alone() {
        let all = |order: &RunOrder| (0..12).map(|r| order.round(r)).collect::<Vec<_>>();
        let order = all(&RunOrder::new(1, "cow", &0.into(), 5));
        assert_eq!(order, all(&RunOrder::new(1, "cow", &0.into(), 5)));
        assert_ne!(order, all(&RunOrder::new(2, "cow", &0.into(), 5)));
        assert_ne!(order, all(&RunOrder::new(1, "horse", &0.into(), 5)));
        assert_ne!(order, all(&RunOrder::new(1, "cow", &1.into(), 5)));
        assert!(RunOrder::new(1, "cow", &0.into(), 0).round(3).is_empty());
    }
}
