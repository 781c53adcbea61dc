//! Files that appear whole or not at all, and are known by their hash.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::StoreError;

/// A file that was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileRecord {
    /// Path in the folder, with forward slashes.
    pub path: String,
    /// Size.
    pub bytes: u64,
    /// SHA-256, hexadecimal.
    pub sha256: String,
}

impl FileRecord {
    /// Whether the file still is what was written.
    ///
    /// # Errors
    /// When it is there but cannot be read.
    pub fn is_intact(&self, root: &Path) -> Result<bool, StoreError> {
        let path = root.join(&self.path);
        let mut file = match File::open(&path) {
            Ok(file) => file,
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(false),
            Err(e) => return Err(StoreError::io(&path, e)),
        };
        let (mut hash, mut bytes, mut buffer) = (Sha256::new(), 0, vec![0; 1 << 16]);
        loop {
            let count = file.read(&mut buffer).map_err(|e| StoreError::io(&path, e))?;
            if count == 0 {
                return Ok(bytes == self.bytes && hex(&hash.finalize()) == self.sha256);
            }
            hash.update(&buffer[..count]);
            bytes += count as u64;
        }
    }
}

/// SHA-256 of `bytes`, hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A file being written under a temporary name. It appears when finished and vanishes when dropped before.
pub struct Sink {
    path: String,
    target: PathBuf,
    partial: PathBuf,
    inner: Option<BufWriter<File>>,
    hash: Sha256,
    bytes: u64,
}

impl Sink {
    /// Starts `root/path`.
    pub fn create(root: &Path, path: &str) -> Result<Self, StoreError> {
        let target = root.join(path);
        let partial = root.join(format!("{path}.partial"));
        let folder = target.parent().unwrap_or(root);
        fs::create_dir_all(folder).map_err(|e| StoreError::io(folder, e))?;
        let file = File::create(&partial).map_err(|e| StoreError::io(&partial, e))?;
        let inner = Some(BufWriter::new(file));
        Ok(Self { path: path.to_owned(), target, partial, inner, hash: Sha256::new(), bytes: 0 })
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn finish(mut self) -> Result<FileRecord, StoreError> {
        self.flush().map_err(|e| StoreError::io(&self.target, e))?;
        self.inner = None;
        fs::rename(&self.partial, &self.target).map_err(|e| StoreError::io(&self.target, e))?;
        let sha256 = hex(&std::mem::take(&mut self.hash).finalize());
        Ok(FileRecord { path: self.path.clone(), bytes: self.bytes, sha256 })
    }
}

impl Write for Sink {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let written = self.inner.as_mut().map_or(Ok(0), |inner| inner.write(buffer))?;
        self.hash.update(&buffer[..written]);
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.as_mut().map_or(Ok(()), Write::flush)
    }
}

impl Drop for Sink {
    fn drop(&mut self) {
        // Finished files have been renamed, so this removes unfinished ones only.
        let _ = fs::remove_file(&self.partial);
    }
}

/// Writes `root/path` in one go.
pub fn write(
    root: &Path,
    path: &str,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<FileRecord, StoreError> {
    let mut sink = Sink::create(root, path)?;
    content(&mut sink).map_err(|e| StoreError::io(&root.join(path), e))?;
    sink.finish()
}

/// The content of a file that may be absent.
pub fn read_if_there(path: &Path) -> Result<Option<Vec<u8>>, StoreError> {
    let mut content = Vec::new();
    match File::open(path).and_then(|mut file| file.read_to_end(&mut content)) {
        Ok(_) => Ok(Some(content)),
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
