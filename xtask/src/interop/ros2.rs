//! What holds of packages for ROS 2 without ROS, which neither Debian nor PyPI has.

use std::path::Path;
use std::process::Command;

use super::urdf;
use crate::tools::{Result, ensure_debian, root, run};
use crate::venv::Environment;

fn environment() -> Result<Environment> {
    Environment::of_readers()?.with(&["tests/interop/ros2/requirements.txt"])
}

pub(super) fn make() -> Result<()> {
    ensure_debian(&urdf::DEBIAN)?;
    environment().map(drop)
}

/// Whether a Gazebo package has launch files.
pub(super) fn is_launched(package: &Path) -> bool {
    package.join("ros2/launch").is_dir()
}

pub(super) fn check(package: &Path) -> Result<Command> {
    let mut command = Command::new(environment()?.python());
    command.arg(root().join("tests/interop/ros2/check.py")).arg(package);
    Ok(command)
}

/// The check must notice faults injected into a package of the synthetic scene.
pub(super) fn check_faults(scene: &Path) -> Result<String> {
    let mut pytest = Command::new(environment()?.python());
    run(pytest
        .env("PLUME_SCENE", scene)
        .args(["-m", "pytest", "--quiet", "tests/interop/ros2/test_check.py"])
        .current_dir(root()))
}
