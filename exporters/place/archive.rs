//! A package as one file.
//!
//! Entries have no time and no owner and are in the order in which they are written, on one thread, so that the same scene
//! gives the same bytes. Paths are those of the folder, without a top-level folder, except in a `tgz`, for which the Unity
//! Package Manager requires `package/`.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use plume_disk::{Existing, Staging};
use tempfile::TempDir;

use super::pack::{Packer, Sink};
use crate::bundle::Bundle;
use crate::contents::Contents;
use crate::error::{ExportError, at};
use crate::manifest;
use crate::package::{Files, MANIFEST, Package};

/// An archive. It is written in a [`Staging`] folder next to its path; [`Archive::finish`] moves it there, and dropping an
/// unfinished one removes it.
pub struct Archive {
    kind: Bundle,
    /// The path as given, for errors.
    asked: PathBuf,
    path: PathBuf,
    existing: Existing,
    staging: Staging,
    packer: Option<Packer>,
    files: Files,
}

/// The name of an archive while it is written.
const GROWING: &str = "archive";

impl Archive {
    /// Whether an archive can be made at `path`: checked before the long work.
    ///
    /// # Errors
    /// [`ExportError::FileExists`], [`ExportError::NotOurs`] and [`ExportError::NotAFile`] when something else is there.
    pub fn check(path: &Path, existing: Existing) -> Result<(), ExportError> {
        let path = path.to_owned();
        match existing {
            _ if path.is_dir() => Err(ExportError::NotAFile { path }),
            _ if !path.exists() => Ok(()),
            Existing::Keep => Err(ExportError::FileExists { path }),
            Existing::Replace if is_archive(&path) => Ok(()),
            Existing::Replace => Err(ExportError::NotOurs { path }),
        }
    }

    /// Starts an archive that will be at `path`.
    ///
    /// # Errors
    /// As [`Archive::check`]; [`ExportError::Io`] when the file cannot be made.
    pub fn create(kind: Bundle, path: &Path, existing: Existing) -> Result<Self, ExportError> {
        Self::check(path, existing)?;
        let (asked, path) = (path.to_owned(), std::path::absolute(path)?);
        let named = |error| at(asked.display(), &error);
        let staging = Staging::beside(&path).map_err(named)?;
        let file = File::create_new(staging.path().join(GROWING)).map_err(named)?;
        let packer = Packer::new(kind, Sink::new(file)).map_err(named)?;
        Ok(Self { kind, asked, path, existing, staging, packer: Some(packer), files: Files::default() })
    }

    /// Moves the archive to its place.
    ///
    /// # Errors
    /// As [`Archive::check`], if something else appeared there in the meantime, and if the disk fails; whatever was there is
    /// unchanged.
    pub fn finish(mut self) -> Result<Files, ExportError> {
        if let Some(packer) = self.packer.take() {
            packer.finish().and_then(Sink::finish).map_err(|error| at(self.asked.display(), &error))?;
        }
        Self::check(&self.asked, self.existing)?;
        let grown = self.staging.path().join(GROWING);
        let done = match self.existing {
            Existing::Keep => plume_disk::publish(&grown, &self.path),
            Existing::Replace => plume_disk::replace_file(&grown, &self.path),
        };
        done.map_err(|error| match error.kind() {
            io::ErrorKind::AlreadyExists => ExportError::FileExists { path: self.asked.clone() },
            _ => at(self.asked.display(), &error).into(),
        })?;
        Ok(std::mem::take(&mut self.files))
    }

    fn packer(&mut self) -> &mut Packer {
        self.packer.as_mut().expect("an archive that is written to is not finished")
    }
}

impl Package for Archive {
    fn open(&mut self, path: &str) -> io::Result<Box<dyn Write + '_>> {
        let folder = self.staging.path().to_owned();
        self.packer().open(path, &folder)
    }

    fn close(&mut self) -> io::Result<()> {
        self.packer().close()
    }

    fn scratch(&mut self) -> io::Result<TempDir> {
        tempfile::tempdir_in(self.staging.path()).map_err(|error| at(self.asked.display(), &error))
    }

    fn files(&mut self) -> &mut Files {
        &mut self.files
    }

    fn bundle(&self) -> Option<Bundle> {
        Some(self.kind)
    }
}

/// Whether the file is an archive with a manifest of ours.
fn is_archive(path: &Path) -> bool {
    let text = Contents::open(path).and_then(|contents| contents.text_of(MANIFEST));
    text.is_ok_and(|text| text.is_some_and(|text| manifest::is_ours(&text)))
}
