//! Records of finished units: the sealed manifest, and the journal of a current or killed run.

use std::io::{self, Write};
use std::path::Path;

use plume_disk::sealed;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::file::read_if_there;
use super::{Stage, StoreError, Unit, sha256};

/// Maximum size of a manifest or journal: about a million units.
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

/// The units of a manifest that may be missing.
pub fn read_manifest(path: &Path) -> Result<Vec<Unit>, StoreError> {
    let Some(text) = read_if_there(path, MOST_BYTES)? else {
        return Ok(Vec::new());
    };
    let bare = sealed::unseal(&text)
        .ok_or_else(|| StoreError::damaged(path, "was changed since it was written: its seal does not match"))?;
    let manifest: Manifest = serde_json::from_slice(&bare).map_err(|error| StoreError::damaged(path, error))?;
    Ok(manifest.units)
}

/// An event of a unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Event {
    /// Its files are being written, which invalidates earlier records.
    Begun {
        /// The stage.
        stage: Stage,
        /// Chunk name, or `cave`.
        name: String,
    },
    /// It is finished.
    Done(Unit),
}

/// A line of a journal: an event with the SHA-256 of its text, by which a truncated line is recognised.
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

/// The events of a journal that may be missing, without truncated lines.
///
/// # Errors
/// If an intact line has an event that no stage produces.
pub fn read_journal(path: &Path) -> Result<Vec<Event>, StoreError> {
    let text = read_if_there(path, MOST_BYTES)?.unwrap_or_default();
    let whole = text.split(|byte| *byte == b'\n').filter_map(|line| {
        let line: Line = serde_json::from_slice(line).ok()?;
        (sha256(line.event.get().as_bytes()) == line.sha256).then_some(line.event)
    });
    whole.map(|event| serde_json::from_str(event.get()).map_err(|error| StoreError::damaged(path, error))).collect()
}
