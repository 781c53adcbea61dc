//! `plume generate`, and its stages one by one.

use std::path::PathBuf;

use clap::Args;

use super::Source;
use super::fault::CliError;
use super::progress::Console;
use super::summary::Summary;
use plume::cave::{self, Cave, Input};
use plume::pipeline::Pipeline;
use plume::store::{CaveFolder, Stage};

/// Makes a cave folder. If interrupted, the same command resumes where it stopped. Given a cave folder as input, updates it
/// to match changes of its recipe and graph.
#[derive(Args)]
pub struct Generate {
    #[command(flatten)]
    pub(super) source: Source,
    /// The cave folder to write [default: the name of the cave, or the cave folder given as input]
    #[arg(short, long, value_name = "CAVE_DIR")]
    output: Option<PathBuf>,
    /// Take what these cave folders have of the cave, as `plume chunk` makes them
    #[arg(long, value_name = "CAVE_DIR", num_args = 1..)]
    parts: Vec<PathBuf>,
}

impl Generate {
    /// Runs the stages up to `last`.
    ///
    /// # Errors
    /// Bad input, I/O errors, Ctrl-C.
    pub fn run(&self, last: Stage, console: &Console) -> Result<(), CliError> {
        let input = self.source.resolve(console)?;
        let named = input.folder.clone();
        let output = self.output.clone().or(named).unwrap_or_else(|| PathBuf::from(input.recipe.name()));
        let mut folder = CaveFolder::open_or_new(&output)?;
        if let Some(named) = input.folder.as_ref().filter(|named| **named != output) {
            folder = folder.based_on(CaveFolder::open(named)?);
        }
        folder = cave::with_parts(folder, &self.parts)?;
        note_changes(&input, console);
        let mut summary = Summary::start();
        let mut done = |stage, pipeline: &Pipeline| summary.stage_done(stage, pipeline);
        if last != Stage::Texture {
            cave::make(&input, &folder, last, self.source.force, console, &mut done)?;
            summary.place("cave", &output, &folder);
        } else {
            let cave = Cave::make(input, folder, self.source.force, console, &mut done)?;
            summary.place("cave", &output, cave.folder());
        }
        summary.print(console)
    }
}

/// Notes what has changed in a cave folder before it is updated.
pub fn note_changes(input: &Input, console: &Console) {
    for change in &input.changes {
        console.note(&format!("  changed   {change}"));
    }
}
