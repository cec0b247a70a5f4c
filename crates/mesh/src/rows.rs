//! Rows of values, of which a few can be replaced.

use std::ops::Range;

/// Where the rows of a table stand in a list of values, for example the half-edges around each
/// vertex. Rows can be replaced and put back in O(1) each: a new row is appended to the values, and
/// the old one stays where it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RowTable {
    ranges: Vec<[u32; 2]>,
    /// What [`replace`](Self::replace) has replaced, and nothing has put back.
    replaced: Vec<Replaced>,
}

#[derive(Clone, Debug, PartialEq)]
struct Replaced {
    /// Number of rows and of values before.
    rows: usize,
    values: usize,
    ranges: Vec<(usize, [u32; 2])>,
}

impl RowTable {
    /// Rows that follow each other: row i is from `starts[i]` to `starts[i + 1]`.
    pub fn of_starts(starts: &[u32]) -> Self {
        let ranges = starts.windows(2).map(|pair| [pair[0], pair[1]]);
        Self {
            ranges: ranges.collect(),
            replaced: Vec::new(),
        }
    }

    /// The place of row `i` in the values.
    #[inline]
    pub fn range(&self, i: usize) -> Range<usize> {
        let [start, end] = self.ranges[i];
        start as usize..end as usize
    }

    /// The places of all rows.
    pub fn ranges(&self) -> impl ExactSizeIterator<Item = Range<usize>> {
        let range = |&[start, end]: &[u32; 2]| start as usize..end as usize;
        self.ranges.iter().map(range)
    }

    /// Replaces the rows of `lengths`, numbers and lengths, by rows that are appended to `values`
    /// values. Afterwards there are `count` rows; those that are added must be among them.
    pub fn replace(
        &mut self,
        count: usize,
        values: usize,
        lengths: impl Iterator<Item = (usize, usize)>,
    ) {
        let mut replaced = Replaced {
            rows: self.ranges.len(),
            values,
            ranges: Vec::new(),
        };
        let removed = (count..self.ranges.len()).map(|i| (i, self.ranges[i]));
        replaced.ranges.extend(removed);
        self.ranges.resize(count, [0; 2]);
        let mut end = values as u32;
        for (i, length) in lengths {
            let start = end;
            end += length as u32;
            if i < replaced.rows {
                replaced.ranges.push((i, self.ranges[i]));
            }
            self.ranges[i] = [start, end];
        }
        self.replaced.push(replaced);
    }

    /// Puts back what was [replaced](Self::replace) last, after which there are `count` rows.
    /// Returns the number of values then, to which they are to be cut; `None` if nothing was
    /// replaced, and nothing changes.
    pub fn put_back(&mut self, count: usize) -> Option<usize> {
        let last = self.replaced.pop_if(|last| last.rows == count)?;
        self.ranges.resize(count, [0; 2]);
        for (i, range) in last.ranges {
            self.ranges[i] = range;
        }
        Some(last.values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_replaced_added_removed_and_put_back() {
        let mut values = vec![1, 2, 3, 4, 5];
        let mut rows = RowTable::of_starts(&[0, 2, 3, 3, 5]);
        let content = |rows: &RowTable, values: &[i32]| -> Vec<Vec<i32>> {
            rows.ranges().map(|range| values[range].to_vec()).collect()
        };
        let first = content(&rows, &values);
        rows.replace(5, values.len(), [(1, 3), (4, 1)].into_iter());
        values.extend([6, 7, 8, 9]);
        let second = content(&rows, &values);
        assert_eq!(second, [&[1, 2][..], &[6, 7, 8], &[], &[4, 5], &[9]]);
        rows.replace(3, values.len(), [(2, 2)].into_iter());
        values.extend([10, 11]);
        let third = content(&rows, &values);
        assert_eq!(third, [&[1, 2][..], &[6, 7, 8], &[10, 11]]);
        for before in [second, first] {
            values.truncate(rows.put_back(before.len()).unwrap());
            assert_eq!(content(&rows, &values), before);
        }
        assert_eq!((values.len(), rows.put_back(4)), (5, None));
    }
}
