//! Stones and dripstone: first the prototypes, then the things of every chunk.

use std::sync::Arc;

use super::{Pipeline, PipelineError, UserFiles, field_and_grid};
use crate::field::CaveField;
use crate::material::Material;
use crate::mesh::Grid;
use crate::recipe::Recipe;
use crate::store::{self, Facts, PROTOTYPES, Stage, ThingFacts, Unit, WHOLE_CAVE};
use crate::texture::{LodSettings, TextureSettings};
use crate::things::{self, Dress, Library, Setting, Shelf};
use plume_graph::{Aabb, Graph};

/// Texels per metre on the shelf relative to those on the wall, as the largest stones are about twice as large as their
/// prototypes. Tuned.
pub(super) const TEXEL_RATIO: f32 = 1.5;
/// Sides of the images of all prototypes, if recipes set those of chunks, in pixels: large enough for the charts of all solids, and
/// about as large as those of the default density. Tuned.
const SIZE_PX: [u32; 2] = [512, 2048];
/// Coarser levels of a prototype.
const LEVELS: LodSettings = LodSettings { levels: 3, reduction: 2.0 };

impl Pipeline<'_> {
    /// Makes the prototypes and the things of all chunks.
    ///
    /// # Errors
    /// If the meshes are missing, the disk fails, or the observer stops.
    pub fn things(&self) -> Result<(), PipelineError> {
        let (field, grid) = field_and_grid(self.recipe, &self.graph)?;
        let walls = self.walls();
        self.things_on(&field, &grid, &walls, &walls)
    }

    /// Makes the prototypes, and the things of some of the walls; `all` has their neighbours.
    pub(super) fn things_on(
        &self,
        field: &CaveField,
        grid: &Grid,
        walls: &[Unit],
        all: &[Unit],
    ) -> Result<(), PipelineError> {
        self.unit(Stage::Things, WHOLE_CAVE, || self.prototypes())?;
        let library = library(self.recipe, self.folder)?;
        self.each(Stage::Things, walls, |wall| {
            self.unit(Stage::Things, &wall.name, || self.things_of(&wall.name, all, grid, field, &library))
        })
    }

    fn prototypes(&self) -> Result<Made, PipelineError> {
        if self.recipe.things().cover <= 0.0 {
            return Ok((Vec::new(), Facts::Things(ThingFacts::default())));
        }
        let shelf = shelf(self.recipe, &self.files);
        let texture = self.recipe.texture();
        let density_px_per_m = TEXEL_RATIO * texture.density_px_per_m;
        let size_px = texture.size_px.map(|size_px| size_px.clamp(SIZE_PX[0], SIZE_PX[1]));
        let texture = TextureSettings { density_px_per_m, size_px, ..texture.clone() };
        let (library, mesh) = Library::of_shelf(self.recipe.kinds(), &shelf);
        let written = store::write_textured(self.folder, PROTOTYPES, &mesh, &shelf, &texture, &LEVELS)?;
        let lods = written.levels.iter().map(Into::into).collect();
        let facts = ThingFacts { things: library.prototypes.len(), lods, ..ThingFacts::default() };
        Ok((written.files, Facts::Things(facts)))
    }

    fn things_of(
        &self,
        name: &str,
        walls: &[Unit],
        grid: &Grid,
        field: &CaveField,
        library: &Library,
    ) -> Result<Made, PipelineError> {
        let setting = setting(self.recipe, &self.graph, field, library);
        let (wall, around) = self.with_neighbours(name, walls)?;
        let index = store::chunk_index(name).expect("walls are named after their chunks");
        let Aabb { min, max } = grid.chunk_bounds(index);
        let bounds = Aabb { min: min.map(f64::from), max: max.map(f64::from) };
        let near = || std::iter::once(&wall).chain(&around);
        let (mut things, gravel) = (things::place(&setting, bounds, near()), things::strew(&setting, bounds, near()));
        let movable = things.iter().filter(|thing| library.is_movable(thing, setting.settings.movable_m)).count();
        let (count, gravel_count) = (things.len(), gravel.len());
        let facts = Facts::Things(ThingFacts { things: count, gravel: gravel_count, movable, lods: Vec::new() });
        things.extend(gravel);
        let file = (!things.is_empty()).then(|| store::write_things(self.folder, name, &things)).transpose()?;
        Ok((file.into_iter().collect(), facts))
    }

    /// Whether every wall has its things.
    pub fn has_things(&self) -> bool {
        let made = self.names(Stage::Things);
        made.contains(WHOLE_CAVE) && self.walls().iter().all(|wall| made.contains(&wall.name))
    }
}

type Made = (Vec<store::FileRecord>, Facts);

/// The prototypes in a cave folder; none if it has no things.
fn library<'a>(recipe: &'a Recipe, folder: &store::CaveFolder) -> Result<Library<'a>, PipelineError> {
    Ok(store::read_prototypes(folder, recipe.kinds())?.map(|prototypes| prototypes.library).unwrap_or_default())
}

/// The shapes of the things of a recipe.
fn shelf(recipe: &Recipe, files: &UserFiles) -> Shelf {
    let material = |setting| files.maps.on(rock_with(recipe, setting));
    let (kinds, replicas, look) = (recipe.kinds(), files.models.replicas(), recipe.look());
    Shelf::new(&Dress { kinds, replicas, material: &material, look, seed: recipe.seed() })
}

/// The shapes of the things of a recipe, and the prototypes made of them; `None` if it has no things.
pub fn stock<'a>(recipe: &'a Recipe, files: &UserFiles) -> Option<(Shelf, Library<'a>)> {
    (recipe.things().cover > 0.0).then(|| {
        let shelf = shelf(recipe, files);
        let (library, _) = Library::of_shelf(recipe.kinds(), &shelf);
        (shelf, library)
    })
}

/// What the things of a recipe follow from, beside its walls.
pub(super) fn setting<'a>(
    recipe: &'a Recipe,
    graph: &'a Graph,
    field: &'a CaveField,
    library: &'a Library<'a>,
) -> Setting<'a> {
    Setting { library, settings: recipe.things(), kinds: recipe.kinds(), field, graph, seed: recipe.seed() }
}

/// The rock with one setting replaced.
fn rock_with(recipe: &Recipe, setting: Option<(&'static str, f64)>) -> Arc<dyn Material> {
    let changed = setting.and_then(|(key, value)| recipe.with(&format!("rock.{key}"), value).ok());
    Arc::clone(changed.as_ref().unwrap_or(recipe).rock())
}
