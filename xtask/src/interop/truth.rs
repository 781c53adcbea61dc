//! What ground truth is held to.

use std::path::Path;
use std::process::Command;

use crate::tools::{Result, ensure_debian, root};
use crate::venv::Environment;

fn environment() -> Result<Environment> {
    Environment::of_project()?.with(&["tests/interop/truth/requirements.txt"])
}

/// `cavern` reads the survey.
pub(super) const DEBIAN: [&str; 1] = ["survex"];

/// Installs it.
pub fn make() -> Result<()> {
    ensure_debian(&DEBIAN)?;
    environment().map(drop)
}

/// Compares a package with the PLY of the same cave beside it.
pub(super) fn check(package: &Path) -> Result<Command> {
    let mut command = Command::new(environment()?.python());
    command.arg(root().join("tests/interop/truth/check.py")).arg(package);
    Ok(command)
}
