//! A graph with data for moves.

use nalgebra::Vector2;

use crate::branches::Branches;
use crate::{Graph, Neighbors, Node, StationId};

/// A graph, its branches and its mean lengths.
pub(super) struct Plan {
    pub(super) graph: Graph,
    pub(super) neighbors: Neighbors<Node>,
    pub(super) branches: Vec<Vec<StationId>>,
    /// Stations with passages.
    pub(super) stations: usize,
    /// Mean length of a passage.
    pub(super) leg_m: f64,
    /// Mean length of a branch.
    pub(super) branch_m: f64,
}

impl Plan {
    pub(super) fn of(graph: Graph) -> Self {
        let neighbors = graph.neighbors();
        let branches: Vec<Vec<StationId>> = Branches::of(&neighbors).iter().map(<[_]>::to_vec).collect();
        let length_m = graph.length_m();
        Self {
            stations: neighbors.degrees().filter(|&degree| degree > 0).count(),
            leg_m: length_m / graph.edges.len().max(1) as f64,
            branch_m: length_m / branches.len().max(1) as f64,
            graph,
            neighbors,
            branches,
        }
    }

    pub(super) fn degree(&self, node: StationId) -> usize {
        self.neighbors[node].len()
    }

    /// The horizontal vector from one station to another.
    pub(super) fn way(&self, from: StationId, to: StationId) -> Vector2<f64> {
        (self.graph[to].position - self.graph[from].position).xy()
    }

    /// Whether a path of at most `hops` passages connects the two, not counting a direct one.
    pub(super) fn are_joined(&self, from: StationId, to: StationId, hops: usize) -> bool {
        let mut seen = vec![false; self.neighbors.len()];
        let mut rim = vec![from];
        seen[from.index()] = true;
        for _ in 0..hops {
            let mut next = Vec::new();
            for &node in &rim {
                for &other in self.neighbors[node].iter().filter(|&&other| (node, other) != (from, to)) {
                    if !seen[other.index()] {
                        seen[other.index()] = true;
                        next.push(other);
                    }
                }
            }
            if seen[to.index()] || next.is_empty() {
                break;
            }
            rim = next;
        }
        seen[to.index()]
    }
}
