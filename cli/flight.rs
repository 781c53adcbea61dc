//! The frames of a flight, in a folder chosen by the user.
//!
//! `flight.json` lists them. Only frames that it lists and whose hashes match are replaced or removed; anything else in the
//! folder belongs to the user.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use plume_disk::{Staging, regular, replace_file};
use serde::{Deserialize, Serialize};

use super::fault::CliError;
use plume::store::{StoreError, sha256};

/// The list in the folder.
const LIST: &str = "flight.json";
const MOST_LIST_BYTES: u64 = 1 << 24;
/// A larger file is not one of our frames.
const MOST_FRAME_BYTES: u64 = 1 << 30;
const HINT: &str = "name a folder that is new, empty, or contains an unmodified earlier flight";

/// The frames in a folder with their SHA-256; two for a frame that an interrupted run may or may not have written.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Flight {
    frames: BTreeMap<String, BTreeSet<String>>,
}

/// Checks before the work whether frames may be written to the folder.
///
/// # Errors
/// If the folder holds something other than a flight, or frames that have been changed; I/O errors.
pub fn check(folder: &Path) -> Result<(), CliError> {
    earlier(folder).map(drop)
}

/// Writes the frames, replacing those of an earlier flight.
///
/// # Errors
/// As [`check`].
pub fn save(folder: &Path, frames: &[Vec<u8>]) -> Result<(), CliError> {
    let mut flight = earlier(folder)?;
    let at = |path: &Path, source| CliError::from(StoreError::io(path, source));
    fs::create_dir_all(folder).map_err(|source| at(folder, source))?;
    let staging = Staging::new(folder).map_err(|source| at(folder, source))?;
    let write = |name: &str, bytes: &[u8]| {
        let growing = staging.path().join(name);
        let written = fs::write(&growing, bytes).and_then(|()| replace_file(&growing, &folder.join(name)));
        written.map_err(|source| at(&folder.join(name), source))
    };
    let frames: Vec<(String, &Vec<u8>)> =
        frames.iter().enumerate().map(|(number, bytes)| (format!("{number:05}.png"), bytes)).collect();
    // Both hashes are listed while the frames are written, so that the next run recognises them after any interruption.
    for (name, bytes) in &frames {
        flight.frames.entry(name.clone()).or_default().insert(sha256(bytes));
    }
    write(LIST, flight.to_text().as_bytes())?;
    for (name, bytes) in &frames {
        write(name, bytes)?;
    }
    let is_left = |name: &&String| frames.iter().all(|(new, _)| new != *name);
    for name in flight.frames.keys().filter(is_left) {
        match fs::remove_file(folder.join(name)) {
            Err(source) if source.kind() != ErrorKind::NotFound => return Err(at(&folder.join(name), source)),
            _ => {}
        }
    }
    let whole = frames.into_iter().map(|(name, bytes)| (name, BTreeSet::from([sha256(bytes)]))).collect();
    write(LIST, Flight { frames: whole }.to_text().as_bytes())
}

/// The flight in a folder, verified to be unchanged; an empty one if the folder is new or empty.
fn earlier(folder: &Path) -> Result<Flight, CliError> {
    let entries = match names(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Flight::default()),
        names => names.map_err(|source| StoreError::io(folder, source))?,
    };
    if entries.is_empty() {
        return Ok(Flight::default());
    }
    let flight = Flight::read(&folder.join(LIST))
        .ok_or_else(|| refused(folder.to_path_buf(), "contains files but no flight.json of an earlier flight"))?;
    for name in entries.iter().filter(|name| is_frame(name)) {
        if !flight.frames.get(name).is_some_and(|hashes| is_intact(&folder.join(name), hashes)) {
            return Err(refused(folder.join(name), "is not a frame of the earlier flight, or was changed since"));
        }
    }
    Ok(flight)
}

/// The contents of a folder, without leftovers of a killed run.
fn names(folder: &Path) -> io::Result<Vec<String>> {
    plume_disk::sweep(folder);
    fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned())).collect()
}

fn is_frame(name: &str) -> bool {
    name.strip_suffix(".png")
        .is_some_and(|number| number.len() >= 5 && number.bytes().all(|digit| digit.is_ascii_digit()))
}

fn is_intact(path: &Path, hashes: &BTreeSet<String>) -> bool {
    let bytes = regular::open_no_follow(path).and_then(|file| regular::read_at_most(file, MOST_FRAME_BYTES));
    bytes.is_ok_and(|bytes| hashes.contains(&sha256(&bytes)))
}

fn refused(path: PathBuf, what: &str) -> CliError {
    CliError::Usage { message: format!("{}: {what}", path.display()), hint: HINT.to_owned() }
}

impl Flight {
    /// The list, if it is one of ours.
    fn read(path: &Path) -> Option<Self> {
        let file = regular::open_no_follow(path).ok()?;
        let flight: Self = serde_json::from_slice(&regular::read_at_most(file, MOST_LIST_BYTES).ok()?).ok()?;
        flight.frames.keys().all(|name| is_frame(name)).then_some(flight)
    }

    fn to_text(&self) -> String {
        format!("{:#}\n", serde_json::json!(self))
    }
}
