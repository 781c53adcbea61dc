//! `cargo xtask test`: all tests that need only cargo and python3.

use std::fs;
use std::process::Command;

use crate::interop;
use crate::plume::{Plume, Profile, cargo};
use crate::tools::{Result, root, show};

/// A cave small enough for every run, yet made of several chunks.
const CAVE: &str = "target/test-cave";
const SMALL: [&str; 4] = ["--set", "graph.nodes=20", "--set", "texture.size_px=256"];

/// Runs the tests of the workspace and of the Python package, then drops balls and drives robots in caves with foreign
/// physics engines.
pub fn run(arguments: &[String]) -> Result<()> {
    rust(arguments)?;
    program()?;
    python()?;
    simulators()?;
    let plume = Plume::package(Profile::Dev)?;
    read_with_another_usd(&plume)?;
    read_meshes(&plume)?;
    drive_through(&plume)
}

/// The tests of the workspace. The Python module has none, but shares what it depends on.
pub fn rust(arguments: &[String]) -> Result<()> {
    show(cargo().args(["test", "--workspace", "--quiet"]).args(arguments))
}

/// Builds the program in `examples/program` as its users would, without optimisation, and lets it make a cave. Its dependencies are
/// those of the workspace.
pub fn program() -> Result<()> {
    let (folder, output) = (root().join("examples/program"), root().join("target/program"));
    let lock = folder.join("Cargo.lock");
    fs::copy(root().join("Cargo.lock"), &lock).map_err(|error| format!("{}: {error}", lock.display()))?;
    let home = output.join("home");
    // What an earlier run has made.
    let _ = fs::remove_dir_all(&home);
    let mut run = Command::new(env!("CARGO"));
    run.args(["run", "--quiet", "--"]).arg(&home).env("CARGO_TARGET_DIR", &output);
    // Line tables would take as long to compile as the rest.
    show(run.env("CARGO_PROFILE_DEV_DEBUG", "false").current_dir(folder))
}

/// Builds the Python package, checks the Python sources and runs the tests of the package.
pub fn python() -> Result<()> {
    Plume::package(Profile::Dev)?;
    interop::mujoco::make()?;
    interop::certify::make()?;
    interop::truth::make()?;
    interop::record::make()?;
    let (python, scene) = (interop::usd::environment()?.python(), interop::write_scene()?);
    let plume = Plume::build(Profile::Dev)?;
    // Each test mostly waits for a separate process.
    let pytest = ["pytest", "--quiet", "--numprocesses", "auto"];
    for check in [&["ruff", "check", "--quiet"][..], &["ruff", "format", "--check", "--quiet"], &pytest] {
        let mut command = Command::new(&python);
        command.env("PLUME_SCENE", &scene).env("PLUME_BINARY", plume.program());
        show(command.arg("-m").args(check).current_dir(root()))?;
    }
    Ok(())
}

/// Drops a ball into two small caves, and drives a Husky through the default one.
pub fn simulators() -> Result<()> {
    let plume = Plume::build(Profile::Dev)?;
    for (name, generator) in [("cave", "gaussian-perlin"), ("mine", "mine")] {
        let (output, generator) = (format!("{CAVE}/{name}"), format!("graph.generator={generator}"));
        let export = ["export", "--target", "gazebo", "--force", "--output", &output, "--set", &generator];
        plume.output(&[&export[..], &SMALL[..]].concat())?;
        interop::only("pybullet", output.as_ref())?;
    }
    interop::urdf::drive(&plume, CAVE)
}

/// Checks with the oldest supported USD; the tests include the newest.
fn read_with_another_usd(plume: &Plume) -> Result<()> {
    let package = format!("{CAVE}/isaac");
    let export = ["export", "--target", "isaac", "--force", "--output", &package];
    plume.output(&[&export[..], &SMALL[..]].concat())?;
    interop::only("usd-old", package.as_ref())
}

/// Checks the formats that no simulator opens.
fn read_meshes(plume: &Plume) -> Result<()> {
    let shelf = format!("{CAVE}/formats");
    let export = ["export", "--target", "obj,ply,stl", "--force", "--output", &shelf];
    plume.output(&[&export[..], &SMALL[..]].concat())?;
    interop::only("trimesh", shelf.as_ref())
}

/// Generates the default cave with small images, since its shape does not depend on them.
fn drive_through(plume: &Plume) -> Result<()> {
    let (package, cave) = (format!("{CAVE}/mujoco"), format!("{CAVE}/mujoco.cave"));
    let places = ["--output", &package, "--keep", &cave];
    let export = ["export", "--target", "mujoco", "--force", "--set", "texture.size_px=256"];
    plume.output(&[&export[..], &places[..]].concat())?;
    for reader in ["compile", "balls", "rays"] {
        interop::only(reader, package.as_ref())?;
    }
    println!("{}", interop::mujoco::drive(package.as_ref())?);
    Ok(())
}
