//! Queues of events whose links lie in one array.

use super::Event;

/// No node.
const NONE: u32 = u32::MAX;

/// An event in its queue, 24 bytes.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// NaN in a node that is free.
    label: f64,
    event: Event,
    birth: u32,
    /// The node behind it, in its queue or among the free ones.
    next: u32,
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

/// The nodes of any number of chains. A node that is left goes to the next event that comes, so
/// as many nodes are ever taken from the allocator as events wait at one time.
#[derive(Clone, Debug)]
pub struct Arena {
    nodes: Vec<Node>,
    free: u32,
    len: usize,
}

impl Default for Arena {
    fn default() -> Self {
        Self {
            nodes: Vec::new(),
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
    #[inline]
    pub fn append(&mut self, chain: &mut Chain, label: f64, event: Event, birth: u32) {
        let node = Node {
            label,
            event,
            birth,
            next: NONE,
        };
        let place = self.place(node);
        if chain.is_empty() {
            chain.head = place;
        } else {
            self.nodes[chain.tail as usize].next = place;
        }
        chain.tail = place;
        self.len += 1;
    }

    #[inline]
    fn place(&mut self, node: Node) -> u32 {
        let place = self.free;
        if place == NONE {
            self.nodes.push(node);
            (self.nodes.len() - 1) as u32
        } else {
            let free = &mut self.nodes[place as usize];
            self.free = free.next;
            *free = node;
            place
        }
    }

    /// The birth of the first event of `chain`.
    #[inline]
    pub fn first_birth(&self, chain: Chain) -> Option<u32> {
        (!chain.is_empty()).then(|| self.nodes[chain.head as usize].birth)
    }

    /// The first event of `chain`.
    #[inline]
    pub fn first(&self, chain: Chain) -> Option<Event> {
        (!chain.is_empty()).then(|| self.nodes[chain.head as usize].event)
    }

    /// Takes the first event of `chain`, with its label.
    #[inline]
    pub fn take(&mut self, chain: &mut Chain) -> Option<(f64, Event)> {
        if chain.is_empty() {
            return None;
        }
        let place = chain.head;
        let node = &mut self.nodes[place as usize];
        let taken = (node.label, node.event);
        chain.head = node.next;
        node.label = f64::NAN;
        node.next = self.free;
        self.free = place;
        self.len -= 1;
        Some(taken)
    }

    /// Moves all events of `from` behind those of `to`, in constant time.
    pub fn join(&mut self, to: &mut Chain, from: &mut Chain) {
        if from.is_empty() {
            return;
        }
        if to.is_empty() {
            *to = *from;
        } else {
            self.nodes[to.tail as usize].next = from.head;
            to.tail = from.tail;
        }
        *from = Chain::EMPTY;
    }

    /// The labels of the windows in all chains, in no order.
    pub fn window_labels(&self) -> impl Iterator<Item = f64> {
        self.nodes
            .iter()
            .filter(|node| !node.label.is_nan() && node.event.is_window())
            .map(|node| node.label)
    }

    /// Forgets all events, keeping the memory; every chain must be made empty too.
    pub fn clear(&mut self) {
        self.nodes.clear();
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
            let mut most = 0;
            for (id, step) in (0u32..).zip(steps) {
                match step {
                    Step::Append(to) => {
                        arena.append(&mut chains[to], f64::from(id), event(id), id);
                        queues[to].push_back(id);
                    }
                    Step::Take(from) => {
                        prop_assert_eq!(arena.first_birth(chains[from]), queues[from].front().copied());
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
                most = most.max(arena.len());
                let mut waiting: Vec<f64> = queues.iter().flatten().map(|&id| f64::from(id)).collect();
                waiting.sort_by(f64::total_cmp);
                let mut labels: Vec<f64> = arena.window_labels().collect();
                labels.sort_by(f64::total_cmp);
                prop_assert_eq!(labels, waiting);
            }
            prop_assert!(arena.nodes.len() == most);
        }
    }

    #[test]
    fn labels_are_those_of_windows_only() {
        let (mut arena, mut chain) = (Arena::default(), Chain::EMPTY);
        arena.append(&mut chain, 1.0, Event::vertex(VertexId::new(3)), 0);
        arena.append(&mut chain, 2.0, event(0), 0);
        assert_eq!(arena.window_labels().collect::<Vec<_>>(), [2.0]);
        assert_eq!(arena.len(), 2);
    }
}
