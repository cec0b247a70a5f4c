//! The cells along a segment.

use geobench_window::Window;
use geobench_window::trimming::{Overlap, Owner};

use super::sites::ROUNDING;

/// The cells along a segment: the first one, and where they change. Positions are fractions of the
/// segment.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct SegmentCells {
    /// The cell at the start.
    pub(crate) first: u32,
    /// In ascending order. Each names the cell after it.
    pub(crate) changes: Vec<Change>,
}

/// Where one cell ends and another begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Change {
    /// The position on the segment, from 0 to 1.
    pub(crate) at: f64,
    /// The cell after it.
    pub(crate) next: u32,
}

/// Width of a cell on a segment, as a fraction of the segment, below which the cell is left out.
/// Rounding leaves gaps of such widths between two other cells.
const NARROW: f64 = 1e-12;

impl SegmentCells {
    /// A segment in cell `first` alone.
    pub(crate) const fn of(first: u32) -> Self {
        Self {
            first,
            changes: Vec::new(),
        }
    }

    /// The cell at the end.
    pub(crate) fn last(&self) -> u32 {
        self.changes.last().map_or(self.first, |change| change.next)
    }

    /// The cells in order.
    pub(crate) fn cells(&self) -> impl Iterator<Item = u32> {
        std::iter::once(self.first).chain(self.changes.iter().map(|change| change.next))
    }

    /// The cells along a segment of length `l`: at each point, the source of the shortest window.
    /// The windows of `list` are disjoint and in ascending order; those of `others` may overlap.
    /// `first` and `last` are the cells at the ends of the segment, which are decided already.
    pub(crate) fn envelope(
        mut list: Vec<(Window, u32)>,
        others: impl Iterator<Item = (Window, u32)>,
        l: f64,
        [first, last]: [u32; 2],
    ) -> Self {
        let mut met = Vec::new();
        let mut overlap = Overlap::default();
        for (new, source) in others {
            let from = list.partition_point(|(w, _)| w.b1 <= new.b0);
            met.clear();
            let behind = list[from..].iter().map(|&(w, _)| w);
            met.extend(behind.take_while(|w| w.b0 < new.b1));
            overlap.share_out(&met, &new, l);
            let parts: Vec<(Window, u32)> = overlap
                .segments()
                .iter()
                .map(|segment| {
                    let (w, source) = match segment.owner {
                        Owner::New => (new, source),
                        Owner::Old(k) => list[from + k],
                    };
                    let (b0, b1) = (segment.start, segment.end);
                    (Window { b0, b1, ..w }, source)
                })
                .collect();
            list.splice(from..from + met.len(), parts);
        }
        let mut runs: Vec<(f64, f64, u32)> = Vec::new();
        for (w, source) in list {
            let (start, end) = (w.b0 / l, w.b1 / l);
            match runs.last_mut() {
                Some(run) if run.2 == source => run.1 = end,
                _ => runs.push((start, end, source)),
            }
        }
        runs.retain(|run| run.1 - run.0 > NARROW);
        let mut line = Self::of(first);
        let mut end = 0.0;
        for (start, run_end, source) in runs {
            if source != line.last() {
                // The gap between two runs is due to rounding. The change is in its middle.
                let at = if end == 0.0 { 0.0 } else { 0.5 * (start + end) };
                line.changes.push(Change { at, next: source });
            }
            end = run_end;
        }
        if line.last() != last {
            line.changes.push(Change {
                at: 1.0,
                next: last,
            });
        }
        line
    }

    /// The line corrected by distances, in a face whose longest edge is `size`. `nearest` gives the
    /// length of the shortest path to a position, and its source: of all paths, or of those from
    /// one source.
    ///
    /// Trimming drops slivers. Longer windows that are wide enough to stay can then appear to be
    /// the shortest there. Paths around the ends of the neighbouring intervals, which `nearest`
    /// includes, are shorter.
    pub(crate) fn settled(
        self,
        size: f64,
        nearest: impl Fn(f64, Option<u32>) -> (f64, u32),
    ) -> Self {
        let settler = DistanceCheck { size, nearest };
        let mut line = self;
        if !settler.agrees(&line) {
            let samples = settler.samples(&line);
            line = Self::of(line.first);
            for pair in samples.windows(2) {
                settler.part(pair[0], pair[1], &mut line.changes);
            }
        }
        settler.simplify(&mut line);
        line
    }

    /// The same line from its other end.
    pub(crate) fn reversed(&self) -> Self {
        let mut before: Vec<u32> = self.cells().collect();
        let first = before.pop().unwrap_or(self.first);
        let places = self.changes.iter().zip(before);
        let changes = places.map(|(change, next)| Change {
            at: 1.0 - change.at,
            next,
        });
        let mut changes: Vec<Change> = changes.collect();
        changes.reverse();
        Self { first, changes }
    }
}

