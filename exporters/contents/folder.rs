//! Files of a folder, in the order of their names.

use std::fs::{self, DirEntry};
use std::io;
use std::path::Path;

use plume_disk::regular;

use super::Gate;
use crate::error::at;

/// Passes on the files below `root`; links are not followed.
pub fn read(root: &Path, mut gate: Gate<'_>) -> io::Result<()> {
    let mut folders = vec![(root.to_owned(), String::new())];
    while let Some((folder, above)) = folders.pop() {
        for entry in sorted(&folder)? {
            let name = entry.file_name();
            let raw = [above.as_bytes(), name.as_encoded_bytes()].concat();
            let Some(path) = gate.path(&raw) else { continue };
            let kind = entry.file_type()?;
            if kind.is_dir() {
                folders.push((entry.path(), format!("{path}/")));
            } else if !kind.is_file() {
                gate.fault(&path, if kind.is_symlink() { "is a link" } else { "is not a file or folder" });
            } else {
                let mut file =
                    regular::open_no_follow(&entry.path()).map_err(|error| at(entry.path().display(), &error))?;
                if gate.file(path, &mut file)?.is_break() {
                    return Ok(());
                }
            }
        }
    }
    Ok(())
}

fn sorted(folder: &Path) -> io::Result<Vec<DirEntry>> {
    let entries = fs::read_dir(folder).and_then(Iterator::collect::<io::Result<Vec<_>>>);
    let mut entries = entries.map_err(|error| at(folder.display(), &error))?;
    entries.sort_by_key(DirEntry::file_name);
    Ok(entries)
}
