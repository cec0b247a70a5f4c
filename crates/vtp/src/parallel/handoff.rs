//! Handoffs: parts of the wavefront that move from one thread to another.

use std::mem;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Mutex, PoisonError};

use geobench_window::Probe;

use super::lag_limit::LagLimit;
use super::padded::Padded;
use super::schedule_fuzz::schedule_fuzz;
use super::thread_view::ThreadView;
use crate::engine::layout::{half_edge, parts};
use crate::engine::store::{COLUMNS, NO_LIST};
use crate::wavefront::{Improvement, SurfaceState, Wavefront};

/// Vertices whose turns are still to come, with all windows of the sender that wait on the faces
/// around them.
#[derive(Clone, Debug, Default)]
pub(super) struct Handoff {
    /// The current bucket of the sender.
    bucket: u32,
    /// The vertices, with the sender's shortest paths to them.
    turns: Vec<Improvement>,
    /// The half-edges with waiting windows, and the numbers of windows.
    lists: Vec<(u32, u32)>,
    /// The windows, list by list, in columns.
    windows: Vec<f64>,
}

impl Handoff {
    fn clear(&mut self) {
        self.turns.clear();
        self.lists.clear();
        self.windows.clear();
    }

    /// Number of windows.
    pub(super) fn windows(&self) -> usize {
        self.windows.len() / COLUMNS
    }

    /// Adds `v`, whose turn in `wavefront` is still to come, and the windows around it. Returns
    /// their weight: `each` for every list, and one for every window.
    ///
    /// No list of the wavefront may be queued, and no effects may be deferred.
    pub(super) fn add(
        &mut self,
        wavefront: &mut Wavefront,
        view: &mut ThreadView<'_>,
        v: u32,
        each: usize,
    ) -> usize {
        wavefront.buckets.remove(v);
        let origin = wavefront.origins[v as usize];
        self.turns.push(Improvement {
            vertex: v,
            h: origin.h,
            entry: origin.entry,
            distance: view.give_up(v),
        });
        let mut weight = 0;
        // A list can only wait on a face if the turn of one of its vertices is still to come.
        for place in view.layout().ring_places(v) {
            let (f, _) = parts(view.layout().rings[place]);
            for corner in 0..3 {
                let list = view.list(f, corner);
                if list != NO_LIST {
                    let len = wavefront.store.len(list);
                    self.lists.push((half_edge(f as u32, corner), len as u32));
                    wavefront.store.copy_out(list, &mut self.windows);
                    view.set_list(f, corner, wavefront.store.set_len(list, 0));
                    weight += each + len;
                }
            }
        }
        weight
    }

    /// Adds all vertices and windows to `wavefront`.
    fn unpack<P: Probe>(
        &self,
        wavefront: &mut Wavefront,
        view: &mut ThreadView<'_>,
        probe: &mut P,
    ) {
        for &turn in &self.turns {
            schedule_fuzz();
            view.take_over(turn.vertex, turn.distance);
            wavefront.take_over(view, turn, probe);
        }
        wavefront.settle(view, probe);
        let mut windows = self.windows.as_slice();
        for &(h, n) in &self.lists {
            let (columns, rest) = windows.split_at(n as usize * COLUMNS);
            windows = rest;
            let (f, corner) = parts(h);
            let list = wavefront.store.append(view.list(f, corner), columns);
            view.set_list(f, corner, list);
            wavefront.kept.receive(h as usize);
            wavefront.make_ready(view, f, corner);
        }
    }
}

/// The mailbox of a thread.
#[derive(Debug, Default)]
struct Slot {
    full: AtomicBool,
    handoff: Mutex<Handoff>,
}

/// The handoffs in transit: at most one to each thread.
#[derive(Debug)]
pub(super) struct Handoffs {
    slots: Vec<Padded<Slot>>,
}

impl Handoffs {
    pub(super) fn new(threads: usize) -> Self {
        Self {
            slots: (0..threads).map(|_| Padded::default()).collect(),
        }
    }

