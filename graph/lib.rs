//! Graphs of passages.
//!
//! A [`Graph`] is stations joined by passages, in metres, right-handed, Z up. It knows no meshes, and reads files only
//! through [`Outside`]. A [`Generator`] makes one from a seed, using named [random streams](seed) and the [centreline]
//! builder; [`realism`] compares it with real caves.

mod aabb;
mod branches;
pub mod centreline;
pub mod clearance;
pub mod echo;
mod generator;
mod id;
mod neighbors;
mod outside;
pub mod realism;
pub mod rng;
mod rows;
pub mod section;
pub mod seed;
pub mod segment;
pub mod sets;
mod shape;
mod spurs;
mod stations;
pub mod tidy;

use nalgebra::Point3;

pub use aabb::Aabb;
pub use centreline::VertexId;
pub use generator::{GenerateError, Generator};
pub use id::Id;
pub use neighbors::Neighbors;
pub use outside::{NoOutside, Outside, RunError, Task};
pub use rows::Rows;
pub use section::{Section, Shape};
pub use shape::millimetres;

/// The version written to every file.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// A station: a point on the centreline of a passage.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Name of the station in files; unique in its graph.
    pub id: u64,
    /// The node it grew from; `None` for the origin of each part.
    pub parent: Option<StationId>,
    /// Position in metres, rounded to 1 mm.
    pub position: Point3<f64>,
    /// Reach to the next node in metres, as in the PLUME paper; passage widths are proportional to it.
    pub radius: f64,
    /// Whether the branch may grow further.
    pub active: bool,
    /// Storey, 0 at the top.
    pub level: u32,
    /// Width and height of the passage here in metres, unless they follow from the radius.
    pub section: Option<Section>,
}

/// A station of a graph: its place among the nodes.
pub type StationId = Id<Node>;

/// Stations and the passages between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    /// The stations.
    pub nodes: Vec<Node>,
    /// Passages as pairs of stations, smaller first, sorted, unique.
    pub edges: Vec<[StationId; 2]>,
}
