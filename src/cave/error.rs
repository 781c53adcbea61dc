//! What went wrong, as the user is told it: what, where, a hint.

use std::io::ErrorKind;
use std::path::PathBuf;

use plume_exporters::ExportError;
use plume_exporters::check::CheckError;

use crate::pipeline::PipelineError;
use crate::recipe::{Faults, did_you_mean};
use crate::store::StoreError;
use plume_graph::echo::shown;

/// Why a cave was not made, opened or handed over.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaveError {
    /// The recipe.
    #[error(transparent)]
    Recipe(#[from] Faults),
    /// The work.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
    /// The package.
    #[error(transparent)]
    Export(ExportError),
    /// What was to be checked is no package.
    #[error(transparent)]
    Check(#[from] CheckError),
    /// An input file.
    #[error("{}: {source}", path.display())]
    Input {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// What was asked for.
    #[error("{message}")]
    Usage {
        /// What is wrong.
        message: String,
        /// What to do.
        hint: String,
    },
    /// The user stopped work that leaves nothing behind to go on from.
    #[error("interrupted")]
    Interrupted,
    /// A check that did not pass.
    #[error("{0}")]
    Failed(String),
}

impl From<ExportError> for CaveError {
    fn from(error: ExportError) -> Self {
        match error {
            ExportError::Load { source, .. } if source.kind() == ErrorKind::Interrupted => {
                Self::Pipeline(PipelineError::Interrupted)
            }
            other => Self::Export(other),
        }
    }
}

impl From<StoreError> for CaveError {
    fn from(error: StoreError) -> Self {
        Self::Pipeline(error.into())
    }
}

impl CaveError {
    /// A name that is in no table: `what` it was to be, and the names there are.
    pub fn unknown<'a>(what: &str, name: &str, known: impl Iterator<Item = &'a str> + Clone) -> Self {
        let names = known.clone().collect::<Vec<_>>().join(", ");
        let hint = format!("{}known: {names}", did_you_mean(name, known));
        Self::Usage { message: format!("there is no {what} {}", shown(name)), hint }
    }

    /// What to do about it; may be empty.
    pub fn hint(&self) -> String {
        match self {
            Self::Usage { hint, .. } => hint.clone(),
            Self::Pipeline(error) => pipeline_hint(error),
            Self::Export(error) => error.hint().unwrap_or_default().to_owned(),
            Self::Check(error) => error.hint().to_owned(),
            _ => String::new(),
        }
    }
}

fn pipeline_hint(error: &PipelineError) -> String {
    match error {
        PipelineError::Generate(error) => error.hint.clone(),
        PipelineError::GraphFile(error) => error.hint.clone(),
        PipelineError::Preview(error) => error.hint().to_owned(),
        PipelineError::Grid(error) => error.hint().to_owned(),
        PipelineError::OtherCave { .. } => "give another folder, or --force to make it anew".into(),
        PipelineError::EditedGraph { .. } => {
            "to go on with it, name the cave folder and leave `graph` and `seed` as they were; --force drops it".into()
        }
        PipelineError::ChangedFiles { .. } => {
            "to keep what you have changed, copy it elsewhere; --force makes these files anew".into()
        }
        PipelineError::Empty => "widen the passages, take a smaller mesh.voxel_m, or ask for more nodes".into(),
        PipelineError::Store(StoreError::Occupied { .. }) => "give a folder that is new or empty".into(),
        PipelineError::Store(StoreError::InUse { .. }) => "wait for it to end, or give another folder".into(),
        PipelineError::Store(StoreError::Changed { .. }) => "`plume generate CAVE_DIR --force` makes it anew".into(),
        PipelineError::Store(StoreError::Damaged { .. }) => {
            "take from the folder what you want to keep, and make the cave again in another".into()
        }
        PipelineError::Store(StoreError::Io { source, .. }) if source.kind() == ErrorKind::StorageFull => {
            "free some space and run the same command again: it goes on where it stopped".into()
        }
        PipelineError::Interrupted => "run the same command again: it goes on where it stopped".into(),
        _ => String::new(),
    }
}
