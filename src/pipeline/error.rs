use std::path::PathBuf;

use crate::graph::GenerateError;
use crate::graph::format::ReadError;
use crate::mesh::GridError;
use crate::preview::PreviewError;
use crate::store::{ChunkError, StoreError};

/// Why a cave was not finished.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PipelineError {
    /// The disk.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The generator could not make such a graph.
    #[error("graph: {0}")]
    Generate(#[from] GenerateError),
    /// A graph file is faulty.
    #[error(transparent)]
    GraphFile(#[from] ReadError),
    /// There is no map of it.
    #[error("preview: {0}")]
    Preview(#[from] PreviewError),
    /// No grid of chunks fits.
    #[error("mesh: {0}")]
    Grid(#[from] GridError),
    /// The folder holds another cave.
    #[error("{}: holds another cave (its {stage} differs)", path.display())]
    OtherCave {
        /// Which folder.
        path: PathBuf,
        /// The first stage that differs.
        stage: &'static str,
    },
    /// The folder's graph was edited, and the recipe asks for another.
    #[error("{}: was edited by hand, and the recipe now makes another graph", path.display())]
    EditedGraph {
        /// The graph file.
        path: PathBuf,
    },
    /// A chunk could not be textured.
    #[error("texture: {0}")]
    Texture(ChunkError),
    /// The user stopped it.
    #[error("interrupted")]
    Interrupted,
}

impl From<ChunkError> for PipelineError {
    fn from(error: ChunkError) -> Self {
        match error {
            ChunkError::Store(error) => Self::Store(error),
            other => Self::Texture(other),
        }
    }
}
