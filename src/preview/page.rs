//! An interactive page for browsers: the passages, and a coarse wall made from the field.
//!
//! A single self-contained file without network access. Arrays are embedded as Base64, little-endian.

mod solid;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use rustc_hash::FxHashMap;
use serde_json::{Value, json};

use self::solid::Solid;
use super::theme::VIRIDIS;
use super::{Drawn, Order, PreviewError, Size, Subject};
use plume_graph::{Graph, StationId};

/// The page, without a cave.
static PAGE: &str = include_str!("../../templates/preview/page.html");
/// Above this number of stations, nearby ones are merged. Tuned: smooth on a weak graphics card.
const MOST_STATIONS: usize = 60_000;

/// The page, which adapts to the size of the window.
pub fn page(subject: &Subject, order: &Order, _size: Size) -> Result<Drawn, PreviewError> {
    let solid = Solid::of(subject, order.stop)?;
    let cave = json!({
        "name": subject.name,
        "numbers": numbers(subject),
        "ramp": VIRIDIS,
        "graph": skeleton(subject),
        "solid": solid.map(|solid| solid.to_json()),
    });
    // A closing tag would end the script element.
    let cave = cave.to_string().replace('<', "\\u003c");
    let name = subject.name.replace('&', "&amp;").replace('<', "&lt;");
    let (head, rest) = PAGE.split_once("{{ name }}").expect("the template has a name");
    let (body, end) = rest.split_once("{{ cave }}").expect("the template has a cave");
    Ok(Drawn::File([head, &name, body, &cave, end].concat().into_bytes()))
}

/// The facts next to the picture.
fn numbers(subject: &Subject) -> Value {
    let graph = subject.graph;
    let degrees = graph.degrees();
    let count = |fits: fn(usize) -> bool| degrees.iter().filter(|&&passages| fits(passages)).count();
    let [width_m, depth_m, height_m] = graph.bounds().expect("a graph to be shown has stations").size();
    let widths = graph.nodes.iter().map(|node| 2.0 * f64::from(subject.passage.reach(node).aside_m));
    let mean_width_m = widths.sum::<f64>() / graph.nodes.len() as f64;
    json!([
        ["nodes", graph.nodes.len().to_string()],
        ["passages", graph.edges.len().to_string()],
        ["length", format!("{:.0} m", graph.length_m())],
        ["loops", graph.loops().to_string()],
        ["junctions", count(|passages| passages > 2).to_string()],
        ["dead ends", count(|passages| passages == 1).to_string()],
        ["mean width", format!("{mean_width_m:.1} m")],
        ["extent", format!("{width_m:.0} × {depth_m:.0} m")],
        ["depth", format!("{height_m:.1} m")],
    ])
}

/// Stations with their half widths, and passages.
fn skeleton(subject: &Subject) -> Value {
    let graph = subject.graph;
    let stands_for = representatives(graph);
    let mut places: Vec<usize> = vec![0; graph.nodes.len()];
    let mut stations: Vec<f32> = Vec::new();
    for (index, node) in graph.nodes.iter().enumerate() {
        if stands_for[index] == index {
            places[index] = stations.len() / 4;
            stations.extend(node.position.iter().map(|c| *c as f32));
            stations.push(subject.passage.reach(node).aside_m);
        }
    }
    let ends = |edge: &[StationId; 2]| edge.map(|end| places[stands_for[end.index()]] as u32);
    let mut edges: Vec<[u32; 2]> = graph.edges.iter().map(ends).filter(|[a, b]| a != b).collect();
    edges.sort_unstable();
    edges.dedup();
    json!({"stations": packed(stations.iter().flat_map(|x| x.to_le_bytes())),
           "passages": packed(edges.iter().flatten().flat_map(|x| x.to_le_bytes()))})
}

/// The representative of each station: the first in its cube of space.
fn representatives(graph: &Graph) -> Vec<usize> {
    let mut cube_m = 1.0;
    let mut found: Vec<usize> = (0..graph.nodes.len()).collect();
    let mut count = found.len();
    while count > MOST_STATIONS {
        let mut first: FxHashMap<[i64; 3], usize> = FxHashMap::default();
        for (index, node) in graph.nodes.iter().enumerate() {
            let cube: [i64; 3] = node.position.coords.map(|c| (c / cube_m).floor() as i64).into();
            found[index] = *first.entry(cube).or_insert(index);
        }
        count = first.len();
        cube_m *= 1.5;
    }
    found
}

fn packed(bytes: impl Iterator<Item = u8>) -> String {
    BASE64_STANDARD.encode(bytes.collect::<Vec<u8>>())
}
