//! The stages, from recipe to finished cave folder, chunk by chunk.
//!
//! Every stage is a function of earlier ones, consists of independent units, and skips units that are already finished. All
//! threads work on chunks; memory is a few chunks per thread, however many there are.

mod error;
mod files;
mod maps;
mod models;
mod needs;
mod outside;
mod part;
mod pieces;
mod preview;
mod program;
mod status;
mod things;
mod threads;

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use serde_json::{Map, Value};

pub use self::error::PipelineError;
pub use self::files::UserFiles;
pub use self::needs::Needs;
pub use self::outside::{Disk, Machine};
pub use self::part::chunk_grid;
pub use self::status::{StageStatus, State};
pub use self::things::stock;
pub use self::threads::with_large_stacks;
use crate::field::{Aabb, CaveField};
use crate::material::Material;
use crate::mesh::{self, ChunkIndex, Grid, GridError};
use crate::preview::{Furnishing, Subject};
use crate::recipe::Recipe;
use crate::store::{self, CaveFolder, Facts, FileRecord, MeshFacts, Stage, TextureFacts, Unit, chunk_name, sha256};
use crate::things::{Library, Shelf};
use plume_graph::Graph;
use plume_survey::{Import, Parts};

/// Observes the work and may stop it.
pub trait Observer: Sync {
    /// A stage of `total` units begins.
    fn begin(&self, stage: Stage, total: usize);
    /// A unit is done.
    fn advance(&self, stage: Stage);
    /// The stage is done.
    fn end(&self, stage: Stage);
    /// Set to stop after the units in progress.
    fn stop(&self) -> &AtomicBool;
    /// Told of something that can be read but is probably a mistake.
    fn warn(&self, _warning: &str) {}
    /// Whether recipes may run programs.
    fn allows_programs(&self) -> bool {
        false
    }
    /// Whether files may refer to files outside their folder.
    fn allows_outside_files(&self) -> bool {
        false
    }
}

/// Nobody watches, and nothing stops the work.
#[derive(Debug, Default)]
pub struct Unobserved {
    stop: AtomicBool,
}

impl Observer for Unobserved {
    fn begin(&self, _: Stage, _: usize) {}

    fn advance(&self, _: Stage) {}

    fn end(&self, _: Stage) {}

    fn stop(&self) -> &AtomicBool {
        &self.stop
    }
}

/// What to do with another cave in the folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Other {
    /// Report an error.
    Refuse,
    /// Update it: it is this cave with a changed recipe or graph, so only what depends on the change is remade.
    Renew,
    /// Replace it.
    Replace,
}

/// A cave being made.
pub struct Pipeline<'a> {
    recipe: &'a Recipe,
    folder: &'a CaveFolder,
    observer: &'a dyn Observer,
    graph: Graph,
    files: UserFiles,
    graph_fingerprint: String,
    preview_fingerprint: String,
    mesh_fingerprint: String,
    texture_fingerprint: String,
    things_fingerprint: String,
    pieces_fingerprint: String,
}

impl<'a> Pipeline<'a> {
    /// Makes or reads the graph and writes recipe and graph into the folder. `given` replaces the recipe's own graph, `last`
    /// is the stage up to which the cave will be made.
    ///
    /// # Errors
    /// If the graph is impossible, the cave would be larger than its recipe allows, or the folder contains something that
    /// must not be replaced.
    pub fn start(
        recipe: &'a Recipe,
        given: Option<Graph>,
        folder: &'a CaveFolder,
        last: Stage,
        other: Other,
        observer: &'a dyn Observer,
    ) -> Result<Self, PipelineError> {
        observer.begin(Stage::Graph, 1);
        let is_given = given.is_some();
        let pipeline = Self::plan(recipe, given, folder, observer)?;
        Needs::estimate(recipe, &pipeline.graph).refuse_excess(recipe, last)?;
        pipeline.refuse_other_parts()?;
        if other == Other::Refuse {
            pipeline.refuse_other_cave()?;
        }
        if other != Other::Replace {
            pipeline.refuse_to_lose_changes()?;
            if !is_given {
                pipeline.refuse_to_lose_edits()?;
            }
        }
        pipeline.write_graph()?;
        observer.advance(Stage::Graph);
        observer.end(Stage::Graph);
        Ok(pipeline)
    }

