//! Access to files and programs for generators and readers.

use std::collections::BTreeSet;
use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use plume_disk::regular;

use super::{Observer, PipelineError, program};
use plume_graph::{Outside, RunError, Task};
use plume_survey::{Import, Parts};

/// Access to files only: regular ones, since a pipe may block and a device may never end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk {
    /// Whether files may refer to files outside their own folder.
    pub allows_outside_files: bool,
}

/// What an observer allows: access to files, and to programs until it asks to stop. It is told of warnings, of each once.
pub struct Machine<'a> {
    disk: Disk,
    observer: &'a dyn Observer,
    told: Mutex<BTreeSet<String>>,
}

/// Most bytes of a graph or survey.
const MAX_BYTES: u64 = 1 << 30;

impl Disk {
    /// Reads a graph or a survey.
    ///
    /// # Errors
    /// If it cannot be read or is not a graph.
    pub fn graph(&self, path: &Path, parts: Parts) -> Result<Import, PipelineError> {
        Ok(plume_survey::read(path, parts, self)?)
    }
}

impl<'a> Machine<'a> {
    /// What this observer allows.
    pub fn new(observer: &'a dyn Observer) -> Self {
        let disk = Disk { allows_outside_files: observer.allows_outside_files() };
        Self { disk, observer, told: Mutex::default() }
    }
}

impl Outside for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        regular::read(path, MAX_BYTES)
    }

    fn is_below(&self, folder: &Path, path: &Path) -> bool {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        match (folder.canonicalize(), resolved(path)) {
            (Ok(folder), Some(path)) => path.starts_with(folder),
            _ => false,
        }
    }

    fn allows_outside_files(&self) -> bool {
        self.allows_outside_files
    }

    fn run(&self, _: &Task) -> Result<Vec<u8>, RunError> {
        Err(RunError {
            message: "the recipe asks to run this program, but programs are not allowed".to_owned(),
            hint: "if you trust the recipe and the program, add --allow-run".to_owned(),
        })
    }
}

/// The path with symlinks resolved. For a missing file, where it would be; `None` if that is unknown.
fn resolved(path: &Path) -> Option<PathBuf> {
    if let Ok(resolved) = path.canonicalize() {
        return Some(resolved);
    }
    if path.symlink_metadata().is_ok() {
        // A dangling link, or one into a folder that we may not read.
        return None;
    }
    let last = path.components().next_back().filter(|last| matches!(last, Component::Normal(_)))?;
    let above = path.parent()?;
    let above = if above.as_os_str().is_empty() { Path::new(".") } else { above };
    Some(resolved(above)?.join(last))
}

impl Outside for Machine<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.disk.read(path)
    }

    fn is_below(&self, folder: &Path, path: &Path) -> bool {
        self.disk.is_below(folder, path)
    }

    fn allows_outside_files(&self) -> bool {
        self.disk.allows_outside_files
    }

    fn warn(&self, warning: &str) {
        // The realism gate reads a file once per attempt.
        if self.told.lock().unwrap_or_else(PoisonError::into_inner).insert(warning.to_owned()) {
            self.observer.warn(warning);
        }
    }

    fn run(&self, task: &Task) -> Result<Vec<u8>, RunError> {
        match self.observer.allows_programs() {
            true => program::run(task, self.observer.stop()),
            false => self.disk.run(task),
        }
    }
}
