//! The Python package `plume`, if installed.

use std::path::{Path, PathBuf};

use crate::program::{Call, Outcome};

/// Reads all arrays of a cave folder.
const OPEN: &str = "import sys, plume
cave = plume.open(sys.argv[1])
for chunk in cave.chunks:
    chunk.positions, chunk.normals, chunk.indices, chunk.collision.indices, chunk.textures.base_color
";

/// A Python interpreter that has the package.
pub struct Python(PathBuf);

impl Python {
    /// The interpreter in the `.venv` of the repository.
    pub fn find(repository: &Path) -> Option<Self> {
        let python = repository.join(".venv/bin/python");
        let has_plume = python.exists() && Call::new(&python, &["-c", "import plume"], repository).run().is_done();
        has_plume.then_some(Self(python))
    }

    /// Opens a cave folder and reads all its arrays.
    pub fn open(&self, folder: &Path, cave: &str) -> Outcome {
        Call::new(&self.0, &["-c", OPEN, cave], folder).run()
    }
}

/// The message if no such interpreter exists.
pub const MISSING: &str = "Python: .venv has no package plume";
