//! Programs for graphs and cave surveys: they read our files, and we read theirs.

use std::path::PathBuf;
use std::process::Command;

use crate::plume::Plume;
use crate::samples;
use crate::tools::{Result, ensure_debian, root, run};
use crate::venv::Environment;

/// A script that compares the output of `plume` with that of others, and injects a fault that they must notice.
pub(super) struct GraphCheck {
    pub(super) name: &'static str,
    pub(super) debian: &'static [&'static str],
    script: &'static str,
    /// Arguments of the script in addition to the program.
    arguments: fn() -> Result<Vec<PathBuf>>,
}

pub(super) static CHECKS: [GraphCheck; 3] = [
    GraphCheck { name: "karstnet", debian: &[], script: "karstnet_agrees.py", arguments: || Ok(Vec::new()) },
    GraphCheck { name: "graphs", debian: &["graphviz"], script: "exported.py", arguments: samples::recipes },
    GraphCheck { name: "surveys", debian: &["survex", "therion"], script: "surveys.py", arguments: || Ok(Vec::new()) },
];

impl GraphCheck {
    /// Installs the programs, or reports what is missing.
    pub(super) fn prepare(&self) -> Result<Environment> {
        ensure_debian(self.debian)?;
        Environment::of_readers()?.with(&["tests/interop/graph/requirements.txt"])
    }

    pub(super) fn ask(&self, environment: &Environment, plume: &Plume) -> Result<String> {
        let script = root().join("tests/interop/graph").join(self.script);
        let mut command = Command::new(environment.python());
        run(command.arg(script).arg(plume.program()).args((self.arguments)()?).current_dir(root()))
    }
}
