//! `cargo xtask test`: all tests that need cargo and python3 alone.

use crate::judge;
use crate::plume::{Plume, cargo};
use crate::tools::Result;

/// A cave small enough for every run, yet made of several chunks.
const CAVE: &str = "target/test-cave";

/// Runs the tests of the workspace, then drops a ball into a cave with a physics engine that is not ours.
pub fn run(arguments: &[String]) -> Result<()> {
    let status = cargo().args(["test", "--workspace", "--quiet"]).args(arguments).status();
    if !status.is_ok_and(|status| status.success()) {
        return Err("the tests above failed".into());
    }
    let settings = ["--set", "graph.nodes=20", "--set", "texture.size_px=256"];
    for (name, generator) in [("cave", "gaussian-perlin"), ("mine", "mine")] {
        let (output, generator) = (format!("{CAVE}/{name}"), format!("graph.generator={generator}"));
        let export = ["export", "--target", "gazebo", "--force", "--output", &output, "--set", &generator];
        Plume::build()?.output(&[&export[..], &settings[..]].concat())?;
        judge::only("pybullet", output.as_ref())?;
    }
    Ok(())
}
