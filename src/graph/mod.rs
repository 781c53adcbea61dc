//! Where the passages go.
//!
//! A [`Graph`] is stations joined by passages, in metres, right-handed, Z up. It knows no meshes and no files.
//! A [`Generator`] makes one from a seed; [`GENERATORS`] lists them all.

mod dice;
pub mod gaussian_perlin;
pub mod json;
pub mod metrics;
pub mod mine;
mod reduced;
mod shape;

use nalgebra::Point3;
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

pub use gaussian_perlin::GaussianPerlin;
pub use mine::Mine;
use shape::millimetres;

/// A station: a point on the centreline of a passage.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Name of the station in files; unique in its graph.
    pub id: u64,
    /// Index of the node it grew from; `None` for the origin.
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

/// The cross-section of a passage, in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Section {
    /// Full width.
    pub width_m: f64,
    /// Full height.
    pub height_m: f64,
}

/// Stations and the passages between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    /// The stations.
    pub nodes: Vec<Node>,
    /// Passages as pairs of indices into `nodes`, smaller first, sorted, unique.
    pub edges: Vec<[usize; 2]>,
}

/// Makes a graph from a seed. Its settings are its fields.
pub trait Generator: std::fmt::Debug + Send + Sync {
    /// The graph of this seed: the same for the same settings and seed on every machine.
    ///
    /// # Errors
    /// When the settings leave no room for the asked number of nodes.
    fn generate(&self, seed: u64) -> Result<Graph, GenerateError>;
}

/// A generator could not reach what was asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
#[non_exhaustive]
pub struct GenerateError {
    /// What could not be reached, lower case.
    pub message: String,
    /// What to change.
    pub hint: String,
}

/// A row of [`GENERATORS`].
#[derive(Debug)]
pub struct GeneratorRow {
    /// Name in recipes.
    pub name: &'static str,
    /// One line for `plume list`.
    pub summary: &'static str,
    /// JSON Schema of the settings: descriptions, ranges, defaults.
    pub schema: fn() -> schemars::Schema,
    /// Reads settings (an object holding a subset of the keys).
    pub read: fn(Value) -> Result<Box<dyn Generator>, serde_json::Error>,
}

/// Every generator, the default first.
pub static GENERATORS: &[GeneratorRow] = &[
    row::<GaussianPerlin>("gaussian-perlin", "caves: the PLUME paper's walk, kept within the statistics of real caves"),
    row::<Mine>("mine", "drifts and cross-cuts on levels joined by ramps or shafts"),
];

/// The generator that recipes call `name`.
pub fn generator(name: &str) -> Option<&'static GeneratorRow> {
    GENERATORS.iter().find(|row| row.name == name)
}

const fn row<G>(name: &'static str, summary: &'static str) -> GeneratorRow
where
    G: Generator + DeserializeOwned + JsonSchema + 'static,
{
    GeneratorRow {
        name,
        summary,
        schema: || schemars::schema_for!(G),
        read: |settings| Ok(Box::new(serde_json::from_value::<G>(settings)?)),
    }
}
