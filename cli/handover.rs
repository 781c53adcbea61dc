//! From the binary, which has no Python inside, to the `plume` command of a Python with the same version of Plume.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use plume_exporters::ExportError;

use super::fault::CliError;
use plume::VERSION;

/// Names the Python to hand over to; takes precedence over all others.
const VARIABLE: &str = "PLUME_PYTHON";
/// Number of parent folders searched for `.venv`: `target/release/plume` is three levels below a workspace.
const FOLDERS_ABOVE: usize = 4;
/// Prints the version of Plume in this Python, or why there is none that can do it. Finds the module that does it without
/// loading it, wherever it comes from.
const PROBE: &str = "
try:
    import importlib.util, sys, plume
    if importlib.util.find_spec(sys.argv[1]) is None:
        raise ModuleNotFoundError(f'No module named {sys.argv[1]!r}')
    print(plume.__version__)
except Exception as error:
    print('!', error)
";

/// What only the Python package can do.
pub enum Need {
    /// A target that is written by a USD library.
    Usd(&'static str),
    /// Tasks of Ray.
    Ray,
    /// File systems of fsspec.
    Publish,
}

impl Need {
    fn reason(&self) -> String {
        match self {
            Self::Usd(target) => format!("target `{target}` is written by the Python package usd-core"),
            Self::Ray => "the engine ray is the Python package ray".to_owned(),
            Self::Publish => "datasets are published by the Python package fsspec".to_owned(),
        }
    }

    /// The module that does it.
    fn module(&self) -> &'static str {
        match self {
            Self::Usd(_) => "pxr",
            Self::Ray => "ray",
            Self::Publish => "fsspec",
        }
    }

    /// The extra of the Python package that installs this module.
    fn extra(&self) -> &'static str {
        match self {
            Self::Usd(_) => "usd",
            Self::Ray => "ray",
            Self::Publish => "publish",
        }
    }
}

/// Runs the same command line in a Python that can do it. On Unix that replaces this process; elsewhere its exit code is
/// returned.
///
/// # Errors
/// [`ExportError::MissingPart`], which lists every place searched.
pub fn to_python(need: &Need, arguments: &[OsString]) -> Result<u8, CliError> {
    let mut looked = String::new();
    for candidate in candidates() {
        match probe(&candidate.python, need.module()) {
            Ok(()) => return replace(&candidate.python, arguments.get(1..).unwrap_or_default()),
            Err(reason) => {
                looked.push_str(&format!("\n  {} ({}): {reason}", candidate.origin, candidate.python.display()));
            }
        }
    }
    Err(ExportError::MissingPart {
        message: format!(
            "{}, and no Python was found that has it together with plume {VERSION}; looked at{looked}",
            need.reason()
        ),
        hint: format!(
            "`pip install '.[{}]'` in the sources of plume {VERSION}, then run that Python's `plume`, or name it in {VARIABLE}",
            need.extra()
        ),
    }
    .into())
}

/// A Python that may have Plume, and how it was found.
struct Candidate {
    origin: String,
    python: PathBuf,
}

/// Only the Python named by the variable if it is set; otherwise the active environment, those near the program, and the
/// one on the path.
fn candidates() -> Vec<Candidate> {
    if let Some(python) = std::env::var_os(VARIABLE) {
        return vec![Candidate { origin: VARIABLE.to_owned(), python: python.into() }];
    }
    let active = ["VIRTUAL_ENV", "CONDA_PREFIX"].into_iter().filter_map(|variable| {
        let folder = PathBuf::from(std::env::var_os(variable)?);
        Some(Candidate { origin: variable.to_owned(), python: python_of(&folder) })
    });
    let program = std::env::current_exe().and_then(|program| program.canonicalize()).unwrap_or_default();
    let around = program.ancestors().skip(1).take(FOLDERS_ABOVE).filter_map(|folder| {
        let environment = folder.join(".venv");
        let candidate = Candidate { origin: "near the program".to_owned(), python: python_of(&environment) };
        environment.is_dir().then_some(candidate)
    });
    let on_path = Candidate { origin: "on the path".to_owned(), python: "python3".into() };
    active.chain(around).chain([on_path]).collect()
}

fn python_of(environment: &Path) -> PathBuf {
    environment.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" })
}

/// Whether this Python has our version and `module`; if not, why not.
fn probe(python: &Path, module: &str) -> Result<(), String> {
    let output = Command::new(python).args(["-c", PROBE, module]).output().map_err(|error| error.to_string())?;
    match String::from_utf8_lossy(&output.stdout).trim() {
        VERSION => Ok(()),
        "" => Err(format!("it failed with {}", output.status)),
        other => Err(match other.strip_prefix("! ") {
            Some(reason) => reason.to_owned(),
            None => format!("it has plume {other}"),
        }),
    }
}

#[cfg(unix)]
fn replace(python: &Path, arguments: &[OsString]) -> Result<u8, CliError> {
    use std::os::unix::process::CommandExt;
    let source = Command::new(python).args(["-m", "plume"]).args(arguments).exec();
    Err(CliError::Input { path: python.to_owned(), source })
}

#[cfg(not(unix))]
fn replace(python: &Path, arguments: &[OsString]) -> Result<u8, CliError> {
    let status = Command::new(python).args(["-m", "plume"]).args(arguments).status();
    let status = status.map_err(|source| CliError::Input { path: python.to_owned(), source })?;
    Ok(status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(1))
}
