//! The integration tests of the library.
//!
//! One program, because every further one would be linked and would wait for its slowest test alone.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod architecture;
mod cave_laws;
mod collapse_laws;
mod common;
mod docs;
mod field_laws;
mod format_laws;
mod graph_files;
mod graph_laws;
mod graph_realism;
mod growth_laws;
mod layer_laws;
mod lod_laws;
mod mesh_laws;
mod model_laws;
mod piece_laws;
mod preview_contrast;
mod preview_laws;
mod size_laws;
mod survey_files;
mod survey_text;
mod texture_bake;
mod texture_laws;
mod texture_support;
mod texture_unwrap;
mod thing_laws;
mod truth_laws;
