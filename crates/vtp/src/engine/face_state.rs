//! The part of a face that changes during a run.

use super::store::NO_LIST;

/// The state of a face in one wavefront: the lists that wait on its half-edges, which of them are
/// queued, and the last run in which the face joined the traversed area.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FaceState {
    list: [u32; 3],
    run: u8,
    queued: [bool; 3],
}

const _: () = assert!(size_of::<FaceState>() == 16);

impl Default for FaceState {
    fn default() -> Self {
        Self {
            list: [NO_LIST; 3],
            run: 0,
            queued: [false; 3],
        }
    }
}

impl FaceState {
    /// The list that waits on a half-edge.
    #[inline(always)]
    pub(crate) fn list(&self, corner: usize) -> u32 {
        self.list[corner]
    }

    /// Sets the list that waits on a half-edge.
    #[inline(always)]
    pub(crate) fn set_list(&mut self, corner: usize, list: u32) {
        self.list[corner] = list;
    }

    /// Takes the list from a half-edge and marks the half-edge as not queued.
    #[inline(always)]
    pub(crate) fn take_list(&mut self, corner: usize) -> u32 {
        self.queued[corner] = false;
        std::mem::replace(&mut self.list[corner], NO_LIST)
    }

    /// Marks a half-edge as queued, if the face has joined in this run. Returns whether this is a
    /// change.
    #[inline(always)]
    pub(crate) fn enqueue(&mut self, corner: usize, run: u8) -> bool {
        let news = self.run == run && !self.queued[corner];
        if news {
            self.queued[corner] = true;
        }
        news
    }

    /// Makes the face one that has joined in no run.
    pub(crate) fn leave(&mut self) {
        self.run = 0;
    }

    /// Makes the face join. Returns whether it had not joined in this run.
    #[inline(always)]
    pub(crate) fn join(&mut self, run: u8) -> bool {
        std::mem::replace(&mut self.run, run) != run
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_edges_are_queued_once_and_when_their_face_has_joined_in_this_run() {
        let mut state = FaceState::default();
        state.set_list(1, 7);
        assert!(!state.enqueue(1, 3));
        assert!(state.join(3) && !state.join(3));
        assert!(state.enqueue(1, 3) && !state.enqueue(1, 3) && state.enqueue(2, 3));
        assert_eq!([0, 1].map(|corner| state.take_list(corner)), [NO_LIST, 7]);
        assert_eq!(state.list(1), NO_LIST);
        assert!(state.enqueue(1, 3) && !state.enqueue(0, 4) && state.join(4));
        state.leave();
        assert!(state.join(4));
    }
}
