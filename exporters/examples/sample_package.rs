//! Writes the sample scenes: `sample_package FOLDER [PYTHON]`.
//!
//! The chamber, for every target that needs no library: `FOLDER/<target>`, `FOLDER/<target>_chunks` with a file per chunk,
//! `FOLDER/<target>_meshopt` compressed, `FOLDER/<target>_pieces` with convex pieces where supported, `FOLDER/fbx_y`
//! with Y up, and `FOLDER/gazebo_ros2` with a rover.
//!
//! The chamber with things in it: `FOLDER/<target>_things` and others, for targets that write copies of a mesh.
//!
//! The marker: `FOLDER/marker/<target>` with the expected result in `FOLDER/marker/marker.json`, and with each injected
//! fault as `FOLDER/marker_<fault>/<target>`; for targets that need a USD library only if an interpreter with usd-core is
//! given.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use plume_exporters::ImageFormat;
use plume_exporters::place::Existing;
use plume_exporters::place::Place;
use plume_exporters::scene::Scene;
use plume_exporters::stage::Library;
use plume_exporters::{TARGETS, TargetRow, target};
use serde_json::{Value, json};

#[path = "../tests/it/sample/lent.rs"]
mod lent;
#[path = "../tests/it/sample/marker.rs"]
mod marker;
#[path = "../tests/it/sample/mod.rs"]
mod sample;
#[path = "../tests/it/sample/strewn.rs"]
mod strewn;

type Lent = Option<Arc<dyn Library>>;
type Result<T> = std::result::Result<T, Box<dyn Error>>;

fn main() -> Result<()> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let folder = arguments.next().ok_or("usage: sample_package FOLDER [PYTHON]")?;
    let library = arguments.next().map(|python| lent::lend(&python)).transpose()?;
    write_chambers(&folder)?;
    write_strewn(&folder)?;
    let faults = marker::FAULTS.map(|(fault, change)| (format!("marker_{fault}"), change));
    for (name, change) in [("marker".to_owned(), (|_| ()) as marker::Change)].into_iter().chain(faults) {
        write_markers(&folder.join(name), change, &library)?;
    }
    Ok(fs::write(folder.join("marker/marker.json"), marker::truth().to_string())?)
}

fn write_chambers(folder: &Path) -> Result<()> {
    let textures = tempfile::tempdir()?;
    let chamber = sample::Chamber::new(textures.path())?;
    for row in TARGETS.iter().filter(|row| !row.needs_usd() && !row.needs_format()) {
        write(&folder.join(row.name), row, json!({}), &chamber.scene(), &None)?;
    }
    for (name, settings) in [
        ("glb_chunks", json!({ "per_chunk": true, "lods": true })),
        ("glb_lods", json!({ "lods": true })),
        ("glb_pieces", json!({ "collision": "pieces" })),
        ("glb_meshopt", json!({ "compression": "meshopt", "lods": true })),
        ("gltf_pieces", json!({ "collision": "pieces" })),
        ("fbx_chunks", json!({ "per_chunk": true })),
        ("fbx_pieces", json!({ "collision": "pieces" })),
        ("fbx_y", json!({ "up": "y" })),
        ("gltf_meshopt", json!({ "compression": "meshopt" })),
        ("gazebo_pieces", json!({ "collision": "pieces" })),
        ("gazebo_ros2", json!({ "ros2": true })),
        ("unity_pieces", json!({ "collision": "pieces", "pipeline": "hdrp" })),
        ("urdf_pieces", json!({ "collision": "pieces" })),
        ("unreal_pieces", json!({ "collision": "pieces" })),
    ] {
        let row = target(name.split('_').next().unwrap_or(name))?.row;
        write(&folder.join(name), row, settings, &chamber.scene(), &None)?;
    }
    // `FOLDER/<target>_webp`, where WebP is supported.
    let webp = sample::Chamber::in_webp(textures.path())?;
    for row in TARGETS.iter().filter(|row| row.images.contains(&ImageFormat::WebP) && !row.needs_usd()) {
        write(&folder.join(format!("{}_webp", row.name)), row, json!({}), &webp.scene(), &None)?;
    }
    Ok(())
}

fn write_strewn(folder: &Path) -> Result<()> {
    let textures = tempfile::tempdir()?;
    let strewn = strewn::Strewn::new(textures.path(), true)?;
    for (name, settings) in [
        ("glb_things", json!({})),
        ("glb_instancing", json!({ "instancing": true, "compression": "meshopt", "lods": true })),
        ("glb_instancing_chunks", json!({ "instancing": true, "per_chunk": true, "collision": "pieces" })),
        ("gltf_instancing", json!({ "instancing": true })),
        ("unity_things", json!({})),
        ("unreal_things", json!({})),
    ] {
        let row = target(name.split('_').next().unwrap_or(name))?.row;
        write(&folder.join(name), row, settings, &strewn.scene(), &None)?;
    }
    Ok(())
}

fn write_markers(folder: &Path, change: marker::Change, library: &Lent) -> Result<()> {
    let textures = tempfile::tempdir()?;
    let marker = marker::Marker::new(textures.path(), change)?;
    for row in TARGETS.iter().filter(|row| !row.needs_format() && (!row.needs_usd() || library.is_some())) {
        write(&folder.join(row.name), row, json!({}), &marker.scene(), library)?;
    }
    Ok(())
}

fn write(folder: &Path, row: &'static TargetRow, settings: Value, scene: &Scene, library: &Lent) -> Result<()> {
    let place = Place { path: folder.to_owned(), bundle: None, existing: Existing::Replace };
    place.write(row.name, &*row.build(settings, library.as_ref())?, scene)?;
    Ok(())
}
