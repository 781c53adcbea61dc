//! The `plume` of this tree: the binary, or the command of the Python package.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::tools::{Result, root, run};
use crate::venv::Environment;

/// How it is compiled.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// Like the tests, so that nothing is compiled twice: optimised, but with debug assertions.
    Dev,
    /// Like the binary that users install.
    Release,
}

impl Profile {
    fn arguments(self) -> &'static [&'static str] {
        match self {
            Self::Dev => &[],
            Self::Release => &["--release"],
        }
    }

    fn folder(self) -> PathBuf {
        root().join("target").join(match self {
            Self::Dev => "debug",
            Self::Release => "release",
        })
    }

    /// Builds all binaries of the workspace and returns the path of one. Cargo unifies features over everything it builds at
    /// once, so building only one would compile its dependencies again with other features.
    pub fn program(self, name: &str) -> Result<PathBuf> {
        eprintln!("building {name}");
        run(cargo().args(["build", "--workspace", "--bins", "--quiet"]).args(self.arguments()))?;
        Ok(self.folder().join(name))
    }

    /// Likewise for an example.
    pub fn example(self, name: &str) -> Result<PathBuf> {
        eprintln!("building {name}");
        run(cargo().args(["build", "--workspace", "--example", name, "--quiet"]).args(self.arguments()))?;
        Ok(self.folder().join("examples").join(name))
    }
}

/// A built `plume`.
pub struct Plume {
    program: PathBuf,
}

impl Plume {
    /// Builds it.
    pub fn build(profile: Profile) -> Result<Self> {
        Ok(Self { program: profile.program("plume")? })
    }

    /// Builds the Python package into `.venv` with everything that its `plume` command needs.
    pub fn package(profile: Profile) -> Result<Self> {
        let environment = Self::python()?;
        eprintln!("building the Python package");
        let mut maturin = Command::new(environment.program("maturin"));
        // The features that the rest of the workspace is built with.
        let features = "plume/default,plume-cli/default,plume-exporters/default";
        let develop = ["develop", "--locked", "--quiet", "--extras", "usd", "--features", features];
        let maturin = maturin.args(develop).args(profile.arguments()).current_dir(root());
        // Maturin looks for the environment of the user first.
        run(maturin.env_remove("CONDA_PREFIX").env("VIRTUAL_ENV", root().join(".venv")))?;
        Ok(Self { program: environment.program("plume") })
    }

    /// The tool that builds the Python package.
    pub fn python() -> Result<Environment> {
        Environment::of_project()?.with(&["python/requirements.txt"])
    }

    /// Where it is.
    pub fn program(&self) -> &Path {
        &self.program
    }

    /// Runs it in the workspace with visible output.
    pub fn show(&self, arguments: &[&str]) -> Result<()> {
        let status = Command::new(&self.program).args(arguments).current_dir(root()).status();
        match status {
            Ok(status) if status.success() => Ok(()),
            Ok(status) => Err(format!("`plume {}`: {status}", arguments.join(" "))),
            Err(error) => Err(format!("cannot run `plume`: {error}")),
        }
    }

    /// Runs it in the workspace and returns its stdout.
    pub fn output(&self, arguments: &[&str]) -> Result<String> {
        run(Command::new(&self.program).args(arguments).current_dir(root()))
    }
}

/// Cargo in the workspace.
pub fn cargo() -> Command {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.current_dir(root());
    cargo
}
