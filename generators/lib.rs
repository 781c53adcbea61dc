//! The generators of cave graphs: one file and one row each.
//!
//! ```
//! use plume_generators::GENERATORS;
//! use plume_graph::NoOutside;
//!
//! let row = GENERATORS.find("karst").ok_or("no such generator")?;
//! let generator = (row.read)(serde_json::json!({"nodes": 60}))?;
//! assert_eq!(generator.generate(7, &NoOutside)?, generator.generate(7, &NoOutside)?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cellular;
mod external;
mod file;
#[doc(hidden)]
pub mod gaussian_perlin;
#[doc(hidden)]
pub mod grown_tunnels;
mod heightmap;
mod karst;
#[doc(hidden)]
pub mod l_system;
#[doc(hidden)]
pub mod layers;
#[doc(hidden)]
pub mod mine;
mod network;
mod perlin;
mod ramp;
mod raster;
#[doc(hidden)]
pub mod space_colonization;
mod tiles;
#[doc(hidden)]
pub mod worms;

use schemars::{JsonSchema, Schema};
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
use plume_registry::{Named, Registry, settings_schema};

/// A row of [`GENERATORS`].
pub struct GeneratorRow {
    /// Name in recipes.
    pub name: &'static str,
    /// One line for `plume list`.
    pub summary: &'static str,
    /// What it is based on, as Markdown for `docs/gallery.md`.
    pub source: &'static str,
    /// A sample recipe, `SAMPLE.toml`, with its picture, `SAMPLE.png`; relative to the repository.
    pub sample: &'static str,
    /// JSON Schema of the settings: descriptions, ranges, defaults. A string with `"format": "path"` is a file name relative
    /// to the recipe.
    pub schema: &'static (dyn Fn() -> Schema + Sync),
    /// Reads settings (an object with a subset of the keys).
    pub read: &'static (dyn Fn(Value) -> Result<Box<dyn Generator>, serde_json::Error> + Sync),
}

/// Every generator, the default first. Programs may [register](Registry::register) their own.
pub static GENERATORS: Registry<GeneratorRow> = Registry::new(&[
    GeneratorRow::new::<GaussianPerlin>(
        "gaussian-perlin",
        "caves: the random walk of the PLUME paper, within the statistics of real caves",
    )
    .based_on(
        "the PLUME paper (Garcia, Richard, Olivares-Mendez 2025), with branch lengths, loops and clearances that \
             make it like real caves",
        "samples/cave",
    ),
    GeneratorRow::new::<Mine>("mine", "drifts and cross-cuts on levels joined by ramps or shafts")
        .based_on("room and pillar, drifts and cross-cuts (Hustrulid & Bullock 2001)", "samples/mine"),
    GeneratorRow::new::<External>("external", "any program that writes graph JSON")
        .based_on("any program", "examples/external/decline"),
    GeneratorRow::new::<Layers>(
        "layers",
        "layers made by other generators, one below another, joined by links within a range of slopes",
    )
    .based_on("layers of any of these, one below another", "samples/layers"),
    GeneratorRow::new::<GrownTunnels>(
        "grown-tunnels",
        "winding tunnels that branch off each other, and connectors between them",
    )
    .based_on("Cano, Tardioli, Mosteo 2023: grown and connector tunnels", "samples/grown-tunnels"),
    GeneratorRow::new::<Cellular>(
        "cellular",
        "chambers and passages of a cellular automaton, in layers joined by ramps",
    )
    .based_on("Johnson, Yannakakis, Togelius 2010: cellular automata", "samples/cellular"),
    GeneratorRow::new::<Worms>("worms", "winding, branching passages that follow noise")
        .based_on("Perlin worms, the random walk of voxel games", "samples/worms"),
    GeneratorRow::new::<Karst>(
        "karst",
        "conduits dissolved by water along bedding planes and fractures, from sinks to springs",
    )
    .based_on(
        "Paris, Guérin, Peytavie, Collon, Galin 2021: cheapest paths for water along horizons and fractures",
        "samples/karst",
    ),
    GeneratorRow::new::<Heightmap>(
        "heightmap",
        "the void between a relief, from a picture or noise, and its mirror image",
    )
    .based_on("an image or elevation model and its mirror image", "samples/heightmap"),
    GeneratorRow::new::<Tiles>("tiles", "tunnels, junctions and rooms assembled from parametric tiles")
        .based_on("parametric tiles, as in the DARPA Subterranean Challenge", "samples/tiles"),
    GeneratorRow::new::<SpaceColonization>(
        "space-colonization",
        "passages that branch towards free space until it is filled",
    )
    .based_on("Runions, Lane, Prusinkiewicz 2007", "samples/space-colonization"),
    GeneratorRow::new::<LSystem>("l-system", "branching passages described by a grammar").based_on(
        "Prusinkiewicz & Lindenmayer 1990, Mark et al. 2015; the grammar is part of the recipe",
        "samples/l-system",
    ),
    GeneratorRow::new::<File>("file", "a graph or a cave survey from a file")
        .based_on("graphs and surveys from files", "samples/original"),
]);

impl GeneratorRow {
    /// The row of a generator, whose fields are its settings, each with a doc comment, a range and a default.
    pub const fn new<G>(name: &'static str, summary: &'static str) -> Self
    where
        G: Generator + DeserializeOwned + JsonSchema + 'static,
    {
        Self {
            name,
            summary,
            source: "",
            sample: "",
            schema: &settings_schema::<G>,
            read: &|settings| Ok(Box::new(serde_json::from_value::<G>(settings)?)),
        }
    }

    /// The row with the generator's source and sample recipe, as listed in `docs/gallery.md`.
    pub const fn based_on(self, source: &'static str, sample: &'static str) -> Self {
        Self { source, sample, ..self }
    }
}

impl std::fmt::Debug for GeneratorRow {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("GeneratorRow").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Named for GeneratorRow {
    fn name(&self) -> &'static str {
        self.name
    }
}
