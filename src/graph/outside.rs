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

    /// Runs a program to its end and gives what it wrote to standard output.
    ///
    /// # Errors
    /// When programs are not allowed, it does not start, fails, takes too long or writes too much; the text says which.
    fn run(&self, task: &Task) -> Result<Vec<u8>, String>;
}

/// A program to be run.
#[derive(Clone, Debug)]
pub struct Task {
    /// The program.
    pub program: PathBuf,
    /// Its arguments.
    pub arguments: Vec<String>,
    /// What it reads on standard input.
    pub input: Vec<u8>,
    /// How long it may take.
    pub limit: Duration,
    /// How much it may write to standard output.
    pub most_bytes: usize,
}

/// No files and no programs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nowhere;

impl Outside for Nowhere {
    fn read(&self, _: &Path) -> io::Result<Vec<u8>> {
        Err(io::Error::new(io::ErrorKind::Unsupported, "files cannot be read here"))
    }

    fn run(&self, _: &Task) -> Result<Vec<u8>, String> {
        Err("programs cannot be run here".to_owned())
    }
}
