//! Plume makes underground worlds and exports them ready to use for simulators.
//!
//! One recipe and one seed give a [`graph`] (where the passages go), a [`field`] (how far is rock), a [`mesh`] in chunks, a
//! set of images for each chunk, and from them a package for a simulator. Same recipe, seed and version, same bytes.
//!
//! ```
//! use plume::Recipe;
//! use plume::graph::NoOutside;
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let recipe = Recipe::from_overrides(&["graph.generator=mine".to_owned(), "graph.nodes=40".to_owned()])?;
//! let graph = recipe.graph().generate(recipe.seed(), &NoOutside)?;
//! assert_eq!(graph.nodes.len(), 40);
//! # Ok(())
//! # }
//! ```
//!
//! [`cave`] shows the way from a recipe to a package.
//!
//! # Extending
//!
//! | what | trait | register it in | example |
//! |---|---|---|---|
//! | layout of passages | [`Generator`] | [`GENERATORS`] | `cli/examples/own_generator.rs` |
//! | rock | [`Rock`] | [`MATERIALS`] | `cli/examples/own_rock.rs` |
//! | target | [`Target`] | [`TARGETS`] | `cli/examples/own_target.rs` |
//!
//! A field of your own is meshed by [`mesh::chunk`]: see `examples/sphere_to_stl.rs`.
//!
//! # What stays
//!
//! The names at this root and the modules listed here are the interface; those left out of the documentation serve the
//! command line and the Python package and change without notice.

pub mod cave;
pub mod mesh;
pub mod recipe;

#[doc(hidden)]
pub mod assemble;
#[doc(hidden)]
pub mod model;
#[doc(hidden)]
pub mod pipeline;
#[doc(hidden)]
pub mod placement;
#[doc(hidden)]
pub mod preset;
#[doc(hidden)]
pub mod preview;
#[doc(hidden)]
pub mod store;
#[doc(hidden)]
pub mod texture;
#[doc(hidden)]
pub mod things;
pub mod trajectory;

pub use plume_exporters as exporters;
pub use plume_generators as generators;
pub use plume_graph as graph;
pub use plume_registry as registry;
#[doc(hidden)]
pub use plume_rock::picture;
use plume_rock::srgb;
pub use plume_rock::{field, material, noise};
pub use plume_survey as survey;
pub use plume_truth as truth;

pub use cave::{Cave, CaveError, Input};
pub use exporters::{ExportError, TARGETS, Target, TargetRow};
pub use field::{Analytic, CaveField, Field};
pub use generators::{GENERATORS, GeneratorRow};
pub use graph::{GenerateError, Generator, Graph, VERSION};
pub use material::{MATERIALS, Material, MaterialRow, Rock};
pub use mesh::{Grid, Mesh, MeshSettings};
pub use pipeline::{Observer, Unobserved};
pub use plume_truth::robot;
pub use recipe::Recipe;
pub use registry::{RegisterError, Registry};
pub use store::{CaveFolder, Stage};
