//! The disk and programs, as generators and readers get them.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::program;
use crate::graph::{Outside, RunError, Task};

/// The disk alone.
#[derive(Clone, Copy, Debug)]
pub struct Disk;

/// The disk, and programs that run until `stop` is set.
#[derive(Clone, Copy, Debug)]
pub struct Machine<'a> {
    /// Set to stop a program that runs.
    pub stop: &'a AtomicBool,
}

/// A graph or survey larger than this is none.
const MAX_BYTES: u64 = 1 << 30;

impl Outside for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        File::open(path)?.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, "is larger than 1 GiB"));
        }
        Ok(bytes)
    }

    fn run(&self, _: &Task) -> Result<Vec<u8>, RunError> {
        Err(RunError {
            message: "the recipe wants to run this program, and programs are not allowed".to_owned(),
            hint: "if you trust the recipe and the program, add --allow-run".to_owned(),
        })
    }
}

impl Outside for Machine<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        Disk.read(path)
    }

    fn run(&self, task: &Task) -> Result<Vec<u8>, RunError> {
        program::run(task, self.stop)
    }
}
