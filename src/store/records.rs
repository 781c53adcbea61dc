//! What is finished in a cave folder: the sealed manifest, and the journal of the run that is at work or was killed.

use std::io::{self, Write};
use std::path::Path;

use plume_disk::sealed;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::file::read_if_there;
use super::{Stage, StoreError, Unit, sha256};

/// No manifest and no journal is longer: about a million units.
const MOST_BYTES: u64 = 1 << 30;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Manifest {
    plume: String,
    units: Vec<Unit>,
}

/// The text of a manifest of these units.
pub fn manifest(units: Vec<Unit>) -> String {
    let manifest = Manifest { plume: crate::VERSION.into(), units };
    sealed::seal(&serde_json::to_string_pretty(&manifest).expect("a manifest is plain data"))
}

/// The units of a manifest that may be absent.
pub fn read_manifest(path: &Path) -> Result<Vec<Unit>, StoreError> {
    let Some(text) = read_if_there(path, MOST_BYTES)? else {
        return Ok(Vec::new());
    };
    let bare = sealed::unseal(&text)
        .ok_or_else(|| StoreError::damaged(path, "is not as it was written: its seal does not fit"))?;
    let manifest: Manifest = serde_json::from_slice(&bare).map_err(|error| StoreError::damaged(path, error))?;
    Ok(manifest.units)
}

/// What happened to a unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Event {
    /// Its files are being written, and are no longer what an earlier record says.
    Begun {
        /// Which stage.
        stage: Stage,
        /// Chunk name, or `cave`.
        name: String,
    },
    /// It is finished.
    Done(Unit),
}

/// A line of a journal: an event with the SHA-256 of its text, so that a torn line is known.
#[derive(Serialize, Deserialize)]
struct Line<'a> {
    sha256: String,
    #[serde(borrow)]
    event: &'a RawValue,
}

/// Adds a line to a journal.
pub fn append(journal: &mut dyn Write, event: &Event) -> io::Result<()> {
    let event = serde_json::value::to_raw_value(event).expect("an event is plain data");
    let line = Line { sha256: sha256(event.get().as_bytes()), event: &event };
    let mut text = serde_json::to_vec(&line).expect("a line is plain data");
    text.push(b'\n');
    journal.write_all(&text)
}

/// The events of a journal that may be absent, without lines that a kill tore.
///
/// # Errors
/// When a line is whole and tells of what no stage does.
pub fn read_journal(path: &Path) -> Result<Vec<Event>, StoreError> {
    let text = read_if_there(path, MOST_BYTES)?.unwrap_or_default();
    let whole = text.split(|byte| *byte == b'\n').filter_map(|line| {
        let line: Line = serde_json::from_slice(line).ok()?;
        (sha256(line.event.get().as_bytes()) == line.sha256).then_some(line.event)
    });
    whole.map(|event| serde_json::from_str(event.get()).map_err(|error| StoreError::damaged(path, error))).collect()
}
