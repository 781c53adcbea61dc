//! From stations to a graph: ids become indices, and every law of a graph is checked.

use rustc_hash::FxHashMap;

use super::error::ReadError;
use super::parse::Station;
use crate::graph::{Graph, Node, millimetres};

/// Members named when a graph falls apart.
const NAMED: usize = 10;

/// Puts a graph together.
pub(super) fn join(stations: &[Station]) -> Result<Graph, ReadError> {
    enough(stations.len())?;
    let places = Places::of(stations)?;
    enough(places.nodes.len())?;
    let mut edges = Vec::new();
    let mut parents = vec![None; places.nodes.len()];
    for station in stations {
        let at = places.find(station, "edges", station.id)?;
        for &other in &station.edges {
            edges.push([at, places.find(station, "edges", other)?]);
        }
        if let Some(parent) = station.parent {
            let parent = places.find(station, "parent", parent)?;
            edges.push([at, parent]);
            parents[at] = parents[at].or(Some(parent));
        }
    }
    // Merged stations may have edges to themselves.
    edges.retain(|[a, b]| a != b);
    check_parents(stations)?;
    let merged = places.nodes.len() < stations.len();
    let mut graph = Graph::new(nodes(stations, &places), edges);
    check_connected(&graph)?;
    let roots = parents.iter().filter(|parent| parent.is_none()).count();
    if merged || roots != 1 {
        parents = tree(&graph, parents.iter().position(Option::is_none).unwrap_or(0));
    }
    for (node, parent) in graph.nodes.iter_mut().zip(parents) {
        node.parent = parent;
    }
    fill_radii(&mut graph);
    Ok(graph)
}

fn enough(nodes: usize) -> Result<(), ReadError> {
    match nodes {
        0 => Err(ReadError::TooFew { nodes: "no nodes" }),
        1 => Err(ReadError::TooFew { nodes: "one node" }),
        _ => Ok(()),
    }
}

/// Where each id stands in the graph. Stations in the same place are one node, which has the first one's id.
struct Places {
    /// Node of each id.
    of_id: FxHashMap<u64, usize>,
    /// Station that each node is made of.
    nodes: Vec<usize>,
}

impl Places {
    fn of(stations: &[Station]) -> Result<Self, ReadError> {
        let mut places = Self { of_id: FxHashMap::default(), nodes: Vec::new() };
        let mut of_position = FxHashMap::default();
        for (index, station) in stations.iter().enumerate() {
            let position = station.position.coords.map(f64::to_bits);
            let position: [u64; 3] = position.into();
            let next = places.nodes.len();
            let node = *of_position.entry(position).or_insert(next);
            if node == next {
                places.nodes.push(index);
            }
            if places.of_id.insert(station.id, node).is_some() {
                return Err(ReadError::DuplicateId { id: station.id });
            }
        }
        Ok(places)
    }

    fn find(&self, from: &Station, key: &'static str, id: u64) -> Result<usize, ReadError> {
        self.of_id.get(&id).copied().ok_or_else(|| ReadError::Node {
            node: format!("node {}", from.id),
            key,
            fault: format!("has {id}, which is no node"),
        })
    }
}

fn nodes(stations: &[Station], places: &Places) -> Vec<Node> {
    let node = |&index: &usize| {
        let station = &stations[index];
        Node {
            id: station.id,
            parent: None,
            position: station.position,
            radius: station.radius.unwrap_or_default(),
            active: station.active,
            level: station.level,
            section: station.section,
        }
    };
    places.nodes.iter().map(node).collect()
}

/// Refuses parents that lead round in a circle.
fn check_parents(stations: &[Station]) -> Result<(), ReadError> {
    let index_of: FxHashMap<u64, usize> =
        (stations.iter().enumerate()).map(|(index, station)| (station.id, index)).collect();
    let mut walk_of = vec![usize::MAX; stations.len()];
    for start in 0..stations.len() {
        let mut at = start;
        while walk_of[at] == usize::MAX {
            walk_of[at] = start;
            match stations[at].parent {
                Some(parent) => at = index_of[&parent],
                None => break,
            }
        }
        let ended = stations[at].parent.is_none();
        if walk_of[at] == start && !ended {
            return Err(ReadError::ParentCircle { id: stations[at].id });
        }
    }
    Ok(())
}

fn check_connected(graph: &Graph) -> Result<(), ReadError> {
    let parts = graph.components();
    if parts.len() == 1 {
        return Ok(());
    }
    let ids = parts.iter().take(NAMED);
    let mut members: Vec<String> = ids.map(|part| graph.nodes[part[0]].id.to_string()).collect();
    if parts.len() > NAMED {
        members.push("…".to_owned());
    }
    Err(ReadError::Disconnected { parts: parts.len(), members: members.join(", ") })
}

/// Parents by breadth from a root, where those of the file name no single origin.
fn tree(graph: &Graph, root: usize) -> Vec<Option<usize>> {
    let neighbors = graph.neighbors();
    let mut parents = vec![None; graph.nodes.len()];
    let mut queue = vec![root];
    let mut next = 0;
    while let Some(&node) = queue.get(next) {
        next += 1;
        for &other in &neighbors[node] {
            if other != root && parents[other].is_none() {
                parents[other] = Some(node);
                queue.push(other);
            }
        }
    }
    parents
}

/// A node without a radius reaches as far as its nearest neighbour.
fn fill_radii(graph: &mut Graph) {
    let neighbors = graph.neighbors();
    for (node, others) in neighbors.iter().enumerate() {
        if graph.nodes[node].radius > 0.0 {
            continue;
        }
        let nearest = others.iter().map(|&other| graph.distance_m(node, other)).fold(f64::INFINITY, f64::min);
        graph.nodes[node].radius = millimetres(nearest).max(0.001);
    }
}
