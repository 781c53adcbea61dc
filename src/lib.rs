//! Plume makes underground worlds and hands them to simulators ready to use.
//!
//! One [`recipe`] and one seed give a [`graph`] (where the passages go), a [`field`] (how far is rock), a [`mesh`] in
//! chunks, a [`texture`] set per chunk, and from them a package for a simulator.
//!
//! Arrows point one way: `cli → cave → pipeline, assemble → store → truth, texture → mesh → field → material → noise`, and
//! `field → graph`. See `ARCHITECTURE.md`.

pub mod cli;

pub mod cave;
pub mod pipeline;

pub mod assemble;
pub mod preset;
pub mod preview;
pub mod recipe;
pub mod store;

pub mod texture;
pub mod truth;

pub mod mesh;

pub mod field;
pub mod material;
pub mod noise;

pub mod echo;
pub mod graph;
pub mod seed;

/// The version that every file Plume writes carries.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
