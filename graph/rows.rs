//! Lists of different lengths in one piece of memory: compressed sparse rows.

use std::ops::{Index, Range};

/// Rows of items of different lengths, such as the neighbours of each node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rows<T> {
    /// Where each row starts in `items`, and the end of the last one.
    starts: Vec<u32>,
    items: Vec<T>,
}

impl<T> Rows<T> {
    /// `count` rows; a pair adds its item to the end of its row. A counting sort, which iterates the pairs twice. There are
    /// fewer than 2³² pairs.
    pub fn from_pairs(count: usize, pairs: impl Iterator<Item = (usize, T)> + Clone) -> Self
    where
        T: Clone + Default,
    {
        let mut starts = vec![0; count + 1];
        pairs.clone().for_each(|(row, _)| starts[row + 1] += 1);
        for row in 0..count {
            starts[row + 1] += starts[row];
        }
        let mut next = starts.clone();
        let mut items = vec![T::default(); starts[count] as usize];
        for (row, item) in pairs {
            items[next[row] as usize] = item;
            next[row] += 1;
        }
        Self { starts, items }
    }

    /// Adds a row.
    pub fn push(&mut self, row: impl IntoIterator<Item = T>) {
        self.items.extend(row);
        self.starts.push(self.items.len() as u32);
    }

    /// The same rows, each of them ascending.
    pub fn ascending(mut self) -> Self
    where
        T: Ord,
    {
        for row in 0..self.len() {
            let range = self.range(row);
            self.items[range].sort_unstable();
        }
        self
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Each row in turn.
    pub fn iter(&self) -> impl Iterator<Item = &[T]> {
        self.starts.windows(2).map(|ends| &self.items[ends[0] as usize..ends[1] as usize])
    }

    /// Where a row lies among all items.
    pub fn range(&self, row: usize) -> Range<usize> {
        self.starts[row] as usize..self.starts[row + 1] as usize
    }

    /// The items of all rows, row by row.
    pub fn items(&self) -> &[T] {
        &self.items
    }

    /// The items of all rows, row by row.
    pub fn into_items(self) -> Vec<T> {
        self.items
    }
}

impl<T> Default for Rows<T> {
    fn default() -> Self {
        Self { starts: vec![0], items: Vec::new() }
    }
}

impl<T> Index<usize> for Rows<T> {
    type Output = [T];

    fn index(&self, row: usize) -> &[T] {
        &self.items[self.range(row)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_keeps_the_order_of_its_items() {
        let rows = Rows::from_pairs(4, [(2, 'c'), (0, 'b'), (2, 'a'), (3, 'd'), (2, 'b')].into_iter());
        assert!(rows.iter().eq([&['b'][..], &[], &['c', 'a', 'b'], &['d']]));
        assert_eq!((rows.len(), rows.range(2), &rows[3]), (4, 1..4, &['d'][..]));
        assert_eq!(rows.ascending().into_items(), ['b', 'a', 'b', 'c', 'd']);
    }

    #[test]
    fn rows_may_be_added_one_by_one() {
        let mut rows = Rows::default();
        assert!(rows.is_empty());
        rows.push([1, 2]);
        rows.push([]);
        rows.push([3]);
        assert!(rows.iter().eq([&[1, 2][..], &[], &[3]]));
        assert_eq!(rows.items(), [1, 2, 3]);
    }
}
