//! The `plume` command in a separate folder.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::SystemTime;

use sha2::{Digest, Sha256};
use tempfile::TempDir;

/// Settings of a cave that is small enough for tests: about 50 m of passage.
pub const SMALL: [&str; 8] = [
    "--set",
    "graph.nodes=12",
    "--set",
    "mesh.voxel_m=0.25",
    "--set",
    "texture.size_px=256",
    "--set",
    "mesh.chunk_m=[12, 12, 12]",
];

/// A temporary folder in which commands run.
pub struct Desk {
    folder: TempDir,
}

impl Desk {
    /// An empty folder.
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    /// A path on the desk.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Puts a file on the desk.
    pub fn file(&self, name: &str, content: &str) {
        fs::write(self.path(name), content).unwrap();
    }

    /// The command with these arguments, not yet started.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_plume"));
        command.args(arguments).current_dir(self.folder.path());
        command
    }

    /// Runs the command.
    pub fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Runs the command on a small cave and expects it to work.
    pub fn make(&self, arguments: &[&str]) {
        let all: Vec<&str> = arguments.iter().chain(&SMALL).copied().collect();
        let output = self.run(&all);
        assert!(output.status.success(), "{all:?}: {}", String::from_utf8_lossy(&output.stderr));
    }

    /// Exit code and stderr of a command that must fail.
    pub fn fault(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let stderr = String::from_utf8(output.stderr).unwrap();
        format!("exit {}\n{stderr}", output.status.code().unwrap())
    }

    /// Names and times of change of all files below a folder of the desk.
    pub fn times(&self, name: &str) -> Vec<(PathBuf, SystemTime)> {
        let changed = |path: PathBuf| (path.clone(), fs::metadata(path).unwrap().modified().unwrap());
        let mut times: Vec<_> = files(&self.path(name)).into_iter().map(changed).collect();
        times.sort();
        times
    }

    /// Names and hashes of all files below a folder of the desk.
    pub fn hashes(&self, name: &str) -> Vec<(String, String)> {
        let root = self.path(name);
        let mut hashes: Vec<_> = files(&root)
            .into_iter()
            .map(|path| {
                let digest = Sha256::digest(fs::read(&path).unwrap());
                let hex = digest.iter().map(|byte| format!("{byte:02x}")).collect();
                (path.strip_prefix(&root).unwrap().display().to_string(), hex)
            })
            .collect();
        hashes.sort();
        hashes
    }
}

/// All files below a folder.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}
