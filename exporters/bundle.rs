//! Packages as one file.
//!
//! Entries have no time and no owner and come in the order in which they are written, on one thread, so that the same scene
//! gives the same bytes. Paths are those of the folder; an archive has no folder round them, but for `tgz`, where the Unity
//! Package Manager wants `package/`.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::contents::Contents;
use crate::error::{ExportError, at};
use crate::manifest;
use crate::package::{self, Existing, Files, MANIFEST, Package};

use self::pack::{Packer, Sink};

mod pack;

/// A kind of file that holds a package.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bundle {
    /// A zip: opened by everything.
    Zip,
    /// A tar, compressed by Zstandard: smaller.
    TarZst,
    /// A tar, compressed by gzip, all of it below `package/`: what npm and the Unity Package Manager install.
    Tgz,
    /// MuJoCo's archive: a zip whose model is called `model.xml`.
    Mjz,
}

impl Bundle {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Zip, Self::TarZst, Self::Tgz, Self::Mjz];

    /// Kinds that hold a package of any target.
    pub const COMMON: [Self; 2] = [Self::Zip, Self::TarZst];

    /// What the user types, and the extension of the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Zip => "zip",
            Self::TarZst => "tar.zst",
            Self::Tgz => "tgz",
            Self::Mjz => "mjz",
        }
    }

    /// The file that `output` becomes: the extension is added where it is not there yet.
    pub fn file(self, output: &Path) -> PathBuf {
        let extension = format!(".{}", self.name());
        match output.as_os_str().as_encoded_bytes().ends_with(extension.as_bytes()) {
            true => output.to_owned(),
            false => package::with_suffix(output, &extension),
        }
    }
}

/// An archive. It grows in `<path>.partial`; [`Archive::finish`] gives it its name, and dropping an unfinished one removes
/// it.
pub struct Archive {
    kind: Bundle,
    path: PathBuf,
    partial: PathBuf,
    packer: Option<Packer>,
    files: Files,
}

impl Archive {
    /// Whether an archive can be made at `path`: asked before the long work.
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
        let path = std::path::absolute(path)?;
        let partial = package::with_suffix(&path, ".partial");
        fs::create_dir_all(path.parent().unwrap_or(&path)).map_err(|error| at(path.display(), &error))?;
        let file = File::create(&partial).map_err(|error| at(partial.display(), &error))?;
        let packer = Packer::new(kind, Sink::new(file)).map_err(|error| at(partial.display(), &error))?;
        Ok(Self { kind, path, partial, packer: Some(packer), files: Files::default() })
    }

    /// Moves the archive to its place.
    ///
    /// # Errors
    /// When the disk refuses; then the partial file is removed.
    pub fn finish(mut self) -> Result<Files, ExportError> {
        if let Some(packer) = self.packer.take() {
            let done = packer.finish().and_then(Sink::finish);
            let done = done.and_then(|()| fs::rename(&self.partial, &self.path));
            if let Err(error) = done {
                self.remove();
                return Err(at(self.path.display(), &error).into());
            }
        }
        Ok(std::mem::take(&mut self.files))
    }

    fn packer(&mut self) -> &mut Packer {
        self.packer.as_mut().expect("an archive that is written to is not finished")
    }

    fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(&self.path)
    }

    /// The export has already failed: a second error here would hide the first.
    fn remove(&self) {
        let _ = fs::remove_file(&self.partial);
    }
}

impl Package for Archive {
    fn open(&mut self, path: &str) -> io::Result<Box<dyn Write + '_>> {
        let folder = self.folder().to_owned();
        self.packer().open(path, &folder)
    }

    fn close(&mut self) -> io::Result<()> {
        self.packer().close()
    }

    fn scratch(&mut self) -> io::Result<TempDir> {
        tempfile::tempdir_in(self.folder()).map_err(|error| at(self.folder().display(), &error))
    }

    fn files(&mut self) -> &mut Files {
        &mut self.files
    }

    fn bundle(&self) -> Option<Bundle> {
        Some(self.kind)
    }
}

impl Drop for Archive {
    fn drop(&mut self) {
        if self.packer.is_some() {
            self.remove();
        }
    }
}

/// Whether the file is an archive with a manifest of ours.
fn is_archive(path: &Path) -> bool {
    let text = Contents::open(path).and_then(|contents| contents.text_of(MANIFEST));
    text.is_ok_and(|text| text.is_some_and(|text| manifest::is_ours(&text)))
}
