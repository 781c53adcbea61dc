//! Files that commands write.

use std::path::Path;

use plume_disk::Existing;

use super::fault::CliError;
use plume::store::StoreError;

/// Writes a file, replacing an existing one.
///
/// # Errors
/// Those of the disk, with the path.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    Ok(plume_disk::write_file(path, Existing::Replace, bytes).map_err(|source| StoreError::io(path, source))?)
}
