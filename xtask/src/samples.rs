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
}

/// The samples that take turns beside the default cave, smaller than they are by default, which takes a fraction of the time to
/// make, write and read. That of the original PLUME cannot be made so small: its checks take longer than all others together.
const SMALL: [Sample; 3] = [
    small("lava-tube", &["--set", "graph.nodes=20", "--set", COARSE, "--set", FEW]),
    small("mine", &["--set", "graph.nodes=20", "--set", COARSE, "--set", FEW]),
    small("salt-mine", &["--set", "graph.nodes=20", "--set", COARSE, "--set", FEW]),
];
const COARSE: &str = "texture.density_px_per_m=20";
const FEW: &str = "things.cover=0.008";

const fn small(name: &'static str, settings: &'static [&'static str]) -> Sample {
    Sample { name, settings }
}

/// The default cave, and one other, smaller than it is by default, chosen by the hash of the commit so that all have their turn.
pub fn by_turns() -> Result<[Sample; 2]> {
    let commit = run(Command::new("git").args(["rev-parse", "HEAD"]).current_dir(root()))?;
    let turn = commit.bytes().fold(0, |sum, byte| sum + usize::from(byte)) % SMALL.len();
    println!("commit {commit}: it is the turn of the sample {}; `--all` takes every one", SMALL[turn].name);
    Ok([Sample::fine(SAMPLES[0]), SMALL[turn]])
}

/// The recipes among the samples, relative to the workspace, in order.
pub fn recipes() -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(root().join("samples")).map_err(|error| error.to_string())?;
    let names = entries.filter_map(|entry| Some(PathBuf::from("samples").join(entry.ok()?.file_name())));
    let mut recipes: Vec<PathBuf> = names.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    recipes.sort();
    Ok(recipes)
}
