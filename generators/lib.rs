//! Every way to lay out a cave: one file and one row each.

mod cellular;
mod external;
mod file;
pub mod gaussian_perlin;
pub mod grown_tunnels;
mod heightmap;
mod karst;
pub mod l_system;
pub mod layers;
pub mod mine;
mod network;
mod perlin;
mod ramp;
mod raster;
pub mod space_colonization;
mod tiles;
pub mod worms;

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::de::DeserializeOwned;
use serde_json::Value;

pub use cellular::Cellular;
pub use external::External;
pub use file::File;
pub use gaussian_perlin::GaussianPerlin;
pub use grown_tunnels::GrownTunnels;
pub use heightmap::Heightmap;
pub use karst::Karst;
pub use l_system::LSystem;
pub use layers::Layers;
pub use mine::Mine;
pub use space_colonization::SpaceColonization;
pub use tiles::Tiles;
pub use worms::Worms;

use plume_graph::{GenerateError, Generator};
use plume_registry::{Named, Registry};

/// A row of [`GENERATORS`].
#[derive(Debug)]
pub struct GeneratorRow {
    /// Name in recipes.
    pub name: &'static str,
    /// One line for `plume list`.
    pub summary: &'static str,
    /// JSON Schema of the settings: descriptions, ranges, defaults. A text with `"format": "path"` names a file, which a
    /// recipe means relative to itself.
    pub schema: fn() -> schemars::Schema,
    /// Reads settings (an object holding a subset of the keys).
    pub read: fn(Value) -> Result<Box<dyn Generator>, serde_json::Error>,
}

/// Every generator, the default first. Programs may [register](Registry::register) their own.
pub static GENERATORS: Registry<GeneratorRow> = Registry::new(&[
    GeneratorRow::new::<GaussianPerlin>(
        "gaussian-perlin",
        "caves: the PLUME paper's walk, kept within the statistics of real caves",
    ),
    GeneratorRow::new::<Mine>("mine", "drifts and cross-cuts on levels joined by ramps or shafts"),
    GeneratorRow::new::<External>("external", "any program that writes graph JSON"),
    GeneratorRow::new::<Layers>(
        "layers",
        "layers of other generators, one below the other, joined by links within a range of slopes",
    ),
    GeneratorRow::new::<GrownTunnels>(
        "grown-tunnels",
        "winding tunnels grown one off another, and connectors between them",
    ),
    GeneratorRow::new::<Cellular>(
        "cellular",
        "chambers and passages grown from random cells, in layers joined by ramps",
    ),
    GeneratorRow::new::<Worms>("worms", "winding passages that crawl where noise leads them, and branch"),
    GeneratorRow::new::<Karst>(
        "karst",
        "what water dissolves along bedding planes and fractures, from sinks to springs",
    ),
    GeneratorRow::new::<Heightmap>(
        "heightmap",
        "the void between a relief and its mirror image, from a picture or of noise",
    ),
    GeneratorRow::new::<Tiles>("tiles", "tunnels, junctions and rooms put together from parametric tiles"),
    GeneratorRow::new::<SpaceColonization>(
        "space-colonization",
        "passages that branch towards open ground until it is taken",
    ),
    GeneratorRow::new::<LSystem>("l-system", "passages that a grammar of branches describes"),
    GeneratorRow::new::<File>("file", "a graph or a cave survey from a file"),
]);

impl GeneratorRow {
    /// The row of a generator whose settings are its fields, each with a doc comment, a range and a default.
    pub const fn new<G>(name: &'static str, summary: &'static str) -> Self
    where
        G: Generator + DeserializeOwned + JsonSchema + 'static,
    {
        Self {
            name,
            summary,
            schema: || inlined::<G>(),
            read: |settings| Ok(Box::new(serde_json::from_value::<G>(settings)?)),
        }
    }
}

impl Named for GeneratorRow {
    fn name(&self) -> &'static str {
        self.name
    }
}

fn inlined<G: JsonSchema>() -> schemars::Schema {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    settings.into_generator().into_root_schema_for::<G>()
}
