//! Readers of what Unity reads. Unity itself is not to be had.

use std::path::Path;
use std::process::Command;

use crate::tools::{Result, root, run};
use crate::venv::Environment;

fn environment() -> Result<Environment> {
    Environment::apart("unity")?.with("tests/judges/unity/requirements.txt")
}

pub(super) fn make() -> Result<()> {
    environment().map(drop)
}

pub(super) fn check(package: &Path) -> Result<Command> {
    let mut command = Command::new(environment()?.python());
    command.arg(root().join("tests/judges/unity/check.py")).arg(package);
    Ok(command)
}

/// Spoils a package in ways that must be noticed.
pub(super) fn spoil() -> Result<String> {
    let mut pytest = Command::new(environment()?.python());
    run(pytest.args(["-m", "pytest", "--quiet", "tests/judges/unity/test_check.py"]).current_dir(root()))
}
