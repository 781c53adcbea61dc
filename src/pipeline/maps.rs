//! The maps of the user's own that a recipe names: read, and put onto the rock.

use std::io::ErrorKind;
use std::path::Path;
use std::sync::Arc;

use plume_disk::regular;

use super::PipelineError;
use super::files::Copies;
use crate::material::{Clad, Material, OwnMaps};
use crate::picture::{Image, Tile};
use crate::texture::{OwnMap, TextureSettings};

/// Most bytes of a file. Tuned: enough for most images of the largest size that is read.
const MAX_BYTES: u64 = 256 << 20;

/// The maps of a recipe.
#[derive(Default)]
pub(super) struct Maps {
    /// Their files.
    pub copies: Copies,
    own: Option<Arc<OwnMaps>>,
}

impl Maps {
    /// Reads the maps that these settings name.
    ///
    /// # Errors
    /// If there is no base colour, or a file is not such an image.
    pub fn read(settings: &TextureSettings) -> Result<Self, PipelineError> {
        let mut maps = Self::default();
        if let Some(folder) = &settings.own {
            let missing = || fault(&folder.join(OwnMap::BaseColor.file_name()), "is missing".to_owned());
            maps.own = Some(Arc::new(OwnMaps {
                base_color: maps.add(folder, OwnMap::BaseColor, Tile::Colors)?.ok_or_else(missing)?,
                normal: maps.add(folder, OwnMap::Normal, Tile::Vectors)?,
                roughness: maps.add(folder, OwnMap::Roughness, Tile::Numbers)?,
                tile_m: settings.own_m,
            }));
        }
        Ok(maps)
    }

    /// Reads a map, if it is there.
    fn add(&mut self, folder: &Path, map: OwnMap, tile: Tile) -> Result<Option<Image>, PipelineError> {
        let path = folder.join(map.file_name());
        let bytes = match regular::read(&path, MAX_BYTES) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            read => read.map_err(|error| fault(&path, format!("cannot be read: {error}")))?,
        };
        let image = Image::read_tile(&bytes, tile).map_err(|problem| fault(&path, problem))?;
        self.copies.0.push((map.kept_path(), bytes));
        Ok(Some(image))
    }

    /// A rock with these maps on it; without any, the rock.
    pub fn on(&self, rock: Arc<dyn Material>) -> Arc<dyn Material> {
        match &self.own {
            Some(maps) => Arc::new(Clad { rock, maps: Arc::clone(maps) }),
            None => rock,
        }
    }
}

fn fault(path: &Path, problem: String) -> PipelineError {
    PipelineError::Map { path: path.to_path_buf(), problem }
}
