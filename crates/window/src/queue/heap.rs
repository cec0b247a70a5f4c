//! A priority queue: least label first.

use super::Discipline;

/// Children of a node. Four make the heap half as deep as two, and lie in one or two cache lines.
const ARITY: usize = 4;

/// A 4-ary heap of items by label, equal labels by item, so that no two distinct entries are ever
/// taken for the same and the order is the same in every run. Entries cannot be removed or
/// changed: push anew, and skip what is outdated when it comes out.
#[derive(Clone, Debug)]
pub struct Heap<T> {
    nodes: Vec<(f64, T)>,
}

impl<T> Default for Heap<T> {
    fn default() -> Self {
        Self { nodes: Vec::new() }
    }
}

#[inline]
fn precedes<T: Ord>(x: &(f64, T), y: &(f64, T)) -> bool {
    x.0 < y.0 || x.0 == y.0 && x.1 < y.1
}

impl<T: Ord + Copy + Send> Discipline<T> for Heap<T> {
    #[inline]
    fn push(&mut self, label: f64, item: T) {
        let node = (label, item);
        let mut hole = self.nodes.len();
        self.nodes.push(node);
        while hole > 0 {
            let parent = (hole - 1) / ARITY;
            if !precedes(&node, &self.nodes[parent]) {
                break;
            }
            self.nodes[hole] = self.nodes[parent];
            hole = parent;
        }
        self.nodes[hole] = node;
    }

    #[inline]
    fn pop(&mut self) -> Option<(f64, T)> {
        let last = self.nodes.pop()?;
        let Some(&least) = self.nodes.first() else {
            return Some(last);
        };
        let mut hole = 0;
        loop {
            let first = ARITY * hole + 1;
            let children = first..(first + ARITY).min(self.nodes.len());
            let Some(child) = children.reduce(|x, y| {
                if precedes(&self.nodes[y], &self.nodes[x]) {
                    y
                } else {
                    x
                }
            }) else {
                break;
            };
            if !precedes(&self.nodes[child], &last) {
                break;
            }
            self.nodes[hole] = self.nodes[child];
            hole = child;
        }
        self.nodes[hole] = last;
        Some(least)
    }

    #[inline]
    fn len(&self) -> usize {
        self.nodes.len()
    }

    fn clear(&mut self) {
        self.nodes.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn takes_in_sorted_order(labels in prop::collection::vec(0u8..20, 0..200)) {
            let mut heap = Heap::default();
            for (i, &label) in labels.iter().enumerate() {
                heap.push(f64::from(label), i);
            }
            let mut expected: Vec<_> = labels.iter().map(|&x| f64::from(x)).zip(0..).collect();
            expected.sort_by(|x, y| x.partial_cmp(y).unwrap());
            let taken: Vec<_> = std::iter::from_fn(|| heap.pop()).collect();
            prop_assert_eq!(taken, expected);
        }
    }

    #[test]
    fn equal_labels_lose_nothing() {
        let mut heap = Heap::default();
        for item in 0..100 {
            heap.push(1.0, item);
        }
        let taken: Vec<i32> = std::iter::from_fn(|| heap.pop())
            .map(|(_, item)| item)
            .collect();
        assert_eq!(taken, (0..100).collect::<Vec<_>>());
    }
}