/// See [`SegmentCells::settled`].
struct DistanceCheck<F> {
    size: f64,
    nearest: F,
}

/// A position on a line, from 0 to 1, and its cell.
type Sample = (f64, u32);

/// Greatest length of a part of a line that is not divided further.
const SHORT: f64 = 1e-13;

impl<F: Fn(f64, Option<u32>) -> (f64, u32)> DistanceCheck<F> {
    /// Whether no other source is nearer than `source` at `t`, up to rounding.
    fn is_nearest(&self, t: f64, source: u32) -> bool {
        let (least, _) = (self.nearest)(t, None);
        let (own, _) = (self.nearest)(t, Some(source));
        own <= least + ROUNDING * (least + self.size)
    }

    /// Whether distances confirm the line: both cells are the nearest at each change, and each cell
    /// is the nearest in the middle of its run.
    fn agrees(&self, line: &SegmentCells) -> bool {
        let mut before = line.first;
        let mut start = 0.0;
        for change in &line.changes {
            let both = [before, change.next];
            if both
                .iter()
                .any(|&source| !self.is_nearest(change.at, source))
                || !self.is_nearest(0.5 * (start + change.at), before)
            {
                return false;
            }
            (before, start) = (change.next, change.at);
        }
        line.changes.is_empty() || self.is_nearest(0.5 * (start + 1.0), before)
    }

    /// The ends of a line, with the cells decided there, and the midpoints of its runs, with their
    /// nearest cells.
    fn samples(&self, line: &SegmentCells) -> Vec<Sample> {
        let mut samples = vec![(0.0, line.first)];
        let mut start = 0.0;
        for end in line.changes.iter().map(|change| change.at).chain([1.0]) {
            if end > start {
                let middle = 0.5 * (start + end);
                samples.push((middle, (self.nearest)(middle, None).1));
            }
            start = end;
        }
        samples.push((1.0, line.last()));
        samples
    }

    /// Removes runs that are due to rounding: along them the cell before is as near, and it takes
    /// them over.
    fn simplify(&self, line: &mut SegmentCells) {
        let mut before = line.first;
        let mut i = 0;
        while let [change, behind, ..] = line.changes[i..] {
            let middle = 0.5 * (change.at + behind.at);
            if self.is_nearest(middle, before) && self.is_nearest(behind.at, before) {
                line.changes.remove(i);
                if behind.next == before {
                    line.changes.remove(i);
                }
            } else {
                before = change.next;
                i += 1;
            }
        }
    }

    /// Appends the changes between two samples.
    fn part(&self, from: Sample, to: Sample, changes: &mut Vec<Change>) {
        let ((u, before), (v, next)) = (from, to);
        if before == next {
            return;
        }
        let t = self.tie(from, to);
        let (least, third) = (self.nearest)(t, None);
        let own = [before, next].map(|source| (self.nearest)(t, Some(source)).0);
        let slack = ROUNDING * (least + self.size);
        if own[0].min(own[1]) <= least + slack || v - u <= SHORT {
            changes.push(Change { at: t, next });
        } else {
            self.part(from, (t, third), changes);
            self.part((t, third), to, changes);
        }
    }

    /// A position between two samples at which their cells are equally near, by bisection.
    fn tie(&self, (mut u, before): Sample, (mut v, next): Sample) -> f64 {
        let lead = |t| (self.nearest)(t, Some(before)).0 - (self.nearest)(t, Some(next)).0;
        if lead(u) >= 0.0 {
            return u;
        }
        if lead(v) <= 0.0 {
            return v;
        }
        loop {
            let middle = 0.5 * (u + v);
            if middle <= u || middle >= v {
                return middle;
            }
            if lead(middle) < 0.0 {
                u = middle;
            } else {
                v = middle;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(px: f64) -> Window {
        Window {
            b0: 0.0,
            b1: 2.0,
            px,
            py: -1.0,
            sigma: 0.0,
        }
    }

    #[test]
    fn cells_change_where_their_windows_tie() {
        let windows = [(window(2.0), 7), (window(0.0), 3)];
        let line = SegmentCells::envelope(Vec::new(), windows.into_iter(), 2.0, [3, 7]);
        let change = Change { at: 0.5, next: 7 };
        assert_eq!((line.first, &line.changes[..]), (3, &[change][..]));
        assert_eq!(line.reversed().first, 7);
        assert_eq!(line.reversed().reversed(), line);
    }

    #[test]
    fn cells_at_the_ends_stay() {
        let line = SegmentCells::envelope(vec![(window(0.0), 3)], std::iter::empty(), 2.0, [1, 2]);
        assert_eq!(line.cells().collect::<Vec<_>>(), [1, 3, 2]);
        assert_eq!((line.changes[0].at, line.changes[1].at), (0.0, 1.0));
    }
}
