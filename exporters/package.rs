//! The sink that targets write into: files by path, counted and hashed on their way. [`Memory`] is one for tests; those on a disk
//! are in [`place`](crate::place).
//!
//! Files are streamed. A package ends with [`MANIFEST`].
//!
//! ```
//! use plume_exporters::package::{Memory, Package};
//!
//! let mut memory = Memory::default();
//! let package: &mut dyn Package = &mut memory;
//! package.text("models/README.md", "A cave.")?;
//! assert!(package.text("../README.md", "Outside.").is_err());
//! assert_eq!(memory.bytes["models/README.md"], b"A cave.");
//! # Ok::<(), plume_exporters::ExportError>(())
//! ```

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use plume_disk::sealed::hex;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use tempfile::{NamedTempFile, TempDir};

use crate::bundle::Bundle;
use crate::error::{ExportError, at};
use crate::scene::Image;

/// Name of the [manifest](crate::manifest).
pub const MANIFEST: &str = "manifest.json";

/// A sink for the files of one package.
///
/// Paths are relative with forward slashes, and each is written once.
pub trait Package {
    /// Opens a new file. Targets call `write` instead, which checks the path and names the file in errors.
    ///
    /// # Errors
    /// When it cannot be created.
    fn open(&mut self, path: &str) -> io::Result<Box<dyn Write + '_>>;

    /// Closes the file opened last. Called by `write`.
    ///
    /// # Errors
    /// If buffered data cannot be written.
    fn close(&mut self) -> io::Result<()> {
        Ok(())
    }

    /// A scratch folder on the disk, for libraries that only write files; results are [copied](#method.copy). It is removed
    /// when dropped.
    ///
    /// # Errors
    /// When it cannot be made.
    fn scratch(&mut self) -> io::Result<TempDir>;

    /// The list of files written so far.
    fn files(&mut self) -> &mut Files;

    /// The kind of bundle, if the package is not a folder.
    fn bundle(&self) -> Option<Bundle> {
        None
    }
}

impl dyn Package + '_ {
    /// Writes the file `path` with the content from `fill`.
    ///
    /// # Errors
    /// If the path is not relative, leads outside, or is taken; if the file cannot be written; and the errors of `fill`.
    pub fn write(
        &mut self,
        path: &str,
        fill: impl FnOnce(&mut dyn Write) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        self.files().check(path)?;
        let inner = self.open(path).map_err(|error| at(path, &error))?;
        let mut file = BufWriter::with_capacity(1 << 16, HashingWriter::new(path, inner));
        fill(&mut file)?;
        file.flush()?;
        let entry = file.into_inner().map_err(io::IntoInnerError::into_error)?.entry();
        self.close().map_err(|error| at(path, &error))?;
        self.files().0.insert(path.to_owned(), entry);
        Ok(())
    }

    /// Writes the file `path` with the content from `fill`, which may go back in it: it is made in the folder `scratch` and copied.
    ///
    /// # Errors
    /// As [`write`](#method.write).
    pub fn write_by(
        &mut self,
        scratch: &Path,
        path: &str,
        fill: impl FnOnce(&mut BufWriter<&File>) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        let place = NamedTempFile::new_in(scratch).map_err(|error| at(path, &error))?;
        let mut file = BufWriter::with_capacity(1 << 16, place.as_file());
        fill(&mut file)?;
        file.flush().map_err(|error| at(path, &error))?;
        self.copy(path, place.path())
    }

    /// Copies the file `from` on the disk to `path`.
    ///
    /// # Errors
    /// As [`write`](#method.write), and if `from` cannot be read.
    pub fn copy(&mut self, path: &str, from: &Path) -> Result<(), ExportError> {
        let mut source = File::open(from).map_err(|error| at(from.display(), &error))?;
        self.write(path, |file| Ok(io::copy(&mut source, file).map(drop)?))?;
        self.files().0.entry(path.to_owned()).and_modify(|entry| entry.source = Some(from.to_owned()));
        Ok(())
    }

    /// Copies an image of a material into `textures/` below `folder`, which is empty or ends with a slash, unless it is there;
    /// returns its path relative to `folder`.
    ///
    /// # Errors
    /// As [`copy`](#method.copy).
    pub fn texture(&mut self, folder: &str, material: &str, role: &str, image: &Image) -> Result<String, ExportError> {
        let file = format!("textures/{material}_{role}.{}", image.format.extension());
        self.share(&format!("{folder}{file}"), image)?;
        Ok(file)
    }

    /// Copies an image to `path`, unless another chunk with the same material has done so.
    ///
    /// # Errors
    /// As [`copy`](#method.copy).
    pub fn share(&mut self, path: &str, image: &Image) -> Result<(), ExportError> {
        let there = self.files().0.get(path).and_then(|entry| entry.source.as_ref());
        if there == Some(&image.path) { Ok(()) } else { self.copy(path, &image.path) }
    }

    /// Whether a file has been written.
    pub fn has(&mut self, path: &str) -> bool {
        self.files().0.contains_key(path)
    }

    /// Writes a text.
    ///
    /// # Errors
    /// As [`write`](#method.write).
    pub fn text(&mut self, path: &str, text: &str) -> Result<(), ExportError> {
        self.write(path, |file| Ok(file.write_all(text.as_bytes())?))
    }

    /// Writes a value as pretty-printed JSON, whose text is never whole in memory.
    ///
    /// # Errors
    /// As [`write`](#method.write).
    pub fn json(&mut self, path: &str, value: &impl Serialize) -> Result<(), ExportError> {
        self.write(path, |file| write_pretty(file, value))
    }
}

