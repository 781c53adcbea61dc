//! `plume measure`: is the mesh of a cave what it should be.

use std::path::PathBuf;

use clap::Args;

use super::fault::CliError;
use super::progress::Console;
use crate::mesh::measure::{Report, weld};
use crate::store::{self, CaveFolder, Stage};

/// Welds the chunks of a cave folder and checks the whole.
#[derive(Args)]
pub struct Measure {
    /// A cave folder with a finished mesh
    #[arg(value_name = "CAVE_DIR")]
    folder: PathBuf,
}

impl Measure {
    /// Prints the report on stdout.
    ///
    /// # Errors
    /// When there is no mesh, or it is not clean.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let folder = CaveFolder::open(&self.folder)?;
        let walls = folder.units(Stage::Mesh).into_iter().filter(|unit| !unit.files.is_empty());
        let meshes = walls.map(|unit| store::read_mesh(&folder, &unit.name)).collect::<Result<Vec<_>, _>>()?;
        if meshes.is_empty() {
            let message = format!("{}: there is no mesh to measure", self.folder.display());
            return Err(CliError::Usage { message, hint: "make one with `plume mesh -o CAVE_DIR`".into() });
        }
        let report = Report::of(&weld(&meshes));
        let json = serde_json::to_value(&report).expect("a report is plain data");
        if console.is_json() {
            console.result(&format!("{json:#}\n"))?;
        } else {
            let lines = json.as_object().into_iter().flatten().map(|(key, value)| format!("  {key:24} {value}\n"));
            console.result(&lines.collect::<String>())?;
        }
        if report.is_clean() { Ok(()) } else { Err(CliError::Failed("the mesh is not clean".into())) }
    }
}
