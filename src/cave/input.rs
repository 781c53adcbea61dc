//! What a cave is made from: the default recipe, a recipe, a graph or a cave folder.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::{Value, json};

use super::CaveError;
use crate::pipeline::{self, Disk};
use crate::preset::{PRESETS, Preset};
use crate::recipe::{self, Recipe};
use crate::store::{self, CaveFolder, Stage};
use plume_graph::Graph;
use plume_graph::realism::RealismSettings;
use plume_survey::{Parts, format_of};

/// The only format whose files may carry a recipe.
const OWN_FORMAT: &str = "json";

/// The note about a cave folder whose graph was edited.
pub const GRAPH_EDITED: &str = "graph.json has been edited";

/// What a cave is made from, resolved.
#[derive(Debug)]
pub struct Input {
    /// The recipe.
    pub recipe: Recipe,
    /// A graph that replaces the recipe's own.
    pub graph: Option<Graph>,
    /// The cave folder, if that is the input.
    pub folder: Option<PathBuf>,
    /// Whether overrides change the recipe of the cave folder.
    pub is_overridden: bool,
    /// What has changed since the cave folder was made: `graph.nodes: 8 → 9`, or an edited graph.
    pub changes: Vec<String>,
}

impl Input {
    /// Reads the input: a recipe (TOML), a graph or survey from `disk`, or a cave folder; without one, the default recipe.
    /// `overrides` are `key=value` pairs that take precedence.
    ///
    /// # Errors
    /// If it cannot be read or is faulty.
    pub fn read(path: Option<&Path>, overrides: &[String], disk: Disk) -> Result<Self, CaveError> {
        let Some(path) = path else {
            return Ok(Self::of(Recipe::from_overrides(overrides)?));
        };
        if path.is_dir() {
            return cave_folder(path, overrides);
        }
        if format_of(path, |row| row.read.is_some()).is_some() {
            return graph_file(path, overrides, disk);
        }
        Ok(Self::of(Recipe::from_toml(&read(path)?, path, overrides)?))
    }

    /// A recipe and nothing else.
    pub fn of(recipe: Recipe) -> Self {
        Self { recipe, graph: None, folder: None, is_overridden: false, changes: Vec::new() }
    }
}

fn cave_folder(folder: &Path, overrides: &[String]) -> Result<Input, CaveError> {
    if !CaveFolder::is_at(folder) {
        return Err(no_cave(folder, "name a recipe, a graph, or a folder made by `plume generate -o`"));
    }
    let path = folder.join(store::RECIPE);
    let text = read(&path)?;
    let own = Recipe::from_kept_toml(&text, &path)?;
    let recipe = Recipe::from_toml(&text, &path, overrides)?;
    let is_overridden = own.to_json() != recipe.to_json();
    let input = Input { folder: Some(folder.to_path_buf()), is_overridden, ..Input::of(recipe) };
    let mut input = with_kept_graph(input, &folder.join(store::GRAPH))?;
    if is_graph_edited(&CaveFolder::open(folder)?)? {
        input.changes.push(GRAPH_EDITED.to_owned());
    }
    Ok(input)
}

/// The folder, which takes from `parts` what they have of its cave.
///
/// # Errors
/// If one is no cave folder, or cannot be read.
pub fn with_parts(folder: CaveFolder, parts: &[PathBuf]) -> Result<CaveFolder, CaveError> {
    let open = |part: &PathBuf| match CaveFolder::is_at(part) {
        true => Ok(CaveFolder::open(part)?),
        false => Err(no_cave(part, "name folders made by `plume chunk -o`")),
    };
    Ok(folder.with_parts(parts.iter().map(open).collect::<Result<_, CaveError>>()?))
}

fn no_cave(folder: &Path, hint: &str) -> CaveError {
    let message = format!("{}: does not contain a cave", folder.display());
    CaveError::Usage { message, hint: hint.into() }
}

/// Whether the graph of a cave folder was edited.
///
/// # Errors
/// If the folder cannot be read.
pub fn is_graph_edited(folder: &CaveFolder) -> Result<bool, CaveError> {
    let units = folder.units(Stage::Graph);
    let mut records = units.iter().flat_map(|unit| &unit.files).filter(|file| file.path == store::GRAPH);
    Ok(records.next().map_or(Ok(false), |record| folder.is_changed(record))?)
}

