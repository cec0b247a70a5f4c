//! Label correcting: a double-ended queue with small labels near its front.

use std::collections::VecDeque;

use geobench_window::queue::{Discipline, Event};
use geobench_window::{Counter, Probe};

/// Options of [`LabelCorrecting`]. Distances do not depend on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelCorrectingOptions {
    /// β, which sets the threshold between the least waiting label (0) and the mean of the waiting
    /// labels (1). Small values approach a priority queue, and scan the waiting events more often.
    /// With an infinite value there is no threshold. Negative values and NaN count as 0.
    pub beta: f64,
}

impl Default for LabelCorrectingOptions {
    fn default() -> Self {
        Self { beta: 0.5 }
    }
}

/// The label correcting queue SLF-LLL-THR of Bertsekas (1993), with which Xu et al. (2015, section
/// 7.4) compare their buckets.
///
/// * *Small label first*: an event goes to the front of a double-ended queue if its label is less
///   than that of the first event, else to the back.
/// * *Large label last*: before an event is taken, events at the front with labels above the
///   queue's mean are moved to the back, at most once around the queue. Without this limit the
///   rotation would never end if rounding puts the mean of equal labels below them.
/// * *Threshold*: events with labels above a threshold wait apart. When the queue is empty, the
///   threshold becomes m + β (a - m), where m is the least and a the mean of the waiting labels.
///   The events that are not above it move into the queue.
///
/// The sources give neither β nor the rule for the threshold. This rule is ours.
///
/// # Cost
///
/// O(1) for each event, without the rotations and scans. These have no useful general bound and
/// cost little in practice. An event takes 16 bytes.
///
/// ```
/// use geobench_fwp::{LabelCorrecting, LabelCorrectingOptions};
/// use geobench_ich::Splitting;
/// use geobench_mesh::Mesh;
/// use geobench_window::continuous::Continuous;
/// use geobench_window::{Solver, VertexFilter};
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let policy = Splitting::new(&mesh, VertexFilter::On);
/// let order = LabelCorrecting::new(LabelCorrectingOptions { beta: 1.0 });
/// let mut solver = Continuous::new(&mesh, policy, order);
/// assert_eq!(solver.distances_from(5)?[5], 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct LabelCorrecting {
    beta: f64,
    queue: VecDeque<(f64, Event)>,
    /// Sum of the labels in the queue, up to rounding.
    sum: f64,
    threshold: f64,
    apart: Vec<(f64, Event)>,
}

/// Below all labels: events that are pushed before the first one is taken wait apart.
const UNSET: f64 = f64::NEG_INFINITY;

impl LabelCorrecting {
    /// An empty queue.
    pub fn new(options: LabelCorrectingOptions) -> Self {
        Self {
            beta: options.beta.max(0.0),
            queue: VecDeque::new(),
            sum: 0.0,
            threshold: UNSET,
            apart: Vec::new(),
        }
    }

    /// Applies "small label first".
    #[inline]
    fn put(&mut self, label: f64, event: Event) {
        match self.queue.front() {
            Some(&(first, _)) if label < first => self.queue.push_front((label, event)),
            _ => self.queue.push_back((label, event)),
        }
        self.sum += label;
    }

    /// Raises the threshold and moves the events below it into the queue; returns whether there are
    /// any.
    fn refill<P: Probe>(&mut self, probe: &mut P) -> bool {
        if self.apart.is_empty() {
            return false;
        }
        let labels = self.apart.iter().map(|&(label, _)| label);
        let (least, sum) = labels.fold((f64::INFINITY, 0.0), |(least, sum), label| {
            (label.min(least), sum + label)
        });
        let excess = sum / self.apart.len() as f64 - least;
        // Rounding may put the mean below the least label, and ∞ · 0 is NaN. Both mean that the
        // labels are equal.
        self.threshold = f64::max(least + self.beta * excess, least);
        self.sum = 0.0;
        let mut apart = std::mem::take(&mut self.apart);
        apart.retain(|&(label, event)| {
            let stays = label > self.threshold;
            if !stays {
                self.put(label, event);
            }
            stays
        });
        self.apart = apart;
        probe.add(Counter::Iterations, 1);
        true
    }

    /// Applies "large label last".
    #[inline]
    fn rotate(&mut self) {
        let mean = self.sum / self.queue.len() as f64;
        for _ in 1..self.queue.len() {
            match self.queue.front() {
                Some(&(first, _)) if first > mean => self.queue.rotate_left(1),
                _ => break,
            }
        }
    }
}

