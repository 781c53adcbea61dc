//! File formats: meshes and materials as bytes, in the conventions of one format each. What a simulator expects around
//! them is the business of the targets.

pub mod fbx;
pub mod gltf;
pub mod msh;
pub mod obj;
pub mod pixels;
pub mod ply;
pub mod stl;
