//! Files that are written in one go.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use crate::{Staging, publish, replace_file};

/// What becomes of a file that is there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// It stays, and nothing is written.
    Keep,
    /// It makes room.
    Replace,
}

/// Writes the file at `path`, with the folders above it.
///
/// # Errors
/// [`io::ErrorKind::AlreadyExists`] when it is there and is to stay; those of the system.
pub fn write_file(path: &Path, existing: Existing, bytes: &[u8]) -> io::Result<()> {
    let staging = Staging::beside(path)?;
    let growing = staging.path().join("file");
    File::create_new(&growing)?.write_all(bytes)?;
    match existing {
        Existing::Keep => publish(&growing, path),
        Existing::Replace => replace_file(&growing, path),
    }
}
