//! The levels in the sequence tree of the windows that wait.

use std::collections::HashMap;

use crate::list::{Entry, WindowList};

/// How many triangles the ancestors of each waiting window have crossed.
///
/// Trimming needs no levels; they are counted because the papers count them. So they are kept in
/// counted runs only, beside the lists, where they cost the stored windows nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Levels {
    of_waiting: HashMap<u32, u32>,
    /// The windows that waited in the list before an insertion.
    before: Vec<u32>,
}

impl Levels {
    /// Number of windows that wait.
    pub(crate) fn len(&self) -> usize {
        self.of_waiting.len()
    }

    pub(crate) fn clear(&mut self) {
        self.of_waiting.clear();
    }

    /// To be called before a window is inserted into `list`.
    pub(crate) fn before_insertion(&mut self, list: &WindowList) {
        self.before.clear();
        self.before.extend(list.waiting());
    }

    /// To be called after a window of this level has been inserted, with what there is to queue.
    pub(crate) fn after_insertion(&mut self, list: &WindowList, entries: &[Entry], level: u32) {
        for entry in entries {
            let level = entry.part_of.map_or(level, |id| self.of_waiting[&id]);
            self.of_waiting.insert(entry.id, level);
        }
        for id in &self.before {
            if !list.waiting().any(|waiting| waiting == *id) {
                self.of_waiting.remove(id);
            }
        }
    }

    /// The turn of window `id` has come.
    pub(crate) fn take(&mut self, id: u32) -> u32 {
        self.of_waiting.remove(&id).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use geobench_window::Window;

    use super::*;
    use crate::list::{Direction, Inserter};

    fn window(b0: f64, b1: f64, px: f64, py: f64) -> Window {
        Window {
            b0,
            b1,
            px,
            py,
            sigma: 0.0,
        }
    }

    #[test]
    fn parts_keep_their_level_and_what_is_gone_does_not_wait() {
        let (mut list, mut inserter) = (WindowList::default(), Inserter::default());
        let mut levels = Levels::default();
        let mut insert = |levels: &mut Levels, window: Window, level: u32| {
            levels.before_insertion(&list);
            inserter.insert(&mut list, &window, Direction::Forward, 1.0);
            levels.after_insertion(&list, &inserter.to_queue, level);
            inserter.to_queue.clone()
        };
        let whole = insert(&mut levels, window(0.0, 1.0, 0.5, -2.0), 3);
        let parts = insert(&mut levels, window(0.4, 0.6, 0.5, -1.0), 7);
        assert_eq!((whole.len(), parts.len(), levels.len()), (1, 3, 3));
        let of_parts: Vec<u32> = parts.iter().map(|part| levels.take(part.id)).collect();
        assert_eq!(of_parts, [3, 7, 3]);
        insert(&mut levels, window(0.0, 0.3, 0.2, -0.5), 1);
        assert_eq!(levels.len(), 1);
        insert(&mut levels, window(0.0, 1.0, 0.2, -0.1), 2);
        assert_eq!(levels.len(), 1, "the one of level 1 is gone");
    }
}
