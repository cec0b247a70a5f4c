//! The test of Mann and Whitney: whether samples of one set tend to be larger than those of
//! another.

use std::f64::consts::SQRT_2;

/// Maximum number of samples of both sets together for the exact probability. Up to it every number
/// of arrangements, at most 50 choose 25, is an integer that `f64` represents.
pub(super) const MOST_FOR_EXACT: usize = 50;

/// The outcome of a Mann-Whitney test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MannWhitney {
    /// Number of pairs (x, y), x from the first set and y from the second, with x > y. A tie counts
    /// one half.
    pub u: f64,
    /// Two-sided p-value: the probability of a `u` at least as far from its mean, if both sets have
    /// the same distribution.
    pub p: f64,
}

/// The two-sided test of Mann and Whitney (1947): whether samples of one set tend to be larger than
/// those of the other. `None` if a set is empty or has a NaN.
///
/// The p-value is exact for up to fifty samples without ties. Otherwise it is that of the normal
/// distribution, corrected for ties (Lehmann 1975, section 1.4) and for continuity. O(n³ log n) for
/// the exact p-value, with n ≤ 50; otherwise O(n log n).
///
/// `statrs` 0.19 is not used. Its exact test takes the wrong tail unless the first set is the
/// larger one, and enumerates all arrangements, 10^11 for 8 and 100 samples.
pub fn mann_whitney(first: &[f64], second: &[f64]) -> Option<MannWhitney> {
    let (m, n) = (first.len(), second.len());
    if m == 0 || n == 0 {
        return None;
    }
    let mut all: Vec<(f64, bool)> = Vec::with_capacity(m + n);
    all.extend(first.iter().map(|&x| (x, true)));
    all.extend(second.iter().map(|&x| (x, false)));
    if all.iter().any(|(x, _)| x.is_nan()) {
        return None;
    }
    all.sort_unstable_by(|(x, _), (y, _)| x.total_cmp(y));

    // `twice_ranks` is twice the sum of the ranks of the first set, since ties have half-integer
    // ranks. `ties` is the tie term, the sum of t³ - t over the groups of t equal samples.
    let (mut twice_ranks, mut ties, mut start) = (0, 0.0, 0);
    // `chunk_by` compares with ==, so -0 and 0 are a tie.
    for tie in all.chunk_by(|(x, _), (y, _)| x == y) {
        let twice_rank = 2 * start + tie.len() + 1;
        twice_ranks += twice_rank * tie.iter().filter(|(_, is_first)| *is_first).count();
        let t = tie.len() as f64;
        ties += t.powi(3) - t;
        start += tie.len();
    }
    let twice_u = twice_ranks - m * (m + 1);
    let p = if ties == 0.0 && m + n <= MOST_FOR_EXACT {
        exact(m, n, twice_u / 2)
    } else {
        normal(m as f64, n as f64, twice_u as f64 / 2.0, ties)
    };
    Some(MannWhitney {
        u: twice_u as f64 / 2.0,
        p,
    })
}

/// The exact p-value, from the counts of all arrangements of `m` and `n` samples.
fn exact(m: usize, n: usize, u: usize) -> f64 {
    let counts = arrangements(m, n);
    let total: f64 = counts.iter().sum();
    let tail: f64 = counts[..=u.min(m * n - u)].iter().sum();
    (2.0 * tail / total).min(1.0)
}

/// The number of arrangements of `m` and `n` distinct samples for each value of U from 0 to `m n`:
/// the coefficients of the Gaussian binomial, the product of (1 - q^(n+i)) / (1 - q^i) for i from 1
/// to m. All intermediate values are integers and at most the largest binomial.
pub(super) fn arrangements(m: usize, n: usize) -> Vec<f64> {
    let mut counts = vec![0.0; m * n + 1];
    counts[0] = 1.0;
    for i in 1..=m {
        for u in (n + i..counts.len()).rev() {
            counts[u] -= counts[u - n - i];
        }
        for u in i..counts.len() {
            counts[u] += counts[u - i];
        }
    }
    counts
}

