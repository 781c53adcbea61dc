//! Where the files of a package go: a [`Folder`] that appears whole or not at all, or [`Memory`] in tests.
//!
//! Files are streamed. A package ends with [`MANIFEST`], which a [`Place`](crate::place::Place) writes; a folder is
//! replaced only if it holds one, so that no export can eat a folder of the user's.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use plume_disk::sealed::hex;
use plume_disk::{Staging, regular};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use tempfile::TempDir;

use crate::bundle::Bundle;
use crate::error::{ExportError, at};
use crate::foreign;
use crate::manifest;
use crate::scene::Image;

/// Name of the [manifest](crate::manifest).
pub const MANIFEST: &str = "manifest.json";
/// No manifest is longer.
const MOST_MANIFEST_BYTES: u64 = 1 << 26;

/// A sink for the files of one package.
///
/// Paths are relative with forward slashes, and each is written once.
pub trait Package {
    /// Opens a new file. Targets call `write` instead, which checks the path, and names the file in errors.
    ///
    /// # Errors
    /// When it cannot be created.
    fn open(&mut self, path: &str) -> io::Result<Box<dyn Write + '_>>;

    /// Ends the file that was opened last. Called by `write`.
    ///
    /// # Errors
    /// When what was gathered cannot be put in its place.
    fn close(&mut self) -> io::Result<()> {
        Ok(())
    }

    /// A folder on a disk, for libraries that only write files; what should stay is [copied](#method.copy). It is
    /// removed when dropped.
    ///
    /// # Errors
    /// When it cannot be made.
    fn scratch(&mut self) -> io::Result<TempDir>;

    /// The list of what has been written so far.
    fn files(&mut self) -> &mut Files;

    /// The kind of file that the package becomes, if it does not stay a folder.
    fn bundle(&self) -> Option<Bundle> {
        None
    }
}

impl dyn Package + '_ {
    /// Writes the file `path` with whatever `fill` puts into it.
    ///
    /// # Errors
    /// When the path is not relative, climbs out, or is taken; when the file cannot be written; and the errors of
    /// `fill`.
    pub fn write(
        &mut self,
        path: &str,
        fill: impl FnOnce(&mut dyn Write) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        self.files().check(path)?;
        let inner = self.open(path).map_err(|error| at(path, &error))?;
        let mut file = BufWriter::with_capacity(1 << 16, Tally::new(path, inner));
        fill(&mut file)?;
        file.flush()?;
        let entry = file.into_inner().map_err(io::IntoInnerError::into_error)?.entry();
        self.close().map_err(|error| at(path, &error))?;
        self.files().0.insert(path.to_owned(), entry);
        Ok(())
    }

    /// Copies the file `from` of the disk to `path`.
    ///
    /// # Errors
    /// As [`write`](#method.write), and when `from` cannot be read.
    pub fn copy(&mut self, path: &str, from: &Path) -> Result<(), ExportError> {
        let mut source = File::open(from).map_err(|error| at(from.display(), &error))?;
        self.write(path, |file| Ok(io::copy(&mut source, file).map(drop)?))?;
        self.files().0.entry(path.to_owned()).and_modify(|entry| entry.source = Some(from.to_owned()));
        Ok(())
    }

    /// Copies an image of a chunk into `textures/` below `folder`, which is empty or ends with a slash; gives its path from
    /// there.
    ///
    /// # Errors
    /// As [`copy`](#method.copy).
    pub fn texture(&mut self, folder: &str, chunk: &str, role: &str, image: &Image) -> Result<String, ExportError> {
        let file = format!("textures/{chunk}_{role}.{}", image.format.extension());
        self.copy(&format!("{folder}{file}"), &image.path)?;
        Ok(file)
    }

    /// Writes a text.
    ///
    /// # Errors
    /// As [`write`](#method.write).
    pub fn text(&mut self, path: &str, text: &str) -> Result<(), ExportError> {
        self.write(path, |file| Ok(file.write_all(text.as_bytes())?))
    }
}

