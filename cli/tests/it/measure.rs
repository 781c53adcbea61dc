//! Exact output of `plume measure` for graphs and cave folders, and what its gate and that of recipes accept.

use std::fs;

use crate::command;
use command::Desk;
use insta::assert_snapshot;
use serde_json::{Value, json};

/// Exit code, stdout and stderr.
fn said(desk: &Desk, arguments: &[&str]) -> String {
    let output = desk.run(&[&["measure"], arguments].concat());
    let [out, fault] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    format!("exit {}\n{out}{fault}", output.status.code().unwrap())
}

fn read(desk: &Desk, arguments: &[&str]) -> Value {
    let output = desk.run(&[&["measure", "--json"], arguments].concat());
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A real cave as a graph file: Sakany.
fn sakany(desk: &Desk) {
    let table = |file: &str| fs::read_to_string(format!("../tests/data/sakany/{file}")).unwrap();
    let places: Vec<Vec<f64>> =
        table("Sakany_nodes.dat").lines().map(|l| l.split_whitespace().map(|x| x.parse().unwrap()).collect()).collect();
    let mut edges = vec![Vec::new(); places.len()];
    for line in table("Sakany_links.dat").lines() {
        let ends: Vec<usize> = line.split_whitespace().map(|x| x.parse::<usize>().unwrap() - 1).collect();
        edges[ends[0]].push(ends[1]);
    }
    let nodes = places.iter().zip(&edges).enumerate().map(|(id, (at, edges))| {
        json!({"id": id, "edges": edges, "radius": 1, "coordinates": {"x": at[0], "y": at[1], "z": at[2]}})
    });
    desk.file("sakany.json", &json!({"plume": "0", "nodes": nodes.collect::<Vec<_>>()}).to_string());
}

#[test]
fn a_graph_is_compared_with_real_caves() {
    let desk = Desk::new();
    sakany(&desk);
    assert_snapshot!("sakany", said(&desk, &["sakany.json"]));
    let graph = &read(&desk, &["sakany.json"])["graph"];
    assert_eq!((graph["verdict"].as_str(), graph["stations"].as_u64()), (Some("unusual"), Some(1716)));
    assert_eq!(graph["metrics"]["tortuosity"]["standing"], "core");
    assert!(said(&desk, &["sakany.json", "--gate"]).starts_with("exit 1\n"));
}

#[test]
fn too_small_graphs_and_other_files_are_reported() {
    let desk = Desk::new();
    let at = |x: u32| json!({"x": x, "y": 0, "z": 0});
    let node = |id: u32, edges: &[u32]| json!({"id": id, "edges": edges, "radius": 1, "coordinates": at(3 * id)});
    desk.file("line.json", &json!({"nodes": [node(0, &[1]), node(1, &[2]), node(2, &[])]}).to_string());
    assert_snapshot!("line", said(&desk, &["line.json", "--gate"]));
    desk.file("letter.txt", "dear diary");
    assert!(said(&desk, &["letter.txt"]).starts_with("exit 2\nerror: letter.txt: has no known graph format\n"));
    assert!(said(&desk, &["nowhere"]).starts_with("exit 2\nerror: nowhere: No such file or directory"));
    let import = desk.fault(&["graph", "import", "nowhere", "-o", "graph.json"]);
    assert!(import.starts_with("exit 2\nerror: nowhere: No such file or directory"), "{import}");
    assert_snapshot!("no_such_parts", said(&desk, &["line.json", "--parts", "some"]));
    for rock in ["nan", "inf", "-1", "1e9"] {
        assert!(said(&desk, &["line.json", &format!("--rock={rock}")]).contains("must be a number from 0 to 100"));
    }
    fs::create_dir(desk.path("empty")).unwrap();
    assert!(said(&desk, &["empty"]).starts_with("exit 2\nerror: empty: does not contain a cave\n hint: "));
}

#[test]
fn a_cave_folder_is_measured_from_its_graph_to_its_mesh() {
    let desk = Desk::new();
    let cave = ["--output", "cave", "--set", "graph.nodes=30", "--quiet"];
    assert!(desk.run(&[&["graph"], &cave[..]].concat()).status.success());
    let graph = read(&desk, &["cave"]);
    assert_eq!(graph["graph"]["verdict"], "real");
    assert!(graph["triangles"].is_null());
    desk.make(&["mesh", "--output", "small"]);
    let both = read(&desk, &["small"]);
    assert_eq!(both["graph"]["verdict"], "too_small");
    assert!(both["triangles"].as_u64().is_some_and(|count| count > 0), "{both}");
    let text = said(&desk, &["small"]);
    assert!(
        text.contains("\nmesh\n  vertices ") && text.contains("\nthe genus counts the handles of the wall: "),
        "{text}"
    );
}

#[test]
fn recipes_have_a_gate_for_any_generator() {
    let desk = Desk::new();
    desk.file("mine.toml", "[graph]\ngenerator = \"mine\"\nnodes = 120\n\n[realism]\ngate = \"reject\"\ntries = 3\n");
    assert_snapshot!("none_passes", desk.fault(&["graph", "mine.toml", "--output", "mine"]));
    assert_eq!(desk.fault(&["preview", "mine.toml"]), desk.fault(&["graph", "mine.toml", "--output", "mine"]));
    let repair = ["graph", "mine.toml", "--set", "realism.gate=repair", "--output", "mine", "--quiet"];
    assert!(desk.run(&repair).status.success());
    assert!(said(&desk, &["mine", "--gate"]).starts_with("exit 0\n"));
    // The folder keeps its graph, and does not when another gate is asked for.
    let before = desk.hashes("mine");
    assert!(desk.run(&["graph", "mine", "--output", "mine", "--quiet"]).status.success());
    assert_eq!(desk.hashes("mine"), before);
    let open = ["graph", "mine", "--set", "realism.gate=off", "--output", "mine", "--force", "--quiet"];
    assert!(desk.run(&open).status.success());
    assert!(said(&desk, &["mine", "--gate"]).starts_with("exit 1\n"));
}
