//! Which nodes are joined to which.

use std::collections::VecDeque;
use std::mem;
use std::ops::Index;

use super::Rows;

/// The neighbours of every node, each list ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Neighbors(Rows<usize>);

impl Neighbors {
    /// The neighbours of so many nodes along these edges.
    pub fn of(nodes: usize, edges: &[[usize; 2]]) -> Self {
        let both_ways = edges.iter().flat_map(|&[a, b]| [(a, b), (b, a)]);
        Self(Rows::from_pairs(nodes, both_ways).ascending())
    }

    /// Nodes, with neighbours or without.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The neighbours of each node, in the order of the nodes.
    pub fn iter(&self) -> impl Iterator<Item = &[usize]> {
        self.0.iter()
    }

    /// The number of neighbours of each node.
    pub fn degrees(&self) -> impl Iterator<Item = usize> {
        self.iter().map(<[usize]>::len)
    }

    /// What can be reached from the starts, breadth first: each node once, after the one it was reached from, and that one.
    /// A start has none, and is passed over where it was reached from an earlier one.
    pub fn by_breadth(&self, starts: impl IntoIterator<Item = usize>) -> impl Iterator<Item = (usize, Option<usize>)> {
        let mut starts = starts.into_iter();
        let mut seen = vec![false; self.len()];
        let mut ahead = VecDeque::new();
        std::iter::from_fn(move || {
            if ahead.is_empty() {
                let start = starts.find(|&start| !mem::replace(&mut seen[start], true))?;
                ahead.push_back((start, None));
            }
            let (node, parent) = ahead.pop_front()?;
            for &other in &self[node] {
                if !mem::replace(&mut seen[other], true) {
                    ahead.push_back((other, Some(node)));
                }
            }
            Some((node, parent))
        })
    }
}

impl Index<usize> for Neighbors {
    type Output = [usize];

    fn index(&self, node: usize) -> &[usize] {
        &self.0[node]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square with a tail, a pair, and a node on its own.
    fn neighbors() -> Neighbors {
        Neighbors::of(8, &[[0, 1], [1, 2], [2, 3], [0, 3], [2, 4], [6, 7]])
    }

    #[test]
    fn neighbours_are_ascending() {
        let neighbors = neighbors();
        assert_eq!((&neighbors[0], &neighbors[2], &neighbors[5]), (&[1, 3][..], &[1, 3, 4][..], &[][..]));
        assert!(neighbors.degrees().eq([2, 2, 3, 2, 1, 0, 1, 1]));
    }

    #[test]
    fn a_walk_reaches_every_node_once_and_the_near_ones_first() {
        let walk = |starts: &[usize]| neighbors().by_breadth(starts.iter().copied()).collect::<Vec<_>>();
        let square = [(4, None), (2, Some(4)), (1, Some(2)), (3, Some(2)), (0, Some(1))];
        assert_eq!(walk(&[4, 0, 4]), square);
        assert_eq!(walk(&[5, 7]), [(5, None), (7, None), (6, Some(7))]);
        assert_eq!(walk(&[]), []);
    }
}
