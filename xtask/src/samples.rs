//! What lies in `samples/`.

use std::fs;
use std::path::PathBuf;

use crate::tools::{Result, root};

/// Recipes that are made whole: meshed, textured and exported.
pub const SAMPLES: [&str; 4] = ["cave", "lava-tube", "mine", "original"];

/// The recipes among the samples, relative to the workspace, in order.
pub fn recipes() -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(root().join("samples")).map_err(|error| error.to_string())?;
    let names = entries.filter_map(|entry| Some(PathBuf::from("samples").join(entry.ok()?.file_name())));
    let mut recipes: Vec<PathBuf> = names.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    recipes.sort();
    Ok(recipes)
}
