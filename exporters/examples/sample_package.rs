//! Writes the sample scene for every target that needs no USD library: `sample_package FOLDER` makes `FOLDER/<target>`,
//! `FOLDER/<target>_chunks` with a file per chunk and `FOLDER/<target>_pieces` with convex pieces where they are offered,
//! and `FOLDER/fbx_y` with Y up.

use std::error::Error;
use std::path::{Path, PathBuf};

use plume_exporters::package::Existing;
use plume_exporters::place::Place;
use plume_exporters::{TARGETS, TargetRow, target};
use serde_json::{Value, json};

#[path = "../tests/sample/mod.rs"]
mod sample;

fn main() -> Result<(), Box<dyn Error>> {
    let folder: PathBuf = std::env::args_os().nth(1).ok_or("usage: sample_package FOLDER")?.into();
    let textures = tempfile::tempdir()?;
    let chamber = sample::Chamber::new(textures.path())?;
    for row in TARGETS.iter().filter(|row| !row.needs_usd()) {
        write(&folder.join(row.name), row, json!({}), &chamber)?;
    }
    for (name, settings) in [
        ("gltf_chunks", json!({ "per_chunk": true })),
        ("gltf_pieces", json!({ "collision": "pieces" })),
        ("fbx_chunks", json!({ "per_chunk": true })),
        ("fbx_pieces", json!({ "collision": "pieces" })),
        ("fbx_y", json!({ "up": "y" })),
        ("gazebo_pieces", json!({ "collision": "pieces" })),
        ("unity_pieces", json!({ "collision": "pieces", "pipeline": "hdrp" })),
        ("urdf_pieces", json!({ "collision": "pieces" })),
    ] {
        let row = target(name.split('_').next().unwrap_or(name))?;
        write(&folder.join(name), row, settings, &chamber)?;
    }
    Ok(())
}

fn write(folder: &Path, row: &TargetRow, settings: Value, chamber: &sample::Chamber) -> Result<(), Box<dyn Error>> {
    let place = Place { path: folder.to_owned(), bundle: None, existing: Existing::Replace };
    place.write(row, &*row.build(settings, None)?, &chamber.scene())?;
    Ok(())
}
