//! Files of a zip.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};

use zip::ZipArchive;
use zip::read::ZipFile;

use super::{Gate, Limited, MOST_FILES, WHOLE, invalid};

/// Type bits of a Unix mode, and their values for a file and for a folder.
const KIND: u32 = 0o170_000;
const KIND_FILE: u32 = 0o100_000;
const KIND_FOLDER: u32 = 0o040_000;

/// Shows the files that the central directory lists. That the local headers say the same, nothing overlaps and nothing is
/// hidden is checked first.
pub fn read(mut file: File, mut left: u64, mut gate: Gate<'_>) -> io::Result<()> {
    let ends_well = ends_well(&mut file)?;
    file.rewind()?;
    let mut zip = ZipArchive::new(BufReader::new(file)).map_err(io::Error::from)?;
    if zip.len() > MOST_FILES {
        return Err(invalid(format!("contains more than {MOST_FILES} files")));
    }
    if zip.offset() != 0 {
        gate.fault(WHOLE, "begins with data that does not belong to the zip");
    } else if !ends_well {
        gate.fault(WHOLE, "has trailing data or a comment");
    }
    if let Err(error) = zip.validate_header_consistency() {
        gate.fault(WHOLE, &format!("is inconsistent: {error}"));
    }
    for index in 0..zip.len() {
        let raw = zip.by_index_data(index).map(|entry| entry.name_raw().to_vec()).map_err(io::Error::from)?;
        let Some(path) = gate.path(&raw) else { continue };
        let mut entry = match zip.by_index(index) {
            Ok(entry) => entry,
            Err(error) => {
                gate.fault(&path, &format!("cannot be read: {error}"));
                continue;
            }
        };
        if let Some(fault) = kind_fault(&entry) {
            gate.fault(&path, fault);
        } else if !entry.is_dir() {
            let mut limited = Limited { inner: &mut entry, left };
            let flow = gate.file(path, &mut limited)?;
            left = limited.left;
            if flow.is_break() {
                return Ok(());
            }
        }
    }
    Ok(())
}

/// The record at the end of a zip that has no comment, and how it begins; how the one begins that stands before it in a
/// large zip.
const END_BYTES: u64 = 22;
const END: &[u8] = b"PK\x05\x06";
const LOCATOR_BYTES: u64 = 20;
const LOCATOR: &[u8] = b"PK\x06\x07";

/// Whether the archive ends with its end record, directly after the data it describes: readers search it backwards from
/// the end, and some might find another one.
fn ends_well(file: &mut File) -> io::Result<bool> {
    let Some(at) = file.seek(SeekFrom::End(0))?.checked_sub(END_BYTES) else { return Ok(false) };
    let mut end = [0; END_BYTES as usize];
    file.seek(SeekFrom::Start(at))?;
    file.read_exact(&mut end)?;
    let number = |at: usize| u64::from(u32::from_le_bytes([end[at], end[at + 1], end[at + 2], end[at + 3]]));
    let follows = number(12) + number(16) == at || has_locator_before(file, at)?;
    Ok(end.starts_with(END) && end.ends_with(&[0, 0]) && follows)
}

fn has_locator_before(file: &mut File, at: u64) -> io::Result<bool> {
    let Some(at) = at.checked_sub(LOCATOR_BYTES) else { return Ok(false) };
    let mut head = [0; LOCATOR.len()];
    file.seek(SeekFrom::Start(at))?;
    file.read_exact(&mut head)?;
    Ok(head == LOCATOR)
}

fn kind_fault(entry: &ZipFile<'_, BufReader<File>>) -> Option<&'static str> {
    match entry.unix_mode().unwrap_or(0) & KIND {
        0 | KIND_FILE | KIND_FOLDER => None,
        _ if entry.is_symlink() => Some("is a link"),
        _ => Some("is not a file or folder"),
    }
}
