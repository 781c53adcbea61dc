//! Disjoint sets of indices (Tarjan 1975): union by size, path halving.

/// A partition of `0..count`.
pub struct Sets {
    up: Vec<usize>,
    size: Vec<usize>,
}

impl Sets {
    /// Every index in a set of its own.
    pub fn new(count: usize) -> Self {
        Self { up: (0..count).collect(), size: vec![1; count] }
    }

    /// The representative of the set of this index.
    pub fn find(&mut self, mut index: usize) -> usize {
        while self.up[index] != index {
            self.up[index] = self.up[self.up[index]];
            index = self.up[index];
        }
        index
    }

    /// Unites the sets of two indices; returns whether they were different.
    pub fn unite(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        if a == b {
            return false;
        }
        let (small, large) = if self.size[a] < self.size[b] { (a, b) } else { (b, a) };
        self.up[small] = large;
        self.size[large] += self.size[small];
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_united_once() {
        let mut sets = Sets::new(5);
        let united = [[0, 1], [3, 4], [1, 0], [4, 0], [1, 3]].map(|[a, b]| sets.unite(a, b));
        assert_eq!(united, [true, true, false, true, false]);
        let one = sets.find(0);
        assert!([1, 3, 4].into_iter().all(|index| sets.find(index) == one));
        assert_eq!(sets.find(2), 2);
    }
}
