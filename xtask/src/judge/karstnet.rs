//! The program by whose numbers real caves are known, on our graphs.

use std::process::Command;

use crate::plume::Plume;
use crate::tools::{Result, root, run};
use crate::venv::Environment;

/// Measures the same graphs with `plume measure` and karstnet.
pub(super) fn agree() -> Result<String> {
    let environment = Environment::apart("karstnet")?.with("tests/judges/graph/requirements-karstnet.txt")?;
    let plume = Plume::build()?;
    let script = root().join("tests/judges/graph/karstnet_agrees.py");
    run(Command::new(environment.python()).arg(script).arg(plume.program()))
}
