//! What recordings are held to: see `tests/python/test_record_checks.py`.

use crate::tools::Result;
use crate::venv::Environment;

/// Installs it.
pub fn make() -> Result<()> {
    Environment::of_project()?.with(&["tests/interop/record/requirements.txt"]).map(drop)
}
