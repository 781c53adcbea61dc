//! Where the passages go.
//!
//! A [`Graph`] is stations joined by passages, in metres, right-handed, Z up. It knows no meshes, and files only by what
//! [`Outside`] lets it read. A [`Generator`] makes one from a seed ([`GENERATORS`] lists them all), a
//! [`format`](mod@format) reads one.

mod branches;
pub mod clearance;
mod dice;
pub mod format;
pub mod generator;
mod neighbors;
mod outside;
mod perlin;
mod ramp;
mod raster;
pub mod realism;
mod section;
mod segment;
mod sets;
mod shape;
mod sketch;
mod spurs;
mod stations;
mod tidy;

use nalgebra::Point3;

pub use generator::{GENERATORS, GenerateError, Generator, GeneratorRow, generator};
pub use neighbors::Neighbors;
pub use outside::{Nowhere, Outside, RunError, Task};
pub use section::{Section, Shape};
use shape::millimetres;

/// A station: a point on the centreline of a passage.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Name of the station in files; unique in its graph.
    pub id: u64,
    /// Index of the node it grew from; `None` for the origin of each part.
    pub parent: Option<usize>,
    /// Position in metres, rounded to 1 mm.
    pub position: Point3<f64>,
    /// Reach to the next node in metres, as in the PLUME paper; passages are wide by a factor of it.
    pub radius: f64,
    /// Whether the branch ended alive: it may grow on.
    pub active: bool,
    /// Storey, 0 at the top.
    pub level: u32,
    /// Width and height of the passage here in metres, where they do not follow from the radius (a mine's drift).
    pub section: Option<Section>,
}

/// Stations and the passages between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    /// The stations.
    pub nodes: Vec<Node>,
    /// Passages as pairs of indices into `nodes`, smaller first, sorted, unique.
    pub edges: Vec<[usize; 2]>,
}