/// The graph of a cave folder takes precedence over the file or the generator it came from, until the recipe asks for
/// another or the graph is deleted.
fn with_kept_graph(input: Input, path: &Path) -> Result<Input, CaveError> {
    if !path.exists() {
        return Ok(input);
    }
    let recipe = &input.recipe;
    let document = pipeline::read_graph(path, parts_of(recipe.to_json()))?;
    // A graph of a version without the realism gate has not passed it.
    let gate =
        |made: &Value| -> RealismSettings { serde_json::from_value(made["realism"].clone()).unwrap_or_default() };
    let is_of = |made: &Value| {
        ["graph", "seed"].iter().all(|key| made[key] == recipe.to_json()[key]) && *recipe.realism() == gate(made)
    };
    let made = document.recipe.as_ref();
    let changes = made.map(|made| recipe::differences(made, recipe.to_json())).unwrap_or_default();
    let graph = made.is_some_and(is_of).then_some(document.graph);
    Ok(Input { graph, changes, ..input })
}

/// What to do with disconnected parts of the graph of this recipe; only graphs from files may have several.
fn parts_of(recipe: &Value) -> Parts {
    Parts::deserialize(&recipe["graph"]["parts"]).unwrap_or_default()
}

/// A graph written by Plume carries its recipe. Any other gets the default recipe, whose `parts` setting applies.
fn graph_file(path: &Path, overrides: &[String], disk: Disk) -> Result<Input, CaveError> {
    let is_of_plume = format_of(path, |row| row.read.is_some()).is_some_and(|row| row.name == OWN_FORMAT);
    let own = if is_of_plume { disk.graph(path, Parts::Keep)?.recipe } else { None };
    let Some(own) = own else { return foreign_graph(path, overrides, disk) };
    let recipe = Recipe::from_json(own, path, overrides)?;
    let document = disk.graph(path, parts_of(recipe.to_json()))?;
    Ok(Input { graph: Some(document.graph), ..Input::of(recipe) })
}

/// A graph or survey without a recipe. It is read here to tell what is wrong about it before anything is made.
fn foreign_graph(path: &Path, overrides: &[String], disk: Disk) -> Result<Input, CaveError> {
    let name = path.to_str().ok_or_else(|| CaveError::Usage {
        message: format!("{}: this path cannot be written to a recipe", path.display()),
        hint: "rename the file so that its path is valid UTF-8".into(),
    })?;
    let file = json!({"graph": {"generator": "file", "path": name}});
    let recipe = Recipe::from_json(file, path, overrides)?;
    // What to do with parts is up to the generator.
    disk.graph(path, Parts::Keep)?;
    Ok(Input::of(recipe))
}

/// The preset called `name`.
///
/// # Errors
/// [`CaveError::Usage`], which suggests the nearest.
pub fn preset(name: &str) -> Result<&'static Preset, CaveError> {
    let row = PRESETS.iter().find(|row| row.name == name);
    row.ok_or_else(|| CaveError::unknown("preset", name, PRESETS.iter().map(|row| row.name)))
}

/// The recipe that starts from a preset, or from a recipe file: a name with a folder or with the ending `.toml`.
///
/// # Errors
/// If there is no such preset or file, or it or an override is faulty.
pub fn start_from(base: &str, overrides: &[String]) -> Result<Recipe, CaveError> {
    let is_file = base.ends_with(".toml") || base.contains(std::path::is_separator);
    if !is_file {
        return Ok(Recipe::from_preset(preset(base)?, overrides)?);
    }
    let file = Path::new(base);
    Ok(Recipe::from_base(&read(file)?, file, overrides)?)
}

/// Reads a recipe that the user named.
///
/// # Errors
/// If it cannot be read.
pub fn read(path: &Path) -> Result<String, CaveError> {
    let text = plume_disk::regular::read(path, recipe::MAX_BYTES).and_then(|bytes| {
        String::from_utf8(bytes).map_err(|_| io::Error::new(ErrorKind::InvalidData, "is not UTF-8 text"))
    });
    text.map_err(|source| CaveError::Input { path: path.to_path_buf(), source })
}
