//! Graphs as files.
//!
//! ```json
//! {"plume": "0.1.0", "recipe": {…}, "nodes": [
//!   {"id": 0, "parent": null, "edges": [1], "coordinates": {"x": 0, "y": 0, "z": 0}, "radius": 4.2, "active": false}, …
//! ]}
//! ```
//! Optional keys: `level` (default 0), `section` (`width_m`, `height_m`) and `name`, what a survey calls the station. Lengths are
//! in metres, Z is up. A graph from a survey also has `"georeference": {"origin_m": [east, north, up], "system": "UTM33N"}`
//! before its nodes: where its origin is in the coordinates of the survey, and the name of that system, if known.
//!
//! The `data.json` of the original PLUME script (Garcia, Richard, Olivares-Mendez 2025) is read too: nodes as an object
//! keyed by id, edges from one end or both. Stations in the same place, to 1 mm, become one node, because its overlapping
//! tunnels are one cave. If missing, `parent` follows from a walk from the origin, `edges` from the other end and the
//! parent, `z` is 0, `radius` is the distance to the nearest neighbour, `active` is false. Graphs are not moved: nodes more
//! than 1000 km from the origin are refused.
//!
//! ```
//! use plume_survey::json;
//!
//! let text = r#"{"nodes": [
//!     {"id": 0, "edges": [1], "coordinates": {"x": 0, "y": 0}},
//!     {"id": 1, "edges": [], "coordinates": {"x": 6, "y": 0}}
//! ]}"#;
//! let graph = json::read(text)?.graph;
//! assert_eq!((graph.edges.len(), graph.length_m()), (1, 6.0));
//! # Ok::<(), json::ReadError>(())
//! ```

mod error;
mod join;
mod parse;
mod write;

use serde_json::Value;

pub use error::ReadError;
pub use write::write;

use super::{Import, Parts, Source, Tally, Written};
use plume_graph::Graph;

/// The content of a graph file.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// The graph: connected, at least two nodes, unique ids, finite lengths.
    pub graph: Graph,
    /// The recipe it was made from, if the file has one.
    pub recipe: Option<Value>,
    /// Whether it lacks a version, like files of the original script.
    pub original: bool,
}

/// Reads the text of a graph file.
///
/// # Errors
/// If it is not JSON, not a graph, or not a graph of a cave; each error has a hint.
pub fn read(text: &str) -> Result<Document, ReadError> {
    read_parts(text, Parts::Refuse).map(|(document, _)| document)
}

/// The same with disconnected parts treated as asked, and the tally of changes.
///
/// # Errors
/// As [`read`].
pub fn read_parts(text: &str, parts: Parts) -> Result<(Document, Tally), ReadError> {
    let file = parse::parse(text)?;
    let mut draft = join::join(&file.stations)?;
    draft.georeference = file.georeference;
    let finished = draft.finished(parts);
    let name = |station: usize| format!("node {}", file.stations[station].id);
    let (graph, tally) = finished.map_err(|error| ReadError::of_draft(error, name))?;
    Ok((Document { graph, recipe: file.recipe, original: file.version.is_none() }, tally))
}

/// Reader of a row of [`FORMATS`](super::FORMATS).
pub(super) fn import(source: &Source, parts: Parts) -> Result<Import, super::ReadError> {
    let read = read_parts(super::text::utf8(source.path, source.bytes)?, parts);
    let (document, tally) =
        read.map_err(|error| super::ReadError::whole(source.path, error.to_string(), error.hint()))?;
    Ok(Import { graph: document.graph, recipe: document.recipe, tally, warnings: Vec::new() })
}

/// Writer of a row of [`FORMATS`](super::FORMATS), without a recipe.
pub(super) fn export(graph: &Graph) -> Vec<Written> {
    vec![Written { suffix: "", bytes: write(graph, plume_graph::VERSION, &Value::Null).into_bytes() }]
}
