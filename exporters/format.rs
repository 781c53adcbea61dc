//! File formats: meshes and materials as bytes, each in the conventions of one format. What a simulator expects around them
//! is up to the targets.

#[doc(hidden)]
pub mod fbx;
pub mod geotiff;
#[doc(hidden)]
pub mod gltf;
pub mod graphml;
pub mod las;
#[doc(hidden)]
pub mod msh;
pub mod npy;
pub mod obj;
pub mod octomap;
pub mod pcd;
#[doc(hidden)]
pub mod pixels;
pub mod ply;
pub mod points;
pub mod ros2;
pub mod stl;
pub mod survex;
pub mod tileset;
