//! Writes a graph as GraphML, one node per line.

use std::fmt::Write;

use quick_xml::escape::escape;

use crate::Written;
use crate::fields::shape_name;
use plume_graph::{Georeference, Graph, Node};

const HEAD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<graphml xmlns="http://graphml.graphdrawing.org/xmlns">
<key id="x" for="node" attr.name="x" attr.type="double"/>
<key id="y" for="node" attr.name="y" attr.type="double"/>
<key id="z" for="node" attr.name="z" attr.type="double"/>
<key id="radius" for="node" attr.name="radius" attr.type="double"/>
<key id="level" for="node" attr.name="level" attr.type="int"/>
<key id="active" for="node" attr.name="active" attr.type="boolean"/>
<key id="width_m" for="node" attr.name="width_m" attr.type="double"/>
<key id="height_m" for="node" attr.name="height_m" attr.type="double"/>
<key id="shape" for="node" attr.name="shape" attr.type="string"/>
"#;
const NAME_KEY: &str = r#"<key id="name" for="node" attr.name="name" attr.type="string"/>"#;
const GRAPH: &str = r#"<graph id="cave" edgedefault="undirected">"#;

/// Writes the graph.
pub(crate) fn export(graph: &Graph) -> Vec<Written> {
    let text = head(graph).and_then(|text| with_elements(text, graph)).expect("writing to a string cannot fail");
    vec![Written { suffix: "", bytes: text.into_bytes() }]
}

/// What precedes the nodes. Names and georeference are declared only if there are any.
fn head(graph: &Graph) -> Result<String, std::fmt::Error> {
    let mut text = HEAD.to_owned();
    if graph.nodes.iter().any(|node| node.name.is_some()) {
        writeln!(text, "{NAME_KEY}")?;
    }
    let Some(Georeference { origin_m, system }) = &graph.georeference else {
        writeln!(text, "{GRAPH}")?;
        return Ok(text);
    };
    let axes = ["origin_x", "origin_y", "origin_z"];
    for axis in axes {
        writeln!(text, r#"<key id="{axis}" for="graph" attr.name="{axis}" attr.type="double"/>"#)?;
    }
    if system.is_some() {
        writeln!(text, r#"<key id="system" for="graph" attr.name="system" attr.type="string"/>"#)?;
    }
    writeln!(text, "{GRAPH}")?;
    for (axis, value) in axes.iter().zip(origin_m.iter()) {
        write!(text, r#"<data key="{axis}">{value}</data>"#)?;
    }
    if let Some(system) = system {
        write!(text, r#"<data key="system">{}</data>"#, escape(&**system))?;
    }
    text.push('\n');
    Ok(text)
}

fn with_elements(mut text: String, graph: &Graph) -> Result<String, std::fmt::Error> {
    for node in &graph.nodes {
        write_node(&mut text, node)?;
    }
    for edge in &graph.edges {
        let [a, b] = edge.map(|node| graph[node].id);
        writeln!(text, r#"<edge source="n{a}" target="n{b}"/>"#)?;
    }
    text.push_str("</graph>\n</graphml>\n");
    Ok(text)
}

fn write_node(text: &mut String, node: &Node) -> std::fmt::Result {
    let [x, y, z] = node.position.coords.into();
    write!(text, r#"<node id="n{}">"#, node.id)?;
    write!(text, r#"<data key="x">{x}</data><data key="y">{y}</data><data key="z">{z}</data>"#)?;
    write!(text, r#"<data key="radius">{}</data><data key="level">{}</data>"#, node.radius, node.level)?;
    write!(text, r#"<data key="active">{}</data>"#, node.active)?;
    if let Some(section) = node.section {
        write!(text, r#"<data key="width_m">{}</data>"#, section.width_m)?;
        write!(text, r#"<data key="height_m">{}</data>"#, section.height_m)?;
        write!(text, r#"<data key="shape">{}</data>"#, shape_name(section.shape))?;
    }
    if let Some(name) = &node.name {
        write!(text, r#"<data key="name">{}</data>"#, escape(&**name))?;
    }
    text.push_str("</node>\n");
    Ok(())
}