/// The files of a package by path.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Files(pub BTreeMap<String, Entry>);

/// A line of the list of files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// Size in bytes.
    pub bytes: u64,
    /// SHA-256 in lower-case hexadecimal.
    pub sha256: String,
    /// The file of the disk that it is a copy of, if it is one; not written down.
    #[serde(skip)]
    pub source: Option<PathBuf>,
}

impl Files {
    /// Bytes of all files together.
    pub fn bytes(&self) -> u64 {
        self.0.values().fold(0, |sum, entry| sum.saturating_add(entry.bytes))
    }

    fn check(&self, path: &str) -> Result<(), ExportError> {
        let taken = self.0.contains_key(path).then_some("is written twice");
        let fault = path_fault(path).or(taken);
        fault.map_or(Ok(()), |fault| Err(ExportError::BadPath { path: path.to_owned(), fault }))
    }
}

/// What is wrong with a path as one inside a package, if anything.
pub(crate) fn path_fault(path: &str) -> Option<&'static str> {
    if path.starts_with('/') || path.contains(['\\', ':', '\0']) {
        return Some("is not relative with forward slashes");
    }
    let has_odd_part = path.split('/').any(|part| matches!(part, "" | "." | ".."));
    has_odd_part.then_some("has an empty, `.` or `..` part")
}

/// What to do with a folder that is already there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// Refuse unless it is empty.
    Keep,
    /// Replace it if it holds the [`MANIFEST`] of a package. Files that the manifest does not name stay.
    Replace,
}

/// A folder on disk. Files gather in a [`Staging`] folder beside it; [`Folder::finish`] moves them to their place, and
/// dropping an unfinished one removes it.
#[derive(Debug)]
pub struct Folder {
    /// As it was asked for, for errors.
    asked: PathBuf,
    path: PathBuf,
    existing: Existing,
    staging: Staging,
    files: Files,
}

/// The name of a package while it grows.
const GROWING: &str = "package";

impl Folder {
    /// Whether a package can be made at `path`: asked before the long work.
    ///
    /// # Errors
    /// [`ExportError::NotEmpty`] and [`ExportError::NotOurs`] when something else is there; [`ExportError::Io`] when
    /// it cannot be looked at.
    pub fn check(path: &Path, existing: Existing) -> Result<(), ExportError> {
        check_vacant(path, existing)
    }

    /// Starts a package that will be at `path`.
    ///
    /// # Errors
    /// [`ExportError::NotEmpty`] and [`ExportError::NotOurs`] when something else is there; [`ExportError::Io`] when
    /// the folder cannot be made.
    pub fn create(path: &Path, existing: Existing) -> Result<Self, ExportError> {
        check_vacant(path, existing)?;
        let (asked, path) = (path.to_owned(), place(path)?);
        let named = |error| at(asked.display(), &error);
        let staging = Staging::beside(&path).map_err(named)?;
        fs::create_dir(staging.path().join(GROWING)).map_err(named)?;
        Ok(Self { asked, path, existing, staging, files: Files::default() })
    }

    /// Moves the package to its place. Of a package that was there, its own files go; what the user has put beside them
    /// moves along.
    ///
    /// # Errors
    /// [`ExportError::NotEmpty`] and [`ExportError::NotOurs`] when something else has come there meanwhile,
    /// [`ExportError::InTheWay`] when a file of the user's has the name of one of the package, and when the disk refuses;
    /// what was there is there still.
    pub fn finish(mut self) -> Result<Files, ExportError> {
        check_vacant(&self.asked, self.existing)?;
        match is_occupied(&self.path) {
            true => self.replace()?,
            false => self.publish()?,
        }
        Ok(std::mem::take(&mut self.files))
    }

