//! `plume measure`: are the mesh of a cave and its convex pieces what they should be.

use std::path::PathBuf;

use clap::Args;
use serde_json::Value;

use super::fault::CliError;
use super::progress::Console;
use crate::cave::Input;
use crate::mesh::PieceReport;
use crate::mesh::measure::{Report, weld};
use crate::pipeline::Pipeline;
use crate::store::{self, CaveFolder, Stage};

/// Welds the chunks of a cave folder and checks the whole; measures the convex pieces, if there are any.
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
        let mut json = serde_json::to_value(&report).expect("a report is plain data");
        if !folder.units(Stage::Pieces).is_empty() {
            append(&mut json, &self.pieces(&folder, console)?);
        }
        if console.is_json() {
            console.result(&format!("{json:#}\n"))?;
        } else {
            let lines = json.as_object().into_iter().flatten().map(|(key, value)| format!("  {key:28} {value}\n"));
            console.result(&lines.collect::<String>())?;
        }
        if report.is_clean() { Ok(()) } else { Err(CliError::Failed("the mesh is not clean".into())) }
    }

    /// Measures the convex pieces.
    fn pieces(&self, folder: &CaveFolder, console: &Console) -> Result<PieceReport, CliError> {
        let Input { recipe, graph, .. } = Input::read(Some(&self.folder), &[])?;
        let pipeline = Pipeline::plan(&recipe, graph, folder, console)?;
        Ok(PieceReport::of(&pipeline.measure_pieces()?))
    }
}

fn append(report: &mut Value, more: &PieceReport) {
    let more = serde_json::to_value(more).expect("a report is plain data");
    if let (Some(report), Value::Object(more)) = (report.as_object_mut(), more) {
        report.extend(more);
    }
}
