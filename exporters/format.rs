//! File formats: meshes and materials as bytes, in the conventions of one format each. What a simulator expects around
//! them is the business of the targets.

#[doc(hidden)]
pub mod fbx;
#[doc(hidden)]
pub mod gltf;
#[doc(hidden)]
pub mod msh;
pub mod obj;
#[doc(hidden)]
pub mod pixels;
pub mod ply;
pub mod stl;
