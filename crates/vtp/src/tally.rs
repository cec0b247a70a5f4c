//! Counts of the comparisons of neighbours, for runs that count.

use geobench_window::{Counter, Probe};

/// Is told what rules 2 and 3 compare and what they prune. Lists are seen as they are before each
/// round of comparisons.
pub(crate) trait PruningTally {
    /// Whether anything is counted.
    const COUNTS: bool;

    /// A list is about to be compared: the first `seam` of its `len` windows came through the one
    /// edge of the triangle behind it, the others through the other edge.
    fn start(&mut self, seam: usize, len: usize) {
        let _ = (seam, len);
    }

    /// Two windows are compared, without regard to the case.
    fn check(&mut self) {}

    /// Windows from number `first` on are compared with their right neighbours, those with a bit in
    /// `pairs`. `cases` has the pairs of cases 1 or 4, 2 or 5, and 3 or 6, and `losers` those in
    /// which the left window, and the right one, loses rays.
    fn compare(&mut self, first: usize, pairs: u8, cases: [u8; 3], losers: [u8; 2]) {
        let _ = (first, pairs, cases, losers);
    }

    /// Of the windows from number `first` on, those in `alive` stay in the list.
    fn keep(&mut self, first: usize, alive: u8) {
        let _ = (first, alive);
    }

    /// A round of comparisons has ended.
    fn turn(&mut self) {}

    /// This many windows are about to cross the triangle.
    fn cross(&mut self, windows: usize) {
        let _ = windows;
    }
}

/// Counts nothing, at no cost.
impl PruningTally for () {
    const COUNTS: bool = false;
}

/// The counts of one list.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairTally {
    windows: usize,
    checks: u64,
    /// Windows that lost rays, by the cases 1 to 6.
    pruned: [u64; 6],
    /// Windows that cross the triangle.
    pub(crate) crossing: usize,
    /// The first window from the other edge.
    seam: usize,
    /// Windows before the seam that have been kept in this round.
    kept: usize,
}

impl PruningTally for PairTally {
    const COUNTS: bool = true;

    fn start(&mut self, seam: usize, len: usize) {
        (self.seam, self.windows) = (seam, len);
    }

    fn check(&mut self) {
        self.checks += 1;
    }

    fn compare(&mut self, first: usize, pairs: u8, cases: [u8; 3], losers: [u8; 2]) {
        self.checks += u64::from(pairs.count_ones());
        // At most one pair has windows from both edges.
        let across = self.seam.checked_sub(first + 1).filter(|lane| *lane < 8);
        let across = across.map_or(0, |lane| 1_u8 << lane);
        for (case, of_case) in cases.into_iter().enumerate() {
            for loser in losers {
                let lost = of_case & loser & pairs;
                self.pruned[case] += u64::from((lost & !across).count_ones());
                self.pruned[case + 3] += u64::from((lost & across).count_ones());
            }
        }
    }

    fn keep(&mut self, first: usize, alive: u8) {
        let before = self.seam.saturating_sub(first).min(8);
        let before = alive & ((1_u16 << before) - 1) as u8;
        self.kept += before.count_ones() as usize;
    }

    fn turn(&mut self) {
        (self.seam, self.kept) = (self.kept, 0);
    }

    fn cross(&mut self, windows: usize) {
        self.crossing = windows;
    }
}

impl PairTally {
    /// The counters that comparisons of neighbours have.
    pub(crate) const OF_NEIGHBOURS: &'static [Counter] = &[
        Counter::ComparedWindows,
        Counter::PairChecks,
        Counter::Case1,
        Counter::Case2,
        Counter::Case3,
        Counter::Case4,
        Counter::Case5,
        Counter::Case6,
    ];

    /// The counters that other comparisons have.
    pub(crate) const OF_OTHERS: &'static [Counter] =
        &[Counter::ComparedWindows, Counter::PairChecks];

    /// Adds the counts to those of a run.
    pub(crate) fn add_to(&self, probe: &mut impl Probe) {
        probe.add(Counter::ComparedWindows, self.windows as u64);
        probe.add(Counter::PairChecks, self.checks);
        for (&counter, &pruned) in Self::OF_NEIGHBOURS[2..].iter().zip(&self.pruned) {
            probe.add(counter, pruned);
        }
    }
}
