//! Python environments: `.venv` for the package and its tests, and others for readers that need a separate one.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::tools::{Result, root, run};

/// Versions of Python that all pinned packages have wheels for: from the first, before the second.
const VERSIONS: [u32; 2] = [11, 15];

/// A virtual environment.
pub struct Environment(PathBuf);

impl Environment {
    /// `.venv`, the environment of the Python package, created on demand.
    pub fn of_project() -> Result<Self> {
        Self(root().join(".venv")).made()
    }

    /// The environment shared by all readers whose dependencies are compatible, created on demand.
    pub fn of_readers() -> Result<Self> {
        Self::apart("readers")
    }

    /// An environment below `target`, created on demand.
    pub fn apart(name: &str) -> Result<Self> {
        Self(root().join("target/venvs").join(name)).made()
    }

    /// Its interpreter.
    pub fn python(&self) -> PathBuf {
        self.program("python")
    }

    /// A program of it.
    pub fn program(&self, name: &str) -> PathBuf {
        match cfg!(windows) {
            true => self.0.join("Scripts").join(name).with_extension("exe"),
            false => self.0.join("bin").join(name),
        }
    }

    /// Installs what these requirements files list. A copy of each list stays in the environment, so that nothing is
    /// downloaded twice.
    pub fn with(self, requirements: &[&str]) -> Result<Self> {
        let lists = requirements.iter().map(|file| List::read(&self.0, file)).collect::<Result<Vec<_>>>()?;
        let missing: Vec<&List> = lists.iter().filter(|list| !list.is_installed()).collect();
        if missing.is_empty() {
            return Ok(self);
        }
        let mut pip = Command::new(self.python());
        pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
        for list in &missing {
            eprintln!("installing {}", list.name);
            pip.arg("--requirement").arg(&list.file);
        }
        run(&mut pip)?;
        missing.iter().try_for_each(|list| fs::write(&list.stamp, &list.wanted)).map_err(|error| error.to_string())?;
        Ok(self)
    }

    fn made(self) -> Result<Self> {
        if run(Command::new(self.python()).args(["-c", ""])).is_ok() {
            return Ok(self);
        }
        eprintln!("making {}", self.0.display());
        // The environment is broken, or its Python is gone.
        let _ = fs::remove_dir_all(&self.0);
        let base = base()?;
        let made = run(Command::new(&base).args(["-m", "venv"]).arg(&self.0));
        made.or_else(|reason| self.without_ensurepip(&base).map_err(|_| reason))?;
        Ok(self)
    }

    /// Debian packages ensurepip separately, but a pip outside can install pip into an environment that has none.
    fn without_ensurepip(&self, base: &Path) -> Result<String> {
        let _ = fs::remove_dir_all(&self.0);
        run(Command::new(base).args(["-m", "venv", "--without-pip"]).arg(&self.0))?;
        run(Command::new(base).args(["-m", "pip", "--python"]).arg(self.python()).args(["install", "--quiet", "pip"]))
    }
}

/// A requirements file of an environment.
struct List {
    name: String,
    file: PathBuf,
    wanted: String,
    /// The copy that marks the list as installed.
    stamp: PathBuf,
}

impl List {
    fn read(environment: &Path, name: &str) -> Result<Self> {
        let file = root().join(name);
        let wanted = fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        let stamp = environment.join(format!("installed-{}", name.replace(['/', '\\'], "-")));
        Ok(Self { name: name.to_owned(), file, wanted, stamp })
    }

    fn is_installed(&self) -> bool {
        fs::read_to_string(&self.stamp).is_ok_and(|installed| installed == self.wanted)
    }
}

/// A Python that all pinned packages have wheels for.
fn base() -> Result<PathBuf> {
    let [first, end] = VERSIONS;
    let fits = format!("import sys; sys.exit(not (3, {first}) <= sys.version_info[:2] < (3, {end}))");
    let named = std::env::var_os("PLUME_PYTHON").map(PathBuf::from);
    let usual = ["python3".into(), "python".into()].into_iter();
    let versions = (first..end).map(|minor| PathBuf::from(format!("python3.{minor}")));
    let mut candidates = named.into_iter().chain(usual).chain(versions);
    candidates.find(|python| run(Command::new(python).args(["-c", &fits])).is_ok()).ok_or_else(|| {
        let last = end - 1;
        format!("no Python 3.{first} to 3.{last} was found; install one, or name it in the variable PLUME_PYTHON")
    })
}
