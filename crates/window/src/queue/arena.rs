//! Linked lists of events in one array.

use super::Event;
use crate::blocks::number;
use crate::prefetch::prefetch;

/// No link.
const NONE: u32 = u32::MAX;

/// An event and its successor in its chain or in the free list.
#[derive(Clone, Copy, Debug)]
struct ArenaSlot {
    label: f64,
    event: Event,
    next: u32,
}

/// A first-in, first-out list in an [`Arena`].
#[derive(Clone, Copy, Debug)]
pub struct Chain {
    pub(super) head: u32,
    tail: u32,
    len: u32,
}

impl Chain {
    /// A chain without events.
    pub const EMPTY: Self = Self {
        head: NONE,
        tail: NONE,
        len: 0,
    };

    /// Number of events.
    #[inline]
    pub fn len(self) -> usize {
        self.len as usize
    }

    /// Whether it has no event.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.tail == NONE
    }
}

/// The events of any number of chains. Freed links are reused, so the arena allocates as many links
/// as are in use at one time.
///
/// ```
/// use geobench_mesh::VertexId;
/// use geobench_window::queue::{Arena, Chain, Event};
///
/// let event = Event::vertex(VertexId::new(4));
/// let (mut arena, mut chain) = (Arena::default(), Chain::EMPTY);
/// arena.append(&mut chain, 2.5, event);
/// assert_eq!(arena.take(&mut chain), Some((2.5, event)));
/// assert!(chain.is_empty());
/// ```
#[derive(Clone, Debug)]
pub struct Arena {
    links: Vec<ArenaSlot>,
    free: u32,
    len: usize,
}

impl Default for Arena {
    fn default() -> Self {
        Self {
            links: Vec::new(),
            free: NONE,
            len: 0,
        }
    }
}

impl Arena {
    /// Number of events in all chains.
    #[inline]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether all chains are empty.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Appends an event to `chain`.
    #[inline(always)]
    #[allow(clippy::inline_always)] // Keeps the event in registers.
    pub fn append(&mut self, chain: &mut Chain, label: f64, event: Event) {
        self.len += 1;
        let mut place = self.free;
        if let Some(free) = self.links.get_mut(place as usize) {
            self.free = free.next;
            free.label = label;
            free.event = event;
            free.next = NONE;
        } else {
            place = self.lengthen(label, event);
        }
        // Half of all buckets are empty: a branch on that would be mispredicted.
        let last = self.links.get_mut(chain.tail as usize);
        *last.map_or(&mut chain.head, |last| &mut last.next) = place;
        chain.tail = place;
        chain.len += 1;
    }

    /// Adds a link to the array.
    #[cold]
    #[inline(never)]
    fn lengthen(&mut self, label: f64, event: Event) -> u32 {
        self.links.push(ArenaSlot {
            label,
            event,
            next: NONE,
        });
        number(self.links.len() - 1)
    }

    /// The events of `chain` with their labels, in the order in which they are taken.
    #[inline]
    pub fn chained(&self, chain: Chain) -> impl Iterator<Item = (f64, Event)> {
        let mut next = chain.head;
        std::iter::from_fn(move || {
            let link = self.links.get(next as usize)?;
            next = link.next;
            Some((link.label, link.event))
        })
    }

    /// Takes the first event of `chain`, with its label.
    #[inline]
    pub fn take(&mut self, chain: &mut Chain) -> Option<(f64, Event)> {
        let place = chain.head;
        let link = self.links.get_mut(place as usize)?;
        chain.head = link.next;
        if link.next == NONE {
            chain.tail = NONE;
        }
        chain.len -= 1;
        link.next = self.free;
        self.free = place;
        self.len -= 1;
        Some((link.label, link.event))
    }

    /// Prefetches the first event of `chain`.
    #[inline]
    pub(crate) fn announce(&self, chain: Chain) {
        prefetch(&self.links, chain.head as usize);
    }

    /// Moves `place` to the next link of its chain and prefetches that link. The link at `place`
    /// should have been prefetched some time ago.
    ///
    /// Results do not depend on it. If the link has been freed since, some other link is
    /// prefetched.
    #[inline]
    pub(crate) fn walk(&self, place: &mut u32) {
        if let Some(link) = self.links.get(*place as usize) {
            *place = link.next;
            prefetch(&self.links, link.next as usize);
        }
    }

    /// Moves all events of `chain` behind those in `to`.
    #[inline]
    pub fn drain(&mut self, chain: &mut Chain, to: &mut Vec<(f64, Event)>) {
        // The count ends the loop before the last link has been loaded, so the processor can go on
        // with the code that follows.
        let mut next = chain.head;
        to.extend((0..chain.len).map(|_| {
            let link = &self.links[next as usize];
            next = link.next;
            (link.label, link.event)
        }));
        self.len -= chain.len as usize;
        if let Some(last) = self.links.get_mut(chain.tail as usize) {
            last.next = self.free;
            self.free = chain.head;
        }
        *chain = Chain::EMPTY;
    }

