//! The model files of a recipe: read, and made into things.

use std::io;
use std::path::Path;
use std::sync::Arc;

use plume_disk::regular;

use super::files::Copies;
use super::{Disk, PipelineError};
use crate::model::{Format, ModelError};
use crate::recipe::Recipe;
use crate::store::is_plain_name;
use crate::things::{FileSettings, Replica};
use plume_graph::Outside;
use plume_graph::echo::shown;

/// Most bytes of a file.
const MAX_BYTES: u64 = 64 << 20;
/// Most files that one model names.
const MOST_FILES: usize = 16;

/// The models of a recipe.
pub(super) struct Models {
    /// Every file.
    pub copies: Copies,
    /// In the order of the recipe.
    replicas: Vec<Arc<Replica>>,
}

impl Models {
    /// Reads the models of a recipe, and the files that those name.
    ///
    /// # Errors
    /// If a file cannot be read, is no model, or is not fit to be a thing.
    pub fn read(recipe: &Recipe, disk: Disk) -> Result<Self, PipelineError> {
        let mut models = Self { copies: Copies::default(), replicas: Vec::new() };
        for file in &recipe.things().files {
            models.add(file, disk).map_err(|error| PipelineError::Model { path: file.path.clone(), error })?;
        }
        Ok(models)
    }

    fn add(&mut self, file: &FileSettings, disk: Disk) -> Result<(), ModelError> {
        const MODELS: &str = "models are GLB or OBJ files: .glb, .obj";
        let format = Format::of(&file.path).ok_or_else(|| ModelError::new("is not a model by its name", MODELS))?;
        let bytes = regular::read(&file.path, MAX_BYTES).map_err(|error| unread(&error))?;
        let folder = file.path.parent().unwrap_or(Path::new(""));
        let mut named: Vec<(String, Vec<u8>)> = Vec::new();
        let mut beside = |name: &str| {
            let bytes = read_beside(folder, name, disk)?;
            if named.iter().all(|(known, _)| known != name) {
                named.push((name.to_owned(), bytes.clone()));
            }
            if named.len() > MOST_FILES {
                return Err(ModelError::new(
                    format!("names more than {MOST_FILES} files"),
                    "bake its textures into one",
                ));
            }
            Ok(bytes)
        };
        let model = format.read(&bytes, &mut beside)?;
        self.replicas.push(Arc::new(Replica::new(model, file.scale)?));
        let kept = named.into_iter().map(|(name, bytes)| (format!("{}/{name}", file.kept_folder()), bytes));
        self.copies.0.push((file.kept_path(), bytes));
        self.copies.0.extend(kept);
        Ok(())
    }

    /// The models as things, in the order of the recipe.
    pub fn replicas(&self) -> &[Arc<Replica>] {
        &self.replicas
    }
}

/// The content of a file that a model names, which must lie below the folder of the model.
fn read_beside(folder: &Path, name: &str, disk: Disk) -> Result<Vec<u8>, ModelError> {
    const BELOW: &str = "put it into the folder of the model, and name it relative to that";
    let path = folder.join(name);
    if !name.split('/').all(is_plain_name) || !disk.is_below(folder, &path) {
        return Err(ModelError::new(format!("names {}, which is not below its folder", shown(name)), BELOW));
    }
    regular::read(&path, MAX_BYTES).map_err(|error| {
        let ModelError { message, hint } = unread(&error);
        ModelError::new(format!("names {}, which {message}", shown(name)), hint)
    })
}

fn unread(error: &io::Error) -> ModelError {
    ModelError::new(
        format!("cannot be read: {error}"),
        "paths are relative to the recipe, those in a model to its folder",
    )
}
