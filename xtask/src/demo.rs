//! `cargo xtask demo`: from a fresh clone to a cave that Gazebo opens.

use crate::plume::Plume;
use crate::tools::Result;

const PACKAGE: &str = "demo/gazebo";

/// Builds `plume` and exports the default cave.
pub fn run(_arguments: &[String]) -> Result<()> {
    Plume::build()?.show(&["export", "--target", "gazebo", "--output", PACKAGE, "--force"])?;
    println!("{PACKAGE} is ready:\n  cd {PACKAGE} && GZ_SIM_RESOURCE_PATH=$PWD/models gz sim worlds/cave.sdf");
    Ok(())
}
