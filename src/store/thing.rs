//! The things of a chunk as JSON, one a line.

use std::io::BufRead;

use super::{CaveFolder, FileRecord, StoreError, things_path};
use crate::things::Thing;

/// Writes the things of a chunk.
///
/// # Errors
/// If the disk fails.
pub fn write_things(folder: &CaveFolder, name: &str, things: &[Thing]) -> Result<FileRecord, StoreError> {
    folder.write(&things_path(name), |out| {
        for thing in things {
            serde_json::to_writer(&mut *out, thing)?;
            writeln!(out)?;
        }
        Ok(())
    })
}

/// Reads the things of a chunk back.
///
/// # Errors
/// If they are missing or damaged.
pub fn read_things(folder: &CaveFolder, name: &str) -> Result<Vec<Thing>, StoreError> {
    let path = things_path(name);
    let content = folder.read(&path)?;
    let things: Result<Vec<Thing>, _> =
        content.lines().map(|line| line.and_then(|line| Ok(serde_json::from_str(&line)?))).collect();
    things.map_err(|error| StoreError::damaged(&folder.root().join(path), error))
}
