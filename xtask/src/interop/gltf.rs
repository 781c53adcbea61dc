//! Readers of glTF, and a browser that draws it and FBX.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::files_of;
use crate::tools::{Result, ensure_debian, ensure_npm, root};

pub(super) const DEBIAN: [&str; 1] = ["chromium"];

pub(super) fn make() -> Result<()> {
    ensure_npm(&folder())
}

pub(super) fn validate(package: &Path) -> Result<Command> {
    let mut command = Command::new("node");
    command.arg(folder().join("validate.mjs")).args(files(package));
    Ok(command)
}

pub(super) fn make_browser() -> Result<()> {
    ensure_debian(&DEBIAN)?;
    make()
}

pub(super) fn draw(package: &Path) -> Result<Command> {
    Ok(picture("shot.mjs", package))
}

pub(super) fn stream(package: &Path) -> Result<Command> {
    Ok(picture("tiles.mjs", package))
}

pub(super) fn stream_in_cesium(package: &Path) -> Result<Command> {
    Ok(draw_into("cesium.mjs", package, &package.with_extension("cesium.png")))
}

/// The picture is next to the package: `<package>.png`.
fn picture(script: &str, package: &Path) -> Command {
    draw_into(script, package, &package.with_extension("png"))
}

fn draw_into(script: &str, package: &Path, picture: &Path) -> Command {
    let mut command = Command::new("node");
    command.arg(folder().join(script)).arg(package).arg("--out").arg(picture);
    command
}

fn files(package: &Path) -> Vec<PathBuf> {
    let folders = [package.to_owned(), package.join("chunks"), package.join("tiles")];
    let is_gltf = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "glb" || ending == "gltf");
    let mut files: Vec<PathBuf> = folders.iter().flat_map(|folder| files_of(folder).filter(is_gltf)).collect();
    files.sort();
    files
}

/// Folder of the scripts.
pub(super) fn folder() -> PathBuf {
    root().join("tests/interop/gltf")
}
