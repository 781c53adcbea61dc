//! Graph files: written by the original script, by other programs, and invalid ones.

use std::fmt::Write;
use std::fs;

use crate::common::files;
use files::Files;
use plume::graph::{Graph, Node, StationId};
use plume::survey::json::{Document, ReadError, read, write};
use plume::survey::{self, Import, Parts};
use proptest::prelude::*;
use serde_json::json;

/// One plane and several heights; the latter is also a sample.
fn original(name: &str) -> Document {
    let folder = if name == "multi" { "samples" } else { "tests/data" };
    let path = format!("{folder}/plume_original_50_{name}.json");
    let text = fs::read_to_string(path).expect("it is in the repository");
    read(&text).expect("it is as the original script wrote it")
}

#[test]
fn files_of_the_original_are_read() {
    for name in ["single", "multi"] {
        let Document { graph, recipe, original } = original(name);
        assert!(original && recipe.is_none());
        assert_eq!(graph.nodes.len(), 50);
        assert_eq!(graph.edges.len(), 49);
        assert_eq!((graph.components().len(), graph.loops()), (1, 0));
        assert!(graph.nodes.iter().all(|node| node.active));
        assert_eq!(graph.nodes[0].parent, None);
        assert!(graph.nodes[1..].iter().all(|node| node.parent.is_some()));
    }
}

#[test]
fn caves_of_the_original_have_their_size() {
    let height_m = |name| {
        let [_, _, height_m] = original(name).graph.bounds().unwrap().size();
        (height_m * 10.0).round() / 10.0
    };
    assert_eq!(height_m("single"), 0.0);
    assert!(height_m("multi") > 5.0);
}

#[test]
fn an_original_survives_our_own_format() {
    let graph = original("multi").graph;
    let recipe = json!({"seed": 7});
    let back = read(&write(&graph, "0.1.0", &recipe)).unwrap();
    assert_eq!(back.graph, graph);
    assert_eq!(back.recipe, Some(recipe));
    assert!(!back.original);
}

#[test]
fn edges_named_at_one_end_and_parents_are_enough() {
    let text = r#"{"nodes": [
        {"id": 5, "coordinates": {"x": 0, "y": 0}},
        {"id": 3, "parent": 5, "coordinates": {"x": 4, "y": 0}},
        {"id": 9, "edges": [3, 5], "coordinates": {"x": 4, "y": 3}}
    ]}"#;
    let graph = read(text).unwrap().graph;
    assert_eq!(graph.edges, StationId::pairs([[0, 1], [0, 2], [1, 2]]));
    let radii: Vec<f64> = graph.nodes.iter().map(|node| node.radius).collect();
    assert_eq!(radii, [4.0, 3.0, 3.0]);
    let parents: Vec<_> = graph.nodes.iter().map(|node| node.parent.map(StationId::index)).collect();
    assert_eq!(parents, [None, Some(0), Some(0)]);
}

#[test]
fn stations_in_one_place_are_one_node() {
    let text = r#"{"nodes": {
        "0": {"id": 0, "parent": null, "edges": [1], "coordinates": {"x": 0, "y": 0, "z": 0}},
        "1": {"id": 1, "parent": 0, "edges": [2], "coordinates": {"x": 4, "y": 0, "z": 0}},
        "2": {"id": 2, "parent": 1, "edges": [3], "coordinates": {"x": 4, "y": 4, "z": 0}},
        "3": {"id": 3, "parent": 2, "edges": [], "coordinates": {"x": 0.0004, "y": 0, "z": 0}}
    }}"#;
    let graph = read(text).unwrap().graph;
    assert_eq!(graph.nodes.len(), 3);
    assert_eq!(graph.loops(), 1);
    let parents: Vec<_> = graph.nodes.iter().map(|node| node.parent.map(StationId::index)).collect();
    assert_eq!(parents, [None, Some(0), Some(0)]);
}

/// Two parts of two and three nodes and a node alone.
const PARTS: &str = r#"{"nodes": [
    {"id": 8, "coordinates": {"x": 50, "y": 9}},
    {"id": 4, "coordinates": {"x": 0, "y": 0}},
    {"id": 5, "parent": 4, "coordinates": {"x": 5, "y": 0}, "radius": 2},
    {"id": 6, "coordinates": {"x": 9, "y": 0}, "section": {"width_m": 2, "height_m": 1}},
    {"id": 7, "parent": 6, "coordinates": {"x": 9, "y": 4}},
    {"id": 9, "parent": 7, "coordinates": {"x": 9, "y": 8}}
]}"#;

