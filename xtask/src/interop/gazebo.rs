//! The libraries that Gazebo is made of.

use std::path::Path;
use std::process::Command;

use super::{REQUIREMENTS, target_folder};
use crate::tools::{Result, ensure_debian, root, run};
use crate::venv::Environment;

/// Gazebo itself is not in Debian; the libraries it is made of are.
pub(super) const DEBIAN: [&str; 9] = [
    "cmake",
    "g++",
    "make",
    "libsdformat-dev",
    "libignition-physics-dev",
    "libignition-physics5-dartsim-plugin5",
    "libignition-plugin-dev",
    "libignition-fuel-tools-dev",
    "libjsoncpp-dev",
];

/// Compiles the program that opens packages with them.
pub(super) fn make() -> Result<()> {
    ensure_debian(&DEBIAN)?;
    let (source, build) = (root().join("tests/interop/gazebo"), target_folder().join("gazebo"));
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(source).arg("-B").arg(&build).arg("-DCMAKE_BUILD_TYPE=Release");
    if run(&mut configure).is_err() && build.exists() {
        // The CMake cache of a checkout that was moved or copied names its old path.
        std::fs::remove_dir_all(&build).map_err(|error| error.to_string())?;
        run(&mut configure)?;
    }
    run(Command::new("cmake").arg("--build").arg(build)).map(drop)
}

pub(super) fn open(package: &Path) -> Result<Command> {
    let mut command = Command::new(target_folder().join("gazebo/open_package"));
    command.arg(package);
    Ok(command)
}

/// Installs Bullet, which represents the physics engines that Gazebo can load.
pub(super) fn make_bullet() -> Result<()> {
    bullet().map(drop)
}

pub(super) fn drop_balls(package: &Path) -> Result<Command> {
    let mut command = Command::new(bullet()?.python());
    command.arg(root().join("tests/interop/drop_pybullet.py")).arg(package);
    Ok(command)
}

pub(super) fn let_go_of_stones(package: &Path) -> Result<Command> {
    let mut command = Command::new(bullet()?.python());
    command.arg(root().join("tests/interop/rest_pybullet.py")).arg(package);
    Ok(command)
}

pub(super) fn bullet() -> Result<Environment> {
    Environment::of_project()?.with(&[REQUIREMENTS])
}
