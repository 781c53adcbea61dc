use std::path::PathBuf;

use crate::mesh::GridError;
use crate::model::ModelError;
use crate::preview::PreviewError;
use crate::store::{ChunkError, StoreError};
use plume_graph::GenerateError;
use plume_survey::ReadError;

/// Why a cave was not finished.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PipelineError {
    /// The cave folder could not be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The generator could not make the graph.
    #[error("graph: {0}")]
    Generate(#[from] GenerateError),
    /// A graph file is faulty.
    #[error(transparent)]
    GraphFile(#[from] ReadError),
    /// The preview could not be drawn.
    #[error("preview: {0}")]
    Preview(#[from] PreviewError),
    /// No grid of chunks fits.
    #[error("mesh: {0}")]
    Grid(#[from] GridError),
    /// The cave would be larger than its recipe allows.
    #[error("{what} need about {needed_gb} GB on the disk, but the limit is {limit_gb} GB")]
    TooLarge {
        /// What needs the space, with the settings that determine it.
        what: String,
        /// The space that it needs, in gigabytes.
        needed_gb: f64,
        /// The limit, in gigabytes.
        limit_gb: f64,
        /// How to need less.
        remedy: String,
    },
    /// The folder holds another cave.
    #[error("{}: holds another cave (its {stage} differs)", path.display())]
    OtherCave {
        /// The folder.
        path: PathBuf,
        /// The first stage that differs.
        stage: &'static str,
    },
    /// What was to be a part of the cave is one of another.
    #[error("{}: is a part of another cave (its recipe, graph or version differs)", path.display())]
    OtherPart {
        /// The folder.
        path: PathBuf,
    },
    /// The folder's graph was edited, and the recipe asks for another.
    #[error("{}: was edited by hand, and the recipe now makes another graph", path.display())]
    EditedGraph {
        /// The graph file.
        path: PathBuf,
    },
    /// Files of the folder have changed since they were written.
    #[error("{}: {} changed since {} written: {}", path.display(), counted(files), was(files), listed(files))]
    ChangedFiles {
        /// The cave folder.
        path: PathBuf,
        /// The files, with forward slashes.
        files: Vec<String>,
    },
    /// A model cannot be a thing.
    #[error("{}: {error}", path.display())]
    Model {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        error: ModelError,
    },
    /// A map of the user's own cannot be put onto the rock.
    #[error("{}: {problem}", path.display())]
    Map {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// There is no wall in the whole cave.
    #[error("mesh: the cave has no open space at this voxel size")]
    Empty,
    /// A chunk could not be textured.
    #[error("texture: {0}")]
    Texture(ChunkError),
    /// The user stopped it.
    #[error("interrupted")]
    Interrupted,
}

/// Number of files listed; the rest are counted.
const NAMED_FILES: usize = 8;

fn counted(files: &[String]) -> String {
    if files.len() == 1 { "a file has".to_owned() } else { format!("{} files have", files.len()) }
}

fn was(files: &[String]) -> &'static str {
    if files.len() == 1 { "it was" } else { "they were" }
}

fn listed(files: &[String]) -> String {
    let named = files.iter().take(NAMED_FILES).cloned().collect::<Vec<_>>().join(", ");
    match files.len().saturating_sub(NAMED_FILES) {
        0 => named,
        more => format!("{named} and {more} more"),
    }
}

impl From<ChunkError> for PipelineError {
    fn from(error: ChunkError) -> Self {
        match error {
            ChunkError::Store(error) => Self::Store(error),
            other => Self::Texture(other),
        }
    }
}
