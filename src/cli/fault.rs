//! Faults as the user sees them: what, where, a hint, and an exit code.

use std::io::ErrorKind;
use std::path::PathBuf;

use plume_exporters::ExportError;

use crate::pipeline::PipelineError;
use crate::recipe::Faults;
use crate::store::StoreError;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CliError {
    /// The recipe.
    #[error(transparent)]
    Recipe(#[from] Faults),
    /// The work.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
    /// The package.
    #[error(transparent)]
    Export(ExportError),
    /// An input file.
    #[error("{}: {source}", path.display())]
    Input {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The words of the command.
    #[error("{message}")]
    Usage {
        /// What is wrong.
        message: String,
        /// What to do.
        hint: String,
    },
    /// A check that did not pass.
    #[error("{0}")]
    Failed(String),
}

impl From<ExportError> for CliError {
    fn from(error: ExportError) -> Self {
        match error {
            ExportError::Load { source, .. } if source.kind() == ErrorKind::Interrupted => {
                Self::Pipeline(PipelineError::Interrupted)
            }
            other => Self::Export(other),
        }
    }
}

impl From<StoreError> for CliError {
    fn from(error: StoreError) -> Self {
        Self::Pipeline(error.into())
    }
}

impl CliError {
    /// 1 the disk or a failed check, 2 usage or bad input, 69 a needed part is missing, 130 interrupted.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Export(ExportError::MissingPart { .. }) => 69,
            Self::Export(ExportError::Library { .. }) => 1,
            Self::Pipeline(PipelineError::Interrupted) => 130,
            Self::Pipeline(PipelineError::Store(StoreError::Io { source, .. })) => io_exit_code(source),
            Self::Export(ExportError::Io(source) | ExportError::Load { source, .. }) => io_exit_code(source),
            Self::Failed(_) => 1,
            _ => 2,
        }
    }

    /// What to do about it; may be empty.
    pub fn hint(&self) -> String {
        match self {
            Self::Usage { hint, .. } => hint.clone(),
            Self::Pipeline(error) => pipeline_hint(error),
            Self::Export(error) => error.hint().unwrap_or_default().to_owned(),
            _ => String::new(),
        }
    }
}

/// What the user can mend is bad input; what the disk does is not.
fn io_exit_code(error: &std::io::Error) -> u8 {
    use ErrorKind::{
        AlreadyExists, InvalidData, IsADirectory, NotADirectory, NotFound, PermissionDenied, ReadOnlyFilesystem,
    };
    let bad_input =
        [AlreadyExists, InvalidData, IsADirectory, NotADirectory, NotFound, PermissionDenied, ReadOnlyFilesystem];
    if bad_input.contains(&error.kind()) { 2 } else { 1 }
}

fn pipeline_hint(error: &PipelineError) -> String {
    match error {
        PipelineError::Generate(error) => error.hint.clone(),
        PipelineError::GraphFile { source, .. } => source.hint().to_owned(),
        PipelineError::Grid(error) => error.hint().to_owned(),
        PipelineError::OtherCave { .. } => "give another folder, or --force to make it anew".into(),
        PipelineError::Store(StoreError::Occupied { .. }) => "give a folder that is new or empty".into(),
        PipelineError::Store(StoreError::InUse { .. }) => "wait for it to end, or give another folder".into(),
        PipelineError::Store(StoreError::Damaged { .. }) => "delete the folder and make it again".into(),
        PipelineError::Store(StoreError::Io { source, .. }) if source.kind() == ErrorKind::StorageFull => {
            "free some space and run the same command again: it goes on where it stopped".into()
        }
        PipelineError::Interrupted => "run the same command again: it goes on where it stopped".into(),
        _ => String::new(),
    }
}
