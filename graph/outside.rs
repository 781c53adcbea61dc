//! The world outside a graph: files and programs. Whoever wants a graph made answers for it.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Answers when a generator or a reader asks for a file or a program.
pub trait Outside: Sync {
    /// The whole file.
    ///
    /// # Errors
    /// When it cannot be read, or is larger than the outside allows.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;

    /// Whether a file lies below a folder, wherever links lead. Where files have no places, all do.
    fn is_below(&self, _folder: &Path, _path: &Path) -> bool {
        true
    }

    /// Whether a file may name files that do not lie below its folder.
    fn allows_strays(&self) -> bool {
        false
    }

    /// Runs a program to its end and gives what it wrote to standard output.
    ///
    /// # Errors
    /// When programs are not allowed, as they are not unless said otherwise; when it does not start, fails, takes too long or
    /// writes too much.
    fn run(&self, _task: &Task) -> Result<Vec<u8>, RunError> {
        Err(RunError { message: "programs cannot be run here".to_owned(), hint: String::new() })
    }
}

/// A program to be run.
#[derive(Clone, Debug)]
pub struct Task {
    /// The program.
    pub program: PathBuf,
    /// Its arguments.
    pub arguments: Vec<String>,
    /// The folder it runs in.
    pub folder: PathBuf,
    /// Names of variables that it sees beside those that any program needs.
    pub environment: Vec<String>,
    /// What it reads on standard input.
    pub input: Vec<u8>,
    /// How long it may take.
    pub limit: Duration,
    /// How much it may write to standard output.
    pub most_bytes: usize,
}

/// A program did not do what it was asked to.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct RunError {
    /// What went wrong, lower case, with the last words of the program where it had any.
    pub message: String,
    /// What to do.
    pub hint: String,
}

/// No files and no programs.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoOutside;

impl Outside for NoOutside {
    fn read(&self, _: &Path) -> io::Result<Vec<u8>> {
        Err(io::Error::new(io::ErrorKind::Unsupported, "files cannot be read here"))
    }
}