/// The files of a package by path.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Files(pub BTreeMap<String, Entry>);

/// An entry of the list of files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// Size in bytes.
    pub bytes: u64,
    /// SHA-256 in lower-case hexadecimal.
    pub sha256: String,
    /// The file on the disk that it was copied from, if any; not stored.
    #[serde(skip)]
    pub source: Option<PathBuf>,
}

impl Files {
    /// Total bytes of all files.
    pub fn bytes(&self) -> u64 {
        self.0.values().fold(0, |sum, entry| sum.saturating_add(entry.bytes))
    }

    fn check(&self, path: &str) -> Result<(), ExportError> {
        let taken = self.0.contains_key(path).then_some("is written twice");
        let fault = path_fault(path).or(taken);
        fault.map_or(Ok(()), |fault| Err(ExportError::BadPath { path: path.to_owned(), fault }))
    }
}

/// What is wrong with a path inside a package, if anything.
pub(crate) fn path_fault(path: &str) -> Option<&'static str> {
    if path.starts_with('/') || path.contains(['\\', ':', '\0']) {
        return Some("is not relative with forward slashes");
    }
    if path.split('/').any(plume_disk::is_device_name) {
        return Some("has a part that is a device name on Windows");
    }
    let has_odd_part = path.split('/').any(|part| matches!(part, "" | "." | ".."));
    has_odd_part.then_some("has an empty, `.` or `..` part")
}

/// Files in memory.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// Bytes by path.
    pub bytes: BTreeMap<String, Vec<u8>>,
    files: Files,
}

impl Package for Memory {
    fn open(&mut self, path: &str) -> io::Result<Box<dyn Write + '_>> {
        Ok(Box::new(self.bytes.entry(path.to_owned()).or_default()))
    }

    fn scratch(&mut self) -> io::Result<TempDir> {
        tempfile::tempdir()
    }

    fn files(&mut self) -> &mut Files {
        &mut self.files
    }
}

/// Counts and hashes the bytes written, and adds the path to errors.
struct HashingWriter<'a> {
    path: &'a str,
    inner: Box<dyn Write + 'a>,
    bytes: u64,
    hash: Sha256,
}

impl<'a> HashingWriter<'a> {
    fn new(path: &'a str, inner: Box<dyn Write + 'a>) -> Self {
        Self { path, inner, bytes: 0, hash: Sha256::new() }
    }

    fn entry(self) -> Entry {
        let sha256 = hex(&self.hash.finalize());
        Entry { bytes: self.bytes, sha256, source: None }
    }
}

impl Write for HashingWriter<'_> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let count = self.inner.write(buffer).map_err(|error| at(self.path, &error))?;
        self.hash.update(&buffer[..count]);
        self.bytes += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush().map_err(|error| at(self.path, &error))
    }
}

/// Writes pretty-printed JSON with a trailing newline.
pub(crate) fn write_pretty(file: &mut dyn Write, value: &impl Serialize) -> Result<(), ExportError> {
    serde_json::to_writer_pretty(&mut *file, value).map_err(io::Error::from)?;
    Ok(file.write_all(b"\n")?)
}
