//! assimp, the importer of many engines and tools.

use std::path::Path;
use std::process::Command;

use super::formats;
use crate::tools::{Result, ensure_debian};
use crate::venv::Environment;

fn environment() -> Result<Environment> {
    Environment::apart("assimp")?.with("tests/judges/formats/requirements-assimp.txt")
}

/// Gets it.
pub(super) fn make() -> Result<()> {
    ensure_debian(&["libassimp5"])?;
    environment().map(drop)
}

/// Opens the marker, or all packages of a cave.
pub(super) fn open(folder: &Path) -> Result<Command> {
    Ok(formats::script(&environment()?, "assimp.py", folder))
}
