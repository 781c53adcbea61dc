//! A cave from its input to its packages: the common ground of the command line and the Python package.
//!
//! [`make`] runs the stages. [`Cave`] is a folder in which all of them are done, and [`target`] exports it. Prints nothing:
//! an [`Observer`] follows progress, a [`CaveError`] says what went wrong and what to do.
//!
//! ```
//! use plume::cave::{self, Order};
//! use plume::exporters::check::check;
//! use plume::exporters::place::{Existing, Place};
//! use plume::{Cave, CaveFolder, Input, Observer, Recipe, Unobserved};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let temporary = tempfile::tempdir()?;
//! # let home = temporary.path();
//! let settings = ["graph.nodes=3", "mesh.voxel_m=0.5", "texture.size_px=256"].map(str::to_owned);
//! let input = Input::of(Recipe::from_overrides(&settings)?);
//! let watch = Unobserved::default();
//! let cave = Cave::make(input, CaveFolder::open_or_new(&home.join("cave"))?, false, &watch, &mut |_, _| ())?;
//!
//! let [wanted] = cave::build(vec![cave::target("obj")?], &[], &["obj.per_chunk=true".to_owned()], None)?.try_into().ok().unwrap();
//! let place = Place { path: home.join("package"), bundle: None, existing: Existing::Keep };
//! let chunks = cave.chunks(watch.stop());
//! cave::export(&cave.scene(&chunks), &[Order { wanted, place }])?;
//! assert!(check(&home.join("package"))?.is_whole());
//! # Ok(())
//! # }
//! ```

mod blockers;
mod certify;
mod error;
mod input;
mod preview;
mod route;
mod surface;
mod target;

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use plume_exporters::scene::Scene;

pub use self::certify::{Certified, NamedRobot, named_robot};
pub use self::error::CaveError;
pub use self::input::{GRAPH_EDITED, Input, is_graph_edited, preset, read, start_from, with_parts};
pub use self::preview::{preview, view_row};
pub use self::route::Journey;
pub use self::surface::Surface;
pub use self::target::{Exported, Order, Wanted, build, bundle, export, refuse_unfit_images, target};
use crate::assemble::{self, FolderChunks};
use crate::pipeline::{self, Disk, Observer, Other, Pipeline, PipelineError};
use crate::recipe::Recipe;
use crate::store::{CaveFolder, Stage, Unit};
use plume_graph::Graph;

/// A finished cave in its folder.
pub struct Cave {
    recipe: Recipe,
    graph: Graph,
    folder: CaveFolder,
    walls: Vec<Unit>,
    fingerprint: String,
}

impl Cave {
    /// Makes what is missing; `force` replaces another cave in the folder.
    ///
    /// # Errors
    /// As [`make`]; if a robot of `world.certify` is not sure to reach every station.
    pub fn make(
        input: Input,
        folder: CaveFolder,
        force: bool,
        observer: &dyn Observer,
        done: &mut dyn FnMut(Stage, &Pipeline),
    ) -> Result<Self, CaveError> {
        let pipeline = make(&input, &folder, Stage::Texture, force, observer, done)?;
        let (graph, walls) = (pipeline.graph().clone(), pipeline.walls());
        let fingerprint = pipeline.cave_fingerprint().to_owned();
        let cave = Self { recipe: input.recipe, graph, folder, walls, fingerprint };
        cave.hold_to_certificates(observer)?;
        Ok(cave)
    }

    /// Opens a finished cave folder without writing anything.
    ///
    /// # Errors
    /// If there is none at `root`, it cannot be read, or a stage is not done.
    pub fn open(root: &Path, observer: &dyn Observer) -> Result<Self, CaveError> {
        if !root.is_dir() {
            return Err(unfit(root, "there is no cave folder"));
        }
        let Input { recipe, graph, .. } = Input::read(Some(root), &[], Disk::default())?;
        let folder = CaveFolder::open(root)?;
        let pipeline = Pipeline::plan(&recipe, graph, &folder, observer)?;
        if !pipeline.is_finished() {
            return Err(unfit(root, "the cave is not finished"));
        }
        let (graph, walls) = (pipeline.graph().clone(), pipeline.walls());
        let fingerprint = pipeline.cave_fingerprint().to_owned();
        Ok(Self { recipe, graph, folder, walls, fingerprint })
    }

    /// Makes the missing convex pieces of its chunks, and calls `done`.
    ///
    /// # Errors
    /// I/O errors, another run in the folder, the observer's stop.
    pub fn make_pieces(
        &self,
        observer: &dyn Observer,
        done: &mut dyn FnMut(Stage, &Pipeline),
    ) -> Result<(), CaveError> {
        let pipeline = Pipeline::plan(&self.recipe, Some(self.graph.clone()), &self.folder, observer)?;
        if pipeline.has_pieces() {
            return Ok(());
        }
        pipeline.make(Stage::Pieces)?;
        done(Stage::Pieces, &pipeline);
        Ok(pipeline.settle()?)
    }

    /// What it was made from.
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// The graph of its passages.
    pub fn graph(&self) -> &Graph {
        &self.graph
    }

    /// The cave folder.
    pub fn folder(&self) -> &CaveFolder {
        &self.folder
    }

    /// Where the cave folder is.
    pub fn root(&self) -> &Path {
        self.folder.root()
    }

    /// Its chunks, loaded one at a time until `stop` is set.
    pub fn chunks<'a>(&'a self, stop: &'a AtomicBool) -> FolderChunks<'a> {
        FolderChunks::new(&self.folder, &self.walls, &self.recipe, stop)
    }

