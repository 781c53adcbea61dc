//! Readers of many formats compare what they see: of the marker, whose geometry is known, or of all packages of a cave.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::faults::copy_folder;
use crate::targets::Target;
use crate::tools::{Result, ensure_debian, root, run};
use crate::venv::Environment;

/// Common formats without a dedicated reader.
const COMMON: [&str; 3] = ["obj", "ply", "stl"];

/// Checks that open the packages of many targets together.
pub(super) const READERS: [&str; 3] = ["trimesh", "blender", "libassimp"];

/// Whether a folder contains the samples of the exporters, including the marker.
pub(super) fn is_marked(folder: &Path) -> bool {
    folder.join("marker/marker.json").is_file()
}

/// Whether a folder contains several packages of one cave.
pub(super) fn is_shelf(folder: &Path) -> bool {
    COMMON.iter().filter(|target| folder.join(target).is_dir()).count() > 1
}

/// Copies the packages of the chamber that any of these readers opens, next to each other.
pub(super) fn shelve(sample: &Path, targets: &[Target]) -> Result<PathBuf> {
    let shelf = sample.join("formats");
    for target in targets.iter().filter(|target| target.checks().any(|check| READERS.contains(&check))) {
        let package = sample.join(target.name());
        if package.is_dir() {
            copy_folder(&package, &shelf.join(target.name())).map_err(|error| error.to_string())?;
        }
    }
    Ok(shelf)
}

fn environment() -> Result<Environment> {
    super::usd::environment()?
        .with(&["tests/interop/mujoco/requirements.txt", "tests/interop/formats/requirements.txt"])
}

/// Joins pictures of the same size from left to right.
pub fn side_by_side(pictures: &[PathBuf], joined: &Path) -> Result<()> {
    let mut command = script(&environment()?, "side_by_side.py", joined);
    run(command.args(pictures)).map(drop)
}

/// Installs the readers that share one Python environment.
pub(super) fn make() -> Result<()> {
    environment().map(drop)
}

/// Where usd-core is, for the program that writes the marker.
pub(super) fn python() -> Option<PathBuf> {
    environment().ok().map(|environment| environment.python())
}

/// Opens the marker with every reader.
pub(super) fn orient(sample: &Path) -> Result<Command> {
    Ok(script(&environment()?, "orientation.py", sample))
}

/// Opens all packages of a cave with trimesh and similar libraries.
pub(super) fn open(folder: &Path) -> Result<Command> {
    Ok(script(&environment()?, "meshes.py", folder))
}

fn assimp() -> Result<Environment> {
    Environment::of_readers()?.with(&["tests/interop/formats/requirements-assimp.txt"])
}

/// Installs assimp, the importer of many engines and tools.
pub(super) fn make_assimp() -> Result<()> {
    ensure_debian(&super::assimp::DEBIAN)?;
    assimp().map(drop)
}

/// Opens the marker, or all packages of a cave, with assimp.
pub(super) fn open_in_assimp(folder: &Path) -> Result<Command> {
    Ok(script(&assimp()?, "assimp.py", folder))
}

/// Runs a script on a folder.
pub(super) fn script(environment: &Environment, name: &str, folder: &Path) -> Command {
    let mut command = Command::new(environment.python());
    command.arg(root().join("tests/interop/formats").join(name)).arg(folder);
    command
}
