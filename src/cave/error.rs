//! Errors as users see them: what, where, and a hint.

use std::io::ErrorKind;
use std::path::PathBuf;

use plume_exporters::ExportError;
use plume_exporters::check::CheckError;

use crate::pipeline::PipelineError;
use crate::recipe::{Faults, did_you_mean};
use crate::store::StoreError;
use plume_graph::echo::shown;

/// Why a cave was not made, opened or exported.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaveError {
    /// The recipe is faulty.
    #[error(transparent)]
    Recipe(#[from] Faults),
    /// A stage failed.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
    /// The export failed.
    #[error(transparent)]
    Export(ExportError),
    /// The package cannot be checked.
    #[error(transparent)]
    Check(#[from] CheckError),
    /// An input file cannot be read.
    #[error("{}: {source}", path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The request is faulty.
    #[error("{message}")]
    Usage {
        /// What is wrong.
        message: String,
        /// What to do.
        hint: String,
    },
    /// The user stopped work that cannot be resumed.
    #[error("interrupted")]
    Interrupted,
    /// A check failed.
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
    /// An unknown name of a `what`, with the known ones.
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

/// What a folder of maps of the user's own has to hold.
const OWN_MAPS: &str = "texture.own names a folder, relative to the recipe, with base_color.png and, if you like, normal.png, both \
                        RGB, and roughness.png: square, of at most 8192 pixels a side, without transparency";

fn pipeline_hint(error: &PipelineError) -> String {
    match error {
        PipelineError::Generate(error) => error.hint.clone(),
        PipelineError::GraphFile(error) => error.hint.clone(),
        PipelineError::Preview(error) => error.hint().to_owned(),
        PipelineError::Grid(error) => error.hint().to_owned(),
        PipelineError::Model { error, .. } => error.hint.to_owned(),
        PipelineError::Map { .. } => OWN_MAPS.into(),
        PipelineError::TooLarge { remedy, .. } => format!("{remedy}, or raise output.max_gb"),
        PipelineError::OtherCave { .. } => "choose another folder, or make it anew with --force".into(),
        PipelineError::OtherPart { .. } => "make the part again, or leave it out".into(),
        PipelineError::EditedGraph { .. } => {
            "to keep your edits, name the cave folder and leave `graph` and `seed` as they were; --force discards them"
                .into()
        }
        PipelineError::ChangedFiles { .. } => {
            "to keep your changes, copy them elsewhere; --force makes these files anew".into()
        }
        PipelineError::Empty => "widen the passages, reduce mesh.voxel_m, or ask for more nodes".into(),
        PipelineError::Store(StoreError::Occupied { .. }) => "choose a new or empty folder".into(),
        PipelineError::Store(StoreError::InUse { .. }) => "wait for it to finish, or choose another folder".into(),
        PipelineError::Store(StoreError::Changed { .. }) => "`plume generate CAVE_DIR --force` makes it anew".into(),
        PipelineError::Store(StoreError::Damaged { .. }) => {
            "save what you want to keep from the folder, and make the cave again in another".into()
        }
        PipelineError::Store(StoreError::Io { source, .. }) if source.kind() == ErrorKind::StorageFull => {
            "free some space and run the same command again: it resumes where it stopped".into()
        }
        PipelineError::Interrupted => "run the same command again: it resumes where it stopped".into(),
        _ => String::new(),
    }
}
