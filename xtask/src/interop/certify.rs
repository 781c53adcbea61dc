//! What certificates are held to: drives along their own paths.

use std::path::{Path, PathBuf};
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
pub const ROVER: Judge = Judge { robot: "rover", target: "mujoco" };
/// The Husky, on triangles in Bullet.
pub const HUSKY: Judge = Judge { robot: "husky", target: "gazebo" };
/// All of them.
pub const JUDGES: [Judge; 2] = [ROVER, HUSKY];

/// Passages that are driven of each class where drives are one check among many.
const FEW: &str = "2";

/// The environment with MuJoCo, Bullet and the Python package.
fn environment() -> Result<Environment> {
    Environment::of_project()?.with(&["tests/interop/mujoco/requirements.txt", REQUIREMENTS])
}

impl Judge {
    /// A few drives in the package of a sample, beside which its cave was kept.
    pub(super) fn check(self, package: &Path) -> Result<String> {
        let cave = mujoco::cave_of(&package.with_file_name("mujoco"));
        let certificate = package.with_extension(format!("{}.json", self.robot));
        self.certify(&environment()?.program("plume"), &cave, &certificate)?;
        run(self.drive("sample", package, &cave, &certificate)?.args(["--passages", FEW]))
    }

    /// Writes what `plume` says of a cave.
    pub fn certify(self, plume: &Path, cave: &Path, certificate: &Path) -> Result<()> {
        let mut certify = Command::new(plume);
        run(certify.arg("certify").arg(cave).args(["--robot", self.robot, "--quiet", "-o"]).arg(certificate)).map(drop)
    }

    /// Holds that to drives in a package of the cave.
    pub fn drive(self, name: &str, package: &Path, cave: &Path, certificate: &Path) -> Result<Command> {
        let mut drives = script("drives.py")?;
        drives.args([self.robot, name]).arg(package).arg(certificate).arg(cave.join("graph.json"));
        Ok(drives)
    }
}

/// Sums up what many drives came to.
pub fn table(results: &Path) -> Result<Command> {
    let mut table = script("table.py")?;
    table.arg(results);
    Ok(table)
}

fn script(name: &str) -> Result<Command> {
    let mut command = Command::new(environment()?.python());
    command.arg(root().join::<PathBuf>(["tests", "interop", "drives", name].iter().collect()));
    Ok(command)
}