    /// Makes or reads the graph without writing anything. `given` replaces the recipe's own graph.
    ///
    /// # Errors
    /// If the graph is impossible.
    pub fn plan(
        recipe: &'a Recipe,
        given: Option<Graph>,
        folder: &'a CaveFolder,
        observer: &'a dyn Observer,
    ) -> Result<Self, PipelineError> {
        let graph = match given {
            Some(graph) => graph,
            None => generated(recipe, observer)?,
        };
        let files = user_files(recipe, observer)?;
        let graph_fingerprint = cave_fingerprint(recipe, &graph, &files);
        let kept = recipe.to_kept_json();
        let section = |keys: &[&str]| keys.iter().map(|key| kept[key].to_string()).collect::<String>();
        let stations = stations(&graph);
        let maps = [crate::VERSION, &stations, &names(&graph), &section(&["name", "passage"])].concat();
        let preview_fingerprint = sha256(maps.as_bytes());
        let [rock_shape, rock_colors] = rock_parts(&kept["rock"]);
        let shape =
            [recipe.version(), stations, section(&["seed", "passage"]), rock_shape, section(&["mesh"])].concat();
        let mesh_fingerprint = sha256(shape.as_bytes());
        let look = section(&["look", "texture", "lod"]);
        let colour = [mesh_fingerprint.as_str(), &rock_colors, &look, &files.maps.copies.fingerprint()].concat();
        let texture_fingerprint = sha256(colour.as_bytes());
        let things = [texture_fingerprint.as_str(), &section(&["things"]), &files.models.copies.fingerprint()].concat();
        let things_fingerprint = sha256(things.as_bytes());
        let pieces_fingerprint = sha256([mesh_fingerprint.as_str(), &section(&["pieces"])].concat().as_bytes());
        Ok(Self {
            recipe,
            folder,
            observer,
            graph,
            files,
            graph_fingerprint,
            preview_fingerprint,
            mesh_fingerprint,
            texture_fingerprint,
            things_fingerprint,
            pieces_fingerprint,
        })
    }

    /// The graph.
    pub fn graph(&self) -> &Graph {
        &self.graph
    }

    /// The field of this cave.
    pub fn field(&self) -> CaveField {
        field_with(self.recipe, &self.graph, &self.files)
    }

    /// Runs a stage, given the stages before it.
    ///
    /// # Errors
    /// As the function of the stage.
    pub fn make(&self, stage: Stage) -> Result<(), PipelineError> {
        with_large_stacks(|| match stage {
            Stage::Graph => Ok(()),
            Stage::Preview => self.preview(),
            Stage::Mesh => self.mesh(),
            Stage::Things => self.things(),
            Stage::Texture => self.texture(),
            Stage::Pieces => self.pieces(),
        })
    }

    /// Makes the meshes of all chunks.
    ///
    /// # Errors
    /// If there is no valid grid or no wall, the disk fails, or the observer stops.
    pub fn mesh(&self) -> Result<(), PipelineError> {
        let (field, grid) = field_and_grid(self.recipe, &self.graph)?;
        self.meshes(&field, &grid, &grid.indices().collect::<Vec<_>>())?;
        if self.walls().is_empty() { Err(PipelineError::Empty) } else { Ok(()) }
    }

    /// Makes those of `chunks` that may have a wall. Others are no units.
    fn meshes(&self, field: &CaveField, grid: &Grid, chunks: &[ChunkIndex]) -> Result<(), PipelineError> {
        let chunks: Vec<ChunkIndex> =
            chunks.iter().copied().filter(|index| mesh::may_have_wall(field, grid, *index)).collect();
        self.each(Stage::Mesh, &chunks, |index| {
            let name = chunk_name(*index);
            self.unit(Stage::Mesh, &name, || {
                let meshes = mesh::chunk(field, grid, *index, self.recipe.mesh());
                Ok(match &meshes {
                    Some(meshes) => (self.write_meshes(&name, meshes)?, Facts::Mesh(meshes.into())),
                    None => (Vec::new(), Facts::Mesh(MeshFacts::default())),
                })
            })
        })
    }

    /// Makes the textures and coarser levels of all chunks.
    ///
    /// # Errors
    /// If the meshes are missing, the disk fails, or the observer stops.
    pub fn texture(&self) -> Result<(), PipelineError> {
        self.textures(&self.field(), &self.walls())
    }

