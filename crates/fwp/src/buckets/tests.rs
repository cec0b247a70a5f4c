//! Tests of the bucket queue without an algorithm.

use std::collections::{BTreeMap, VecDeque};

use geobench_window::{Count, Counter};
use proptest::prelude::*;

use super::*;
use crate::test_support::{check_queue, id_of, square, steps, window};

/// Buckets of width 1.
fn unit_buckets(batch: BatchSize) -> Buckets {
    let mut buckets = Buckets::new(&square(), BucketOptions::default());
    buckets.calendar = Calendar::new(1.0);
    buckets.batch = batch;
    buckets
}

/// How many events of the round are still to be taken.
fn left(buckets: &Buckets) -> usize {
    buckets.linked.len() + buckets.events.len() - buckets.next
}

fn options() -> impl Strategy<Value = BucketOptions> {
    let width = prop_oneof![
        0.01..1000.0f64,
        Just(0.0),
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(1e-300),
        Just(1e300),
    ];
    let batch = prop_oneof![
        (0..100u32).prop_map(|max| BatchSize::Adaptive { max }),
        (0..100u32).prop_map(BatchSize::Fixed),
        Just(BatchSize::Fixed(u32::MAX)),
    ];
    (width, batch).prop_map(|(width, batch)| BucketOptions { width, batch })
}

proptest! {
    #[test]
    fn every_event_comes_once_at_any_width_and_k(options in options(), steps in steps()) {
        check_queue(&mut Buckets::new(&square(), options), &steps)?;
    }

    /// Events beget others, as windows do, no nearer than themselves. With a list of all that
    /// waits, rounds are taken apart and held to what the paper says of them.
    #[test]
    fn rounds_take_the_nearest_buckets_and_nothing_born_in_them(
        first in prop::collection::vec(0.0..40.0f64, 1..60),
        later in prop::collection::vec((0..3usize, 0.0..12.0f64), 0..400),
        size in 1..30u32,
    ) {
        let mut buckets = unit_buckets(BatchSize::Fixed(size));
        let (mut waiting, mut labels) = (Vec::new(), Vec::new());
        let mut push = |buckets: &mut Buckets, waiting: &mut Vec<u32>, label: f64| {
            let id = labels.len() as u32;
            labels.push(label);
            waiting.push(id);
            buckets.push(label, window(id), &mut ());
        };
        for label in first {
            push(&mut buckets, &mut waiting, label);
        }
        let mut later = later.into_iter();
        let mut next = buckets.pop(&mut ());
        while let Some(begun) = next {
            let round = buckets.round;
            let (mut taken, mut last) = (0, 0);
            let mut old = std::mem::take(&mut waiting);
            let at_start = old.len();
            let mut current = begun;
            loop {
                let (label, event) = current;
                prop_assert!(old.contains(&id_of(event)), "born in this round, or lost");
                old.retain(|&id| id != id_of(event));
                taken += 1;
                let bucket = buckets.calendar.bucket(label);
                prop_assert!(last <= bucket && bucket <= round.end);
                last = bucket;
                if let Some((children, further)) = later.next() {
                    for _ in 0..children {
                        push(&mut buckets, &mut waiting, label + further);
                    }
                }
                let is_over = left(&buckets) == 0;
                next = buckets.pop(&mut ());
                match next {
                    Some(event) if !is_over => current = event,
                    _ => break,
                }
            }
            prop_assert!(taken >= at_start.min(size as usize), "{} of {}", taken, at_start);
            waiting.append(&mut old);
        }
        prop_assert!(waiting.is_empty());
    }
}

#[test]
fn within_a_bucket_the_first_to_come_is_the_first_to_go() {
    let mut buckets = unit_buckets(BatchSize::Fixed(1));
    for (id, label) in [5.9, 5.1, 3.0, 5.5].into_iter().enumerate() {
        buckets.push(label, window(id as u32), &mut ());
    }
    let order: Vec<u32> = std::iter::from_fn(|| buckets.pop(&mut ()))
        .map(|(_, event)| id_of(event))
        .collect();
    assert_eq!(order, [2, 0, 1, 3]);
}

