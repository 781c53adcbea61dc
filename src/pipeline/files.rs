//! The files that a recipe names beside those of its graph, and their copies in the cave folder.

use super::maps::Maps;
use super::models::Models;
use super::{Disk, PipelineError};
use crate::recipe::Recipe;
use crate::store::{CaveFolder, FileRecord, StoreError, sha256};

/// Models of things, and maps of the rock.
pub struct UserFiles {
    /// The models.
    pub(super) models: Models,
    /// The maps.
    pub(super) maps: Maps,
}

impl UserFiles {
    /// Reads the files of a recipe.
    ///
    /// # Errors
    /// If one cannot be read or is not fit for its purpose.
    pub fn read(recipe: &Recipe, disk: Disk) -> Result<Self, PipelineError> {
        Ok(Self { models: Models::read(recipe, disk)?, maps: Maps::read(recipe.texture())? })
    }

    /// What follows from the files follows from this text; empty without any.
    pub(super) fn fingerprint(&self) -> String {
        self.models.copies.fingerprint() + &self.maps.copies.fingerprint()
    }

    /// Writes all files into a cave folder.
    pub(super) fn keep(&self, folder: &CaveFolder) -> Result<Vec<FileRecord>, StoreError> {
        Ok([self.models.copies.keep(folder)?, self.maps.copies.keep(folder)?].concat())
    }
}

/// Files by their paths in a cave folder.
#[derive(Default)]
pub(super) struct Copies(pub Vec<(String, Vec<u8>)>);

impl Copies {
    /// What follows from the files follows from this text; empty without any.
    pub fn fingerprint(&self) -> String {
        self.0.iter().map(|(path, bytes)| format!("\n{path} {}", sha256(bytes))).collect()
    }

    fn keep(&self, folder: &CaveFolder) -> Result<Vec<FileRecord>, StoreError> {
        self.0.iter().map(|(path, bytes)| folder.write(path, |out| out.write_all(bytes))).collect()
    }
}