#[test]
fn parts_are_treated_as_asked() {
    let import = |parts| survey::read("parts.json".as_ref(), parts, &Files::one("parts.json", PARTS));
    let told = |import: Result<Import, survey::ReadError>| {
        let Import { graph, tally, .. } = import.unwrap();
        let ids = |node: Option<StationId>| node.map(|node| graph[node].id);
        let parents: Vec<_> = graph.stations().map(|node| (ids(Some(node)), ids(graph[node].parent))).collect();
        let edges: Vec<_> = graph.edges.iter().map(|edge| edge.map(|node| graph[node].id)).collect();
        format!("joined {} left out {}\n{parents:?}\n{edges:?}", tally.joined, tally.left_out)
    };
    insta::assert_snapshot!("parts_refused", import(Parts::Refuse).unwrap_err());
    insta::assert_snapshot!("parts_joined", told(import(Parts::Join)));
    insta::assert_snapshot!("parts_kept", told(import(Parts::Keep)));
    insta::assert_snapshot!("parts_longest", told(import(Parts::Longest)));
    let lone = PARTS.replace(r#""id": 6,"#, r#""id": 6, "parent": 5,"#);
    assert_eq!(read(&lone).unwrap_err(), ReadError::Lone { node: "node 8".to_owned() });
}

#[test]
fn a_file_too_large_is_refused_while_it_is_read() {
    let mut text = r#"{"nodes": ["#.to_owned();
    for id in 0..=1_000_000 {
        let comma = if id == 0 { "" } else { "," };
        write!(text, r#"{comma}{{"id":{id},"coordinates":{{"x":{id},"y":0}}}}"#).unwrap();
    }
    text.push_str("]}");
    assert_eq!(read(&text).unwrap_err(), ReadError::TooMany { what: "nodes", most: 1_000_000 });
}

/// The error for each bad file: one golden text for all of them.
#[test]
fn bad_files_are_refused_with_a_message() {
    let mut files: Vec<_> = fs::read_dir("tests/data/bad_graphs").unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let mut told = String::new();
    for path in files {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let text = fs::read_to_string(&path).unwrap();
        let error = read(&text).expect_err(&name);
        writeln!(told, "{name}\n  error: {error}\n   hint: {}", error.hint()).unwrap();
    }
    insta::assert_snapshot!("bad_graphs", told);
}

fn straight(nodes: usize) -> Graph {
    let node = |i: usize| Node {
        id: i as u64,
        parent: i.checked_sub(1).map(StationId::new),
        position: [2.0 * i as f64, 1.0, -0.5].into(),
        radius: 2.0,
        active: i + 1 == nodes,
        level: 0,
        section: None,
        name: None,
    };
    let edges = StationId::pairs((1..nodes).map(|i| [i, i - 1]));
    Graph::new((0..nodes).map(node).collect(), edges)
}

#[test]
fn a_graph_knows_its_shape() {
    let graph = straight(4);
    assert_eq!(graph.edges, StationId::pairs([[0, 1], [1, 2], [2, 3]]));
    assert_eq!((graph.degree(StationId::new(0)), graph.degree(StationId::new(1))), (1, 2));
    assert_eq!((graph.length_m(), graph.loops()), (6.0, 0));
    let mut closed = graph.clone();
    closed.edges.extend(StationId::pairs([[0, 3]]));
    assert_eq!(closed.loops(), 1);
    let cut = Graph::new(graph.nodes.clone(), StationId::pairs([[2, 3], [3, 2]]));
    assert_eq!(
        cut.components(),
        [&[0][..], &[1], &[2, 3]].map(|part| part.iter().copied().map(StationId::new).collect::<Vec<_>>())
    );
    assert_eq!(Graph::default().bounds(), None);
}

#[test]
fn scaling_scales_every_length() {
    let graph = straight(3).scaled(2.5);
    assert_eq!(graph.length_m(), 10.0);
    assert_eq!(graph.nodes[2].radius, 5.0);
    assert_eq!(graph.bounds().unwrap().max, [10.0, 2.5, -1.25]);
}

proptest! {
    /// Any file is either read or refused, and graphs that are read keep the laws.
    #[test]
    fn damaged_files_are_read_or_refused(
        cuts in prop::collection::vec((any::<prop::sample::Index>(), 0..6_usize, "[-0-9a-z\",:{}\\[\\].]{0,4}"), 1..4)
    ) {
        let mut text = write(&straight(6), "0.1.0", &json!({}));
        for (place, length, patch) in cuts {
            let start = place.index(text.len());
            let end = (start + length).min(text.len());
            text.replace_range(start..end, &patch);
        }
        if let Ok(Document { graph, .. }) = read(&text) {
            prop_assert_eq!(graph.components().len(), 1);
            prop_assert!(graph.nodes.iter().all(|node| node.radius > 0.0));
            prop_assert!(graph.nodes.iter().all(|node| node.position.iter().all(|x| x.is_finite())));
            let back = read(&write(&graph, "0.1.0", &json!({}))).unwrap().graph;
            prop_assert_eq!(back, graph);
        }
    }
}
