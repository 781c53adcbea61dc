//! Files of a zip.

use std::fs::File;
use std::io::{self, BufReader};

use zip::ZipArchive;
use zip::read::ZipFile;

use super::{Gate, Limited, MOST_FILES, WHOLE, invalid};

/// Bits of a Unix mode that say what an entry is, and those of a file and of a folder.
const KIND: u32 = 0o170_000;
const KIND_FILE: u32 = 0o100_000;
const KIND_FOLDER: u32 = 0o040_000;

/// Shows the files that the central directory lists. That the local headers say the same, nothing overlaps and nothing is
/// hidden is checked first.
pub fn read(file: File, mut left: u64, mut gate: Gate<'_>) -> io::Result<()> {
    let mut zip = ZipArchive::new(BufReader::new(file)).map_err(io::Error::from)?;
    if zip.len() > MOST_FILES {
        return Err(invalid(format!("holds more than {MOST_FILES} files")));
    }
    if zip.offset() != 0 {
        gate.fault(WHOLE, "begins with something that is no zip");
    }
    if let Err(error) = zip.validate_header_consistency() {
        gate.fault(WHOLE, &format!("contradicts itself: {error}"));
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

fn kind_fault(entry: &ZipFile<'_, BufReader<File>>) -> Option<&'static str> {
    match entry.unix_mode().unwrap_or(0) & KIND {
        0 | KIND_FILE | KIND_FOLDER => None,
        _ if entry.is_symlink() => Some("is a link"),
        _ => Some("is neither a file nor a folder"),
    }
}
