//! The exit code of a fault.

use std::io::ErrorKind;

use plume_exporters::ExportError;

use super::signals;
pub use plume::cave::CaveError as CliError;
use plume::pipeline::PipelineError;
use plume::store::StoreError;

/// 1 the disk or a failed check, 2 usage or bad input, 69 a needed part is missing, 128 and the number of the signal that
/// interrupted it.
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

/// What the user can mend is bad input; what the disk does is not.
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
