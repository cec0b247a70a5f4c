//! Parts of the wavefront that change hands.

use std::mem;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Mutex, PoisonError};

use geobench_window::Probe;

use super::jitter::jitter;
use super::pace::Pace;
use super::padded::Padded;
use super::part::Part;
use crate::engine::store::{COLUMNS, NO_LIST};
use crate::engine::surface::{half_edge, parts};
use crate::wave::{Field, Improvement, Wave};

/// Vertices that are to have their turns, with all windows of the giver that wait on the faces
/// around them.
#[derive(Clone, Debug, Default)]
pub(super) struct Gift {
    /// The bucket at which the giver is.
    bucket: u32,
    /// The vertices, with the shortest paths that the giver had to them.
    turns: Vec<Improvement>,
    /// The half-edges on which windows wait, and how many.
    lists: Vec<(u32, u32)>,
    /// These windows, list by list, in columns.
    windows: Vec<f64>,
}

impl Gift {
    fn clear(&mut self) {
        self.turns.clear();
        self.lists.clear();
        self.windows.clear();
    }

    /// The windows in it.
    pub(super) fn windows(&self) -> usize {
        self.windows.len() / COLUMNS
    }

    /// Adds `v`, whose turn was to come in `wave`, and the windows around it. Returns what they
    /// weigh, `each` for each list and one for each window.
    ///
    /// None of the wave's lists may be ready to cross, and no path may wait for its consequences.
    pub(super) fn add(
        &mut self,
        wave: &mut Wave,
        part: &mut Part<'_>,
        v: u32,
        each: usize,
    ) -> usize {
        wave.buckets.remove(v);
        let origin = wave.origins[v as usize];
        self.turns.push(Improvement {
            vertex: v,
            h: origin.h,
            entry: origin.entry,
            distance: part.give_up(v),
        });
        let mut weight = 0;
        // A list may wait on a face only if the wave has the turn of one of its vertices to come.
        for place in part.surface().ring_places(v) {
            let (f, _) = parts(part.surface().rings[place]);
            for corner in 0..3 {
                let list = part.list(f, corner);
                if list != NO_LIST {
                    let len = wave.store.len(list);
                    self.lists.push((half_edge(f as u32, corner), len as u32));
                    wave.store.copy_out(list, &mut self.windows);
                    part.set_list(f, corner, wave.store.set_len(list, 0));
                    weight += each + len;
                }
            }
        }
        weight
    }

    /// Takes all of it into a wave.
    fn unpack<P: Probe>(&self, wave: &mut Wave, part: &mut Part<'_>, probe: &mut P) {
        for &turn in &self.turns {
            jitter();
            part.take_over(turn.vertex, turn.distance);
            wave.hear_of(part, turn, probe);
        }
        wave.settle(part, probe);
        let mut windows = self.windows.as_slice();
        for &(h, n) in &self.lists {
            let (columns, rest) = windows.split_at(n as usize * COLUMNS);
            windows = rest;
            let (f, corner) = parts(h);
            let list = wave.store.append(part.list(f, corner), columns);
            part.set_list(f, corner, list);
            wave.make_ready(part, f, corner);
        }
    }
}

/// Where a gift to a thread lies.
#[derive(Debug, Default)]
struct Slot {
    full: AtomicBool,
    gift: Mutex<Gift>,
}

/// The gifts on their way: one to each thread at a time.
#[derive(Debug)]
pub(super) struct Gifts {
    slots: Vec<Padded<Slot>>,
}

impl Gifts {
    pub(super) fn new(threads: usize) -> Self {
        Self {
            slots: (0..threads).map(|_| Padded::default()).collect(),
        }
    }

    /// Has `fill` pack what a thread at `bucket` gives to thread `to`, unless something is on its
    /// way there already.
    pub(super) fn send(&self, bucket: u32, to: usize, pace: &Pace, fill: impl FnOnce(&mut Gift)) {
        let slot = &self.slots[to].0;
        let Ok(mut gift) = slot.gift.try_lock() else {
            return;
        };
        jitter();
        if slot.full.load(Relaxed) {
            return;
        }
        gift.clear();
        fill(&mut gift);
        if !gift.turns.is_empty() {
            pace.begin();
            jitter();
            gift.bucket = bucket;
            pace.call_back(to, bucket);
            slot.full.store(true, Relaxed);
        }
    }

