//! Whether a package is intact: the checks of `plume check`.
//!
//! Every file has the size and hash recorded in the manifest, and there are no others; every file parses as the format that
//! its extension names; every reference leads to a file of the package; there are as many things as the manifest says. Nothing
//! is unpacked to the disk, and nothing is trusted ([`contents`]). Not checked: who made it (the seal is not a signature), and
//! whether a simulator accepts it.
//!
//! [`contents`]: crate::contents
//!
//! ```
//! use plume_exporters::check::check;
//!
//! let folder = tempfile::tempdir()?;
//! assert!(check(folder.path()).is_err(), "an empty folder is not a package");
//! # Ok::<(), std::io::Error>(())
//! ```

use std::collections::BTreeSet;
use std::io::{self, Read};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use plume_disk::sealed;
use serde::Serialize;

use crate::contents::{Contents, Visitor, WHOLE};
use crate::manifest::{self, FORMAT, Head, Manifest};
use crate::package::MANIFEST;

use self::content::Content;
use self::found::Found;

mod chunks;
mod content;
mod found;
mod readers;
mod things;

/// Maximum number of faults reported; a package that has more is beyond repair.
const MOST_FAULTS: usize = 1000;

/// What was found.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Report {
    /// The target, according to the package; empty if its manifest cannot be read.
    pub target: String,
    /// The program that made it, according to the package.
    pub generator: String,
    /// SHA-256 of everything that it follows from; empty if the package does not say.
    pub fingerprint: String,
    /// Number of files, including the manifest.
    pub files: usize,
    /// Total size of its files, according to the manifest.
    pub bytes: u64,
    /// What is wrong, by path; empty if the package is intact.
    pub faults: Vec<Fault>,
}

/// Something that is wrong with a package.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Fault {
    /// The path in the package; `.` for the package itself.
    pub path: String,
    /// What is wrong, as the predicate of a sentence whose subject is the path.
    pub what: String,
}

/// Why a package could not be checked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckError {
    /// The folder or file cannot be read.
    #[error("{}: {source}", path.display())]
    Unreadable {
        /// The folder or file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// The folder or archive is not a package.
    #[error("{}: contains no package manifest", path.display())]
    NotAPackage {
        /// The folder or archive.
        path: PathBuf,
    },
    /// The package was made by a later version.
    #[error("{}: this package was made by {generator}; its manifest has format {format}, this program supports {FORMAT}", path.display())]
    Newer {
        /// The folder or archive.
        path: PathBuf,
        /// What made it.
        generator: String,
        /// Format of its manifest.
        format: u32,
    },
    /// The package was made by an earlier version.
    #[error("{}: this package was made by an earlier version, whose manifest lacks what a check needs", path.display())]
    Older {
        /// The folder or archive.
        path: PathBuf,
    },
}

impl CheckError {
    /// What to do about it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Unreadable { .. } => "name a folder written by `plume export`, or a zip, mjz, tar.zst or tgz of one",
            Self::NotAPackage { .. } => "name a package written by `plume export`",
            Self::Newer { .. } => "upgrade plume",
            Self::Older { .. } => "export the package again",
        }
    }
}

/// Checks the package at `path`, a folder or an archive.
///
/// # Errors
/// If it is not a package of this version. Faults in a package are not errors; they are in the report.
pub fn check(path: &Path) -> Result<Report, CheckError> {
    let unreadable = |source| CheckError::Unreadable { path: path.to_owned(), source };
    let contents = Contents::open(path).map_err(unreadable)?;
    let text = match contents.text_of(MANIFEST) {
        Ok(text) => text.ok_or_else(|| CheckError::NotAPackage { path: path.to_owned() })?,
        Err(error) if is_of_the_system(&error) => return Err(unreadable(error)),
        Err(error) => return Ok(Report::broken(WHOLE, format!("cannot be read: {error}"))),
    };
    check_version(path, &text)?;
    let manifest = match Manifest::from_text(&text) {
        Ok(manifest) => manifest,
        Err(what) => return Ok(Report::broken(MANIFEST, what)),
    };
    let mut inspection = Inspection::new(&manifest);
    if let Err(error) = contents.read(&mut inspection) {
        inspection.fault(WHOLE, &format!("cannot be read: {error}"));
    }
    Ok(inspection.report())
}

