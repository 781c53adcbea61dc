//! Reinforcement learning.

use std::process::Command;

use crate::tools::{Result, root, run};
use crate::venv::Environment;

/// The environment with MuJoCo, skrl and the Python package.
fn environment() -> Result<Environment> {
    Environment::of_project()?.with(&["tests/interop/mujoco/requirements.txt", "tests/interop/gym/requirements.txt"])
}

/// Installs it.
pub(super) fn make() -> Result<()> {
    environment().map(drop)
}

/// Trains a driver on small caves for a few steps.
pub(super) fn train() -> Result<String> {
    run(Command::new(environment()?.python()).arg(root().join("tests/interop/gym/train.py")))
}
