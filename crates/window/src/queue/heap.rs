//! A heap of labelled items.

/// Children of a node. With four the heap is half as deep as with two, and the children of a node
/// lie in one or two cache lines.
const ARITY: usize = 4;

/// A 4-ary min-heap of labelled items. The order of items with equal labels depends on the
/// insertions alone, so it is the same in every run. With `TIES`, equal labels are ordered by their
/// items. Entries cannot be removed or changed: push a new entry, and skip outdated ones when they
/// are popped.
///
/// ```
/// use geobench_window::queue::MinHeap;
///
/// let mut heap = MinHeap::default();
/// heap.push(2.0, "far");
/// heap.push(1.0, "near");
/// assert_eq!(heap.pop(), Some((1.0, "near")));
/// ```
#[derive(Clone, Debug)]
pub struct QuaternaryHeap<T, const TIES: bool> {
    nodes: Vec<(f64, T)>,
}

/// A [`QuaternaryHeap`] without an order of equal labels.
pub type MinHeap<T> = QuaternaryHeap<T, false>;

impl<T, const TIES: bool> Default for QuaternaryHeap<T, TIES> {
    fn default() -> Self {
        Self { nodes: Vec::new() }
    }
}

impl<T: Copy + PartialOrd, const TIES: bool> QuaternaryHeap<T, TIES> {
    /// Adds `item` with its label, which must not be NaN.
    #[inline]
    pub fn push(&mut self, label: f64, item: T) {
        self.nodes.push((label, item));
        self.rise(self.nodes.len() - 1, (label, item));
    }

    /// Takes an item of least label.
    #[inline]
    pub fn pop(&mut self) -> Option<(f64, T)> {
        let last = self.nodes.pop()?;
        let Some(&least) = self.nodes.first() else {
            return Some(last);
        };
        // The last node nearly always belongs near the bottom. So the hole sinks to the bottom
        // first, and the node rises from there, which saves comparisons with it on the way down.
        let mut hole = 0;
        while let Some(child) = self.least_child(hole) {
            self.nodes[hole] = self.nodes[child];
            hole = child;
        }
        self.rise(hole, last);
        Some(least)
    }

    /// The item that [`pop`](Self::pop) would take.
    #[inline]
    pub fn peek(&self) -> Option<(f64, T)> {
        self.nodes.first().copied()
    }

    /// Number of items.
    #[inline]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether no item is left.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// All items with their labels, in no order.
    pub fn iter(&self) -> impl Iterator<Item = &(f64, T)> {
        self.nodes.iter()
    }

    /// Drops all items, keeping the memory.
    pub fn clear(&mut self) {
        self.nodes.clear();
    }

    /// Moves the hole towards the root until `node` fits into it.
    #[inline]
    fn rise(&mut self, mut hole: usize, node: (f64, T)) {
        while hole > 0 {
            let parent = (hole - 1) / ARITY;
            if !Self::is_before(node, self.nodes[parent]) {
                break;
            }
            self.nodes[hole] = self.nodes[parent];
            hole = parent;
        }
        self.nodes[hole] = node;
    }

    /// The least child of `hole`. Which one it is cannot be predicted, so four children are
    /// compared without branches.
    #[inline]
    fn least_child(&self, hole: usize) -> Option<usize> {
        let first = ARITY * hole + 1;
        let end = (first + ARITY).min(self.nodes.len());
        if let Some(&[a, b, c, d]) = self.nodes.get(first..first + ARITY) {
            let low = usize::from(Self::is_before(b, a));
            let high = 2 + usize::from(Self::is_before(d, c));
            let is_high = if TIES {
                Self::is_before(self.nodes[first + high], self.nodes[first + low])
            } else {
                c.0.min(d.0) < a.0.min(b.0)
            };
            return Some(first + std::hint::select_unpredictable(is_high, high, low));
        }
        (first..end).reduce(|x, y| {
            if Self::is_before(self.nodes[y], self.nodes[x]) {
                y
            } else {
                x
            }
        })
    }

    /// Whether `a` comes before `b`.
    #[inline]
    fn is_before(a: (f64, T), b: (f64, T)) -> bool {
        a.0 < b.0 || TIES && a.0 == b.0 && a.1 < b.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn takes_in_sorted_order(labels in prop::collection::vec(0u8..20, 0..200)) {
            let mut heap = MinHeap::default();
            for (i, &label) in labels.iter().enumerate() {
                heap.push(f64::from(label), i);
            }
            let mut expected = labels.clone();
            expected.sort_unstable();
            let mut taken: Vec<_> = std::iter::from_fn(|| heap.pop()).collect();
            prop_assert!(taken.iter().map(|x| x.0).eq(expected.into_iter().map(f64::from)));
            taken.sort_unstable_by_key(|x| x.1);
            prop_assert!(taken.iter().map(|x| x.0).eq(labels.into_iter().map(f64::from)));
        }
    }

    #[test]
    fn equal_labels_lose_nothing() {
        let mut heap = MinHeap::default();
        for item in 0..100 {
            heap.push(1.0, item);
        }
        let mut taken: Vec<i32> = std::iter::from_fn(|| heap.pop())
            .map(|(_, item)| item)
            .collect();
        taken.sort_unstable();
        assert_eq!(taken, (0..100).collect::<Vec<_>>());
    }
}
