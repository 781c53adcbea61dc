//! A separate folder for each attempt.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::program::{Call, Outcome};
use crate::tree::{self, Tree};

/// A temporary folder in which commands run. It goes with all it holds.
pub struct Desk {
    plume: PathBuf,
    folder: TempDir,
}

impl Desk {
    /// An empty one in `scratch`, except for the folder `tmp` for temporary files of commands.
    pub fn new(plume: &Path, scratch: &Path) -> Self {
        let folder = tempfile::Builder::new().prefix("try").tempdir_in(scratch).expect("a folder can be made");
        fs::create_dir(folder.path().join("tmp")).expect("a folder can be made");
        Self { plume: plume.to_owned(), folder }
    }

    /// A path here.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Everything here.
    pub fn tree(&self) -> Tree {
        Tree::of(self.folder.path())
    }

    /// Everything in a folder here.
    pub fn tree_of(&self, name: &str) -> Tree {
        Tree::of(&self.path(name))
    }

    /// Writes a file and the folders above it.
    pub fn file(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("it lies on the desk")).expect("a folder can be made");
        fs::write(path, content).expect("a file can be written");
    }

    /// Replaces what is there with a link to `target`.
    pub fn link(&self, name: &str, target: impl AsRef<Path>) {
        let path = self.path(name);
        let _ = fs::remove_file(&path).or_else(|_| fs::remove_dir_all(&path));
        std::os::unix::fs::symlink(target, path).expect("a link can be made");
    }

    /// Copies a folder here.
    pub fn copy(&self, from: &Path, name: &str) {
        tree::copy(from, &self.path(name)).expect("a folder can be copied");
    }

    /// The command with these arguments, not yet started.
    pub fn call(&self, arguments: &[&str]) -> Call {
        Call::new(&self.plume, arguments, self.folder.path())
    }

    /// Runs the command.
    pub fn run(&self, arguments: &[&str]) -> Outcome {
        self.call(arguments).run()
    }

    /// Runs another program.
    pub fn run_other(&self, program: &str, arguments: &[&str]) -> Outcome {
        Call::new(Path::new(program), arguments, self.folder.path()).run()
    }

    /// Whether the package at `name` is intact.
    pub fn check(&self, name: &str) -> Result<(), String> {
        self.run(&["check", name]).done()
    }
}
