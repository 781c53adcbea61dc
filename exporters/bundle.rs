//! Packages as one file.
//!
//! Entries have no time and come in the order in which they are written, so that the same scene gives the same bytes.

use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use crate::error::{ExportError, at};
use crate::package::{self, Existing, Files, MANIFEST, Package};

/// A kind of file that holds a package.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bundle {
    /// MuJoCo's archive: a zip whose model is called `model.xml`.
    Mjz,
}

impl Bundle {
    /// Every kind.
    pub const ALL: [Self; 1] = [Self::Mjz];

    /// What the user types, and the extension of the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mjz => "mjz",
        }
    }

    /// The file that `output` becomes: the extension is added where it is not there yet.
    pub fn file(self, output: &Path) -> PathBuf {
        match output.extension().is_some_and(|extension| extension == self.name()) {
            true => output.to_owned(),
            false => package::with_suffix(output, &format!(".{}", self.name())),
        }
    }
}

/// A zip file. It grows in `<path>.partial`; [`Archive::finish`] gives it its name, and dropping an unfinished one removes
/// it.
#[derive(Debug)]
pub struct Archive {
    kind: Bundle,
    path: PathBuf,
    partial: PathBuf,
    zip: Option<ZipWriter<BufWriter<File>>>,
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
        Ok(Self { kind, path, partial, zip: Some(ZipWriter::new(BufWriter::new(file))), files: Files::default() })
    }

    /// Writes the manifest and moves the archive to its place.
    ///
    /// # Errors
    /// When the disk refuses; then the partial file is removed.
    pub fn finish(mut self) -> Result<Files, ExportError> {
        (&mut self as &mut dyn Package).write_manifest()?;
        if let Some(zip) = self.zip.take() {
            let done = zip.finish().map_err(io::Error::from).and_then(|mut file| file.flush());
            let done = done.and_then(|()| fs::rename(&self.partial, &self.path));
            if let Err(error) = done {
                self.remove();
                return Err(at(self.path.display(), &error).into());
            }
        }
        Ok(std::mem::take(&mut self.files))
    }

    /// The export has already failed: a second error here would hide the first.
    fn remove(&self) {
        let _ = fs::remove_file(&self.partial);
    }
}

impl Package for Archive {
    fn open(&mut self, path: &str) -> io::Result<Box<dyn Write + '_>> {
        let zip = self.zip.as_mut().expect("an archive that is written to is not finished");
        zip.start_file(path, options(path))?;
        Ok(Box::new(zip))
    }

    fn scratch(&mut self) -> io::Result<TempDir> {
        let folder = self.path.parent().unwrap_or(&self.path);
        tempfile::tempdir_in(folder).map_err(|error| at(folder.display(), &error))
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
        if self.zip.is_some() {
            self.remove();
        }
    }
}

/// Images are compressed already. The time is that of no file: 1980, the first that a zip can say.
fn options(path: &str) -> SimpleFileOptions {
    let method = match path.ends_with(".png") || path.ends_with(".jpg") {
        true => CompressionMethod::Stored,
        false => CompressionMethod::Deflated,
    };
    let options = SimpleFileOptions::default().compression_method(method);
    options.last_modified_time(zip::DateTime::default()).unix_permissions(0o644)
}

/// Whether the file is a zip with a list of files such as ours.
fn is_archive(path: &Path) -> bool {
    let Some(mut zip) = File::open(path).ok().and_then(|file| ZipArchive::new(file).ok()) else { return false };
    let mut text = Vec::new();
    let read = zip.by_name(MANIFEST).is_ok_and(|mut manifest| manifest.read_to_end(&mut text).is_ok());
    read && package::is_manifest(&text)
}
