//! The files and programs that generators find in the tests, and graphs of every generator.

use std::io;
use std::path::Path;

use plume::generators::{GENERATORS, GeneratorRow};
use plume::graph::{Graph, Outside, RunError, Task};
use plume::material::{MATERIALS, MaterialRow};
use serde_json::{Value, json};

/// Provides small built-in files.
pub struct World;

impl Outside for World {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        match path.to_str() {
            Some("graph.json") => Ok(LOOP.as_bytes().to_vec()),
            _ => Err(io::ErrorKind::NotFound.into()),
        }
    }

    fn run(&self, _: &Task) -> Result<Vec<u8>, RunError> {
        Ok(LOOP.as_bytes().to_vec())
    }
}

/// A loop with a dead end.
const LOOP: &str = r#"{"plume": "", "nodes": [
    {"id": 0, "parent": null, "edges": [1, 3], "coordinates": {"x": 0, "y": 0, "z": 0}, "radius": 4, "active": false},
    {"id": 1, "parent": 0, "edges": [2], "coordinates": {"x": 6, "y": 0, "z": 0}, "radius": 4, "active": false},
    {"id": 2, "parent": 1, "edges": [3], "coordinates": {"x": 7, "y": 6, "z": 1}, "radius": 4, "active": false},
    {"id": 3, "parent": 0, "edges": [4], "coordinates": {"x": 1, "y": 7, "z": 0}, "radius": 4, "active": false},
    {"id": 4, "parent": 3, "edges": [], "coordinates": {"x": -4, "y": 10, "z": -1}, "radius": 4, "active": true}
]}"#;

/// The first generator in every rock, and each other one in one rock, by turns: for laws that are too slow for every pair.
pub fn kinds() -> Vec<(&'static GeneratorRow, &'static MaterialRow)> {
    let first = MATERIALS.iter().map(|rock| (GENERATORS.default_row(), rock));
    first.chain(GENERATORS.iter().skip(1).zip(MATERIALS.iter().cycle())).collect()
}

/// Whether a generator has a setting of this name.
pub fn has(row: &GeneratorRow, key: &str) -> bool {
    !(row.schema)().to_value()["properties"][key].is_null()
}

/// Settings with this number of nodes, if supported.
pub fn sized(row: &GeneratorRow, nodes: u32) -> Value {
    if has(row, "nodes") { json!({ "nodes": nodes }) } else { json!({}) }
}

/// A small graph.
pub fn small(row: &GeneratorRow, nodes: u32, seed: u64) -> Graph {
    let settings = match row.name {
        "layers" => json!({"layer": [{"nodes": nodes}, {"nodes": nodes}], "link_count": 1}),
        _ => sized(row, nodes),
    };
    let generator = (row.read)(settings).expect("the settings are its own");
    generator.generate(seed, &World).expect(row.name)
}
