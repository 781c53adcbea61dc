//! Access to files and programs, provided by whoever asks for a graph.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Provides files and programs to generators and readers.
pub trait Outside: Sync {
    /// The content of a file.
    ///
    /// # Errors
    /// If it cannot be read, or is larger than allowed.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;

    /// Whether a file is below a folder, symlinks resolved. True by default, for implementations without folders.
    fn is_below(&self, _folder: &Path, _path: &Path) -> bool {
        true
    }

    /// Whether a file may refer to files outside its own folder.
    fn allows_outside_files(&self) -> bool {
        false
    }

    /// Tells the user of something that can be read but is probably a mistake; by default nobody is told.
    fn warn(&self, _warning: &str) {}

    /// Runs a program and returns its standard output.
    ///
    /// # Errors
    /// If programs are not allowed (the default), or it does not start, fails, takes too long or writes too much.
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
    /// Names of environment variables that it sees in addition to those that any program needs.
    pub environment: Vec<String>,
    /// What it reads on standard input.
    pub input: Vec<u8>,
    /// Time limit.
    pub limit: Duration,
    /// Most bytes that it may write to standard output.
    pub most_bytes: usize,
}

/// A program that failed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct RunError {
    /// What went wrong, lower case, with the last output of the program if there was any.
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
