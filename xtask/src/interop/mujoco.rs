//! MuJoCo.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::tools::{Result, root, run};
use crate::venv::Environment;

/// The environment with MuJoCo and the Python package.
fn environment() -> Result<Environment> {
    Environment::of_project()?.with(&["tests/interop/mujoco/requirements.txt"])
}

/// Installs it.
pub fn make() -> Result<()> {
    environment().map(drop)
}

/// The folder of the cave that a package was made from, if it was kept.
pub(super) fn cave_of(package: &Path) -> PathBuf {
    package.with_extension("cave")
}

pub(super) fn compile(package: &Path) -> Result<Command> {
    script("compile.py", package)
}

pub(super) fn drop_balls(package: &Path) -> Result<Command> {
    let mut command = script("balls.py", package)?;
    let cave = cave_of(package);
    if cave.is_dir() {
        command.arg(cave);
    }
    Ok(command)
}

pub(super) fn shoot_rays(package: &Path) -> Result<Command> {
    script("rays.py", package)
}

pub(super) fn count_things(package: &Path) -> Result<Command> {
    script("things.py", package)
}

pub(super) fn sleep(package: &Path) -> Result<Command> {
    script("sleep.py", package)
}

/// Drives a rover through the cave; a package without a cave has no centreline.
pub fn drive(package: &Path) -> Result<String> {
    run(script("drive.py", package)?.arg(cave_of(package)))
}

fn script(name: &str, package: &Path) -> Result<Command> {
    let mut command = Command::new(environment()?.python());
    command.arg(root().join("tests/interop/mujoco").join(name)).arg(package);
    Ok(command)
}