    /// Whether there is one for a thread.
    #[inline(always)]
    pub(super) fn has(&self, to: usize) -> bool {
        self.slots[to].0.full.load(Relaxed)
    }

    /// Takes the gift to a thread, if there is one, into its wave; `spare` is for its room. Returns
    /// whether there was one.
    pub(super) fn receive<P: Probe>(
        &self,
        to: usize,
        pace: &Pace,
        spare: &mut Gift,
        wave: &mut Wave,
        part: &mut Part<'_>,
        probe: &mut P,
    ) -> bool {
        if !self.has(to) {
            return false;
        }
        let slot = &self.slots[to].0;
        let mut gift = slot.gift.lock().unwrap_or_else(PoisonError::into_inner);
        mem::swap(&mut *gift, spare);
        slot.full.store(false, Relaxed);
        drop(gift);
        jitter();
        // It may have looked elsewhere since it was called back.
        pace.call_back(to, spare.bucket);
        spare.unpack(wave, part, probe);
        jitter();
        pace.end();
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::store::WindowStore;
    use crate::parallel::shared::Shared;
    use crate::parallel::test_run::{Thread, path, saddle, two_threads};
    use geobench_window::{Count, Counter};

    /// The windows that wait on half-edge `h`.
    fn windows(store: &WindowStore, part: &Part<'_>, h: u32) -> Vec<[f64; COLUMNS]> {
        let (f, corner) = parts(h);
        let list = part.list(f, corner);
        (0..store.len(list)).map(|i| store.get(list, i)).collect()
    }

    /// Has windows wait on `h`.
    fn put(wave: &mut Wave, part: &mut Part<'_>, h: u32, windows: &[[f64; COLUMNS]]) {
        let list = wave.store.reserve(NO_LIST, windows.len());
        for (i, &window) in windows.iter().enumerate() {
            wave.store.put(list, i, window);
        }
        let (f, corner) = parts(h);
        part.set_list(f, corner, wave.store.set_len(list, windows.len()));
    }

    /// `v` changes hands, with what waits around it; returns what that weighs, lists with 100.
    fn give(shared: &Shared, from: &mut Thread, to: &mut Thread, v: u32) -> usize {
        let mut gift = Gift::default();
        let (wave, mut part) = from.part(shared);
        let weight = gift.add(wave, &mut part, v, 100);
        let (wave, mut part) = to.part(shared);
        gift.unpack(wave, &mut part, &mut ());
        weight
    }

    #[test]
    fn what_changes_hands_arrives_whole() {
        let (shared, [mut a, mut b]) = two_threads();
        let v = saddle(&shared.surface);
        a.find(&shared, path(&shared.surface, v, 0, 2.5));
        let (f, _) = parts(shared.surface.ring(v)[1]);
        let lists = [0, 2].map(|corner| {
            let windows: Vec<_> = (0..9 + corner).map(|i| [i as f64; COLUMNS]).collect();
            (half_edge(f as u32, corner), windows)
        });
        let there = [[50.0; COLUMNS]];
        for (h, windows) in &lists {
            let (wave, mut part) = a.part(&shared);
            put(wave, &mut part, *h, windows);
        }
        let (wave, mut part) = b.part(&shared);
        put(wave, &mut part, lists[0].0, &there);

        assert_eq!(give(&shared, &mut a, &mut b, v), 2 * 100 + 9 + 11);
        assert_eq!(
            (a.wave.buckets.nearest(), a.wave.store.waiting()),
            (None, 0)
        );
        assert_eq!((a.wave.store.lists(), b.wave.store.lists()), (0, 2));
        let (wave, part) = b.part(&shared);
        assert_eq!(wave.buckets.nearest(), Some(2));
        assert_eq!(part.reached(v), 2.5);
        let both = [&there, lists[0].1.as_slice()].concat();
        assert_eq!(windows(&wave.store, &part, lists[0].0), both);
        assert_eq!(windows(&wave.store, &part, lists[1].0), lists[1].1);
    }

    /// Otherwise windows that come back would wait there for ever.
    #[test]
    fn a_vertex_that_was_given_away_has_a_turn_when_the_wave_comes_back() {
        let (shared, [mut a, mut b]) = two_threads();
        let v = saddle(&shared.surface);
        a.find(&shared, path(&shared.surface, v, 0, 2.5));
        give(&shared, &mut a, &mut b, v);
        for _ in 0..2 {
            a.find(&shared, path(&shared.surface, v, 1, 3.5));
            assert_eq!(
                (a.wave.buckets.nearest(), a.wave.buckets.len()),
                (Some(2), 1)
            );
        }
    }

    #[test]
    fn windows_start_from_a_vertex_that_was_given_away_once() {
        let (shared, [mut a, mut b]) = two_threads();
        let v = saddle(&shared.surface);
        a.find(&shared, path(&shared.surface, v, 0, 2.5));
        give(&shared, &mut a, &mut b, v);
        a.find(&shared, path(&shared.surface, v, 1, 3.5));
        let started = [a, b].map(|mut thread| {
            let mut count = Count::default();
            let (wave, mut part) = thread.part(&shared);
            wave.take_turn(&mut part, 2, &mut count);
            count
                .counters(&[Counter::PseudoSources])
                .get(Counter::PseudoSources)
        });
        assert_eq!(started, [Some(0), Some(1)]);
    }

    #[test]
    fn what_comes_to_a_vertex_that_has_had_its_turn_crosses_at_once() {
        let (shared, [mut a, mut b]) = two_threads();
        let v = saddle(&shared.surface);
        b.find(&shared, path(&shared.surface, v, 0, 4.0));
        let (wave, mut part) = b.part(&shared);
        wave.take_turn(&mut part, 4, &mut ());
        a.find(&shared, path(&shared.surface, v, 2, 2.5));
        let h = shared.surface.ring(v)[0];
        let (wave, mut part) = a.part(&shared);
        put(wave, &mut part, h, &[[7.0; COLUMNS]]);
        give(&shared, &mut a, &mut b, v);
        let (wave, mut part) = b.part(&shared);
        // What it sends for the shorter path it knows of now.
        assert_eq!(
            (part.reached(v), wave.origins[v as usize].h),
            (2.5, path(&shared.surface, v, 2, 0.0).h)
        );
        let (f, corner) = parts(h);
        assert!(!part.join(f) && !part.enqueue(f, corner));
        assert!(windows(&wave.store, &part, h).contains(&[7.0; COLUMNS]));
        wave.buckets.remove(v);
        assert!(wave.buckets.near().all(|other| other != v));
    }

    #[test]
    fn gifts_travel_one_at_a_time_and_count_as_work() {
        let (shared, [mut a, mut b]) = two_threads();
        let (gifts, pace) = (&shared.gifts, &shared.pace);
        let vertices: Vec<u32> = (100..103).collect();
        for &v in &vertices {
            a.find(&shared, path(&shared.surface, v, 0, 2.5));
        }
        let mut send = |v| {
            let (wave, mut part) = a.part(&shared);
            gifts.send(2, 1, pace, |gift| {
                gift.add(wave, &mut part, v, 1);
            });
        };
        let mut spare = Gift::default();
        let mut receive = || {
            let (wave, mut part) = b.part(&shared);
            let any = gifts.receive(1, pace, &mut spare, wave, &mut part, &mut ());
            (any, wave.buckets.len())
        };
        assert_eq!(receive(), (false, 0));
        send(100);
        send(101);
        pace.end();
        assert!(!pace.is_over() && gifts.has(1) && !gifts.has(0));
        assert_eq!(receive(), (true, 1));
        assert!(pace.is_over());
        pace.begin();
        send(102);
        assert_eq!((receive(), receive()), ((true, 2), (false, 2)));
        gifts.send(2, 1, pace, |_| {});
        assert!(!gifts.has(1), "an empty one");
        // What was not sent is still there.
        assert_eq!(a.wave.buckets.near().collect::<Vec<_>>(), [101]);
    }
}
