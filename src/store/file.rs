//! Files that appear whole or not at all, and are identified by their hash.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use plume_disk::{regular, sealed};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::StoreError;

/// A written file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileRecord {
    /// Path in the folder, with forward slashes.
    pub path: String,
    /// Size.
    pub bytes: u64,
    /// SHA-256, hexadecimal.
    pub sha256: String,
}

/// The state of a written file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileState {
    /// Unchanged.
    Intact,
    /// Missing.
    Missing,
    /// Changed.
    Changed,
}

impl FileRecord {
    /// The state of the file.
    ///
    /// # Errors
    /// If it exists but cannot be read.
    pub fn state(&self, root: &Path) -> Result<FileState, StoreError> {
        let path = root.join(&self.path);
        let named = |error| StoreError::io(&path, error);
        refuse_link_above(root, &path)?;
        let mut file = match regular::open_no_follow(&path) {
            Ok(file) => file,
            Err(error) => match error.kind() {
                ErrorKind::NotFound => return Ok(FileState::Missing),
                // A link, a folder or a pipe replaced the file.
                ErrorKind::InvalidInput | ErrorKind::IsADirectory => return Ok(FileState::Changed),
                _ => return Err(named(error)),
            },
        };
        if file.metadata().map_err(named)?.len() != self.bytes {
            return Ok(FileState::Changed);
        }
        let is_intact = hash_of(&mut file).map_err(named)? == self.sha256;
        Ok(if is_intact { FileState::Intact } else { FileState::Changed })
    }

    /// The content of the file, verified.
    ///
    /// # Errors
    /// [`StoreError::Changed`] if it was changed; if it cannot be read.
    pub fn read(&self, root: &Path) -> Result<Vec<u8>, StoreError> {
        let path = root.join(&self.path);
        refuse_link_above(root, &path)?;
        let file = regular::open_no_follow(&path).map_err(|error| StoreError::io(&path, error))?;
        let content = regular::read_at_most(file, self.bytes);
        match content {
            Ok(content) if content.len() as u64 == self.bytes && sealed::sha256(&content) == self.sha256 => Ok(content),
            Err(error) if error.kind() != ErrorKind::FileTooLarge => Err(StoreError::io(&path, error)),
            _ => Err(StoreError::Changed { path }),
        }
    }
}

fn hash_of(file: &mut File) -> io::Result<String> {
    let (mut hash, mut buffer) = (Sha256::new(), vec![0; 1 << 16]);
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(sealed::hex(&hash.finalize())),
            count => hash.update(&buffer[..count]),
        }
    }
}

/// A file being written in a staging folder. It appears when finished, and is removed if dropped before.
pub struct Sink {
    path: String,
    target: PathBuf,
    partial: PathBuf,
    inner: BufWriter<File>,
    hash: Sha256,
    bytes: u64,
}

impl Sink {
    /// Starts `root/path` as `partial`, which is a unique name.
    pub fn create(root: &Path, path: &str, partial: PathBuf) -> Result<Self, StoreError> {
        let target = root.join(path);
        let folder = target.parent().unwrap_or(root);
        refuse_link_above(root, &target)?;
        fs::create_dir_all(folder).map_err(|e| StoreError::io(folder, e))?;
        let file = File::create_new(&partial).map_err(|e| StoreError::io(&target, e))?;
        let path = path.to_owned();
        Ok(Self { path, target, partial, inner: BufWriter::new(file), hash: Sha256::new(), bytes: 0 })
    }

    /// Renames the file into place, once its content is synced.
    ///
    /// # Errors
    /// If the disk fails.
    pub fn finish(mut self) -> Result<FileRecord, StoreError> {
        let named = |error| StoreError::io(&self.target, error);
        self.inner.flush().map_err(named)?;
        self.inner.get_ref().sync_all().map_err(named)?;
        fs::rename(&self.partial, &self.target).map_err(named)?;
        let sha256 = sealed::hex(&std::mem::take(&mut self.hash).finalize());
        Ok(FileRecord { path: std::mem::take(&mut self.path), bytes: self.bytes, sha256 })
    }
}

impl Write for Sink {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(buffer)?;
        self.hash.update(&buffer[..written]);
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl Drop for Sink {
    fn drop(&mut self) {
        // Finished files have been renamed, so this only removes unfinished ones.
        let _ = fs::remove_file(&self.partial);
    }
}

/// The content of a file that may be missing.
pub fn read_if_there(path: &Path, most_bytes: u64) -> Result<Option<Vec<u8>>, StoreError> {
    match regular::open_no_follow(path).and_then(|file| regular::read_at_most(file, most_bytes)) {
        Ok(content) => Ok(Some(content)),
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(None),
        Err(e) => Err(StoreError::io(path, e)),
    }
}

/// Whether there is nothing at `path`, or an empty folder.
pub fn is_vacant(path: &Path) -> Result<bool, StoreError> {
    match fs::read_dir(path) {
        Ok(mut entries) => Ok(entries.next().is_none()),
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(true),
        Err(e) => Err(StoreError::io(path, e)),
    }
}

/// Refuses a file in a linked folder, which may be anywhere.
pub fn refuse_link_above(root: &Path, path: &Path) -> Result<(), StoreError> {
    let folder = path.parent().unwrap_or(root);
    let is_link = folder != root && folder.symlink_metadata().is_ok_and(|metadata| metadata.is_symlink());
    match is_link {
        true => Err(StoreError::damaged(folder, "is a symbolic link, which is not allowed in a cave folder")),
        false => Ok(()),
    }
}
