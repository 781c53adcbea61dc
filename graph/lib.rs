//! Graphs of passages.
//!
//! A [`Graph`] is stations joined by passages, in metres, right-handed, Z up. It knows no meshes, and reads files only
//! through [`Outside`]. A [`Generator`] makes one from a seed, using named [random streams](seed) and the [centreline]
//! builder; [`realism`] compares it with real caves.
//!
//! ```
//! use plume_graph::centreline::{CentrelineBuilder, Vertex};
//!
//! let mut centreline = CentrelineBuilder::default();
//! let vertex = |x| Vertex { position: [x, 0.0, 0.0].into(), section: None, level: 0 };
//! let (entrance, end) = (centreline.add(vertex(0.0)), centreline.add(vertex(12.0)));
//! centreline.join(entrance, end);
//! let graph = centreline.into_graph();
//! assert_eq!((graph.nodes.len(), graph.length_m(), graph.loops()), (2, 12.0, 0));
//! ```

mod aabb;
mod branches;
pub mod centreline;
pub mod clearance;
#[doc(hidden)]
pub mod echo;
mod generator;
mod georeference;
mod id;
mod neighbors;
mod outside;
pub mod realism;
pub mod rng;
mod rows;
pub mod section;
pub mod seed;
#[doc(hidden)]
pub mod segment;
#[doc(hidden)]
pub mod sets;
mod shape;
mod spurs;
mod stations;
#[doc(hidden)]
pub mod tidy;

use nalgebra::Point3;

pub use aabb::Aabb;
pub use centreline::VertexId;
pub use generator::{GenerateError, Generator};
pub use georeference::{Georeference, MAX_NAME_BYTES, MAX_ORIGIN_M, name};
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
    /// What the station is called in the survey that it was read from; see [`name()`]. Not necessarily unique.
    pub name: Option<Box<str>>,
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
    /// Where its origin is in the coordinates of a survey, if it was read from one.
    pub georeference: Option<Georeference>,
}
