//! Where recordings are made: caves, paths and runs, each unless it is there.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::plume::{Plume, Profile};
use crate::tools::{Result, root, run};
use crate::venv::Environment;

/// A cave: its name, and what `plume generate` is told.
pub struct Cave {
    name: &'static str,
    arguments: &'static str,
}

impl Cave {
    /// Arguments are separated by spaces.
    pub const fn new(name: &'static str, arguments: &'static str) -> Self {
        Self { name, arguments }
    }

    /// As files and folders are called.
    pub fn name(&self) -> &str {
        self.name
    }
}

/// The folder for them all, and what makes them.
pub struct Studio {
    plume: Plume,
    environment: Environment,
    folder: PathBuf,
}

impl Studio {
    /// Builds and installs what it needs.
    pub fn open() -> Result<Self> {
        let environment = Environment::apart("slam")?.with(&["tests/interop/slam/requirements.txt"])?;
        let folder = root().join("target/vslam");
        for name in ["caves", "paths", "runs", "results", "strips"] {
            let folder = folder.join(name);
            fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        }
        Ok(Self { plume: Plume::build(Profile::Dev)?, environment, folder })
    }

    /// A file or folder in it.
    pub fn place(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// A script of `tests/interop/slam`.
    pub fn script(&self, name: &str) -> Command {
        let mut command = Command::new(self.environment.python());
        command.arg(root().join("tests/interop/slam").join(name));
        command
    }

    /// The lap of a cave: see `lap.py`.
    pub fn lap(&self, cave: &Cave) -> Result<PathBuf> {
        let lap = self.place(&format!("paths/{}.lap.tum", cave.name));
        if !lap.exists() {
            let path = self.path(cave, "loop")?;
            run(self.script("lap.py").args([&path, &lap]))?;
        }
        Ok(lap)
    }

    /// A path through a cave for a level camera, half a metre over the floor.
    pub fn path(&self, cave: &Cave, kind: &str) -> Result<PathBuf> {
        let path = self.place(&format!("paths/{}.{kind}.tum", cave.name));
        if !path.exists() {
            let places = [&self.cave(cave)?, &path].map(|place| place.to_string_lossy().into_owned());
            let [cave, path] = &places;
            let carried = ["--kind", kind, "--height", "0.5", "--speed", "1.0", "--quiet"];
            self.plume.show(&[&["path", cave], &carried[..], &["-o", path]].concat())?;
        }
        Ok(path)
    }

    /// What a rig records in a cave along a path.
    pub fn record(&self, cave: &Cave, path: &Path, rig: &str) -> Result<PathBuf> {
        let run = self.place(&format!("runs/{}-{}", cave.name, name_of(rig)));
        if !run.exists() {
            let places = [&self.cave(cave)?, path, &run].map(|place| place.to_string_lossy().into_owned());
            let [cave, path, run] = &places;
            self.plume.show(&["record", cave, "--path", path, "--rig", rig, "--quiet", "-o", run])?;
        }
        Ok(run)
    }

    /// The folder of a cave; one that was left unfinished is finished.
    fn cave(&self, cave: &Cave) -> Result<PathBuf> {
        let folder = self.place(&format!("caves/{}", cave.name));
        let output = folder.to_string_lossy();
        let mut command = vec!["generate", "--quiet", "-o", &output];
        command.extend(cave.arguments.split(' '));
        self.plume.show(&command)?;
        Ok(folder)
    }
}

/// The name of a rig, which may be a file.
fn name_of(rig: &str) -> String {
    Path::new(rig).file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}
