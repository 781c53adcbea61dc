//! Writes a resolved [`scene::Scene`] as packages for simulators.
//!
//! This crate has never heard of a cave: it gets meshes, encoded textures, lights and poses, in metres and Z up, and
//! writes what each simulator expects. Targets never name each other.

pub mod scene;