/// The p-value by the normal approximation.
fn normal(m: f64, n: f64, u: f64, ties: f64) -> f64 {
    let all = m + n;
    let variance = m * n / 12.0 * (all + 1.0 - ties / (all * (all - 1.0)));
    if variance <= 0.0 {
        return 1.0; // All samples are equal.
    }
    let distance = ((u - m * n / 2.0).abs() - 0.5).max(0.0);
    libm::erfc(distance / (variance.sqrt() * SQRT_2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, published: f64) {
        assert!((found - published).abs() < 1e-12, "{found} {published}");
    }

    /// The example in the documentation of `scipy.stats.mannwhitneyu`, and the same with the sets
    /// exchanged.
    #[test]
    fn the_example_of_scipy() {
        let males = [19.0, 22.0, 16.0, 29.0, 24.0];
        let females = [20.0, 11.0, 17.0, 12.0];
        let test = mann_whitney(&males, &females).unwrap();
        assert_eq!(test.u, 17.0);
        close(test.p, 0.111_111_111_111_111_1);
        let test = mann_whitney(&females, &males).unwrap();
        assert_eq!(test.u, 3.0);
        close(test.p, 0.111_111_111_111_111_1);
        // The same documentation gives this for the normal approximation.
        close(normal(5.0, 4.0, 17.0, 0.0), 0.111_346_886_533_140_41);
    }

    /// Critical values of the two-sided test at 5 %, from textbook tables: the largest U whose
    /// p-value is at most 0.05.
    #[test]
    fn the_critical_values_of_the_tables() {
        let table = [
            (4, 4, 0),
            (5, 5, 2),
            (5, 8, 6),
            (6, 6, 5),
            (7, 7, 8),
            (8, 8, 13),
            (10, 10, 23),
            (12, 15, 49),
            (20, 20, 127),
        ];
        for (m, n, critical) in table {
            assert!(exact(m, n, critical) <= 0.05, "{m} {n}");
            assert!(exact(m, n, critical + 1) > 0.05, "{m} {n}");
            assert_eq!(exact(m, n, critical), exact(n, m, m * n - critical));
        }
    }

    #[test]
    fn sets_apart_are_as_unlikely_as_one_arrangement_in_all() {
        let low: Vec<f64> = (0..5).map(f64::from).collect();
        let high: Vec<f64> = (10..15).map(f64::from).collect();
        for (first, second, u) in [(&low, &high, 0.0), (&high, &low, 25.0)] {
            let test = mann_whitney(first, second).unwrap();
            assert_eq!(test.u, u);
            close(test.p, 2.0 / 252.0);
        }
    }

    #[test]
    fn the_counts_are_those_of_all_arrangements() {
        // Enumerates all choices of 3 of 7 ranks.
        let mut counted = vec![0.0; 13];
        for a in 1..=7_usize {
            for b in a + 1..=7 {
                for c in b + 1..=7 {
                    counted[a + b + c - 6] += 1.0;
                }
            }
        }
        assert_eq!(arrangements(3, 4), counted);
        assert_eq!(arrangements(4, 3), counted);
        let largest = arrangements(25, 25);
        assert_eq!(largest.iter().sum::<f64>(), 126_410_606_437_752.0);
    }

    #[test]
    fn ties_and_many_samples_go_by_the_normal_distribution() {
        assert_eq!(mann_whitney(&[1.0; 6], &[1.0; 6]).unwrap().p, 1.0);
        // Ranks 1.5, 1.5, 3.5, 3.5, 5, 6; U = 0.5; variance 0.75 (7 - 12/30) = 4.95.
        let test = mann_whitney(&[1.0, 1.0, 2.0], &[2.0, 3.0, 4.0]).unwrap();
        assert_eq!(test.u, 0.5);
        close(test.p, libm::erfc(3.5 / (2.0 * 4.95_f64).sqrt()));
        // At the limit of the exact test the approximation is close to the exact value.
        for u in [180, 220, 250, 312] {
            let (exact, normal) = (exact(25, 25, u), normal(25.0, 25.0, u as f64, 0.0));
            assert!((exact - normal).abs() < 0.003, "{u}: {exact} {normal}");
        }
    }

    #[test]
    fn without_samples_there_is_no_test() {
        assert_eq!(mann_whitney(&[], &[1.0]), None);
        assert_eq!(mann_whitney(&[1.0], &[]), None);
        assert_eq!(mann_whitney(&[1.0], &[f64::NAN]), None);
    }
}
