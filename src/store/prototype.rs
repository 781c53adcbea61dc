//! The prototypes of things in the cave folder: a mesh of all of them at every level of detail, and one set of images.

use super::ply::PlyMesh;
use super::{
    CaveFolder, Facts, LodFacts, PROTOTYPES, Stage, StoreError, WHOLE_CAVE, lod_path, read_ply, textured_path,
};
use crate::things::{Kinds, Library};

/// The prototypes of a cave folder.
pub struct Prototypes<'a> {
    /// What they are.
    pub library: Library<'a>,
    /// The mesh of all of them at every level of detail, the finest first.
    pub levels: Vec<PlyMesh>,
    /// Upper bound of the distance of each level from the finest, in metres.
    pub errors_m: Vec<f64>,
}

/// Reads the prototypes of these kinds; `None` if there are none.
///
/// # Errors
/// If they are missing or damaged.
pub fn read_prototypes<'a>(folder: &CaveFolder, kinds: Kinds<'a>) -> Result<Option<Prototypes<'a>>, StoreError> {
    let unit = folder.units(Stage::Things).into_iter().find(|unit| unit.name == WHOLE_CAVE);
    let Some(unit) = unit.filter(|unit| !unit.files.is_empty()) else { return Ok(None) };
    let coarser: Vec<LodFacts> = if let Facts::Things(facts) = unit.facts { facts.lods } else { Vec::new() };
    let paths = (1..=coarser.len()).map(|level| lod_path(PROTOTYPES, level));
    let paths = std::iter::once(textured_path(PROTOTYPES)).chain(paths);
    let levels: Vec<PlyMesh> = paths.map(|path| read_ply(folder, &path)).collect::<Result<_, _>>()?;
    let library = Library::new(kinds, &levels[0].positions);
    let errors_m = std::iter::once(0.0).chain(coarser.iter().map(|facts| facts.error_m)).collect();
    Ok(Some(Prototypes { library, levels, errors_m }))
}
