//! Construction and basic properties of graphs.

use std::ops::{Index, IndexMut};

use super::{Aabb, Graph, Neighbors, Node, StationId};

impl Graph {
    /// A graph of these nodes; edges may be in any order, in either direction and duplicated.
    pub fn new(nodes: Vec<Node>, edges: Vec<[StationId; 2]>) -> Self {
        let mut edges: Vec<[StationId; 2]> = edges.into_iter().map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        Self { nodes, edges, georeference: None }
    }

    /// The same graph numbered breadth-first from the first node of each part, so that parents precede their children; ids
    /// follow the new order. Nodes without passages are dropped; those with several are not active.
    pub fn numbered_by_breadth(self) -> Self {
        let neighbors = self.neighbors();
        let starts = neighbors.nodes().filter(|&node| !neighbors[node].is_empty());
        let mut new = vec![StationId::default(); neighbors.len()];
        let mut nodes = Vec::with_capacity(neighbors.len());
        for (old, parent) in neighbors.by_breadth(starts) {
            new[old.index()] = StationId::new(nodes.len());
            nodes.push(Node {
                id: nodes.len() as u64,
                parent: parent.map(|parent| new[parent.index()]),
                active: self[old].active && neighbors[old].len() == 1,
                ..self[old].clone()
            });
        }
        let edges = self.edges.into_iter().map(|edge| edge.map(|node| new[node.index()])).collect();
        Self { georeference: self.georeference, ..Self::new(nodes, edges) }
    }

    /// Sets the radii, which were 0: the distance to the first child, or to the parent at a dead end.
    pub fn with_reaches(mut self) -> Self {
        // In reverse, so that the first child wins.
        for node in self.stations().rev() {
            let Some(parent) = self[node].parent else { continue };
            let reach = millimetres(self.distance_m(node, parent)).max(0.001);
            if self[node].radius == 0.0 {
                self[node].radius = reach;
            }
            self[parent].radius = reach;
        }
        self
    }

    /// Every station.
    pub fn stations(&self) -> impl DoubleEndedIterator<Item = StationId> + ExactSizeIterator + Clone + use<> {
        StationId::all(self.nodes.len())
    }

    /// The neighbours of each node, ascending.
    pub fn neighbors(&self) -> Neighbors<Node> {
        Neighbors::of(self.nodes.len(), &self.edges)
    }

    /// Passages at a node. Looks at all edges: ask for the [degrees](Self::degrees) of many nodes at once.
    pub fn degree(&self, node: StationId) -> usize {
        self.edges.iter().filter(|edge| edge.contains(&node)).count()
    }

    /// Passages at each node.
    pub fn degrees(&self) -> Vec<usize> {
        let mut degrees = vec![0; self.nodes.len()];
        self.edges.iter().flatten().for_each(|&end| degrees[end.index()] += 1);
        degrees
    }

    /// Straight-line distance between two nodes in metres.
    pub fn distance_m(&self, a: StationId, b: StationId) -> f64 {
        (self[a].position - self[b].position).norm()
    }

    /// Total length of all passages in metres.
    pub fn length_m(&self) -> f64 {
        self.edges.iter().map(|&[a, b]| self.distance_m(a, b)).sum()
    }

    /// Number of independent loops.
    pub fn loops(&self) -> usize {
        self.edges.len() + self.components().len() - self.nodes.len()
    }

    /// Connected components, each ascending, ordered by their first node.
    pub fn components(&self) -> Vec<Vec<StationId>> {
        let neighbors = self.neighbors();
        let mut components: Vec<Vec<StationId>> = Vec::new();
        for (node, parent) in neighbors.by_breadth(neighbors.nodes()) {
            match components.last_mut().filter(|_| parent.is_some()) {
                Some(component) => component.push(node),
                None => components.push(vec![node]),
            }
        }
        components.iter_mut().for_each(|component| component.sort_unstable());
        components
    }

    /// The box round all nodes, in metres; `None` without nodes.
    pub fn bounds(&self) -> Option<Aabb<f64>> {
        Aabb::from_points(self.nodes.iter().map(|node| node.position))
    }

    /// The graph scaled about the origin of its frame: positions, radii and sections, rounded to 1 mm. It is no longer where
    /// its survey has it, unless the factor is 1.
    pub fn scaled(&self, factor: f64) -> Self {
        let nodes = self.nodes.iter().map(|node| node.scaled(factor)).collect();
        let georeference = self.georeference.clone().filter(|_| factor == 1.0);
        Self { nodes, edges: self.edges.clone(), georeference }
    }
}

impl Index<StationId> for Graph {
    type Output = Node;

    fn index(&self, station: StationId) -> &Node {
        &self.nodes[station.index()]
    }
}

impl IndexMut<StationId> for Graph {
    fn index_mut(&mut self, station: StationId) -> &mut Node {
        &mut self.nodes[station.index()]
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
pub fn millimetres(length_m: f64) -> f64 {
    // Adding zero turns -0.0 into 0.0, which is written differently.
    (length_m * 1000.0).round() / 1000.0 + 0.0
}
