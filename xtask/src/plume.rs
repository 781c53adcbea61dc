//! The `plume` binary of this tree.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::tools::{Result, root, run};

/// A built `plume`.
pub struct Plume {
    program: PathBuf,
}

impl Plume {
    /// Builds it, optimised.
    pub fn build() -> Result<Self> {
        eprintln!("building plume");
        run(cargo().args(["build", "--release", "--quiet", "--package", "plume"]))?;
        Ok(Self { program: root().join("target/release/plume") })
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
