//! The hidden cave folder of an export without `--keep`: it stays after a kill, so that the next run can resume, and is
//! removed once the packages are complete.

use std::fs::{self, File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

use plume_disk::regular;

use super::{StoreError, file};

/// The marker file. It is locked while a run is using the folder.
const MARKER: &str = "plume-temporary";
const MARKER_TEXT: &[u8] =
    b"This cave folder belongs to an interrupted export. The same export resumes with it and removes\n\
                             it; so may you.\n";

/// A cave folder that is removed when the work is done.
#[derive(Debug)]
pub struct TemporaryFolder {
    path: PathBuf,
    marker: File,
}

impl TemporaryFolder {
    /// Claims the folder at `path`: a new one, or one left by an export.
    ///
    /// # Errors
    /// [`StoreError::Occupied`] if something else is there, [`StoreError::InUse`] if another run is using it; if the disk
    /// fails.
    pub fn claim(path: &Path) -> Result<Self, StoreError> {
        let marker_path = path.join(MARKER);
        let named = |error| StoreError::io(path, error);
        if path.symlink_metadata().is_ok_and(|metadata| metadata.is_symlink()) {
            return Err(StoreError::damaged(path, "is a symbolic link"));
        }
        let is_marked = regular::open_no_follow(&marker_path).is_ok();
        if !is_marked && !file::is_vacant(path)? {
            return Err(StoreError::Occupied { path: path.to_path_buf() });
        }
        fs::create_dir_all(path).map_err(named)?;
        let mut marker = regular::append_no_follow(&marker_path).map_err(named)?;
        let is_taken = matches!(marker.try_lock(), Err(TryLockError::WouldBlock));
        // Another run may have removed it just now.
        if is_taken || marker_path.symlink_metadata().is_err() {
            return Err(StoreError::InUse { path: path.to_path_buf() });
        }
        if !is_marked {
            marker.write_all(MARKER_TEXT).map_err(named)?;
        }
        Ok(Self { path: path.to_path_buf(), marker })
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Removes it with its contents. What cannot be removed only costs space.
    pub fn remove(self) {
        let Self { path, marker } = self;
        // The marker is removed last, so that leftovers of a kill are recognised.
        for entry in fs::read_dir(&path).into_iter().flatten().flatten() {
            let _ = match entry.file_type() {
                _ if entry.file_name() == MARKER => Ok(()),
                Ok(kind) if kind.is_dir() => fs::remove_dir_all(entry.path()),
                _ => fs::remove_file(entry.path()),
            };
        }
        let _ = fs::remove_file(path.join(MARKER));
        drop(marker);
        let _ = fs::remove_dir(&path);
    }
}
