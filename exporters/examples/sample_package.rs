//! Writes the sample scene for every target that needs no library: `sample_package FOLDER` makes `FOLDER/<target>`,
//! `FOLDER/glb_chunks` with a file per chunk, `FOLDER/<target>_meshopt` packed, and `FOLDER/<target>_pieces` with convex pieces where they are offered.

use std::error::Error;
use std::path::{Path, PathBuf};

use plume_exporters::package::{Existing, Folder};
use plume_exporters::{TARGETS, TargetRow, target};
use serde_json::{Value, json};

#[path = "../tests/sample/mod.rs"]
mod sample;

fn main() -> Result<(), Box<dyn Error>> {
    let folder: PathBuf = std::env::args_os().nth(1).ok_or("usage: sample_package FOLDER")?.into();
    let textures = tempfile::tempdir()?;
    let chamber = sample::Chamber::new(textures.path())?;
    for row in TARGETS.iter().filter(|row| !row.needs_usd() && !row.needs_format()) {
        write(&folder.join(row.name), row, json!({}), &chamber)?;
    }
    for (name, settings) in [
        ("glb_chunks", json!({ "per_chunk": true, "lods": true })),
        ("glb_lods", json!({ "lods": true })),
        ("glb_pieces", json!({ "collision": "pieces" })),
        ("glb_meshopt", json!({ "compression": "meshopt", "lods": true })),
        ("gltf_pieces", json!({ "collision": "pieces" })),
        ("gltf_meshopt", json!({ "compression": "meshopt" })),
        ("gazebo_pieces", json!({ "collision": "pieces" })),
        ("urdf_pieces", json!({ "collision": "pieces" })),
    ] {
        let row = target(name.split('_').next().unwrap_or(name))?.row;
        write(&folder.join(name), row, settings, &chamber)?;
    }
    // `FOLDER/<target>_webp`, where WebP is written.
    let webp = sample::Chamber::in_webp(textures.path())?;
    for name in ["glb", "gltf"] {
        write(&folder.join(format!("{name}_webp")), target(name)?.row, json!({}), &webp)?;
    }
    Ok(())
}

fn write(
    folder: &Path,
    row: &'static TargetRow,
    settings: Value,
    chamber: &sample::Chamber,
) -> Result<(), Box<dyn Error>> {
    let mut package = Folder::create(folder, Existing::Replace)?;
    row.build(settings, None)?.export(&chamber.scene(), &mut package)?;
    package.finish()?;
    Ok(())
}
