//! The `plume` of this tree: the binary, or the command of the Python package.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::tools::{Result, root, run};
use crate::venv::Environment;

/// A built `plume`.
pub struct Plume {
    program: PathBuf,
}

impl Plume {
    /// Builds it, optimised.
    pub fn build() -> Result<Self> {
        eprintln!("building plume");
        run(cargo().args(["build", "--release", "--quiet", "--package", "plume-cli"]))?;
        Ok(Self { program: root().join("target/release/plume") })
    }

    /// Builds the Python package into `.venv`, optimised, with everything that its `plume` command needs.
    pub fn package() -> Result<Self> {
        let environment = Environment::of_project()?.with("python/requirements.txt")?;
        eprintln!("building the Python package");
        let mut maturin = Command::new(environment.program("maturin"));
        let maturin = maturin.args(["develop", "--release", "--locked", "--quiet"]).current_dir(root());
        // Maturin looks for the environment of the user first.
        run(maturin.env_remove("CONDA_PREFIX").env("VIRTUAL_ENV", root().join(".venv")))?;
        Ok(Self { program: environment.program("plume") })
    }

    /// Where it is.
    pub fn program(&self) -> &Path {
        &self.program
    }

    /// Runs it in the workspace, its progress visible.
    pub fn show(&self, arguments: &[&str]) -> Result<()> {
        let status = Command::new(&self.program).args(arguments).current_dir(root()).status();
        match status {
            Ok(status) if status.success() => Ok(()),
            Ok(status) => Err(format!("`plume {}`: {status}", arguments.join(" "))),
            Err(error) => Err(format!("cannot run `plume`: {error}")),
        }
    }

    /// Runs it in the workspace and gives its stdout.
    pub fn output(&self, arguments: &[&str]) -> Result<String> {
        run(Command::new(&self.program).args(arguments).current_dir(root()))
    }

    /// Runs an example of the package, optimised, and gives its stdout.
    pub fn example(&self, name: &str, argument: &Path) -> Result<String> {
        run(cargo().args(["run", "--release", "--quiet", "--example", name, "--"]).arg(argument))
    }
}

/// Cargo in the workspace.
pub fn cargo() -> Command {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.current_dir(root());
    cargo
}