/// K starts with all that wait, grows by what comes beyond the last bucket, and shrinks by what
/// comes before its end.
#[test]
fn k_follows_the_wavefront() {
    let mut buckets = unit_buckets(BatchSize::Adaptive { max: 100 });
    let mut count = Count::default();
    for id in 0..4 {
        buckets.push(0.5, window(id), &mut count);
    }
    for id in 4..8 {
        buckets.pop(&mut count);
        buckets.push(3.5, window(id), &mut count);
    }
    assert_eq!(buckets.round.size, 4);
    buckets.pop(&mut count);
    assert_eq!(buckets.round.size, 4, "4 + 4 - 0, but no more than 4 wait");
    for _ in 0..3 {
        buckets.pop(&mut count);
        buckets.push(3.6, window(9), &mut count);
    }
    buckets.pop(&mut count);
    assert_eq!(buckets.round.size, 1, "4 + 0 - 3");
    let counters = count.counters(Buckets::COUNTERS);
    assert_eq!(counters.get(Counter::KPeak), Some(4));
    assert_eq!(counters.get(Counter::Iterations), Some(3));
    assert_eq!(counters.get(Counter::QueuePushes), Some(11));
    assert_eq!(counters.get(Counter::QueuePeak), Some(4));
}

#[test]
fn k_has_a_limit() {
    let mut buckets = unit_buckets(BatchSize::Adaptive { max: 3 });
    for id in 0..10 {
        buckets.push(f64::from(id), window(id), &mut ());
    }
    buckets.pop(&mut ());
    assert_eq!((buckets.round.size, buckets.round.end), (3, 3));
}

/// `P_end` is one bucket behind the last that counts among the K.
#[test]
fn a_round_takes_one_bucket_more_than_it_counts() {
    let mut buckets = unit_buckets(BatchSize::Fixed(2));
    for (id, label) in [0.1, 1.1, 2.1, 3.1].into_iter().enumerate() {
        buckets.push(label, window(id as u32), &mut ());
    }
    buckets.pop(&mut ());
    assert_eq!(left(&buckets), 2);
    let mut buckets = unit_buckets(BatchSize::Fixed(2));
    for (id, label) in [0.1, 1.1, 3.1].into_iter().enumerate() {
        buckets.push(label, window(id as u32), &mut ());
    }
    buckets.pop(&mut ());
    assert_eq!(left(&buckets), 1, "the bucket behind the last one is empty");
}

/// Algorithm 1 of Xu et al. 2015 as printed, with births, on buckets of width 1 that are numbered
/// from 1. Where its lines 5 and 7 and section 4.2 differ, it follows the text: the counts are
/// those of one round.
#[derive(Default)]
struct Algorithm1 {
    buckets: BTreeMap<u64, VecDeque<(i64, u32)>>,
    wavefront_size: i64,
    k: i64,
    c_large: i64,
    c_small: i64,
}

#[expect(
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    reason = "labels are not negative, and queues are short"
)]
impl Algorithm1 {
    fn insert(&mut self, label: f64, birth: i64, id: u32) {
        let bucket = label as u64 + 1;
        self.buckets
            .entry(bucket)
            .or_default()
            .push_back((birth, id));
        self.wavefront_size += 1;
    }

    /// Runs to the end. `children` gives the labels of the children of a window, which are numbered
    /// in the order in which they come. Returns the windows in the order in which they are
    /// propagated, and K of each round.
    fn run(
        mut self,
        first: &[f64],
        k_max: i64,
        mut children: impl FnMut(u32) -> Vec<f64>,
    ) -> (Vec<u32>, Vec<i64>) {
        let (mut order, mut ks) = (Vec::new(), Vec::new());
        let mut ids = 0..;
        for &label in first {
            self.insert(label, -1, ids.next().unwrap());
        }
        self.c_large = self.wavefront_size;
        let mut iter = 0;
        while self.wavefront_size != 0 {
            self.k += self.c_large - self.c_small;
            (self.c_large, self.c_small) = (0, 0);
            self.k = self.k.max(1).min(self.wavefront_size).min(k_max);
            ks.push(self.k);
            self.buckets.retain(|_, queue| !queue.is_empty());
            let p1 = *self.buckets.keys().next().unwrap();
            let (mut p_end, mut wc) = (p1, 0);
            while wc < self.k {
                wc += self
                    .buckets
                    .get(&p_end)
                    .map_or(0, |queue| queue.len() as i64);
                p_end += 1;
            }
            for p2 in p1..=p_end {
                while let Some(&(birth, id)) = self.buckets.get(&p2).and_then(VecDeque::front)
                    && birth < iter
                {
                    self.buckets.get_mut(&p2).unwrap().pop_front();
                    self.wavefront_size -= 1;
                    order.push(id);
                    for label in children(id) {
                        if label >= p_end as f64 {
                            self.c_large += 1;
                        } else {
                            self.c_small += 1;
                        }
                        self.insert(label, iter, ids.next().unwrap());
                    }
                }
            }
            iter += 1;
        }
        (order, ks)
    }
}

