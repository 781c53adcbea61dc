//! The Python environment of the project, `.venv`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::tools::{Result, root, run};

/// A Python that has what the file `requirements` of the workspace lists; made and filled when needed.
pub fn python(requirements: &str) -> Result<PathBuf> {
    let venv = root().join(".venv");
    let python = venv.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    if !python.exists() {
        eprintln!("making {}", venv.display());
        run(Command::new("python3").args(["-m", "venv"]).arg(&venv))?;
    }
    install(&python, &venv, &root().join(requirements))?;
    Ok(python)
}

/// A copy of the list stays in the environment, so that nothing is asked of the network twice.
fn install(python: &Path, venv: &Path, requirements: &Path) -> Result<()> {
    let wanted = fs::read_to_string(requirements).map_err(|error| format!("{}: {error}", requirements.display()))?;
    let slug = requirements.to_string_lossy().replace(['/', '\\', ':'], "-");
    let stamp = venv.join(format!("installed{slug}"));
    if fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted) {
        return Ok(());
    }
    eprintln!("installing {}", requirements.display());
    run(Command::new(python).args(["-m", "pip", "install", "-q", "-r"]).arg(requirements))?;
    fs::write(stamp, wanted).map_err(|error| error.to_string())
}
