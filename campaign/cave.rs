//! The cave that is attacked: small, so that a try takes a fraction of a second.

use std::path::{Path, PathBuf};

use crate::desk::Desk;

/// Four stations in two chunks, with every kind of file that a cave folder has but for pieces.
pub const SMALL: [&str; 8] = [
    "--set",
    "graph.nodes=4",
    "--set",
    "mesh.voxel_m=0.4",
    "--set",
    "texture.size_px=256",
    "--set",
    "mesh.chunk_m=[12, 12, 12]",
];

/// Makes it in `scratch`.
pub fn make(plume: &Path, scratch: &Path) -> PathBuf {
    let desk = Desk::new(plume, scratch);
    desk.run(&[&["generate", "--output", "c"][..], &SMALL].concat()).done().expect("the small cave can be made");
    let cave = scratch.join("cave");
    crate::tree::copy(&desk.path("c"), &cave).expect("a folder can be copied");
    cave
}
