//! Plume makes underground worlds and hands them to simulators ready to use.
//!
//! One [`recipe`] and one seed give a [`graph`] (where the passages go), a [`field`] (how far is rock), a [`mesh`] in
//! chunks, a [`texture`] set per chunk, and from them a package for a simulator.
//!
//! Arrows point one way: `cli → pipeline → assemble, store → truth, texture → mesh → field → material → noise`, and
//! `field → graph`. See `ARCHITECTURE.md`.

pub mod field;
pub mod graph;
pub mod material;
pub mod mesh;
pub mod noise;
pub mod seed;
pub mod texture;
