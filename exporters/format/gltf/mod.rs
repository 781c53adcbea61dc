//! glTF 2.0 as JSON and bytes.
//!
//! Written after the Khronos specification 2.0 (<https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>).

pub mod glb;
mod layout;

pub use layout::{Layout, bounds};
