//! `plume generate`, and its stages one by one.

use std::path::PathBuf;

use clap::Args;

use super::Source;
use super::fault::CliError;
use super::input::Input;
use super::progress::Console;
use super::summary::Summary;
use crate::pipeline::Pipeline;
use crate::store::{CaveFolder, Stage};

/// Makes a cave folder; stopped or killed, the same command goes on where it stopped.
#[derive(Args)]
pub struct Generate {
    #[command(flatten)]
    source: Source,
    /// The cave folder to make [default: the name of the cave, or the cave folder named]
    #[arg(short, long, value_name = "CAVE_DIR")]
    output: Option<PathBuf>,
}

/// The last stage to make.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Until {
    /// Only the graph.
    Graph,
    /// Also the triangles.
    Mesh,
    /// Also the images.
    Textures,
}

impl Generate {
    /// Runs the stages up to `until`.
    ///
    /// # Errors
    /// Bad input, the disk, Ctrl-C.
    pub fn run(&self, until: Until, console: &Console) -> Result<(), CliError> {
        let input = self.source.resolve()?;
        let named = input.folder.clone();
        let output = self.output.clone().or(named).unwrap_or_else(|| PathBuf::from(&input.recipe.name));
        let folder = CaveFolder::open_or_new(&output)?;
        let mut summary = Summary::start();
        make(&input, &folder, until, self.source.force, console, &mut summary)?;
        summary.place("cave", &output, &folder);
        summary.print(console)
    }
}

/// Makes the stages up to `until` in `folder` and settles it.
///
/// # Errors
/// Bad input, the disk, Ctrl-C.
pub fn make<'a>(
    input: &'a Input,
    folder: &'a CaveFolder,
    until: Until,
    force: bool,
    console: &'a Console,
    summary: &mut Summary,
) -> Result<Pipeline<'a>, CliError> {
    let pipeline = Pipeline::start(&input.recipe, input.graph.clone(), folder, force, console)?;
    summary.graph(pipeline.graph());
    if until >= Until::Mesh {
        pipeline.mesh()?;
        summary.mesh(&pipeline.walls());
    }
    if until >= Until::Textures {
        pipeline.texture()?;
        summary.texture(&pipeline.units(Stage::Texture));
    }
    pipeline.settle()?;
    Ok(pipeline)
}