impl Discipline for LabelCorrecting {
    const COUNTERS: &'static [Counter] = &[
        Counter::QueuePushes,
        Counter::QueuePeak,
        Counter::Iterations,
    ];

    #[inline]
    fn push<P: Probe>(&mut self, label: f64, event: Event, probe: &mut P) {
        if label > self.threshold {
            self.apart.push((label, event));
        } else {
            self.put(label, event);
        }
        probe.add(Counter::QueuePushes, 1);
        probe.raise(
            Counter::QueuePeak,
            (self.queue.len() + self.apart.len()) as u64,
        );
    }

    #[inline]
    fn pop<P: Probe>(&mut self, probe: &mut P) -> Option<(f64, Event)> {
        if self.queue.is_empty() && !self.refill(probe) {
            return None;
        }
        self.rotate();
        let (label, event) = self.queue.pop_front()?;
        self.sum -= label;
        Some((label, event))
    }

    #[inline]
    fn upcoming(&self, skipped: usize) -> Option<Event> {
        self.queue.get(skipped).map(|&(_, event)| event)
    }

    fn events(&self) -> impl Iterator<Item = (f64, Event)> {
        self.queue.iter().chain(&self.apart).copied()
    }

    fn clear(&mut self) {
        self.queue.clear();
        self.apart.clear();
        self.sum = 0.0;
        self.threshold = UNSET;
    }
}

#[cfg(test)]
mod tests {
    use geobench_window::Count;
    use proptest::prelude::*;

    use super::*;
    use crate::test_support::{check_queue, id_of, steps, window};

    fn filled(beta: f64, labels: &[f64]) -> LabelCorrecting {
        let mut queue = LabelCorrecting::new(LabelCorrectingOptions { beta });
        for (id, &label) in (0u32..).zip(labels) {
            queue.push(label, window(id), &mut ());
        }
        queue
    }

    fn order(mut queue: LabelCorrecting) -> Vec<u32> {
        std::iter::from_fn(|| queue.pop(&mut ()))
            .map(|(_, event)| id_of(event))
            .collect()
    }

    proptest! {
        #[test]
        fn every_event_comes_once_at_any_threshold(
            beta in prop_oneof![0.0..3.0f64, Just(f64::INFINITY), Just(f64::NAN), Just(-1.0)],
            steps in steps(),
        ) {
            let options = LabelCorrectingOptions { beta };
            check_queue(&mut LabelCorrecting::new(options), &steps)?;
        }
    }

    #[test]
    fn small_labels_go_in_front() {
        // 5 enters the queue, then 7 behind it, 3 in front, and 4 at the back. When 7 comes to the
        // front it is above the mean of 7 and 4.
        let queue = filled(f64::INFINITY, &[5.0, 7.0, 3.0, 4.0]);
        assert_eq!(order(queue), [2, 0, 3, 1]);
    }

    #[test]
    fn large_labels_go_last() {
        let mut queue = filled(f64::INFINITY, &[2.0, 9.0, 8.0, 1.0, 3.0]);
        assert_eq!(queue.pop(&mut ()), Some((1.0, window(3))));
        assert_eq!(queue.pop(&mut ()), Some((2.0, window(0))));
        // 9 and 8 are above the mean of 9, 8 and 3.
        assert_eq!(queue.pop(&mut ()), Some((3.0, window(4))));
        assert_eq!(queue.pop(&mut ()), Some((8.0, window(2))));
    }

    /// Every label is above the mean if that is off by rounding, or by 1e300 that came and went. A
    /// public program then never stops rotating.
    #[test]
    fn rotation_ends_when_all_labels_are_above_the_mean() {
        let mut queue = filled(f64::INFINITY, &[1.0, 1.0, 1e300, 1.0]);
        for _ in 0..4 {
            assert!(queue.pop(&mut ()).is_some());
            queue.push(1.0, window(9), &mut ());
            queue.sum = -1.0;
        }
        assert_eq!(queue.queue.len(), 4);
    }

    #[test]
    fn labels_above_the_threshold_wait() {
        let mut queue = filled(0.5, &[0.0, 1.0, 2.0, 9.0]);
        let mut count = Count::default();
        // The mean is 3.
        queue.pop(&mut count);
        assert_eq!(queue.threshold, 1.5);
        queue.push(1.6, window(4), &mut count);
        assert_eq!(queue.apart.len(), 3);
        queue.push(1.4, window(5), &mut count);
        assert_eq!(queue.queue.len(), 2);
        assert_eq!(order(queue), [1, 5, 4, 2, 3]);
        let counters = count.counters(LabelCorrecting::COUNTERS);
        assert_eq!(counters.get(Counter::Iterations), Some(1));
        assert_eq!(counters.get(Counter::QueuePeak), Some(5));
    }
}
