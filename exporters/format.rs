//! File formats: meshes and materials as bytes, each in the conventions of one format. What a simulator expects around them
//! is up to the targets.

#[doc(hidden)]
pub mod fbx;
#[doc(hidden)]
pub mod gltf;
#[doc(hidden)]
pub mod msh;
pub mod npy;
pub mod obj;
#[doc(hidden)]
pub mod pixels;
pub mod ply;
pub mod stl;
