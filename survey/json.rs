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
//! and the parent, `z` is 0, `radius` is the distance to the nearest neighbour, `active` is false. Graphs are not moved:
//! what is more than 1000 km from the origin is refused.

mod error;
mod join;
mod parse;
mod write;

use serde_json::Value;

pub use error::ReadError;
pub use write::write;

use super::{Import, Parts, Source, Tally, Written};
use plume_graph::Graph;

/// What a graph file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// The graph: in one part, at least two nodes, unique ids, all lengths finite.
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
    read_parts(text, Parts::Refuse).map(|(document, _)| document)
}

/// The same with parts as asked, and what that took.
///
/// # Errors
/// As [`read`].
pub fn read_parts(text: &str, parts: Parts) -> Result<(Document, Tally), ReadError> {
    let file = parse::parse(text)?;
    let finished = join::join(&file.stations)?.finished(parts);
    let name = |station: usize| format!("node {}", file.stations[station].id);
    let (graph, tally) = finished.map_err(|error| ReadError::of_draft(error, name))?;
    Ok((Document { graph, recipe: file.recipe, original: file.version.is_none() }, tally))
}

/// Reads a file as a row of [`FORMATS`](super::FORMATS) does.
pub(super) fn import(source: &Source, parts: Parts) -> Result<Import, super::ReadError> {
    let read = read_parts(super::text::utf8(source.path, source.bytes)?, parts);
    let (document, tally) =
        read.map_err(|error| super::ReadError::whole(source.path, error.to_string(), error.hint()))?;
    Ok(Import { graph: document.graph, recipe: document.recipe, tally })
}

/// Writes a graph without its recipe, as a row of [`FORMATS`](super::FORMATS) does.
pub(super) fn export(graph: &Graph) -> Vec<Written> {
    vec![Written { suffix: "", bytes: write(graph, plume_graph::VERSION, &Value::Null).into_bytes() }]
}
