//! Which nodes are joined to which.

use std::collections::VecDeque;
use std::mem;
use std::ops::Index;

use super::{Id, Rows};

/// The neighbours of every node, each list ascending.
#[derive(Clone, Debug, PartialEq)]
pub struct Neighbors<T>(Rows<Id<T>>);

impl<T> Neighbors<T> {
    /// The neighbours of this many nodes along these edges.
    pub fn of(nodes: usize, edges: &[[Id<T>; 2]]) -> Self {
        let both_ways = edges.iter().flat_map(|&[a, b]| [(a.index(), b), (b.index(), a)]);
        Self(Rows::from_pairs(nodes, both_ways).ascending())
    }

    /// Number of nodes, with neighbours or without.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Every node.
    pub fn nodes(&self) -> impl DoubleEndedIterator<Item = Id<T>> + ExactSizeIterator + Clone {
        Id::all(self.len())
    }

    /// The neighbours of each node, in the order of the nodes.
    pub fn iter(&self) -> impl Iterator<Item = &[Id<T>]> {
        self.0.iter()
    }

    /// The number of neighbours of each node.
    pub fn degrees(&self) -> impl Iterator<Item = usize> {
        self.iter().map(<[_]>::len)
    }

    /// The nodes reachable from the starts, breadth-first: each node once, with the one it was reached from. A start has none,
    /// and is skipped if it was reached from an earlier one.
    pub fn by_breadth(&self, starts: impl IntoIterator<Item = Id<T>>) -> impl Iterator<Item = (Id<T>, Option<Id<T>>)> {
        let mut starts = starts.into_iter();
        let mut seen = vec![false; self.len()];
        let mut ahead = VecDeque::new();
        std::iter::from_fn(move || {
            if ahead.is_empty() {
                let start = starts.find(|&start| !mem::replace(&mut seen[start.index()], true))?;
                ahead.push_back((start, None));
            }
            let (node, parent) = ahead.pop_front()?;
            for &other in &self[node] {
                if !mem::replace(&mut seen[other.index()], true) {
                    ahead.push_back((other, Some(node)));
                }
            }
            Some((node, parent))
        })
    }
}

impl<T> Index<Id<T>> for Neighbors<T> {
    type Output = [Id<T>];

    fn index(&self, node: Id<T>) -> &[Id<T>] {
        &self.0[node.index()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StationId;

    /// A square with a tail, a pair, and an isolated node.
    fn neighbors() -> Neighbors<crate::Node> {
        Neighbors::of(8, &StationId::pairs([[0, 1], [1, 2], [2, 3], [0, 3], [2, 4], [6, 7]]))
    }

    #[test]
    fn neighbours_are_ascending() {
        let neighbors = neighbors();
        for (node, others) in [(0, &[1, 3][..]), (2, &[1, 3, 4]), (5, &[])] {
            assert!(neighbors[StationId::new(node)].iter().map(|other| other.index()).eq(others.iter().copied()));
        }
        assert!(neighbors.degrees().eq([2, 2, 3, 2, 1, 0, 1, 1]));
    }

    #[test]
    fn a_walk_reaches_every_node_once_and_near_ones_first() {
        let walk = |starts: &[usize]| {
            let walk = neighbors().by_breadth(starts.iter().copied().map(StationId::new)).collect::<Vec<_>>();
            walk.into_iter().map(|(node, parent)| (node.index(), parent.map(Id::index))).collect::<Vec<_>>()
        };
        let square = [(4, None), (2, Some(4)), (1, Some(2)), (3, Some(2)), (0, Some(1))];
        assert_eq!(walk(&[4, 0, 4]), square);
        assert_eq!(walk(&[5, 7]), [(5, None), (7, None), (6, Some(7))]);
        assert_eq!(walk(&[]), []);
    }
}
