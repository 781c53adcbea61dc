//! GraphML (<http://graphml.graphdrawing.org/>), as written and read by networkx, igraph, Gephi and yEd.
//!
//! Position, radius, section and level of a node are under keys of those names; in a yEd drawing without such keys, the
//! position is that of the drawing, as a plan. Edges are undirected. Node names that are numbers, such as `7` or `n7`,
//! become ids; otherwise nodes are numbered. Hyperedges, nested graphs and document types are refused: only the predefined
//! XML entities are known, so that no file can expand in memory.
//!
//! Positions may be in any grid ([`origin`](super::origin)). Preserves everything of a graph except parents.

mod read;
mod write;

pub(super) use read::import;
pub(super) use write::export;
