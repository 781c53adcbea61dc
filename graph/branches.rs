//! The branches of a graph, which run between junctions and dead ends.

use super::{Id, Neighbors, Rows};

/// Paths of nodes whose ends do not have exactly two neighbours, and whose inner nodes do, in the order of their first
/// ends. A ring without junctions is a branch from its lowest node to itself; these come last.
pub(super) struct Branches<T>(Rows<Id<T>>);

impl<T> Branches<T> {
    pub(super) fn of(neighbors: &Neighbors<T>) -> Self {
        let mut branches = Self(Rows::default());
        let mut seen = vec![false; neighbors.len()];
        let is_end = |node: Id<T>| neighbors[node].len() != 2;
        for start in neighbors.nodes().filter(|&node| is_end(node)) {
            for &first in &neighbors[start] {
                // A branch is walked from its first end; one of two nodes has no inner node to mark as visited.
                let is_walked = if is_end(first) { first < start } else { seen[first.index()] };
                if !is_walked {
                    branches.walk(neighbors, &mut seen, [start, first]);
                }
            }
        }
        for start in neighbors.nodes() {
            if !is_end(start) && !seen[start.index()] {
                seen[start.index()] = true;
                branches.walk(neighbors, &mut seen, [start, neighbors[start][0]]);
            }
        }
        branches
    }

    /// Adds the branch that starts with these two nodes.
    fn walk(&mut self, neighbors: &Neighbors<T>, seen: &mut [bool], [start, first]: [Id<T>; 2]) {
        let (mut before, mut at) = (start, first);
        let mut nodes = vec![before, at];
        while let (&[a, b], true) = (&neighbors[at], at != start) {
            seen[at.index()] = true;
            (before, at) = (at, if a == before { b } else { a });
            nodes.push(at);
        }
        self.0.push(nodes);
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &[Id<T>]> {
        self.0.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StationId;

    fn branches<const N: usize>(nodes: usize, edges: [[usize; 2]; N]) -> Vec<Vec<usize>> {
        let neighbors = Neighbors::of(nodes, &StationId::pairs(edges));
        let indices = |branch: &[StationId]| branch.iter().map(|node| node.index()).collect();
        Branches::of(&neighbors).iter().map(indices).collect()
    }

    #[test]
    fn branches_run_from_end_to_end_and_are_listed_once() {
        // Two junctions, 2 and 4, joined directly and via 3; dead ends 0 and 6.
        let edges = [[0, 1], [1, 2], [2, 3], [3, 4], [2, 4], [4, 6]];
        assert_eq!(branches(7, edges), [vec![0, 1, 2], vec![2, 3, 4], vec![2, 4], vec![4, 6]]);
    }

    #[test]
    fn rings_are_branches_to_themselves() {
        // A ring on the tail of 3, and one on its own.
        let edges = [[0, 1], [1, 2], [0, 2], [2, 3], [4, 5], [5, 6], [4, 6]];
        assert_eq!(branches(7, edges), [vec![2, 0, 1, 2], vec![2, 3], vec![4, 5, 6, 4]]);
    }
}
