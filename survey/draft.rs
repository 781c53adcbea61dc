//! A graph as read from a file, and how it is completed.
//!
//! Unlike in a [centreline](plume_graph::centreline), nodes keep their order, ids and radii, so that a graph survives a round
//! trip through a file. Missing values are filled in: parents by a walk from the first node of each part that has none,
//! radii by the distance to the nearest neighbour.

use std::path::Path;

use nalgebra::Point3;

use super::limits::MAX_LENGTH_M;
use super::parts::{Disconnected, Fate, first_at_place};
use super::{Parts, ReadError, Tally};
use plume_graph::{Georeference, Graph, Node, StationId, millimetres};

/// Nodes and edges in any order. A radius of 0 is unknown; parents are neighbours and form no cycle.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Draft {
    pub(super) nodes: Vec<Node>,
    pub(super) edges: Vec<[StationId; 2]>,
    /// What the file says about the origin of its coordinates.
    pub(super) georeference: Option<Georeference>,
}

/// A node of which only the position is known.
pub(super) fn node_at(id: u64, position: Point3<f64>) -> Node {
    Node { id, parent: None, position, radius: 0.0, active: false, level: 0, section: None, name: None }
}

/// Why a draft is not a valid graph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum DraftError {
    /// Too few nodes for a passage: what there is instead, in words.
    TooFew(&'static str),
    /// A node without passages, where disconnected parts are refused.
    Lone(usize),
    /// Several disconnected parts, where they are refused.
    Disconnected(Disconnected),
}

impl DraftError {
    /// The same as an error of the whole file, with the file's names of nodes.
    pub(super) fn into_error(self, path: &Path, name: impl Fn(usize) -> String) -> ReadError {
        match self {
            Self::TooFew(nodes) => ReadError::whole(path, format!("a graph with {nodes} is not a cave"), TOO_FEW_HINT),
            Self::Lone(node) => ReadError::whole(path, format!("{} has no passages", name(node)), LONE_HINT),
            Self::Disconnected(error) => error.into_error(path, name),
        }
    }
}

pub(super) const TOO_FEW_HINT: &str = "a cave needs two nodes and a passage between them";
pub(super) const LONE_HINT: &str = "remove it or add its passages; it is dropped unless disconnected parts are refused";

impl Draft {
    /// The graph, with lengths rounded to 1 mm, nodes in one place welded to the first of them and parts treated as asked; and
    /// a tally of these changes. Nodes without passages are dropped, or refused if parts are.
    pub(super) fn finished(self, parts: Parts) -> Result<(Graph, Tally), DraftError> {
        let places: Vec<Point3<f64>> = self.nodes.iter().map(|node| node.position).collect();
        let welds = first_at_place(&places);
        match welds.iter().enumerate().filter(|&(node, &first)| node == first).take(2).count() {
            0 => return Err(DraftError::TooFew("no nodes")),
            1 => return Err(DraftError::TooFew("one node")),
            _ => {}
        }
        let lines: Vec<[usize; 2]> = self.edges.iter().map(|edge| edge.map(StationId::index)).collect();
        let fate = Fate::of(&places, &lines, parts).map_err(DraftError::Disconnected)?;
        if !fate.stays.contains(&true) {
            return Err(DraftError::TooFew("nodes without passages"));
        }
        match fate.stays.iter().position(|stays| !stays) {
            Some(lone) if parts == Parts::Refuse => return Err(DraftError::Lone(lone)),
            _ => {}
        }
        let left_out = fate.stays.iter().filter(|stays| !**stays).count();
        let tally = Tally { joined: fate.joins.len(), left_out, ..Tally::default() };
        Ok((self.graph(&fate, &welds), tally))
    }

    /// The graph of the remaining nodes after the `welds`.
    fn graph(self, fate: &Fate, welds: &[usize]) -> Graph {
        let mut new = vec![StationId::default(); self.nodes.len()];
        let mut graph = Graph::default();
        let mut parents = Vec::new();
        let mut merged = false;
        for (old, node) in self.nodes.into_iter().enumerate().filter(|&(old, _)| fate.stays[old]) {
            let parent = node.parent;
            let name = node.name.clone();
            if welds[old] == old {
                new[old] = StationId::new(graph.nodes.len());
                graph.nodes.push(Node { parent: None, ..rounded(node) });
                parents.push(parent);
                continue;
            }
            merged = true;
            new[old] = new[welds[old]];
            let kept = &mut parents[new[old].index()];
            *kept = kept.or(parent);
            let kept = &mut graph[new[old]].name;
            *kept = kept.take().or(name);
        }
        let edges = self.edges.into_iter().filter(|edge| edge.iter().all(|end| fate.stays[end.index()]));
        let joins = fate.joins.iter().map(|join| join.map(StationId::new));
        let edges = edges.chain(joins).map(|edge| edge.map(|end| new[end.index()]));
        let mut graph = Graph::new(graph.nodes, edges.filter(|[a, b]| a != b).collect());
        graph.georeference = self.georeference;
        let mut parents: Vec<Option<StationId>> =
            parents.into_iter().map(|parent| parent.map(|parent: StationId| new[parent.index()])).collect();
        let roots = parents.iter().filter(|parent| parent.is_none()).count();
        if merged || !fate.joins.is_empty() || roots != fate.parts {
            parents = forest(&graph, &parents);
        }
        graph.nodes.iter_mut().zip(parents).for_each(|(node, parent)| node.parent = parent);
        fill_radii(&mut graph);
        graph
    }
}

fn rounded(node: Node) -> Node {
    let length = |length_m: f64| millimetres(length_m).clamp(0.001, MAX_LENGTH_M);
    let section = node.section.map(|section| section.map(length));
    let radius = if node.radius > 0.0 { length(node.radius) } else { 0.0 };
    Node { position: node.position.map(millimetres), radius, section, ..node }
}

/// Parents by breadth-first search from the first node of each part without a parent, or from its first node.
fn forest(graph: &Graph, had: &[Option<StationId>]) -> Vec<Option<StationId>> {
    let origins = graph.stations().filter(|node| had[node.index()].is_none());
    let mut parents = vec![None; graph.nodes.len()];
    for (node, parent) in graph.neighbors().by_breadth(origins.chain(graph.stations())) {
        parents[node.index()] = parent;
    }
    parents
}

/// The radius of a node without one is the distance to its nearest neighbour.
fn fill_radii(graph: &mut Graph) {
    let neighbors = graph.neighbors();
    for node in graph.stations() {
        if graph[node].radius > 0.0 {
            continue;
        }
        let nearest = neighbors[node].iter().map(|&other| graph.distance_m(node, other)).fold(f64::INFINITY, f64::min);
        graph[node].radius = millimetres(nearest).clamp(0.001, MAX_LENGTH_M);
    }
}
