//! What the first argument of a command means.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::Source;
use super::fault::CliError;
use crate::graph::Graph;
use crate::pipeline;
use crate::recipe::Recipe;
use crate::store::{self, CaveFolder};

/// A resolved source.
pub struct Input {
    /// The whole recipe.
    pub recipe: Recipe,
    /// A graph that replaces the recipe's own.
    pub graph: Option<Graph>,
    /// The cave folder, if that is what was named.
    pub folder: Option<PathBuf>,
}

impl Source {
    /// Reads what was named: nothing, a recipe, a graph or a cave folder.
    ///
    /// # Errors
    /// When it cannot be read or is faulty.
    pub fn resolve(&self) -> Result<Input, CliError> {
        let overrides = self.overrides();
        let Some(path) = &self.input else {
            return Ok(Input { recipe: Recipe::from_overrides(&overrides)?, graph: None, folder: None });
        };
        if path.is_dir() {
            return self.cave_folder(path);
        }
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
            return graph_file(path, &overrides);
        }
        let recipe = Recipe::from_toml(&read(path)?, path, &overrides)?;
        Ok(Input { recipe, graph: None, folder: None })
    }

    fn cave_folder(&self, folder: &Path) -> Result<Input, CliError> {
        if !CaveFolder::is_at(folder) {
            let message = format!("{}: holds no cave", folder.display());
            let hint = "name a recipe, a graph, or a folder that `plume generate -o` made".into();
            return Err(CliError::Usage { message, hint });
        }
        let path = folder.join(store::RECIPE);
        let recipe = Recipe::from_toml(&read(&path)?, &path, &self.overrides())?;
        let graph = kept_graph(&folder.join(store::GRAPH), recipe.to_json())?;
        Ok(Input { recipe, graph, folder: Some(folder.to_path_buf()) })
    }
}

/// The graph of a cave folder counts, not the file or the generator it once came from, until the recipe asks for
/// another or it is gone.
fn kept_graph(path: &Path, recipe: &Value) -> Result<Option<Graph>, CliError> {
    if !path.exists() {
        return Ok(None);
    }
    let document = pipeline::read_graph(path)?;
    let is_of = |made: &Value| ["graph", "seed"].iter().all(|key| made[key] == recipe[key]);
    Ok(document.recipe.as_ref().is_some_and(is_of).then_some(document.graph))
}

/// A graph of ours brings its recipe. One of the original PLUME gets the default recipe round it.
fn graph_file(path: &Path, overrides: &[String]) -> Result<Input, CliError> {
    let document = pipeline::read_graph(path)?;
    let Some(recipe) = document.recipe else {
        let name = path.to_str().ok_or_else(|| CliError::Usage {
            message: format!("{}: a recipe cannot hold this path", path.display()),
            hint: "rename the file so that its path is UTF-8".into(),
        })?;
        let file = json!({"graph": {"generator": "file", "path": name}});
        let recipe = Recipe::from_json(file, path, overrides)?;
        return Ok(Input { recipe, graph: None, folder: None });
    };
    let recipe = Recipe::from_json(recipe, path, overrides)?;
    Ok(Input { recipe, graph: Some(document.graph), folder: None })
}

fn read(path: &Path) -> Result<String, CliError> {
    fs::read_to_string(path).map_err(|source| CliError::Input { path: path.to_path_buf(), source })
}