    /// Sends the handoff that `fill` packs, from a thread at `bucket` to thread `to`, unless
    /// another one is in transit to that thread.
    pub(super) fn send(
        &self,
        bucket: u32,
        to: usize,
        lag: &LagLimit,
        fill: impl FnOnce(&mut Handoff),
    ) {
        let slot = &self.slots[to].0;
        let Ok(mut handoff) = slot.handoff.try_lock() else {
            return;
        };
        schedule_fuzz();
        if slot.full.load(Relaxed) {
            return;
        }
        handoff.clear();
        fill(&mut handoff);
        if !handoff.turns.is_empty() {
            lag.begin();
            schedule_fuzz();
            handoff.bucket = bucket;
            lag.call_back(to, bucket);
            slot.full.store(true, Relaxed);
        }
    }

    /// Whether a handoff to thread `to` is in transit.
    #[inline(always)]
    pub(super) fn has(&self, to: usize) -> bool {
        self.slots[to].0.full.load(Relaxed)
    }

    /// Receives and unpacks the handoff to a thread, if there is one; returns whether there was.
    /// `spare` is swapped into the mailbox, so that its memory is reused.
    pub(super) fn receive<P: Probe>(
        &self,
        to: usize,
        lag: &LagLimit,
        spare: &mut Handoff,
        wavefront: &mut Wavefront,
        view: &mut ThreadView<'_>,
        probe: &mut P,
    ) -> bool {
        if !self.has(to) {
            return false;
        }
        let slot = &self.slots[to].0;
        let mut handoff = slot.handoff.lock().unwrap_or_else(PoisonError::into_inner);
        mem::swap(&mut *handoff, spare);
        slot.full.store(false, Relaxed);
        drop(handoff);
        schedule_fuzz();
        // The thread may have changed its bucket since it was moved back.
        lag.call_back(to, spare.bucket);
        spare.unpack(wavefront, view, probe);
        schedule_fuzz();
        lag.end();
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
    fn windows(store: &WindowStore, view: &ThreadView<'_>, h: u32) -> Vec<[f64; COLUMNS]> {
        let (f, corner) = parts(h);
        let list = view.list(f, corner);
        (0..store.len(list)).map(|i| store.get(list, i)).collect()
    }

    /// Makes windows wait on `h`.
    fn put(
        wavefront: &mut Wavefront,
        view: &mut ThreadView<'_>,
        h: u32,
        windows: &[[f64; COLUMNS]],
    ) {
        let list = wavefront.store.reserve(NO_LIST, windows.len());
        for (i, &window) in windows.iter().enumerate() {
            wavefront.store.put(list, i, window);
        }
        let (f, corner) = parts(h);
        view.set_list(f, corner, wavefront.store.set_len(list, windows.len()));
    }

    /// Hands `v` off with the windows around it. Returns their weight, where a list counts 100.
    fn give(shared: &Shared, from: &mut Thread, to: &mut Thread, v: u32) -> usize {
        let mut handoff = Handoff::default();
        let (wavefront, mut view) = from.view(shared);
        let weight = handoff.add(wavefront, &mut view, v, 100);
        let (wavefront, mut view) = to.view(shared);
        handoff.unpack(wavefront, &mut view, &mut ());
        weight
    }

    #[test]
    fn handed_over_windows_are_unchanged() {
        let (shared, [mut a, mut b]) = two_threads();
        let v = saddle(&shared.layout);
        a.find(&shared, path(&shared.layout, v, 0, 2.5));
        let (f, _) = parts(shared.layout.ring(v)[1]);
        let lists = [0, 2].map(|corner| {
            let windows: Vec<_> = (0..9 + corner).map(|i| [i as f64; COLUMNS]).collect();
            (half_edge(f as u32, corner), windows)
        });
        let there = [[50.0; COLUMNS]];
        for (h, windows) in &lists {
            let (wavefront, mut view) = a.view(&shared);
            put(wavefront, &mut view, *h, windows);
        }
        let (wavefront, mut view) = b.view(&shared);
        put(wavefront, &mut view, lists[0].0, &there);

        assert_eq!(give(&shared, &mut a, &mut b, v), 2 * 100 + 9 + 11);
        assert_eq!(
            (a.wavefront.buckets.nearest(), a.wavefront.store.waiting()),
            (None, 0)
        );
        assert_eq!(
            (a.wavefront.store.lists(), b.wavefront.store.lists()),
            (0, 2)
        );
        let (wavefront, view) = b.view(&shared);
        assert_eq!(wavefront.buckets.nearest(), Some(2));
        assert_eq!(view.reached(v), 2.5);
        let both = [&there, lists[0].1.as_slice()].concat();
        assert_eq!(windows(&wavefront.store, &view, lists[0].0), both);
        assert_eq!(windows(&wavefront.store, &view, lists[1].0), lists[1].1);
    }

    /// Otherwise windows that return would wait for ever.
    #[test]
    fn a_vertex_that_was_given_away_has_a_turn_when_the_wave_comes_back() {
        let (shared, [mut a, mut b]) = two_threads();
        let v = saddle(&shared.layout);
        a.find(&shared, path(&shared.layout, v, 0, 2.5));
        give(&shared, &mut a, &mut b, v);
        for _ in 0..2 {
            a.find(&shared, path(&shared.layout, v, 1, 3.5));
            assert_eq!(
                (a.wavefront.buckets.nearest(), a.wavefront.buckets.len()),
                (Some(2), 1)
            );
        }
    }

    #[test]
    fn windows_start_from_a_vertex_that_was_given_away_once() {
        let (shared, [mut a, mut b]) = two_threads();
        let v = saddle(&shared.layout);
        a.find(&shared, path(&shared.layout, v, 0, 2.5));
        give(&shared, &mut a, &mut b, v);
        a.find(&shared, path(&shared.layout, v, 1, 3.5));
        let started = [a, b].map(|mut thread| {
            let mut count = Count::default();
            let (wavefront, mut view) = thread.view(&shared);
            wavefront.take_turn(&mut view, 2, &mut count);
            count
                .counters(&[Counter::PseudoSources])
                .get(Counter::PseudoSources)
        });
        assert_eq!(started, [Some(0), Some(1)]);
    }

    #[test]
    fn windows_handed_to_a_vertex_after_its_turn_cross_at_once() {
        let (shared, [mut a, mut b]) = two_threads();
        let v = saddle(&shared.layout);
        b.find(&shared, path(&shared.layout, v, 0, 4.0));
        let (wavefront, mut view) = b.view(&shared);
        wavefront.take_turn(&mut view, 4, &mut ());
        a.find(&shared, path(&shared.layout, v, 2, 2.5));
        let h = shared.layout.ring(v)[0];
        let (wavefront, mut view) = a.view(&shared);
        put(wavefront, &mut view, h, &[[7.0; COLUMNS]]);
        give(&shared, &mut a, &mut b, v);
        let (wavefront, mut view) = b.view(&shared);
        // It sends windows for the shorter path that it now knows.
        assert_eq!(
            (view.reached(v), wavefront.origins[v as usize].h),
            (2.5, path(&shared.layout, v, 2, 0.0).h)
        );
        let (f, corner) = parts(h);
        assert!(!view.join(f) && !view.enqueue(f, corner));
        assert!(windows(&wavefront.store, &view, h).contains(&[7.0; COLUMNS]));
        wavefront.buckets.remove(v);
        assert!(wavefront.buckets.near().all(|other| other != v));
    }

    #[test]
    fn handoffs_travel_one_at_a_time_and_count_as_work() {
        let (shared, [mut a, mut b]) = two_threads();
        let (handoffs, lag) = (&shared.handoffs, &shared.lag);
        let vertices: Vec<u32> = (100..103).collect();
        for &v in &vertices {
            a.find(&shared, path(&shared.layout, v, 0, 2.5));
        }
        let mut send = |v| {
            let (wavefront, mut view) = a.view(&shared);
            handoffs.send(2, 1, lag, |handoff| {
                handoff.add(wavefront, &mut view, v, 1);
            });
        };
        let mut spare = Handoff::default();
        let mut receive = || {
            let (wavefront, mut view) = b.view(&shared);
            let any = handoffs.receive(1, lag, &mut spare, wavefront, &mut view, &mut ());
            (any, wavefront.buckets.len())
        };
        assert_eq!(receive(), (false, 0));
        send(100);
        send(101);
        lag.end();
        assert!(!lag.is_over() && handoffs.has(1) && !handoffs.has(0));
        assert_eq!(receive(), (true, 1));
        assert!(lag.is_over());
        lag.begin();
        send(102);
        assert_eq!((receive(), receive()), ((true, 2), (false, 2)));
        handoffs.send(2, 1, lag, |_| {});
        assert!(!handoffs.has(1), "an empty one");
        // The vertices that were not sent are still in the queue.
        assert_eq!(a.wavefront.buckets.near().collect::<Vec<_>>(), [101]);
    }
}
