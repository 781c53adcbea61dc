//! `cargo xtask realism [SEEDS]`: how closely the graphs of every generator resemble real caves, as tables for `docs/realism.md`.

use crate::plume::cargo;
use crate::tools::Result;

/// Prints the tables.
pub fn run(arguments: &[String]) -> Result<()> {
    let example = ["run", "--release", "--quiet", "--package", "plume-caves", "--example", "realism", "--"];
    match cargo().args(example).args(arguments).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("the example `realism`: {status}")),
        Err(error) => Err(format!("cannot run cargo: {error}")),
    }
}
