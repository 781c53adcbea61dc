//! Files that are written in one step.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use crate::{Staging, publish, replace_file};

/// What to do with an existing file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// Keep it and write nothing.
    Keep,
    /// Replace it.
    Replace,
}

/// Writes the file at `path`, creating parent folders.
///
/// # Errors
/// [`io::ErrorKind::AlreadyExists`] if it exists and is to be kept; I/O errors.
pub fn write_file(path: &Path, existing: Existing, bytes: &[u8]) -> io::Result<()> {
    let staging = Staging::beside(path)?;
    let growing = staging.path().join("file");
    File::create_new(&growing)?.write_all(bytes)?;
    match existing {
        Existing::Keep => publish(&growing, path),
        Existing::Replace => replace_file(&growing, path),
    }
}
