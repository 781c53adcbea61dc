//! Readers of URDF packages, and a robot that drives through one.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::files_of;
use crate::plume::Plume;
use crate::tools::{Result, ensure_debian, root, run};
use crate::venv::Environment;

pub(super) const DEBIAN: [&str; 1] = ["liburdfdom-tools"];

/// `<package>/<name>/urdf/<name>.urdf`.
pub(super) fn file_of(package: &Path) -> Option<PathBuf> {
    let urdf = |folder: PathBuf| Some(folder.join("urdf").join(folder.file_name()?).with_extension("urdf"));
    files_of(package).filter_map(urdf).find(|path| path.is_file())
}

pub(super) fn install_parser() -> Result<()> {
    ensure_debian(&DEBIAN)
}

pub(super) fn parse(package: &Path) -> Result<Command> {
    let mut command = Command::new("check_urdf");
    command.args(file_of(package));
    Ok(command)
}

fn environment() -> Result<Environment> {
    Environment::of_readers()?.with(&["tests/interop/urdf/requirements.txt"])
}

pub(super) fn make() -> Result<()> {
    environment().map(drop)
}

pub(super) fn open_in_pinocchio(package: &Path) -> Result<Command> {
    Ok(script(&environment()?, "open_pinocchio.py", package))
}

pub(super) fn open_in_yourdfpy(package: &Path) -> Result<Command> {
    Ok(script(&environment()?, "open_yourdfpy.py", package))
}

/// Drives a Husky through the default cave, once on the triangles and once on the convex pieces. The cave and a picture of
/// each drive stay in `folder` of the workspace.
pub fn drive(plume: &Plume, folder: &str) -> Result<()> {
    let cave = format!("{folder}/husky-cave");
    for collision in ["triangles", "pieces"] {
        let (output, option) = (format!("{folder}/husky-{collision}"), format!("urdf.collision={collision}"));
        let export = ["export", "--target", "urdf", "--output", &output, "--force", "--keep", &cave];
        plume.output(&[&export[..], &["--option", &option, "--set", "texture.size_px=256"]].concat())?;
        let mut drive = script(&super::gazebo::bullet()?, "drive.py", &root().join(&output));
        let picture = root().join(&output).with_extension("png");
        println!("{}", run(drive.arg(root().join(&cave).join("graph.json")).arg(picture))?);
    }
    Ok(())
}

/// Injected faults of a package must stop the Husky.
pub(super) fn check_faults() -> Result<String> {
    let mut pytest = Command::new(super::usd::environment()?.python());
    run(pytest.args(["-m", "pytest", "--quiet", "tests/interop/urdf/test_drive.py"]).current_dir(root()))
}

fn script(environment: &Environment, name: &str, package: &Path) -> Command {
    let mut command = Command::new(environment.python());
    command.arg(root().join("tests/interop/urdf").join(name)).arg(package);
    command
}
