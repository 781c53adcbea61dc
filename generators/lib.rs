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

/// Every generator, the default first.
pub static GENERATORS: &[GeneratorRow] = &[
    row::<GaussianPerlin>("gaussian-perlin", "caves: the PLUME paper's walk, kept within the statistics of real caves"),
    row::<Mine>("mine", "drifts and cross-cuts on levels joined by ramps or shafts"),
    row::<External>("external", "any program that writes graph JSON"),
    row::<Layers>(
        "layers",
        "layers of other generators, one below the other, joined by links within a range of slopes",
    ),
    row::<GrownTunnels>("grown-tunnels", "winding tunnels grown one off another, and connectors between them"),
    row::<Cellular>("cellular", "chambers and passages grown from random cells, in layers joined by ramps"),
    row::<Worms>("worms", "winding passages that crawl where noise leads them, and branch"),
    row::<Karst>("karst", "what water dissolves along bedding planes and fractures, from sinks to springs"),
    row::<Heightmap>("heightmap", "the void between a relief and its mirror image, from a picture or of noise"),
    row::<Tiles>("tiles", "tunnels, junctions and rooms put together from parametric tiles"),
    row::<SpaceColonization>("space-colonization", "passages that branch towards open ground until it is taken"),
    row::<LSystem>("l-system", "passages that a grammar of branches describes"),
    row::<File>("file", "a graph or a cave survey from a file"),
];

/// The generator that recipes call `name`.
pub fn generator(name: &str) -> Option<&'static GeneratorRow> {
    GENERATORS.iter().find(|row| row.name == name)
}

fn inlined<G: JsonSchema>() -> schemars::Schema {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    settings.into_generator().into_root_schema_for::<G>()
}

const fn row<G>(name: &'static str, summary: &'static str) -> GeneratorRow
where
    G: Generator + DeserializeOwned + JsonSchema + 'static,
{
    GeneratorRow {
        name,
        summary,
        schema: || inlined::<G>(),
        read: |settings| Ok(Box::new(serde_json::from_value::<G>(settings)?)),
    }
}
