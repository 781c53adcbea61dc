//! Exit codes of errors.

use std::io::ErrorKind;

use plume_exporters::ExportError;

use super::signals;
pub use plume::cave::CaveError as CliError;
use plume::pipeline::PipelineError;
use plume::store::StoreError;

/// 1 for a disk error or a failed check, 2 for usage or bad input, 69 for a missing dependency, 128 plus the signal number
/// after an interrupt.
pub fn exit_code(error: &CliError) -> u8 {
    match error {
        CliError::Export(ExportError::MissingPart { .. }) => 69,
        CliError::Export(ExportError::Library { .. }) => 1,
        CliError::Interrupted | CliError::Pipeline(PipelineError::Interrupted) => signals::exit_code(),
        CliError::Pipeline(PipelineError::Store(StoreError::Io { source, .. })) => io_exit_code(source),
        CliError::Export(ExportError::Io(source) | ExportError::Load { source, .. }) => io_exit_code(source),
        CliError::Failed(_) => 1,
        _ => 2,
    }
}

/// What the user can fix counts as bad input; disk failures do not.
fn io_exit_code(error: &std::io::Error) -> u8 {
    use ErrorKind::{
        AlreadyExists, InvalidData, InvalidFilename, IsADirectory, NotADirectory, NotFound, PermissionDenied,
        ReadOnlyFilesystem,
    };
    let bad_input = [
        AlreadyExists,
        InvalidData,
        InvalidFilename,
        IsADirectory,
        NotADirectory,
        NotFound,
        PermissionDenied,
        ReadOnlyFilesystem,
    ];
    if bad_input.contains(&error.kind()) { 2 } else { 1 }
}
