//! `cargo xtask test`: all tests that need cargo and python3 alone.

use std::process::Command;

use crate::judge;
use crate::plume::{Plume, cargo};
use crate::tools::{Result, root};

/// A cave small enough for every run, yet made of several chunks.
const CAVE: &str = "target/test-cave";
const SMALL: [&str; 4] = ["--set", "graph.nodes=20", "--set", "texture.size_px=256"];

/// Runs the tests of the workspace, drops a ball into a cave and drives a robot through one with a physics
/// engine that is not ours, then checks the Python
/// sources and runs the tests of the Python package.
pub fn run(arguments: &[String]) -> Result<()> {
    // The extension module is no program that cargo could test: Python does.
    let test = ["test", "--workspace", "--exclude", "plume-python", "--quiet"];
    show(cargo().args(test).args(arguments))?;
    drop_balls()?;
    judge::urdf::drive(&Plume::build()?, CAVE)?;
    read_meshes(&Plume::build()?)?;
    let plume = Plume::package()?;
    judge::mujoco::make()?;
    let python = judge::usd::environment()?.python();
    for check in [&["ruff", "check", "--quiet"][..], &["ruff", "format", "--check", "--quiet"], &["pytest", "--quiet"]]
    {
        show(Command::new(&python).arg("-m").args(check).current_dir(root()))?;
    }
    read_with_another_usd(&plume)?;
    drive_through(&plume)
}

/// The validators of the newest USD are among the tests; this is the oldest.
fn read_with_another_usd(plume: &Plume) -> Result<()> {
    let package = format!("{CAVE}/isaac");
    let export = ["export", "--target", "isaac", "--force", "--output", &package];
    plume.output(&[&export[..], &SMALL[..]].concat())?;
    judge::only("usd-old", package.as_ref())
}

/// The formats that have no simulator to judge them.
fn read_meshes(plume: &Plume) -> Result<()> {
    let shelf = format!("{CAVE}/formats");
    let export = ["export", "--target", "obj,ply,stl", "--force", "--output", &shelf];
    plume.output(&[&export[..], &SMALL[..]].concat())?;
    judge::only("trimesh", shelf.as_ref())
}

/// The default cave, whole; its images are small, since nothing in its shape depends on them.
fn drive_through(plume: &Plume) -> Result<()> {
    let (package, cave) = (format!("{CAVE}/mujoco"), format!("{CAVE}/mujoco.cave"));
    let places = ["--output", &package, "--keep", &cave];
    let export = ["export", "--target", "mujoco", "--force", "--set", "texture.size_px=256"];
    plume.output(&[&export[..], &places[..]].concat())?;
    for judge in ["compile", "balls", "rays"] {
        judge::only(judge, package.as_ref())?;
    }
    println!("{}", judge::mujoco::drive(package.as_ref())?);
    Ok(())
}

fn show(command: &mut Command) -> Result<()> {
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err("the tests above failed".to_owned()),
        Err(error) => Err(format!("cannot run `{}`: {error}", command.get_program().to_string_lossy())),
    }
}

fn drop_balls() -> Result<()> {
    let plume = Plume::build()?;
    for (name, generator) in [("cave", "gaussian-perlin"), ("mine", "mine")] {
        let (output, generator) = (format!("{CAVE}/{name}"), format!("graph.generator={generator}"));
        let export = ["export", "--target", "gazebo", "--force", "--output", &output, "--set", &generator];
        plume.output(&[&export[..], &SMALL[..]].concat())?;
        judge::only("pybullet", output.as_ref())?;
    }
    Ok(())
}
