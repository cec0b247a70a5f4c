//! First in, first out.

use std::collections::VecDeque;

use super::Discipline;

/// Takes items in the order in which they came, whatever their labels.
#[derive(Clone, Debug)]
pub struct Fifo<T> {
    items: VecDeque<(f64, T)>,
}

impl<T> Default for Fifo<T> {
    fn default() -> Self {
        Self {
            items: VecDeque::new(),
        }
    }
}

impl<T: Send> Discipline<T> for Fifo<T> {
    #[inline]
    fn push(&mut self, label: f64, item: T) {
        self.items.push_back((label, item));
    }

    #[inline]
    fn pop(&mut self) -> Option<(f64, T)> {
        self.items.pop_front()
    }

    #[inline]
    fn len(&self) -> usize {
        self.items.len()
    }

    fn clear(&mut self) {
        self.items.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_of_arrival() {
        let mut fifo = Fifo::default();
        fifo.push(3.0, 'a');
        fifo.push(1.0, 'b');
        assert_eq!(fifo.len(), 2);
        assert_eq!(fifo.pop(), Some((3.0, 'a')));
        assert_eq!(fifo.pop(), Some((1.0, 'b')));
        assert_eq!(fifo.pop(), None);
    }
}
