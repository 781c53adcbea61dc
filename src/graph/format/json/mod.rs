//! Graphs as files.
//!
//! ```json
//! {"plume": "0.1.0", "recipe": {…}, "nodes": [
//!   {"id": 0, "parent": null, "edges": [1], "coordinates": {"x": 0, "y": 0, "z": 0}, "radius": 4.2, "active": false}, …
//! ]}
//! ```
//! Optional beside them: `level` (0 when absent) and `section` (`width_m`, `height_m`). Lengths are metres, Z is up.
//!
//! Read as well is what the original PLUME script (Garcia, Richard, Olivares-Mendez 2025) writes as `data.json`: nodes
//! as an object keyed by id, edges from one end or both. Stations in the same place, to 1 mm, become one node, as its
//! overlapping tunnels are one cave. Left out, `parent` follows from a walk from the origin, `edges` from the other end
//! and the parent, `z` is 0, `radius` is the distance to the nearest neighbour, `active` is false.

mod error;
mod join;
mod parse;
mod write;

use serde_json::Value;

pub use error::ReadError;
pub use write::write;

use super::{Import, Parts, Source, Tally, Written};
use crate::graph::Graph;

/// What a graph file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// The graph: connected, at least two nodes, unique ids, all lengths finite.
    pub graph: Graph,
    /// The recipe it was made from, where the file has one.
    pub recipe: Option<Value>,
    /// Whether it names no version, as the files of the original script do not.
    pub original: bool,
}

/// Reads the text of a graph file.
///
/// # Errors
/// When it is no JSON, no graph, or a graph of which no cave can be made; each error has a hint.
pub fn read(text: &str) -> Result<Document, ReadError> {
    let file = parse::parse(text)?;
    Ok(Document { graph: join::join(&file.stations)?, recipe: file.recipe, original: file.version.is_none() })
}

/// Reads a file as a row of [`FORMATS`](super::FORMATS) does.
pub(super) fn import(source: &Source, _: Parts) -> Result<Import, super::ReadError> {
    let text = str::from_utf8(source.bytes);
    let text = text.map_err(|error| {
        super::ReadError::byte(source.path, error.valid_up_to(), "is not UTF-8 text", "save the file as UTF-8")
    })?;
    let document = read(text.trim_start_matches('\u{feff}'));
    let document = document.map_err(|error| super::ReadError::whole(source.path, error.to_string(), error.hint()))?;
    Ok(Import { graph: document.graph, recipe: document.recipe, tally: Tally::default() })
}

/// Writes a graph without its recipe, as a row of [`FORMATS`](super::FORMATS) does.
pub(super) fn export(graph: &Graph) -> Vec<Written> {
    vec![Written { suffix: "", bytes: write(graph, crate::VERSION, &Value::Null).into_bytes() }]
}
