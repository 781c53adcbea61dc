//! Readers of the formats that Unity reads. Unity itself needs a licence and is not run.

use std::path::Path;
use std::process::Command;

use crate::tools::{Result, root, run};
use crate::venv::Environment;

fn environment() -> Result<Environment> {
    Environment::of_readers()?.with(&["tests/interop/unity/requirements.txt"])
}

pub(super) fn make() -> Result<()> {
    environment().map(drop)
}

pub(super) fn check(package: &Path) -> Result<Command> {
    let mut command = Command::new(environment()?.python());
    command.arg(root().join("tests/interop/unity/check.py")).arg(package);
    Ok(command)
}

/// The readers must notice faults injected into a package of the synthetic scene.
pub(super) fn check_faults(scene: &Path) -> Result<String> {
    let mut pytest = Command::new(environment()?.python());
    run(pytest
        .env("PLUME_SCENE", scene)
        .args(["-m", "pytest", "--quiet", "tests/interop/unity/test_check.py"])
        .current_dir(root()))
}
