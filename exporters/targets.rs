//! Every target, one file each.

pub mod assimp;
pub mod fbx;
pub mod gazebo;
pub mod glb;
pub mod gltf;
pub mod isaac;
pub mod mujoco;
pub mod obj;
pub mod ply;
pub mod stl;
pub mod tiles;
pub mod truth;
pub mod unity;
pub mod unreal;
pub mod urdf;
pub mod usd;
pub mod usdz;
