//! What libassimp writes for us, opened by readers that are not assimp's.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::plume::Plume;
use crate::tools::{Result, ensure_debian, root};
use crate::venv::Environment;

pub(super) const DEBIAN: [&str; 1] = ["libassimp5"];

/// Formats that a reader is there for.
const TARGETS: [&str; 2] = ["assimp:collada", "assimp:obj"];

/// Whether assimp has written it: no other target makes Collada, and others put OBJ into folders.
pub(super) fn is_package(package: &Path) -> bool {
    super::holds(package, &["dae"]) || super::holds(package, &["obj"]) && super::holds(package, &["mtl"])
}

fn environment() -> Result<Environment> {
    Environment::of_readers()?.with(&["tests/interop/assimp/requirements.txt"])
}

pub(super) fn make() -> Result<()> {
    install()?;
    environment().map(drop)
}

fn install() -> Result<()> {
    ensure_debian(&DEBIAN)
}

pub(super) fn compare(package: &Path) -> Result<Command> {
    let mut command = Command::new(environment()?.python());
    command.arg(root().join("tests/interop/assimp/compare.py")).arg(package);
    Ok(command)
}

/// A small cave in each format, with the GLB of the same next to them. None without libassimp: then the reader is skipped,
/// too.
pub(super) fn export(plume: &Plume) -> Result<Vec<PathBuf>> {
    if install().is_err() {
        return Ok(Vec::new());
    }
    let output = "target/interop/assimp";
    let targets = format!("glb,{}", TARGETS.join(","));
    let mut export = vec!["export", "samples/cave.toml", "--target", &targets, "--output", output, "--force"];
    export.extend(["--set", "graph.nodes=12", "--set", "texture.size_px=256"]);
    plume.output(&export)?;
    Ok(TARGETS.map(|target| root().join(output).join(target.replace(':', "-"))).into())
}