    fn textures(&self, field: &CaveField, walls: &[Unit]) -> Result<(), PipelineError> {
        self.each(Stage::Texture, walls, |wall| {
            self.unit(Stage::Texture, &wall.name, || {
                let mesh = store::read_mesh(self.folder, &wall.name)?;
                let (texture, lod) = (self.recipe.texture(), self.recipe.lod());
                let written = store::write_textured(self.folder, &wall.name, &mesh, field, texture, lod)?;
                let facts = TextureFacts::new(&written.textured, &written.levels);
                Ok((written.files, Facts::Texture(facts)))
            })
        })
    }

    /// Writes the manifest and removes files that belong to no unit of this cave.
    ///
    /// # Errors
    /// If the disk fails.
    pub fn settle(&self) -> Result<(), PipelineError> {
        let keep = |unit: &Unit| unit.fingerprint == self.fingerprint(unit.stage);
        Ok(self.folder.settle(keep)?)
    }

    /// Finished mesh units with a wall, in order of their names.
    pub fn walls(&self) -> Vec<Unit> {
        let mut walls = self.units(Stage::Mesh);
        walls.retain(|unit| !unit.files.is_empty());
        walls
    }

    /// Finished units of this cave; the folder may also contain those of another.
    pub fn units(&self, stage: Stage) -> Vec<Unit> {
        let mut units = self.folder.units(stage);
        units.retain(|unit| unit.fingerprint == self.fingerprint(stage));
        units
    }

    /// SHA-256 of everything that the cave follows from.
    pub fn cave_fingerprint(&self) -> &str {
        &self.graph_fingerprint
    }

    /// Whether every wall is textured and has its things. Texturing starts after the last mesh.
    pub fn is_finished(&self) -> bool {
        let (walls, textured) = (self.walls(), self.names(Stage::Texture));
        !walls.is_empty() && walls.iter().all(|wall| textured.contains(&wall.name)) && self.has_things()
    }

    /// The names of [`units`](Self::units).
    fn names(&self, stage: Stage) -> BTreeSet<String> {
        self.units(stage).into_iter().map(|unit| unit.name).collect()
    }

    fn fingerprint(&self, stage: Stage) -> &str {
        match stage {
            Stage::Graph => &self.graph_fingerprint,
            Stage::Preview => &self.preview_fingerprint,
            Stage::Mesh => &self.mesh_fingerprint,
            Stage::Things => &self.things_fingerprint,
            Stage::Texture => &self.texture_fingerprint,
            Stage::Pieces => &self.pieces_fingerprint,
        }
    }

    fn refuse_other_cave(&self) -> Result<(), PipelineError> {
        for (stage, name) in
            [(Stage::Graph, "recipe, graph or version"), (Stage::Mesh, "shape"), (Stage::Texture, "look")]
        {
            let is_other = |unit: &Unit| unit.fingerprint != self.fingerprint(stage);
            if self.folder.units(stage).iter().any(is_other) {
                return Err(PipelineError::OtherCave { path: self.folder.root().to_path_buf(), stage: name });
            }
        }
        Ok(())
    }

    /// Protects from making a whole cave anew where its parts were to be put together.
    fn refuse_other_parts(&self) -> Result<(), PipelineError> {
        let is_other = |unit: &Unit| unit.fingerprint != self.graph_fingerprint;
        match self.folder.parts().iter().find(|part| part.units(Stage::Graph).iter().any(is_other)) {
            Some(part) => Err(PipelineError::OtherPart { path: part.root().to_path_buf() }),
            None => Ok(()),
        }
    }

    /// Protects a graph that was edited by hand from being overwritten by a generated one.
    fn refuse_to_lose_edits(&self) -> Result<(), PipelineError> {
        let path = self.folder.root().join(store::GRAPH);
        let units = self.folder.units(Stage::Graph);
        for record in units.iter().flat_map(|unit| &unit.files).filter(|file| file.path == store::GRAPH) {
            let is_edited = self.folder.is_changed(record)? && read_graph(&path, Parts::Keep).is_ok();
            if is_edited {
                return Err(PipelineError::EditedGraph { path });
            }
        }
        Ok(())
    }

