//! Crossing several windows together before they leave the queue.

use geobench_mesh::HalfEdgeId;

use super::policy::Policy;
use super::surface::Surface;
use crate::crossings::{Crossings, LANES};
use crate::probe::{Phase, Probe};
use crate::queue::{Discipline, EventKind};
use crate::simd::Instructions;

/// The next windows of the queue at the last refill, in order, with their crossings.
///
/// Results do not depend on the lookahead. Only the crossing is computed early. Whether the window
/// is still alive, and what its children are compared with, is decided when the window leaves the
/// queue.
#[derive(Clone, Debug, Default)]
pub(super) struct Lookahead {
    crossings: Crossings,
    ids: [u32; LANES],
    /// The first window that has not been taken.
    next: usize,
}

impl Lookahead {
    /// Crosses windows with `instructions`, or narrower ones if the processor lacks them.
    pub(super) fn new(instructions: Instructions) -> Self {
        Self {
            crossings: Crossings::new(instructions),
            ..Self::default()
        }
    }

    pub(super) fn clear(&mut self) {
        self.crossings.clear();
        self.next = 0;
    }

    /// Forgets all half-edges, before a change of the mesh.
    pub(super) fn forget(&mut self) {
        self.crossings.forget();
        self.next = 0;
    }

    pub(super) fn crossings(&self) -> &Crossings {
        &self.crossings
    }

    /// The lane of window `id` on `h`, which has left `queue`; `None` if it was not crossed early.
    #[inline]
    pub(super) fn lane<W: Policy, Q: Discipline, P: Probe>(
        &mut self,
        h: HalfEdgeId,
        id: u32,
        queue: &Q,
        policy: &W,
        surface: &Surface,
        probe: &mut P,
    ) -> Option<usize> {
        if self.next == self.crossings.len() {
            probe.enter(Phase::Propagation);
            self.refill(h, id, queue, policy, surface);
            probe.enter(Phase::Management);
        }
        let next = self.next;
        if self.ids[next % LANES] == id {
            self.next += 1;
            return Some(next);
        }
        self.skip_to(id)
    }

    /// Skips the lanes before `id`: the queue has changed its order, and their windows are crossed
    /// later without a lane. A window pushed after the last refill has no lane and skips none.
    #[cold]
    fn skip_to(&mut self, id: u32) -> Option<usize> {
        let waiting = &self.ids[self.next..self.crossings.len()];
        let lane = self.next + waiting.iter().position(|&other| other == id)?;
        self.next = lane + 1;
        Some(lane)
    }

    /// Crosses this window and the next ones of the queue, and prefetches the memory that these and
    /// the windows after them will need.
    #[inline(never)]
    fn refill<W: Policy, Q: Discipline>(
        &mut self,
        h: HalfEdgeId,
        id: u32,
        queue: &Q,
        policy: &W,
        surface: &Surface,
    ) {
        self.clear();
        self.add(h, id, policy, surface);
        let mut coming = queue.coming();
        for event in coming.by_ref().take(LANES - 1) {
            if let EventKind::Window(h, id) = event.kind() {
                self.add(h, id, policy, surface);
            }
        }
        for event in coming.take(LANES) {
            if let EventKind::Window(h, id) = event.kind() {
                policy.announce(h, id);
                surface.announce(h);
            }
        }
        self.crossings.cross(surface.faces());
    }

    #[inline(always)]
    #[allow(clippy::inline_always)] // Keeps the window in registers.
    fn add<W: Policy>(&mut self, h: HalfEdgeId, id: u32, policy: &W, surface: &Surface) {
        if let Some(window) = policy.foresee(id) {
            self.ids[self.crossings.len()] = id;
            self.crossings.add(h, window);
            policy.prepare(h, id, surface);
            surface.prepare(h);
        }
    }
}