fn is_of_the_system(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::PermissionDenied)
}

/// Tells a manifest of another version from a damaged one and from a file that is not ours.
fn check_version(path: &Path, text: &[u8]) -> Result<(), CheckError> {
    let path = path.to_owned();
    match serde_json::from_slice::<Head>(text) {
        Ok(Head { format, generator, .. }) if format > FORMAT => Err(CheckError::Newer { path, generator, format }),
        Ok(Head { format, .. }) if format < FORMAT => Err(CheckError::Older { path }),
        Ok(_) => Ok(()),
        Err(_) if manifest::is_of_first_format(text) => Err(CheckError::Older { path }),
        Err(_) if sealed::looks_sealed(text) => Ok(()),
        Err(_) => Err(CheckError::NotAPackage { path }),
    }
}

impl Report {
    /// Whether nothing is wrong.
    pub fn is_whole(&self) -> bool {
        self.faults.is_empty()
    }

    /// The report on a package of which nothing but one fault is known.
    fn broken(path: &str, what: String) -> Self {
        let faults = vec![Fault { path: path.to_owned(), what }];
        Self { target: String::new(), generator: String::new(), fingerprint: String::new(), files: 0, bytes: 0, faults }
    }
}

/// A check in progress.
struct Inspection<'a> {
    manifest: &'a Manifest,
    seen: BTreeSet<String>,
    found: Found,
    faults: BTreeSet<Fault>,
}

impl<'a> Inspection<'a> {
    fn new(manifest: &'a Manifest) -> Self {
        Self { manifest, seen: BTreeSet::new(), found: Found::default(), faults: BTreeSet::new() }
    }

    /// Parses a file by its extension, and compares it with the manifest.
    fn inspect(&mut self, content: &mut Content<'_>, sha256: &str) -> Result<(), String> {
        let parsed = readers::read(content, &mut self.found);
        let (bytes, found) = content.finish().map_err(|error| format!("cannot be read: {error}"))?;
        if bytes > content.size() {
            return Err(format!("has more than the {} bytes recorded in the manifest", content.size()));
        }
        if bytes < content.size() {
            return Err(format!("has {bytes} bytes, not the {} recorded in the manifest", content.size()));
        }
        if found != sha256 {
            self.fault(content.path(), "differs from the manifest: the SHA-256 does not match");
        }
        parsed.map_err(|unfit| unfit.0)
    }

    fn report(mut self) -> Report {
        for path in self.manifest.files.0.keys().filter(|path| !self.seen.contains(*path)) {
            self.faults.insert(Fault { path: path.clone(), what: "is missing".to_owned() });
        }
        self.faults.extend(chunks::faults(self.manifest));
        self.faults.extend(self.found.faults(&self.manifest.files));
        self.faults.extend(things::faults(self.manifest.things.as_ref(), self.found.counted_things()));
        Report {
            target: self.manifest.target.clone(),
            generator: self.manifest.generator.clone(),
            fingerprint: self.manifest.fingerprint.clone(),
            files: self.manifest.files.0.len() + 1,
            bytes: self.manifest.files.bytes(),
            faults: self.faults.into_iter().take(MOST_FAULTS).collect(),
        }
    }
}

impl Visitor for Inspection<'_> {
    fn file(&mut self, path: &str, bytes: &mut dyn Read) -> ControlFlow<()> {
        if path == MANIFEST {
            return ControlFlow::Continue(());
        }
        let Some(entry) = self.manifest.files.0.get(path) else {
            self.fault(path, "is not in the manifest");
            return ControlFlow::Continue(());
        };
        self.seen.insert(path.to_owned());
        let mut content = Content::new(path, entry.bytes, bytes);
        if let Err(what) = self.inspect(&mut content, &entry.sha256) {
            self.fault(path, &what);
        }
        ControlFlow::Continue(())
    }

    fn fault(&mut self, path: &str, what: &str) {
        if self.faults.len() < MOST_FAULTS {
            self.faults.insert(Fault { path: path.to_owned(), what: what.to_owned() });
        }
    }
}