    /// Protects files changed by the user from being overwritten or deleted.
    fn refuse_to_lose_changes(&self) -> Result<(), PipelineError> {
        let files = self.folder.changes()?;
        match files.is_empty() {
            true => Ok(()),
            false => Err(PipelineError::ChangedFiles { path: self.folder.root().to_path_buf(), files }),
        }
    }

    fn write_graph(&self) -> Result<(), PipelineError> {
        self.unit(Stage::Graph, store::WHOLE_CAVE, || {
            let recipe =
                self.folder.write(store::RECIPE, |out| out.write_all(self.recipe.to_kept_toml().as_bytes()))?;
            let graph = self
                .folder
                .write(store::GRAPH, |out| out.write_all(kept_graph_text(self.recipe, &self.graph).as_bytes()))?;
            let files = [vec![recipe, graph], self.files.keep(self.folder)?].concat();
            Ok((files, Facts::Graph((&self.graph).into())))
        })
    }

    fn write_meshes(&self, name: &str, meshes: &mesh::ChunkMeshes) -> Result<Vec<FileRecord>, PipelineError> {
        let visual = store::write_mesh(self.folder, &store::wall_path(name), &meshes.visual)?;
        let collision = store::write_mesh(self.folder, &store::collision_path(name), &meshes.collision)?;
        Ok(vec![visual, collision])
    }

    /// Makes a unit, whose files and facts `make` returns, unless it exists or can be taken from the base folder.
    fn unit(
        &self,
        stage: Stage,
        name: &str,
        make: impl FnOnce() -> Result<(Vec<FileRecord>, Facts), PipelineError>,
    ) -> Result<(), PipelineError> {
        let fingerprint = self.fingerprint(stage);
        if self.folder.finished(stage, name, fingerprint)?.is_some() {
            return Ok(());
        }
        self.folder.begin_unit(stage, name)?;
        if self.folder.take_over(stage, name, fingerprint)? {
            return Ok(());
        }
        let (files, facts) = make()?;
        let unit = Unit { stage, name: name.to_owned(), fingerprint: fingerprint.to_owned(), files, facts };
        Ok(self.folder.commit(unit)?)
    }

    /// Runs `work` on every item on all threads, notifying the observer, until one fails or the user stops.
    fn each<T: Sync>(
        &self,
        stage: Stage,
        items: &[T],
        work: impl Fn(&T) -> Result<(), PipelineError> + Sync,
    ) -> Result<(), PipelineError> {
        self.observer.begin(stage, items.len());
        let each = |item: &T| {
            if self.observer.stop().load(Ordering::Relaxed) {
                return Err(PipelineError::Interrupted);
            }
            work(item)?;
            self.observer.advance(stage);
            Ok(())
        };
        items.par_iter().try_for_each(each)?;
        self.observer.end(stage);
        Ok(())
    }
}

/// The settings of a rock that its shape follows from, and its colours.
fn rock_parts(rock: &Value) -> [String; 2] {
    let (colors, shape): (Map<_, _>, Map<_, _>) =
        rock.as_object().cloned().unwrap_or_default().into_iter().partition(|(key, _)| key == "colors");
    [shape, colors].map(|part| Value::from(part).to_string())
}

/// SHA-256 of everything that a cave follows from.
pub fn cave_fingerprint(recipe: &Recipe, graph: &Graph, files: &UserFiles) -> String {
    let text = kept_graph_text(recipe, graph);
    sha256(format!("{}\n{text}{}", recipe.version(), files.fingerprint()).as_bytes())
}

/// The files that a recipe names beside those of its graph.
///
/// # Errors
/// If one cannot be read or is not fit for its purpose.
pub fn user_files(recipe: &Recipe, observer: &dyn Observer) -> Result<UserFiles, PipelineError> {
    UserFiles::read(recipe, Disk { allows_outside_files: observer.allows_outside_files() })
}

/// The shape of the cave described by this recipe and graph: the field without the user's maps.
pub fn field(recipe: &Recipe, graph: &Graph) -> CaveField {
    field_of(recipe, graph, Arc::clone(recipe.rock()))
}

/// The field with the looks that these files give it.
pub fn field_with(recipe: &Recipe, graph: &Graph, files: &UserFiles) -> CaveField {
    field_of(recipe, graph, files.maps.on(Arc::clone(recipe.rock())))
}

