//! Windows crossed before their turns come.

use geobench_mesh::HalfEdgeId;

use super::policy::Policy;
use super::surface::Surface;
use crate::crossings::{Crossings, LANES};
use crate::queue::{Discipline, EventKind};
use crate::simd::Instructions;

/// The windows that were next to come when it looked last, in that order, and their crossings.
///
/// Nothing depends on whether a window was foreseen: it is crossed before its turn, and everything
/// else, from the question whether it still matters to what its child is compared with, is done
/// when its turn comes.
#[derive(Clone, Debug, Default)]
pub(super) struct Foresight {
    crossings: Crossings,
    ids: [u32; LANES],
    /// The first window that has not been taken.
    next: usize,
}

impl Foresight {
    /// Windows cross with `instructions`, or narrower ones if the processor lacks them.
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

    pub(super) fn crossings(&self) -> &Crossings {
        &self.crossings
    }

    /// The lane of window `id` on `h`, which has come out of `queue`; `None` if it was not
    /// foreseen.
    #[inline]
    pub(super) fn lane<W: Policy, Q: Discipline>(
        &mut self,
        h: HalfEdgeId,
        id: u32,
        queue: &Q,
        policy: &W,
        surface: &Surface,
    ) -> Option<usize> {
        if self.next == self.crossings.len() {
            self.look(h, id, queue, policy, surface);
        }
        let next = self.next;
        if self.ids[next % LANES] == id {
            self.next += 1;
            return Some(next);
        }
        self.skip_to(id)
    }

    /// Passes over windows that other events have been put in front of for good. Those that came
    /// too late to be foreseen move nothing.
    #[cold]
    fn skip_to(&mut self, id: u32) -> Option<usize> {
        let waiting = &self.ids[self.next..self.crossings.len()];
        let lane = self.next + waiting.iter().position(|&other| other == id)?;
        self.next = lane + 1;
        Some(lane)
    }

    /// Crosses this window and those that come next, and asks for what their turns will need and
    /// for those after them.
    #[inline(never)]
    fn look<W: Policy, Q: Discipline>(
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
    #[allow(clippy::inline_always)] // A window is not to pass through memory.
    fn add<W: Policy>(&mut self, h: HalfEdgeId, id: u32, policy: &W, surface: &Surface) {
        if let Some(window) = policy.foresee(id) {
            self.ids[self.crossings.len()] = id;
            self.crossings.add(h, window);
            policy.prepare(h, id, surface);
            surface.prepare(h);
        }
    }
}