    /// Fails if the place was taken between the check and now.
    fn publish(&self) -> Result<(), ExportError> {
        plume_disk::publish(&self.growing(), &self.path).map_err(|error| match error.kind() {
            io::ErrorKind::AlreadyExists | io::ErrorKind::DirectoryNotEmpty => {
                ExportError::NotEmpty { path: self.asked.clone() }
            }
            io::ErrorKind::NotADirectory => ExportError::NotAFolder { path: self.asked.clone() },
            _ => at(self.asked.display(), &error).into(),
        })
    }

    fn replace(&self) -> Result<(), ExportError> {
        let own = manifest_of(&self.path).and_then(|text| manifest::files_of(&text));
        let own = own.ok_or_else(|| ExportError::NotOurs { path: self.asked.clone() })?;
        foreign::keep(&self.asked, &own, &self.growing())?;
        self.staging.swap(GROWING, &self.path).map_err(|error| at(self.asked.display(), &error))?;
        Ok(())
    }

    fn growing(&self) -> PathBuf {
        self.staging.path().join(GROWING)
    }
}

impl Package for Folder {
    fn open(&mut self, path: &str) -> io::Result<Box<dyn Write + '_>> {
        let path = self.growing().join(path);
        fs::create_dir_all(path.parent().expect("a file lies in the package"))?;
        Ok(Box::new(File::create_new(path)?))
    }

    fn scratch(&mut self) -> io::Result<TempDir> {
        tempfile::tempdir_in(self.staging.path()).map_err(|error| at(self.asked.display(), &error))
    }

    fn files(&mut self) -> &mut Files {
        &mut self.files
    }
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

/// Counts and hashes what passes, and puts the path into errors.
struct Tally<'a> {
    path: &'a str,
    inner: Box<dyn Write + 'a>,
    bytes: u64,
    hash: Sha256,
}

impl<'a> Tally<'a> {
    fn new(path: &'a str, inner: Box<dyn Write + 'a>) -> Self {
        Self { path, inner, bytes: 0, hash: Sha256::new() }
    }

    fn entry(self) -> Entry {
        let sha256 = hex(&self.hash.finalize());
        Entry { bytes: self.bytes, sha256, source: None }
    }
}

impl Write for Tally<'_> {
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

fn check_vacant(path: &Path, existing: Existing) -> Result<(), ExportError> {
    if path.is_file() {
        return Err(ExportError::NotAFolder { path: path.to_owned() });
    }
    let mut entries = match fs::read_dir(path) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(at(path.display(), &error).into()),
    };
    if entries.next().is_none() {
        return Ok(());
    }
    match existing {
        Existing::Keep => Err(ExportError::NotEmpty { path: path.to_owned() }),
        Existing::Replace if is_package(path) => Ok(()),
        Existing::Replace => Err(ExportError::NotOurs { path: path.to_owned() }),
    }
}

/// Whether the folder holds a manifest of ours; other programs have a `manifest.json` too.
fn is_package(path: &Path) -> bool {
    manifest_of(path).is_some_and(|text| manifest::is_ours(&text))
}

fn manifest_of(path: &Path) -> Option<Vec<u8>> {
    regular::open_no_follow(&path.join(MANIFEST)).and_then(|file| regular::read_at_most(file, MOST_MANIFEST_BYTES)).ok()
}

fn is_occupied(path: &Path) -> bool {
    fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some())
}

/// JSON for people to read, with a newline at its end.
pub(crate) fn pretty(value: &impl Serialize) -> Result<String, ExportError> {
    let mut text = serde_json::to_string_pretty(value).map_err(io::Error::from)?;
    text.push('\n');
    Ok(text)
}

/// The path without links, dots and trailing slashes, so that a suffix makes a neighbour of it.
fn place(path: &Path) -> io::Result<PathBuf> {
    match path.canonicalize() {
        Ok(path) => Ok(path),
        Err(_) => std::path::absolute(path.components().collect::<PathBuf>()),
    }
}

/// The path with something at its end.
pub(crate) fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.to_owned().into_os_string();
    name.push(suffix);
    name.into()
}
