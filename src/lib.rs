//! Plume makes underground worlds and hands them to simulators ready to use.
//!
//! One [`recipe`] and one seed give a [`graph`] (where the passages go), a [`field`] (how far is rock), a [`mesh`] in
//! chunks, a [`texture`] set per chunk, and from them a package for a simulator.
//!
//! Arrows point one way: `cave → pipeline, assemble → store → placement, texture → mesh → field → material → noise`, and
//! `field → graph`. See `ARCHITECTURE.md`.

pub mod cave;
pub mod pipeline;

pub mod assemble;
pub mod preset;
pub mod preview;
pub mod recipe;
pub mod store;

pub mod placement;
pub mod texture;

pub mod mesh;

pub mod field;
pub mod material;
pub mod noise;

pub use plume_exporters as exporters;
pub use plume_generators as generators;
pub use plume_graph as graph;
pub use plume_registry as registry;
pub use plume_survey as survey;

pub use plume_graph::VERSION;
