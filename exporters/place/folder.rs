//! A package as a folder that appears whole or not at all, and is replaced only if it holds a manifest of ours, so that no
//! export can eat a folder of the user's.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use plume_disk::{Existing, Staging, regular};
use tempfile::TempDir;

use super::user_files;
use crate::error::{ExportError, at};
use crate::manifest;
use crate::package::{Files, MANIFEST, Package};

/// Largest size of a manifest.
const MOST_MANIFEST_BYTES: u64 = 1 << 26;

/// A folder on the disk. Files are written to a [`Staging`] folder next to it; [`Folder::finish`] moves them into place,
/// and dropping an unfinished one removes it.
#[derive(Debug)]
pub struct Folder {
    /// The path as given, for errors.
    asked: PathBuf,
    path: PathBuf,
    existing: Existing,
    staging: Staging,
    files: Files,
}

/// The name of a package while it is written.
const GROWING: &str = "package";

impl Folder {
    /// Whether a package can be made at `path`: checked before the long work.
    ///
    /// # Errors
    /// [`ExportError::NotEmpty`] and [`ExportError::NotOurs`] if something else is there; [`ExportError::Io`] if it cannot
    /// be read.
    pub fn check(path: &Path, existing: Existing) -> Result<(), ExportError> {
        check_vacant(path, existing)
    }

    /// Starts a package that will be at `path`.
    ///
    /// # Errors
    /// [`ExportError::NotEmpty`] and [`ExportError::NotOurs`] if something else is there; [`ExportError::Io`] if the folder
    /// cannot be made.
    pub fn create(path: &Path, existing: Existing) -> Result<Self, ExportError> {
        check_vacant(path, existing)?;
        let (asked, path) = (path.to_owned(), place(path)?);
        let named = |error| at(asked.display(), &error);
        let staging = Staging::beside(&path).map_err(named)?;
        fs::create_dir(staging.path().join(GROWING)).map_err(named)?;
        Ok(Self { asked, path, existing, staging, files: Files::default() })
    }

    /// Moves the package into place. Files of an existing package are removed; the user's files in it are carried over.
    ///
    /// # Errors
    /// [`ExportError::NotEmpty`] and [`ExportError::NotOurs`] if something else appeared there in the meantime,
    /// [`ExportError::InTheWay`] if a file of the user has the name of one of the package, and if the disk fails; whatever
    /// was there is unchanged.
    pub fn finish(mut self) -> Result<Files, ExportError> {
        // Another run that replaced the package after its manifest was read would have its files taken for the user's.
        let _lock = self.staging.lock_parent();
        check_vacant(&self.asked, self.existing)?;
        match is_occupied(&self.path) {
            true => self.replace()?,
            false => self.publish()?,
        }
        Ok(std::mem::take(&mut self.files))
    }

    /// Fails if the path was taken since the check.
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
        user_files::carry_over(&self.asked, &own, &self.growing())?;
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

/// Whether the folder contains a manifest of ours; other programs have a `manifest.json` too.
fn is_package(path: &Path) -> bool {
    manifest_of(path).is_some_and(|text| manifest::is_ours(&text))
}

fn manifest_of(path: &Path) -> Option<Vec<u8>> {
    regular::open_no_follow(&path.join(MANIFEST)).and_then(|file| regular::read_at_most(file, MOST_MANIFEST_BYTES)).ok()
}

fn is_occupied(path: &Path) -> bool {
    fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some())
}

/// The path without links, dots and trailing slashes, so that appending a suffix gives a sibling.
fn place(path: &Path) -> io::Result<PathBuf> {
    match path.canonicalize() {
        Ok(path) => Ok(path),
        Err(_) => std::path::absolute(path.components().collect::<PathBuf>()),
    }
}
