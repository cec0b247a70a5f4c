//! Connected sets (union-find).

/// A partition of `0..n` whose sets can only be joined (union-find).
///
/// ```
/// use geobench_mesh::DisjointSets;
///
/// let mut sets = DisjointSets::new(4);
/// sets.union(3, 1);
/// assert_eq!((sets.find(3), sets.count()), (1, 3));
/// ```
#[derive(Clone, Debug, Default)]
pub struct DisjointSets {
    parents: Vec<u32>,
}

impl DisjointSets {
    /// `n` sets of one element each. `n` must be at most 2³².
    pub fn new(n: usize) -> Self {
        Self {
            parents: (0..n as u32).collect(),
        }
    }

    /// The partition given by the parent of each element, which must not be greater than the
    /// element.
    pub fn of(parents: Vec<u32>) -> Self {
        Self { parents }
    }

    /// The smallest element of the set of `x`.
    ///
    /// # Panics
    ///
    /// If there is no such element.
    pub fn find(&mut self, mut x: u32) -> u32 {
        loop {
            let parent = self.parents[x as usize];
            if parent == x {
                return x;
            }
            // Path halving, which makes later searches shorter.
            let grandparent = self.parents[parent as usize];
            self.parents[x as usize] = grandparent;
            x = grandparent;
        }
    }

    /// Joins the sets of `x` and `y`.
    ///
    /// # Panics
    ///
    /// If there is no such element.
    pub fn union(&mut self, x: u32, y: u32) {
        let (x, y) = (self.find(x), self.find(y));
        self.parents[x.max(y) as usize] = x.min(y);
    }

    /// Adds a set of one new element, and returns the element.
    pub fn add(&mut self) -> u32 {
        let new = self.parents.len() as u32;
        self.parents.push(new);
        new
    }

    /// Number of sets.
    pub fn count(&self) -> usize {
        let is_root = |(x, &parent): (usize, &u32)| x == parent as usize;
        self.parents
            .iter()
            .enumerate()
            .filter(|&p| is_root(p))
            .count()
    }
}

#[cfg(test)]
mod tests {
    use super::DisjointSets;

    #[test]
    fn joined_elements_share_their_smallest_member() {
        let mut sets = DisjointSets::new(6);
        for (x, y) in [(5, 3), (3, 1), (4, 2), (1, 5)] {
            sets.union(x, y);
        }
        let roots: Vec<u32> = (0..6).map(|x| sets.find(x)).collect();
        assert_eq!(roots, [0, 1, 2, 1, 2, 1]);
        assert_eq!(sets.count(), 3);
    }
}
