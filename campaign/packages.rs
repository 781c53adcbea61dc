//! The kinds of packages that need no Python.

/// Targets.
pub const TARGETS: [&str; 11] =
    ["gazebo", "mujoco", "unity", "unreal", "urdf", "glb", "gltf", "fbx", "obj", "ply", "stl"];

/// Bundles, each with a target that has it.
pub const BUNDLES: [(&str, &str); 4] = [("zip", "obj"), ("tar.zst", "obj"), ("tgz", "unity"), ("mjz", "mujoco")];