    /// Moves all events of `from` behind those of `to`, in constant time.
    pub fn join(&mut self, to: &mut Chain, from: &mut Chain) {
        if from.is_empty() {
            return;
        }
        if to.is_empty() {
            *to = *from;
        } else {
            self.links[to.tail as usize].next = from.head;
            to.tail = from.tail;
            to.len += from.len;
        }
        *from = Chain::EMPTY;
    }

    /// The events of all chains with their labels, in no order.
    pub fn events(&self) -> impl Iterator<Item = (f64, Event)> {
        let mut is_free = vec![false; self.links.len()];
        let mut next = self.free;
        while let Some(link) = self.links.get(next as usize) {
            is_free[next as usize] = true;
            next = link.next;
        }
        let links = self.links.iter().zip(is_free);
        links
            .filter(|(_, is_free)| !is_free)
            .map(|(link, _)| (link.label, link.event))
    }

    /// Removes all events, keeping the memory. Every chain must be set to [`Chain::EMPTY`] as well.
    pub fn clear(&mut self) {
        self.links.clear();
        self.free = NONE;
        self.len = 0;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use geobench_mesh::{HalfEdgeId, VertexId};
    use proptest::prelude::*;

    use super::*;

    fn event(id: u32) -> Event {
        Event::window(HalfEdgeId::new(0), id)
    }

    #[derive(Clone, Copy, Debug)]
    enum Step {
        Append(usize),
        Take(usize),
        Join(usize, usize),
    }

    fn steps() -> impl Strategy<Value = Vec<Step>> {
        let step = (0..4u8, 0..3usize, 1..3usize).prop_map(|(kind, to, by)| match kind {
            0 | 1 => Step::Append(to),
            2 => Step::Take(to),
            _ => Step::Join(to, (to + by) % 3),
        });
        prop::collection::vec(step, 0..200)
    }

    proptest! {
        #[test]
        fn chains_are_queues(steps in steps()) {
            let mut arena = Arena::default();
            let mut chains = [Chain::EMPTY; 3];
            let mut queues: [VecDeque<u32>; 3] = Default::default();
            for (id, step) in (0u32..).zip(steps) {
                match step {
                    Step::Append(to) => {
                        arena.append(&mut chains[to], f64::from(id), event(id));
                        queues[to].push_back(id);
                    }
                    Step::Take(from) => {
                        let coming: Vec<_> = arena.chained(chains[from]).collect();
                        let waiting = queues[from].iter();
                        let waiting: Vec<_> = waiting.map(|&id| (f64::from(id), event(id))).collect();
                        prop_assert_eq!(coming, waiting);
                        let expected = queues[from].pop_front().map(|id| (f64::from(id), event(id)));
                        prop_assert_eq!(arena.take(&mut chains[from]), expected);
                    }
                    Step::Join(to, from) => {
                        let mut source = chains[from];
                        arena.join(&mut chains[to], &mut source);
                        chains[from] = source;
                        let moved = std::mem::take(&mut queues[from]);
                        queues[to].extend(moved);
                    }
                }
                let mut waiting: Vec<f64> = queues.iter().flatten().map(|&id| f64::from(id)).collect();
                waiting.sort_by(f64::total_cmp);
                let mut labels: Vec<f64> = arena.events().map(|(label, _)| label).collect();
                labels.sort_by(f64::total_cmp);
                prop_assert_eq!(labels, waiting);
            }
            for (chain, queue) in chains.iter_mut().zip(&mut queues) {
                let mut drained = Vec::new();
                arena.drain(chain, &mut drained);
                let expected: Vec<_> = queue.drain(..).map(|id| (f64::from(id), event(id))).collect();
                prop_assert_eq!(drained, expected);
            }
            prop_assert!(arena.is_empty());
        }
    }

    #[test]
    fn vertices_wait_among_windows() {
        let (mut arena, mut chain) = (Arena::default(), Chain::EMPTY);
        arena.append(&mut chain, 1.0, Event::vertex(VertexId::new(3)));
        arena.append(&mut chain, 2.0, event(0));
        let windows = arena.events().filter(|(_, event)| event.is_window());
        assert_eq!(windows.collect::<Vec<_>>(), [(2.0, event(0))]);
        assert_eq!(arena.len(), 2);
    }

    #[test]
    fn links_are_reused() {
        let (mut arena, mut chain) = (Arena::default(), Chain::EMPTY);
        for round in 0..100 {
            for id in 0..21 {
                arena.append(&mut chain, f64::from(id), event(round));
            }
            while arena.take(&mut chain).is_some() {}
        }
        assert_eq!(arena.links.len(), 21);
        assert_eq!(size_of::<ArenaSlot>(), 24);
    }
}