proptest! {
    #[test]
    fn rounds_are_those_of_algorithm_1(
        first in prop::collection::vec(0.0..20.0f64, 1..30),
        steps in prop::collection::vec(prop::collection::vec(0.0..8.0f64, 0..3), 1..300),
        k_max in 1..40u32,
    ) {
        // Labels and numbers of windows are the same in both, since both take them in one order.
        let script = |labels: &mut Vec<f64>, id: u32, step: usize| -> Vec<f64> {
            let further = steps.get(step).map_or(&[][..], |step| step);
            let children: Vec<f64> = further.iter().map(|f| labels[id as usize] + f).collect();
            labels.extend(&children);
            children
        };
        let (mut labels, mut step) = (first.clone(), 0);
        let expected = Algorithm1::default().run(&first, i64::from(k_max), |id| {
            step += 1;
            script(&mut labels, id, step - 1)
        });
        let mut buckets = unit_buckets(BatchSize::Adaptive { max: k_max });
        let (mut labels, mut order, mut ks) = (first.clone(), Vec::new(), Vec::new());
        let (mut id, mut rounds) = (0, Count::default());
        let mut push = |buckets: &mut Buckets, label| {
            buckets.push(label, window(id), &mut ());
            id += 1;
        };
        for &label in &first {
            push(&mut buckets, label);
        }
        loop {
            let is_new = left(&buckets) == 0;
            let Some((_, event)) = buckets.pop(&mut rounds) else { break };
            if is_new {
                ks.push(buckets.round.size);
            }
            for label in script(&mut labels, id_of(event), order.len()) {
                push(&mut buckets, label);
            }
            order.push(id_of(event));
        }
        prop_assert_eq!((order, ks), expected);
    }
}

/// Rounding can put a child a bucket below its parent, behind the one at which a round begins.
#[test]
fn a_label_below_the_first_bucket_is_not_lost() {
    let mut buckets = unit_buckets(BatchSize::Fixed(1));
    buckets.push(7.0, window(0), &mut ());
    buckets.pop(&mut ());
    buckets.push(6.999, window(1), &mut ());
    buckets.push(8.0, window(2), &mut ());
    assert_eq!(buckets.pop(&mut ()), Some((6.999, window(1))));
}

/// Labels from 1e-300 to 1e300 in one queue take as much memory as there are events, and no
/// longer than it takes to jump from one to the next.
#[test]
fn labels_of_any_magnitude_are_safe() {
    let mut buckets = unit_buckets(BatchSize::Fixed(1));
    let labels: Vec<f64> = (-300..=300).map(|e| 10f64.powi(e)).collect();
    for (id, &label) in (0u32..).zip(labels.iter().rev()) {
        buckets.push(label, window(id), &mut ());
    }
    let far: Vec<f64> = std::iter::from_fn(|| buckets.pop(&mut ()))
        .map(|(label, _)| label)
        .filter(|&label| label >= 1.0)
        .collect();
    assert!(
        far.iter()
            .copied()
            .eq(labels.into_iter().filter(|&l| l >= 1.0))
    );
}

/// An 8-bit birth comes round again after 256 rounds, as one public queue of buckets has found:
/// what came during the round is then taken in it.
#[test]
fn windows_that_arrive_during_a_round_wait_for_the_next() {
    let mut buckets = unit_buckets(BatchSize::Fixed(2));
    for id in 0..2 {
        buckets.push(0.0, window(id), &mut ());
    }
    for id in 2..1000 {
        assert_eq!(buckets.pop(&mut ()), Some((0.0, window(id - 2))));
        // Two in each round, whatever has come into their bucket.
        assert_eq!(left(&buckets), 1 - id as usize % 2);
        buckets.push(0.0, window(id), &mut ());
    }
}

/// More events in one round than there is room for those that are known.
#[test]
fn the_events_of_a_long_round_are_known_a_little_ahead() {
    let mut buckets = unit_buckets(BatchSize::Fixed(1));
    let count = 3 * ROOM as u32;
    for id in 0..count {
        buckets.push(0.0, window(id), &mut ());
    }
    for id in 0..count {
        assert_eq!(buckets.pop(&mut ()), Some((0.0, window(id))));
        let coming: Vec<u32> = buckets.coming().map(id_of).collect();
        let expected: Vec<u32> = (id + 1..count).take(KNOWN).collect();
        assert_eq!(coming, expected);
        assert_eq!(buckets.events().count() as u32, count - 1 - id);
    }
    assert_eq!(buckets.pop(&mut ()), None);
}

#[test]
fn the_width_is_that_of_the_paper() {
    let buckets = Buckets::new(
        &square(),
        BucketOptions {
            width: 2.0,
            ..BucketOptions::default()
        },
    );
    let mean = (4.0 + 2f64.sqrt()) / 5.0;
    assert!((buckets.calendar.width() - 2.0 * mean / 2.0).abs() < 1e-15);
}
