//! `cargo xtask demo`: from a fresh clone to a cave that Gazebo and Isaac Sim open.

use crate::plume::{Plume, Profile};
use crate::tools::Result;

const FOLDER: &str = "demo";

/// Builds the Python package and exports the default cave with its `plume` command.
pub fn run(_arguments: &[String]) -> Result<()> {
    Plume::package(Profile::Release)?.show(&["export", "--target", "gazebo,isaac", "--output", FOLDER, "--force"])?;
    println!(
        "two packages are ready:\n  cd {FOLDER}/gazebo && GZ_SIM_RESOURCE_PATH=$PWD/models gz sim worlds/cave.sdf\n  \
         in Isaac Sim, File > Open {FOLDER}/isaac/cave.usda"
    );
    Ok(())
}
