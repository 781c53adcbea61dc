//! The plan of a graph for Graphviz (<https://graphviz.org/doc/info/lang.html>): `neato -n -Tsvg cave.dot`.
//!
//! Nodes are pinned at their positions, ten points per metre, in plan view with north up. Their `z` in metres is added for
//! other programs. Names of stations stand beside them, and the graph has the attributes `origin` and `system` if it is
//! georeferenced. Write-only: a drawing is not a survey.

use std::fmt::Write;

use super::Written;
use plume_graph::{Georeference, Graph};

/// Points (72 per inch) for a metre. Tuned so that a passage of 3 m is as long as the names of its stations are wide.
const POINTS_PER_M: f64 = 10.0;

/// Writes the drawing.
pub(super) fn export(graph: &Graph) -> Vec<Written> {
    let mut text = "graph cave {\n  node [shape=point];\n".to_owned();
    if let Some(Georeference { origin_m, system }) = &graph.georeference {
        let [x, y, z] = (*origin_m).into();
        writeln!(text, "  origin=\"{x},{y},{z}\";").expect("writing to a string cannot fail");
        if let Some(system) = system {
            writeln!(text, "  system={};", quoted(system)).expect("writing to a string cannot fail");
        }
    }
    for node in &graph.nodes {
        let [x, y, z] = node.position.coords.into();
        let [x, y] = [x, y].map(|length_m| (length_m * POINTS_PER_M * 100.0).round() / 100.0);
        let name = node.name.as_deref().map(|name| format!(", xlabel={}", quoted(name))).unwrap_or_default();
        writeln!(text, "  n{} [pos=\"{x},{y}\", z=\"{z}\"{name}];", node.id).expect("writing to a string cannot fail");
    }
    for edge in &graph.edges {
        let [a, b] = edge.map(|node| graph[node].id);
        writeln!(text, "  n{a} -- n{b};").expect("writing to a string cannot fail");
    }
    text.push_str("}\n");
    vec![Written { suffix: "", bytes: text.into_bytes() }]
}

/// A text in quotes, in which Graphviz expands nothing.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
