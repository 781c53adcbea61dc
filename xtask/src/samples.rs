//! The recipes in `samples/`.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::tools::{Result, root, run};

/// Recipes that run through every stage: meshed, textured and exported.
pub const SAMPLES: [&str; 5] = ["cave", "lava-tube", "mine", "salt-mine", "original"];

/// A sample as it is exported for interop checks.
#[derive(Clone, Copy)]
pub struct Sample {
    /// Name of the recipe.
    pub name: &'static str,
    /// Arguments in addition to the recipe.
    pub settings: &'static [&'static str],
}

impl Sample {
    /// At its own density of texels.
    pub fn fine(name: &'static str) -> Self {
        Self { name, settings: &[] }
    }

    /// With small images and few things, which take a fraction of the time to make, write and read.
    fn coarse(name: &'static str) -> Self {
        Self { name, settings: &["--set", "texture.density_px_per_m=20", "--set", "things.cover=0.008"] }
    }
}

/// The default cave, and one other with coarse images and few things, chosen by the hash of the commit so that all have their turn.
pub fn by_turns() -> Result<[Sample; 2]> {
    let [default, others @ ..] = SAMPLES;
    let commit = run(Command::new("git").args(["rev-parse", "HEAD"]).current_dir(root()))?;
    let turn = commit.bytes().fold(0, |sum, byte| sum + usize::from(byte)) % others.len();
    println!("commit {commit}: it is the turn of the sample {}; `--all` takes every one", others[turn]);
    Ok([Sample::fine(default), Sample::coarse(others[turn])])
}

/// The recipes among the samples, relative to the workspace, in order.
pub fn recipes() -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(root().join("samples")).map_err(|error| error.to_string())?;
    let names = entries.filter_map(|entry| Some(PathBuf::from("samples").join(entry.ok()?.file_name())));
    let mut recipes: Vec<PathBuf> = names.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    recipes.sort();
    Ok(recipes)
}
