//! Writes the sample scene for every target: `sample_package FOLDER` makes `FOLDER/<target>`.

use std::error::Error;
use std::path::PathBuf;

use plume_exporters::TARGETS;
use plume_exporters::package::{Existing, Folder};
use serde_json::json;

#[path = "../tests/sample/mod.rs"]
mod sample;

fn main() -> Result<(), Box<dyn Error>> {
    let folder: PathBuf = std::env::args_os()
        .nth(1)
        .ok_or("usage: sample_package FOLDER")?
        .into();
    let textures = tempfile::tempdir()?;
    let chamber = sample::Chamber::new(textures.path())?;
    for target in TARGETS {
        let mut package = Folder::create(&folder.join(target.name), Existing::Replace)?;
        (target.build)(json!({}))?.export(&chamber.scene(), &mut package)?;
        package.finish()?;
    }
    Ok(())
}
