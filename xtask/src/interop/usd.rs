//! Readers of USD stages.

use std::path::Path;
use std::process::Command;

use crate::tools::{Result, root, run};
use crate::venv::Environment;

/// Environment variable that accepts the licence of ovphysx.
const TERMS: &str = "PLUME_OMNIVERSE_TERMS";

/// The environment with the newest reader and the Python package.
pub fn environment() -> Result<Environment> {
    Environment::of_project()?.with(&[super::REQUIREMENTS, "tests/interop/usd/requirements.txt"])
}

/// The oldest USD that the package is written with.
pub fn old_environment() -> Result<Environment> {
    Environment::apart("usd-old")?.with(&["tests/interop/usd/requirements-old.txt"])
}

/// A second physics engine, under an open licence.
fn newton_environment() -> Result<Environment> {
    Environment::of_readers()?.with(&["tests/interop/usd/requirements-newton.txt"])
}

/// Whether the user has accepted the licence of Isaac Sim's physics engine; it is never installed without.
pub(super) fn has_agreed() -> bool {
    std::env::var(TERMS).as_deref() == Ok("accepted")
}

fn physx_environment() -> Result<Environment> {
    Environment::apart("physx")?.with(&["tests/interop/usd/requirements-physx.txt"])
}

pub(super) fn make() -> Result<()> {
    environment().map(drop)
}

pub(super) fn make_old() -> Result<()> {
    old_environment().map(drop)
}

pub(super) fn make_newton() -> Result<()> {
    newton_environment().map(drop)
}

pub(super) fn make_physx() -> Result<()> {
    make()?;
    physx_environment().map(drop)
}

pub(super) fn validate(package: &Path) -> Result<Command> {
    script("validate.py", package)
}

pub(super) fn compare(package: &Path) -> Result<Command> {
    let mut command = script("same.py", package)?;
    command.arg(old_environment()?.python());
    Ok(command)
}

pub(super) fn drop_balls(package: &Path) -> Result<Command> {
    let mut command = Command::new(newton_environment()?.python());
    command.arg(root().join("tests/interop/usd/newton_drop.py")).arg(package);
    Ok(command)
}

pub(super) fn touch(package: &Path) -> Result<Command> {
    let mut command = script("physx.py", package)?;
    command.arg(physx_environment()?.python());
    Ok(command)
}

/// PhysX must notice injected faults of a package.
pub(super) fn check_faults() -> Result<String> {
    let mut pytest = Command::new(environment()?.python());
    pytest.args(["-m", "pytest", "--quiet", "tests/interop/usd/test_physx.py"]).current_dir(root());
    run(pytest.env("PLUME_PHYSX_PYTHON", physx_environment()?.python()))
}

fn script(name: &str, package: &Path) -> Result<Command> {
    let mut command = Command::new(environment()?.python());
    command.arg(root().join("tests/interop/usd").join(name)).arg(package);
    Ok(command)
}
