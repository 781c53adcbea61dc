//! The current name, which items of a `.3d` file change by a few bytes each.

use plume_graph::MAX_NAME_BYTES;

use super::super::{ReadError, files};
use super::bytes::Bytes;

/// A prime, so that names which differ hash apart.
const FACTOR: u64 = 0x0000_0100_0000_01b3;
const EMPTY: u64 = 0xcbf2_9ce4_8422_2325;

/// A name, and the hashes (FNV-1a) of its prefixes: changing it takes time proportional to the change, however long the name
/// is, and a file cannot claim more memory than its size. Hashes collide in one of 10⁷ caves of a million stations; the
/// only consequence is that a cross-section is mistaken for another.
#[derive(Default)]
pub(super) struct Label {
    bytes: Vec<u8>,
    hashes: Vec<u64>,
}

impl Label {
    /// Drops bytes from the end and appends others, as the next item of the file says.
    pub(super) fn read(&mut self, bytes: &mut Bytes) -> Result<(), ReadError> {
        let at = bytes.at();
        let (dropped, added) = match bytes.u8()? {
            0 => (count(bytes)?, count(bytes)?),
            both => (usize::from(both >> 4), usize::from(both & 0x0f)),
        };
        let added = bytes.take(added)?;
        let Some(kept) = self.hashes.len().checked_sub(dropped) else {
            let message = format!("drops {dropped} bytes of a name of {}", self.hashes.len());
            return Err(bytes.fault_at(at, message, "process the survey again with `cavern`"));
        };
        self.hashes.truncate(kept);
        self.bytes.truncate(kept);
        self.bytes.extend_from_slice(added);
        for &byte in added {
            self.hashes.push((self.hash() ^ u64::from(byte)).wrapping_mul(FACTOR));
        }
        Ok(())
    }

    /// The whole name; `None` if it is empty or too long to be kept.
    pub(super) fn name(&self) -> Option<Box<str>> {
        if self.bytes.len() > MAX_NAME_BYTES {
            return None;
        }
        plume_graph::name(&files::text(&self.bytes))
    }

    /// The hash of the whole name.
    pub(super) fn hash(&self) -> u64 {
        self.hashes.last().copied().unwrap_or(EMPTY)
    }
}

/// A count in one byte, or in four after the byte 255.
fn count(bytes: &mut Bytes) -> Result<usize, ReadError> {
    match bytes.u8()? {
        0xff => Ok(bytes.u32()? as usize),
        count => Ok(usize::from(count)),
    }
}
