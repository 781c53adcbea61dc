//! Access to files and programs for generators and readers.

use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::atomic::AtomicBool;

use plume_disk::regular;

use super::{PipelineError, program};
use plume_graph::{Outside, RunError, Task};
use plume_survey::{Import, Parts};

/// Access to files only: regular ones, since a pipe may block and a device may never end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk {
    /// Whether files may refer to files outside their own folder.
    pub allows_outside_files: bool,
}

/// Access to files, and to programs that run until `stop` is set.
#[derive(Clone, Copy, Debug)]
pub struct Machine<'a> {
    /// The disk.
    pub disk: Disk,
    /// Set to stop a program that runs.
    pub stop: &'a AtomicBool,
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

    fn run(&self, task: &Task) -> Result<Vec<u8>, RunError> {
        program::run(task, self.stop)
    }
}
