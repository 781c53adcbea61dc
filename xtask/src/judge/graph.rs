//! Programs that know graphs and caves: what they make of ours, and we of theirs.

use std::path::PathBuf;
use std::process::Command;

use crate::plume::Plume;
use crate::samples;
use crate::tools::{Result, ensure_debian, root, run};
use crate::venv::Environment;

/// A script that asks others of what `plume` says or writes, and spoils something that they must notice.
pub(super) struct Judge {
    pub(super) name: &'static str,
    debian: &'static [&'static str],
    script: &'static str,
    /// What the script is told beside the program.
    arguments: fn() -> Result<Vec<PathBuf>>,
}

pub(super) const JUDGES: [Judge; 3] = [
    Judge { name: "karstnet", debian: &[], script: "karstnet_agrees.py", arguments: || Ok(Vec::new()) },
    Judge { name: "graphs", debian: &["graphviz"], script: "exported.py", arguments: samples::recipes },
    Judge { name: "surveys", debian: &["survex", "therion"], script: "surveys.py", arguments: || Ok(Vec::new()) },
];

impl Judge {
    /// Gets the programs, or says what is missing.
    pub(super) fn prepare(&self) -> Result<Environment> {
        ensure_debian(self.debian)?;
        Environment::apart("graph")?.with("tests/judges/graph/requirements.txt")
    }

    pub(super) fn ask(&self, environment: &Environment, plume: &Plume) -> Result<String> {
        let script = root().join("tests/judges/graph").join(self.script);
        let mut command = Command::new(environment.python());
        run(command.arg(script).arg(plume.program()).args((self.arguments)()?).current_dir(root()))
    }
}