fn field_of(recipe: &Recipe, graph: &Graph, rock: Arc<dyn Material>) -> CaveField {
    CaveField::new(graph, recipe.passage(), rock, recipe.look().clone(), recipe.seed())
}

/// The field, and the grid over it.
fn field_and_grid(recipe: &Recipe, graph: &Graph) -> Result<(CaveField, Grid), GridError> {
    refuse_absurd_size(recipe, graph)?;
    let field = field(recipe, graph);
    let grid = Grid::new(field.bounds(), recipe.mesh())?;
    Ok((field, grid))
}

/// Checks the size before the field is built, whose memory grows with it.
fn refuse_absurd_size(recipe: &Recipe, graph: &Graph) -> Result<(), GridError> {
    let bounds = station_bounds(graph, recipe.passage().width_per_radius);
    match bounds.map(|bounds| Grid::new(bounds, recipe.mesh())) {
        Some(Err(error @ (GridError::TooFar { .. } | GridError::TooManyChunks { .. }))) => Err(error),
        _ => Ok(()),
    }
}

/// The cave as the subject of previews.
pub fn subject<'a>(recipe: &'a Recipe, graph: &'a Graph, field: &'a CaveField) -> Subject<'a> {
    let lamp_spacing_m = recipe.world().lights.then_some(recipe.world().light_spacing_m);
    Subject { name: recipe.name(), graph, passage: recipe.passage(), field, lamp_spacing_m, furnishing: None }
}

/// The cave as the subject of previews with its things, if it has any.
pub fn furnished<'a>(
    recipe: &'a Recipe,
    graph: &'a Graph,
    field: &'a CaveField,
    stock: Option<&'a (Shelf, Library<'a>)>,
) -> Subject<'a> {
    let furnishing = stock.map(|(shelf, library)| {
        let setting = things::setting(recipe, graph, field, library);
        Furnishing { setting, shelf, mesh: recipe.mesh() }
    });
    Subject { furnishing, ..subject(recipe, graph, field) }
}

/// The text of the cave's graph file.
pub fn graph_text(recipe: &Recipe, graph: &Graph) -> String {
    plume_survey::json::write(graph, crate::VERSION, recipe.to_json())
}

/// The same in a cave folder.
fn kept_graph_text(recipe: &Recipe, graph: &Graph) -> String {
    plume_survey::json::write(graph, crate::VERSION, &recipe.to_kept_json())
}

/// A box round the passages where they are widest, at the stations; `None` without stations.
fn station_bounds(graph: &Graph, width_per_radius: f32) -> Option<Aabb<f32>> {
    let bounds = graph.nodes.iter().map(|node| {
        let own_m = node.section.map_or(0.0, |section| section.width_m);
        let half_m = own_m.max(node.radius * f64::from(width_per_radius)) / 2.0;
        let Aabb { min, max } = Aabb::from(<[f64; 3]>::from(node.position)).padded(half_m);
        Aabb { min: min.map(|low| low as f32), max: max.map(|high| high as f32) }
    });
    bounds.reduce(Aabb::union)
}

/// The graph without its recipe and without names, on which the shape of the rock depends.
fn stations(graph: &Graph) -> String {
    plume_survey::json::write(&graph.anonymous(), "", &Value::Null)
}

/// The names of stations, which maps show; empty without any.
fn names(graph: &Graph) -> String {
    let named = graph.nodes.iter().filter_map(|node| Some((node.id, node.name.as_deref()?)));
    named.map(|(id, name)| format!("{id} {name}\n")).collect()
}

/// The graph of this recipe, passed by its gate.
///
/// # Errors
/// If the graph is impossible, or the observer stops.
pub fn generated(recipe: &Recipe, observer: &dyn Observer) -> Result<Graph, PipelineError> {
    let graph = recipe.realism().generate(recipe.graph(), recipe.seed(), &Machine::new(observer));
    graph.map_err(|error| match observer.stop().load(Ordering::Relaxed) {
        true => PipelineError::Interrupted,
        false => error.into(),
    })
}

/// Reads a graph file.
///
/// # Errors
/// If it cannot be read or is not a graph.
pub fn read_graph(path: &Path, parts: Parts) -> Result<Import, PipelineError> {
    Disk::default().graph(path, parts)
}
