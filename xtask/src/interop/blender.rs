//! Blender as a Python module.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::formats;
use crate::tools::{Result, ensure_debian, root, run};
use crate::venv::Environment;

/// System libraries that the module links to, although it opens no window.
pub(super) const DEBIAN: [&str; 10] = [
    "libgl1",
    "libgomp1",
    "libsm6",
    "libx11-6",
    "libxext6",
    "libxfixes3",
    "libxi6",
    "libxkbcommon0",
    "libxrender1",
    "libxxf86vm1",
];

/// The one version of Python that the module is built for.
const FITS: &str = "import sys; sys.exit(sys.version_info[:2] != (3, 11))";

fn environment() -> Result<Environment> {
    let environment = Environment::apart("blender")?;
    run(Command::new(environment.python()).args(["-c", FITS]))
        .map_err(|_| "Blender 4.2 is a module of Python 3.11 only; name one in the variable PLUME_PYTHON")?;
    environment.with(&["tests/interop/formats/requirements-blender.txt"])
}

/// Installs it: 1.5 GB.
pub(super) fn make() -> Result<()> {
    ensure_debian(&DEBIAN)?;
    environment().map(drop)
}

/// Renders a package of glTF from one of its start poses.
pub fn picture(package: &Path, picture: &Path, spawn: usize) -> Result<String> {
    make()?;
    let mut command = formats::script(&environment()?, "picture.py", package);
    run(command.arg(picture).arg(spawn.to_string()))
}

/// Measures the contrast of pictures, a line each.
///
/// # Errors
/// If one is flat or blurred.
pub fn contrast(pictures: &[PathBuf]) -> Result<String> {
    let mut command = Command::new(environment()?.python());
    run(command.arg(root().join("tests/interop/formats/contrast.py")).args(pictures))
}

/// Opens the marker, or all packages of a cave.
pub(super) fn open(folder: &Path) -> Result<Command> {
    Ok(formats::script(&environment()?, "blender.py", folder))
}
