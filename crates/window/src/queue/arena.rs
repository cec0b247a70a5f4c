//! Queues of events whose links lie in one array.

use super::Event;

/// No chunk.
const NONE: u32 = u32::MAX;

/// Events of a chunk: as many as two cache lines hold.
const ROOM: usize = 7;

/// Consecutive events of one chain.
#[derive(Clone, Copy, Debug)]
#[repr(align(128))]
struct Chunk {
    /// The chunk behind it, in its chain or among the free ones.
    next: u32,
    /// Which of the events are there; none in a chunk that is free.
    start: u16,
    end: u16,
    events: [(f64, Event); ROOM],
}

impl Chunk {
    fn events(&self) -> &[(f64, Event)] {
        &self.events[usize::from(self.start)..usize::from(self.end)]
    }
}

/// A queue in an [`Arena`], first in, first out.
#[derive(Clone, Copy, Debug)]
pub struct Chain {
    head: u32,
    /// Means nothing while `head` is [`NONE`].
    tail: u32,
}

impl Chain {
    /// Without any event.
    pub const EMPTY: Self = Self {
        head: NONE,
        tail: NONE,
    };

    /// Whether it has no event.
    pub fn is_empty(self) -> bool {
        self.head == NONE
    }
}

/// The events of any number of chains, seven of one chain in a chunk of 128 bytes. A chunk that
/// becomes empty goes to the next chain that needs one, so that as many are ever taken from the
/// allocator as are needed at one time.
#[derive(Clone, Debug)]
pub struct Arena {
    chunks: Vec<Chunk>,
    free: u32,
    len: usize,
}

impl Default for Arena {
    fn default() -> Self {
        Self {
            chunks: Vec::new(),
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
    #[allow(clippy::inline_always)] // Its events are not to pass through memory on their way.
    pub fn append(&mut self, chain: &mut Chain, label: f64, event: Event) {
        self.len += 1;
        if !chain.is_empty() {
            let tail = &mut self.chunks[chain.tail as usize];
            let end = usize::from(tail.end);
            if let Some(place) = tail.events.get_mut(end) {
                *place = (label, event);
                tail.end += 1;
                return;
            }
        }
        self.lengthen(chain, label, event);
    }

    /// Appends an event in a chunk of its own.
    fn lengthen(&mut self, chain: &mut Chain, label: f64, event: Event) {
        let chunk = Chunk {
            next: NONE,
            start: 0,
            end: 1,
            events: [(label, event); ROOM],
        };
        let place = self.free;
        let place = if place == NONE {
            self.chunks.push(chunk);
            (self.chunks.len() - 1) as u32
        } else {
            let free = &mut self.chunks[place as usize];
            self.free = free.next;
            *free = chunk;
            place
        };
        if chain.is_empty() {
            chain.head = place;
        } else {
            self.chunks[chain.tail as usize].next = place;
        }
        chain.tail = place;
    }

    /// The event that is taken from `chain` after `skipped` others, if it is near enough to tell
    /// without following the chain: the next six or so can be told.
    #[inline]
    pub fn upcoming(&self, chain: Chain, skipped: usize) -> Option<Event> {
        let head = self.chunks.get(chain.head as usize)?;
        let events = head.events();
        let event = events.get(skipped).or_else(|| {
            let next = self.chunks.get(head.next as usize)?;
            next.events().get(skipped - events.len())
        });
        event.map(|&(_, event)| event)
    }

    /// Takes the first event of `chain`, with its label.
    #[inline]
    pub fn take(&mut self, chain: &mut Chain) -> Option<(f64, Event)> {
        let chunk = self.chunks.get_mut(chain.head as usize)?;
        let taken = chunk.events[usize::from(chunk.start)];
        chunk.start += 1;
        self.len -= 1;
        if chunk.start == chunk.end {
            let emptied = chain.head;
            chain.head = chunk.next;
            self.release(emptied);
        }
        Some(taken)
    }

    /// Takes all events of `chain`.
    #[inline]
    pub fn drain(&mut self, chain: &mut Chain, mut to: impl FnMut(&[(f64, Event)])) {
        while let Some(chunk) = self.chunks.get(chain.head as usize) {
            let emptied = chain.head;
            let events = chunk.events();
            to(events);
            self.len -= events.len();
            chain.head = chunk.next;
            self.release(emptied);
        }
    }

    #[inline]
    fn release(&mut self, place: u32) {
        let chunk = &mut self.chunks[place as usize];
        (chunk.start, chunk.end) = (0, 0);
        chunk.next = self.free;
        self.free = place;
    }

    /// Moves all events of `from` behind those of `to`, in constant time.
    pub fn join(&mut self, to: &mut Chain, from: &mut Chain) {
        if from.is_empty() {
            return;
        }
        if to.is_empty() {
            *to = *from;
        } else {
            self.chunks[to.tail as usize].next = from.head;
            to.tail = from.tail;
        }
        *from = Chain::EMPTY;
    }

    /// The events of all chains with their labels, in no order.
    pub fn events(&self) -> impl Iterator<Item = (f64, Event)> {
        self.chunks.iter().flat_map(Chunk::events).copied()
    }

    /// Forgets all events, keeping the memory; every chain must be made empty too.
    pub fn clear(&mut self) {
        self.chunks.clear();
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
        fn chains_are_queues_and_nodes_are_reused(steps in steps()) {
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
                        for ahead in 0..ROOM {
                            let upcoming = arena.upcoming(chains[from], ahead);
                            let expected = queues[from].get(ahead).map(|&id| event(id));
                            prop_assert!(upcoming == expected || upcoming.is_none());
                            prop_assert!(upcoming == expected || ahead > 0);
                        }
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
                arena.drain(chain, |events| drained.extend(events.iter().map(|&(_, event)| event)));
                let expected: Vec<_> = queue.drain(..).map(event).collect();
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
    fn chunks_are_reused() {
        let (mut arena, mut chain) = (Arena::default(), Chain::EMPTY);
        for round in 0..100 {
            for id in 0..3 * ROOM as u32 {
                arena.append(&mut chain, f64::from(id), event(round));
            }
            while arena.take(&mut chain).is_some() {}
        }
        assert_eq!(arena.chunks.len(), 3);
        assert_eq!(size_of::<Chunk>(), 128);
    }
}
