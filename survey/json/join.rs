//! Turns stations into a draft, ids into indices.

use std::collections::HashMap;

use super::error::ReadError;
use super::parse::ParsedStation;
use crate::draft::Draft;
use plume_graph::{Node, StationId};

/// Assembles a graph.
pub(super) fn join(stations: &[ParsedStation]) -> Result<Draft, ReadError> {
    let indices = indices(stations)?;
    let find = |from: &ParsedStation, key: &'static str, id: u64| {
        indices.get(&id).copied().ok_or_else(|| ReadError::Node {
            node: format!("node {}", from.id),
            key,
            fault: format!("refers to {id}, which is not a node"),
        })
    };
    let mut draft = Draft::default();
    for (at, station) in stations.iter().enumerate().map(|(at, station)| (StationId::new(at), station)) {
        for &other in &station.edges {
            draft.edges.push([at, find(station, "edges", other)?]);
        }
        let parent = station.parent.map(|parent| find(station, "parent", parent)).transpose()?;
        draft.edges.extend(parent.map(|parent| [at, parent]));
        draft.nodes.push(node(station, parent));
    }
    check_parents(&draft.nodes)?;
    Ok(draft)
}

/// The index of the station of each id, randomly hashed, so that no file can provoke collisions.
fn indices(stations: &[ParsedStation]) -> Result<HashMap<u64, StationId>, ReadError> {
    let mut indices = HashMap::new();
    for (index, station) in stations.iter().enumerate() {
        if indices.insert(station.id, StationId::new(index)).is_some() {
            return Err(ReadError::DuplicateId { id: station.id });
        }
    }
    Ok(indices)
}

fn node(station: &ParsedStation, parent: Option<StationId>) -> Node {
    Node {
        id: station.id,
        parent,
        position: station.position,
        radius: station.radius.unwrap_or_default(),
        active: station.active,
        level: station.level,
        section: station.section,
        name: station.name.clone(),
    }
}

/// Refuses cycles of parents.
fn check_parents(nodes: &[Node]) -> Result<(), ReadError> {
    let mut walk_of = vec![usize::MAX; nodes.len()];
    for start in 0..nodes.len() {
        let mut at = start;
        while walk_of[at] == usize::MAX {
            walk_of[at] = start;
            match nodes[at].parent {
                Some(parent) => at = parent.index(),
                None => break,
            }
        }
        let ended = nodes[at].parent.is_none();
        if walk_of[at] == start && !ended {
            return Err(ReadError::ParentCircle { id: nodes[at].id });
        }
    }
    Ok(())
}
