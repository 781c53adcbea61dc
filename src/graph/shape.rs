//! What can be asked of any graph, and how one is put together.

use nalgebra::Point3;

use super::{Graph, Node};

impl Graph {
    /// A graph of these nodes; edges may come in any order, either way round and more than once.
    pub fn new(nodes: Vec<Node>, edges: Vec<[usize; 2]>) -> Self {
        let mut edges: Vec<[usize; 2]> = edges.into_iter().map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        Self { nodes, edges }
    }

    /// The neighbours of each node, ascending.
    pub fn neighbors(&self) -> Vec<Vec<usize>> {
        let mut neighbors = vec![Vec::new(); self.nodes.len()];
        for &[a, b] in &self.edges {
            neighbors[a].push(b);
            neighbors[b].push(a);
        }
        neighbors.iter_mut().for_each(|others| others.sort_unstable());
        neighbors
    }

    /// Passages at a node. Looks at all edges: ask [`neighbors`](Self::neighbors) for many nodes.
    pub fn degree(&self, node: usize) -> usize {
        self.edges.iter().filter(|edge| edge.contains(&node)).count()
    }

    /// Straight distance between two nodes in metres.
    pub fn distance_m(&self, a: usize, b: usize) -> f64 {
        (self.nodes[a].position - self.nodes[b].position).norm()
    }

    /// Length of all passages in metres.
    pub fn length_m(&self) -> f64 {
        self.edges.iter().map(|&[a, b]| self.distance_m(a, b)).sum()
    }

    /// Independent loops: passages more than a tree would have.
    pub fn loops(&self) -> usize {
        self.edges.len() + self.components().len() - self.nodes.len()
    }

    /// Sets of nodes that passages connect, each ascending, ordered by their first node.
    pub fn components(&self) -> Vec<Vec<usize>> {
        let neighbors = self.neighbors();
        let mut seen = vec![false; self.nodes.len()];
        let mut components = Vec::new();
        for start in 0..self.nodes.len() {
            if !seen[start] {
                components.push(component(start, &neighbors, &mut seen));
            }
        }
        components
    }

    /// Lowest and highest corner of the box round all nodes, in metres; `None` without nodes.
    pub fn bounds(&self) -> Option<[Point3<f64>; 2]> {
        let first = self.nodes.first()?.position;
        let corners = self
            .nodes
            .iter()
            .fold([first, first], |[low, high], node| [low.inf(&node.position), high.sup(&node.position)]);
        Some(corners)
    }

    /// The graph enlarged about the origin of its frame: positions, radii and sections, rounded to 1 mm.
    pub fn scaled(&self, factor: f64) -> Self {
        let nodes = self.nodes.iter().map(|node| node.scaled(factor)).collect();
        Self { nodes, edges: self.edges.clone() }
    }
}

impl Node {
    fn scaled(&self, factor: f64) -> Self {
        let length = |length_m: f64| millimetres(length_m * factor);
        Self {
            position: self.position.map(length),
            radius: length(self.radius),
            section: self.section.map(|section| section.map(length)),
            ..self.clone()
        }
    }
}

/// A length in metres, rounded to 1 mm.
pub(super) fn millimetres(length_m: f64) -> f64 {
    // Adding zero turns -0.0 into 0.0, which files write differently.
    (length_m * 1000.0).round() / 1000.0 + 0.0
}

fn component(start: usize, neighbors: &[Vec<usize>], seen: &mut [bool]) -> Vec<usize> {
    let mut found = vec![start];
    seen[start] = true;
    let mut next = 0;
    while let Some(&node) = found.get(next) {
        next += 1;
        for &other in &neighbors[node] {
            if !seen[other] {
                seen[other] = true;
                found.push(other);
            }
        }
    }
    found.sort_unstable();
    found
}
