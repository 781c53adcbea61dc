//! `cargo xtask drives [SEEDS]`: holds certificates to drives. Default caves of that many seeds, ten unless told otherwise, and one
//! cave of every sample recipe; about four CPU minutes for ten.

use std::fs;
use std::path::{Path, PathBuf};

use crate::interop::mujoco;
use crate::plume::{Plume, Profile};
use crate::samples;
use crate::tools::{Result, root};

/// Passages that are driven in a cave, of each class.
const PASSAGES: &str = "12";

/// The task.
pub fn run(arguments: &[String]) -> Result<()> {
    let seeds: usize = match arguments {
        [] => 10,
        [count] => count.parse().map_err(|_| format!("{count} is no number of seeds"))?,
        _ => return Err("one number at most".to_owned()),
    };
    let plume = Plume::package(Profile::Dev)?;
    let folder = root().join("target/drives");
    let mut caves = Vec::new();
    for seed in 1..=seeds {
        caves.extend(cave(&plume, &folder, &format!("seed_{seed}"), &["--seed", &seed.to_string()])?);
        let layers = ["--seed", &seed.to_string(), "--set", "graph.layers=3"];
        caves.extend(cave(&plume, &folder, &format!("layers_{seed}"), &layers)?);
    }
    for recipe in samples::recipes()? {
        let name = recipe.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        caves.extend(cave(&plume, &folder, &name, &[&recipe.to_string_lossy()])?);
    }
    let status = mujoco::drives(PASSAGES, &caves)?.status().map_err(|error| format!("cannot run Python: {error}"))?;
    if status.success() { Ok(()) } else { Err("a path that is called go was not driven".to_owned()) }
}

/// The package for MuJoCo of a cave, and the cave, made unless they are there.
fn cave(plume: &Plume, folder: &Path, name: &str, input: &[&str]) -> Result<[PathBuf; 2]> {
    let [package, cave] = ["mujoco", "cave"].map(|what| folder.join(format!("{name}.{what}")));
    fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let places = [package.to_string_lossy(), cave.to_string_lossy()];
    let coarse = ["--set", "texture.density_px_per_m=5", "--quiet"];
    let command = ["export", "--target", "mujoco", "-o", &places[0], "--keep", &places[1]];
    plume.show(&[&command[..], &coarse, input].concat())?;
    Ok([package, cave])
}
