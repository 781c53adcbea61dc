//! GraphML (<http://graphml.graphdrawing.org/>), as networkx, igraph, Gephi and yEd write and read it.
//!
//! A node has its place, radius, section and level under keys of those names; where a drawing of yEd has no such keys, it is
//! where it is drawn, seen from above. Edges have no direction. Names of nodes that are numbers, as `7` or `n7`, become ids;
//! otherwise nodes are numbered. Hyperedges, graphs inside nodes and document types are refused: this reader knows no
//! entities but those of XML itself, so that no file can grow in memory.
//!
//! Places may be of any grid ([`origin`](super::origin)). Held is all of a graph but its parents.

mod read;
mod write;

pub(super) use read::import;
pub(super) use write::export;
