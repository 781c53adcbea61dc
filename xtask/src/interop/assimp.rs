//! Files written through libassimp, opened by readers other than assimp.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::plume::Plume;
use crate::tools::{Result, ensure_debian, root};
use crate::venv::Environment;

pub(super) const DEBIAN: [&str; 1] = ["libassimp5"];

/// Formats that have an independent reader.
const TARGETS: [&str; 2] = ["assimp:collada", "assimp:obj"];

/// Whether assimp wrote the package. Read from its manifest, because other targets write OBJ as well.
pub(super) fn is_package(package: &Path) -> bool {
    let manifest = std::fs::read(package.join("manifest.json")).unwrap_or_default();
    let manifest: Value = serde_json::from_slice(&manifest).unwrap_or_default();
    manifest["target"].as_str().is_some_and(|target| target.starts_with("assimp:"))
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

/// Exports a small cave in each format, and as GLB for comparison. Exports nothing without libassimp; the reader is then
/// skipped as well.
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
