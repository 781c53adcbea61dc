//! Writes a graph as text: one node per line, keys in a fixed order, so that files can be compared.

use std::fmt::Write;

use serde::Serialize;
use serde_json::Value;

use plume_graph::{Georeference, Graph, Section};

#[derive(Serialize)]
struct WrittenStation<'a> {
    id: u64,
    parent: Option<u64>,
    edges: &'a [u64],
    coordinates: Coordinates,
    radius: f64,
    active: bool,
    #[serde(skip_serializing_if = "is_top")]
    level: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    section: Option<Section>,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<&'a str>,
}

#[derive(Serialize)]
struct WrittenGeoreference<'a> {
    origin_m: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    system: Option<&'a str>,
}

#[derive(Serialize)]
struct Coordinates {
    x: f64,
    y: f64,
    z: f64,
}

fn is_top(level: &u32) -> bool {
    *level == 0
}

/// The text of a graph file with this graph, made by this version of plume from this recipe.
pub fn write(graph: &Graph, version: &str, recipe: &Value) -> String {
    let version = Value::from(version);
    let mut text = format!("{{\n\"plume\": {version},\n\"recipe\": {recipe},\n");
    if let Some(Georeference { origin_m, system }) = &graph.georeference {
        let georeference = WrittenGeoreference { origin_m: (*origin_m).into(), system: system.as_deref() };
        let georeference = serde_json::to_string(&georeference).expect("numbers and texts");
        writeln!(text, "\"georeference\": {georeference},").expect("writing to a string cannot fail");
    }
    text.push_str("\"nodes\": [");
    let neighbors = graph.neighbors();
    for (index, (node, others)) in graph.nodes.iter().zip(neighbors.iter()).enumerate() {
        let edges: Vec<u64> = others.iter().map(|&other| graph[other].id).collect();
        let station = WrittenStation {
            id: node.id,
            parent: node.parent.map(|parent| graph[parent].id),
            edges: &edges,
            coordinates: Coordinates { x: node.position.x, y: node.position.y, z: node.position.z },
            radius: node.radius,
            active: node.active,
            level: node.level,
            section: node.section,
            name: node.name.as_deref(),
        };
        let separator = if index == 0 { "" } else { "," };
        let line = serde_json::to_string(&station).expect("numbers, lists and texts");
        write!(text, "{separator}\n{line}").expect("writing to a string cannot fail");
    }
    text.push_str("\n]\n}\n");
    text
}
