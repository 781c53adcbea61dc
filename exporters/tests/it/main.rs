//! The integration tests of the exporters.
//!
//! One program, because every further one would be linked and would wait for its slowest test alone.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "sample/changed.rs"]
mod changed;
mod check_formats;
mod check_laws;
mod fbx_reads_back;
mod fbx_things;
#[path = "sample/forge.rs"]
mod forge;
mod friction;
mod gazebo_package;
mod glb_package;
mod gltf_instancing;
mod gltf_meshopt;
mod gltf_package;
mod gravel;
mod hostile_archives;
mod laws;
#[path = "sample/ledger.rs"]
mod ledger;
#[path = "sample/levels.rs"]
mod levels;
mod meshes_read_back;
#[path = "sample/mjcf.rs"]
mod mjcf;
mod mujoco_package;
mod places;
mod sample;
mod station_frames;
#[path = "sample/strewn.rs"]
mod strewn;
mod thing_laws;
mod things_counted;
mod tiles_package;
#[path = "sample/told.rs"]
mod told;
#[path = "sample/touched.rs"]
mod touched;
mod truth_package;
mod unity_package;
mod unity_things;
mod unreal_package;
mod urdf_package;
mod usd_things;
