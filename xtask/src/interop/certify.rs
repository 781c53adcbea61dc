//! What certificates are held to: drives along their own paths.

use std::path::Path;
use std::process::Command;

use super::{REQUIREMENTS, mujoco};
use crate::tools::{Result, root, run};
use crate::venv::Environment;

/// A robot that drives.
#[derive(Clone, Copy)]
pub struct Judge {
    /// Its name, as `plume list robots` has it.
    pub robot: &'static str,
    /// The target whose packages it drives in.
    pub target: &'static str,
}

/// The sample rover, on convex pieces in MuJoCo.
const ROVER: Judge = Judge { robot: "rover", target: "mujoco" };
/// That, and the Husky on triangles of rock and hulls of things in Bullet.
pub const JUDGES: [Judge; 2] = [ROVER, Judge { robot: "husky", target: "gazebo" }];

/// Passages that are driven of each class where drives are one check among many.
const FEW: &str = "2";

/// The environment with MuJoCo, Bullet, libigl and the Python package.
fn environment() -> Result<Environment> {
    let [mujoco, igl] = ["mujoco", "truth"].map(|check| format!("tests/interop/{check}/requirements.txt"));
    Environment::of_project()?.with(&[&mujoco, REQUIREMENTS, &igl])
}

/// Installs it.
pub fn make() -> Result<()> {
    environment().map(drop)
}

impl Judge {
    /// Holds a certificate of it to drives in a package of the cave.
    pub fn drive(self, name: &str, package: &Path, cave: &Path, certificate: &Path) -> Result<Command> {
        let mut drives = script("drives.py")?;
        drives.args([self.robot, name]).arg(package).arg(certificate).arg(cave.join("graph.json"));
        Ok(drives)
    }
}

/// Holds what is said of the rover to a few drives in a MuJoCo package, beside which its cave was kept. The Husky and a drone have
/// theirs in `tests/python/test_drive_checks.py`.
pub(super) fn check(package: &Path) -> Result<String> {
    let (cave, certificate) = (mujoco::cave_of(package), package.with_extension("rover.json"));
    certify(&environment()?.program("plume"), &cave, ROVER.robot, &certificate)?;
    run(ROVER.drive("sample", package, &cave, &certificate)?.args(["--passages", FEW]))
}

/// Writes what `plume` says of a robot in a cave.
pub fn certify(plume: &Path, cave: &Path, robot: &str, certificate: &Path) -> Result<()> {
    let mut certify = Command::new(plume);
    run(certify.arg("certify").arg(cave).args(["--robot", robot, "--quiet", "-o"]).arg(certificate)).map(drop)
}

/// Sums up what many drives came to.
pub fn table(results: &Path) -> Result<Command> {
    let mut table = script("table.py")?;
    table.arg(results);
    Ok(table)
}

fn script(name: &str) -> Result<Command> {
    let mut command = Command::new(environment()?.python());
    command.arg(root().join("tests/interop/drives").join(name));
    Ok(command)
}
