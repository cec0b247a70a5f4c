//! The children of a list that has crossed its face.

use geobench_window::trimming::KeptWindows;

use super::kernels::Triangle;
use super::levels::Levels;
use super::store::{NO_LIST, WindowStore};

/// The lists behind both exits of a face, after children have been added.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sent {
    /// The half-edges on which the lists wait.
    pub(crate) exits: [u32; 2],
    /// The lists; [`NO_LIST`] where no child can arrive.
    pub(crate) lists: [u32; 2],
    /// Their lengths before the children arrived.
    pub(crate) before: [usize; 2],
    /// Their lengths now.
    pub(crate) after: [usize; 2],
}

impl Sent {
    /// The exits through which children may have left.
    #[inline(always)]
    pub(crate) fn sides(&self) -> impl Iterator<Item = usize> + use<> {
        let lists = self.lists;
        (0..2).filter(move |&side| lists[side] != NO_LIST)
    }

    /// Number of children.
    #[inline(always)]
    pub(crate) fn children(&self) -> usize {
        self.after[0] + self.after[1] - self.before[0] - self.before[1]
    }

    /// Records the levels of the children of the list on `h`, which has crossed `triangle`. Returns
    /// the deepest.
    pub(crate) fn record_levels(
        &self,
        levels: &mut Levels,
        store: &WindowStore,
        h: u32,
        triangle: &Triangle,
    ) -> u32 {
        let departure = levels.leave(h, triangle);
        let arrive = |side: usize| {
            let children = store.windows_at(self.lists[side], self.before[side]..self.after[side]);
            levels.arrive(self.exits[side], children, &departure, side)
        };
        self.sides().map(arrive).max().unwrap_or(0)
    }

    /// Reduces children beside thin faces to the parts that `kept` admits.
    #[inline(always)]
    pub(crate) fn admit(&mut self, kept: &mut KeptWindows, store: &mut WindowStore) {
        if kept.is_empty() {
            return;
        }
        for side in self.sides() {
            let exit = self.exits[side];
            if kept.holds(exit as usize) {
                // Older windows may have been coalesced with children.
                let first = self.before[side].min(self.after[side]);
                let places = first..self.after[side];
                self.after[side] = store.admit(kept, exit, self.lists[side], places);
            }
        }
    }
}