    /// The names of its chunks, in their order.
    pub fn chunk_names(&self) -> impl Iterator<Item = &str> {
        self.walls.iter().map(|wall| wall.name.as_str())
    }

    /// The [field](crate::field) at finite `points` in metres: negative in air, zero on the wall, positive in rock.
    pub fn field(&self, points: &[[f32; 3]]) -> Vec<f32> {
        pipeline::field(&self.recipe, &self.graph).scattered(points)
    }

    /// The scene, with start poses and lamps.
    pub fn scene<'a>(&self, chunks: &'a FolderChunks<'a>) -> Scene<'a> {
        let field = pipeline::field(&self.recipe, &self.graph);
        let scene = assemble::scene(&self.recipe, &self.graph, &field, chunks);
        Scene { fingerprint: self.fingerprint.clone(), ..scene }
    }
}

/// Makes the stages up to `last` in `folder`, and the pieces that its parts have, calls `done` after each, and settles the folder. If the folder is itself the
/// input, it follows edits of its recipe and graph; `force` replaces another cave. An ephemeral folder gets no maps.
///
/// # Errors
/// An impossible graph, another cave in the folder, I/O errors, the observer's stop.
pub fn make<'a>(
    input: &'a Input,
    folder: &'a CaveFolder,
    last: Stage,
    force: bool,
    observer: &'a dyn Observer,
    done: &mut dyn FnMut(Stage, &Pipeline),
) -> Result<Pipeline<'a>, PipelineError> {
    let pipeline = start(input, folder, last, force, observer)?;
    done(Stage::Graph, &pipeline);
    let stages: &[Stage] = match last {
        Stage::Graph => &[],
        Stage::Preview => &[Stage::Preview],
        Stage::Mesh => &[Stage::Preview, Stage::Mesh],
        Stage::Things => &[Stage::Preview, Stage::Mesh, Stage::Things],
        Stage::Texture => &[Stage::Preview, Stage::Mesh, Stage::Things, Stage::Texture],
        Stage::Pieces => &[Stage::Preview, Stage::Mesh, Stage::Pieces],
    };
    let has_pieces = |part: &CaveFolder| !part.units(Stage::Pieces).is_empty();
    let pieces_of_parts = folder.parts().iter().any(has_pieces).then_some(&Stage::Pieces);
    let stages = stages.iter().filter(|stage| **stage != Stage::Preview || !folder.is_ephemeral());
    for &stage in stages.chain(pieces_of_parts.filter(|_| last == Stage::Texture)) {
        pipeline.make(stage)?;
        done(stage, &pipeline);
    }
    pipeline.settle()?;
    Ok(pipeline)
}

/// Makes `stages` of some chunks in `folder`, without those of any others but what these take of their neighbours; see
/// [`Pipeline::part`]. Returns the meshes of those that have a wall.
///
/// # Errors
/// As [`make`].
pub fn make_part(
    input: &Input,
    folder: &CaveFolder,
    numbers: Range<usize>,
    stages: &BTreeSet<Stage>,
    force: bool,
    observer: &dyn Observer,
) -> Result<Vec<Unit>, PipelineError> {
    let last = if stages.contains(&Stage::Texture) { Stage::Texture } else { Stage::Mesh };
    let pipeline = start(input, folder, last, force, observer)?;
    let walls = pipeline.part(numbers, stages)?;
    pipeline.settle()?;
    Ok(walls)
}

/// Numbers of chunks along x, y and z in the grid of the cave of this input, for [`make_part`].
///
/// # Errors
/// An impossible graph or grid.
pub fn chunk_grid(input: &Input, observer: &dyn Observer) -> Result<[i32; 3], CaveError> {
    let graph = preview::graph_of(input, observer)?;
    Ok(pipeline::chunk_grid(&input.recipe, &graph)?)
}

/// What [`make_part`] makes of chunks unless told otherwise.
pub const CHUNK_STAGES: [Stage; 3] = [Stage::Mesh, Stage::Things, Stage::Texture];

/// A stage of chunks by its name.
///
/// # Errors
/// [`CaveError::Usage`], which suggests the nearest.
pub fn chunk_stage(name: &str) -> Result<Stage, CaveError> {
    let stages = [&CHUNK_STAGES[..], &[Stage::Pieces]].concat();
    let stage = stages.iter().find(|stage| stage.name() == name).copied();
    stage.ok_or_else(|| CaveError::unknown("stage", name, stages.iter().map(|stage| stage.name())))
}

fn start<'a>(
    input: &'a Input,
    folder: &'a CaveFolder,
    last: Stage,
    force: bool,
    observer: &'a dyn Observer,
) -> Result<Pipeline<'a>, PipelineError> {
    let is_own = input.folder.as_deref() == Some(folder.root());
    let other = match (force, is_own) {
        (true, _) => Other::Replace,
        (false, true) => Other::Renew,
        (false, false) => Other::Refuse,
    };
    Pipeline::start(&input.recipe, input.graph.clone(), folder, last, other, observer)
}

/// SHA-256 of everything that the cave of this input follows from.
///
/// # Errors
/// An impossible graph.
pub fn fingerprint(input: &Input, observer: &dyn Observer) -> Result<String, CaveError> {
    let graph = preview::graph_of(input, observer)?;
    let files = pipeline::user_files(&input.recipe, observer)?;
    Ok(pipeline::cave_fingerprint(&input.recipe, &graph, &files))
}

fn unfit(root: &Path, what: &str) -> CaveError {
    let message = format!("{}: {what}", root.display());
    CaveError::Usage { message, hint: "name a folder finished by `plume generate -o`".into() }
}
