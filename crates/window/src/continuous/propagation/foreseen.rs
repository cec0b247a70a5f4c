//! The turn of a window that has been crossed before.

// A window is not to pass through memory between its crossing and where it waits.
#![allow(clippy::inline_always)]

use geobench_mesh::HalfEdgeId;

use super::Continuous;
use crate::continuous::policy::{Child, Policy};
use crate::counters::Counter;
use crate::crossings::Offspring;
use crate::probe::{Phase, Probe};
use crate::queue::{Discipline, Event};

impl<W: Policy, Q: Discipline> Continuous<W, Q> {
    /// Goes on with a window that crossed the face of `h` before its turn: what
    /// [`cross`](Self::cross) does, with results that are there already.
    #[inline(always)]
    pub(super) fn cross_foreseen<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        lane: usize,
        lineage: W::Lineage,
        probe: &mut P,
    ) {
        self.begin(probe);
        let crossings = self.foresight.crossings();
        let covers_apex = crossings.covers_apex(lane);
        let (apex, d) = (crossings.apex(lane), crossings.apex_distance(lane));
        if d < self.surface.distance(apex) {
            self.offer(apex, d, probe);
        }
        let tried = if covers_apex {
            self.split_foreseen(h, lane, d, lineage, probe)
        } else if let Some(heir) = self.policy.descend(&lineage) {
            self.hand_on(&self.foresight.crossings().child(lane), heir, probe);
            [true; 2]
        } else {
            [false; 2]
        };
        self.end(h, tried, probe);
    }

    /// As [`split`](Self::split), for a window whose straight path to the apex, of length `d`, and
    /// whose left child are there already.
    #[inline(never)]
    fn split_foreseen<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        lane: usize,
        d: f64,
        lineage: W::Lineage,
        probe: &mut P,
    ) -> [bool; 2] {
        let Some(heir) = self.policy.descend(&lineage) else {
            return [false; 2];
        };
        let faces = self.surface.faces();
        let entry = self.foresight.crossings().entry(lane, faces);
        let [left, right] = self.policy.split_at(h, entry, d, heir);
        if let Some(heir) = left {
            self.hand_on(&self.foresight.crossings().child(lane), heir, probe);
        }
        if let Some(heir) = right {
            let crossings = self.foresight.crossings();
            let child = crossings.right_child(lane, self.surface.faces());
            self.hand_on(&child, heir, probe);
        }
        [left.is_some(), right.is_some()]
    }

    /// Hands on what a window leaves that was crossed before its turn, if that is anything.
    #[inline(always)]
    fn hand_on<P: Probe>(&mut self, offspring: &Offspring, lineage: W::Lineage, probe: &mut P) {
        let Offspring {
            outlet,
            window,
            label,
            ..
        } = *offspring;
        let (Some(h), true) = (outlet.half_edge(), window.b0 < window.b1) else {
            return;
        };
        probe.add(Counter::Children, 1);
        if window.b1 - window.b0 < self.threshold {
            probe.add(Counter::Filtered, 1);
            return;
        }
        probe.enter(Phase::Pruning);
        let distances = outlet.corners.map(|v| self.surface.distance(v));
        let child = Child {
            h,
            window,
            lineage,
            label,
            is_beaten: offspring.is_beaten(distances),
        };
        let waits = self.policy.admit(&child, &self.surface, probe);
        if let Some(id) = waits {
            self.queue.push(label, Event::window(h, id), probe);
        }
        probe.add(Counter::Kept, u64::from(waits.is_some()));
        probe.enter(Phase::Propagation);
    }
}
