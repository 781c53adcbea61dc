//! `plume chunk`: some chunks of a cave, for many machines.

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::Source;
use super::fault::CliError;
use super::progress::Console;
use plume::cave;
use plume::store::CaveFolder;

/// Makes some chunks of a cave, so that many machines can share a large one; `plume generate --parts` puts them together.
/// Without chunks, prints how many there are.
#[derive(Args)]
pub struct Chunk {
    #[command(flatten)]
    pub(super) source: Source,
    /// A chunk, or the first and the last, such as 20-39; the first of all is 0
    #[arg(value_name = "CHUNKS", value_parser = numbers)]
    numbers: Option<Range<usize>>,
    /// What to make of them: mesh, things, texture, pieces
    #[arg(long, value_name = "STAGE,…", value_delimiter = ',', default_value = "mesh,things,texture")]
    stages: Vec<String>,
    /// Take what these cave folders have of them
    #[arg(long, value_name = "CAVE_DIR", num_args = 1..)]
    parts: Vec<PathBuf>,
    /// The cave folder to write [default: the name of the cave with the numbers]
    #[arg(short, long, value_name = "CAVE_DIR")]
    output: Option<PathBuf>,
}

impl Chunk {
    /// Makes the chunks, or prints how many there are.
    ///
    /// # Errors
    /// Bad input, I/O errors, Ctrl-C.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let input = self.source.resolve(console)?;
        let Some(numbers) = self.numbers.clone() else {
            return count(console, cave::chunk_grid(&input, console)?);
        };
        let (first, last) = (numbers.start, numbers.end - 1);
        let named = || PathBuf::from(format!("{}-{first}-{last}", input.recipe.name()));
        let output = self.output.clone().unwrap_or_else(named);
        let folder = cave::with_parts(CaveFolder::open_or_new(&output)?, &self.parts)?;
        let stages = self.stages.iter().map(|name| cave::chunk_stage(name)).collect::<Result<BTreeSet<_>, _>>()?;
        let walls = cave::make_part(&input, &folder, numbers, &stages, self.source.force, console)?;
        summarise(console, &output, &walls.into_iter().map(|wall| wall.name).collect::<Vec<_>>())
    }
}

fn count(console: &Console, grid: [i32; 3]) -> Result<(), CliError> {
    let chunks: i64 = grid.into_iter().map(i64::from).product();
    if console.is_json() {
        return console.result(&format!("{:#}\n", json!({"chunks": chunks, "grid": grid})));
    }
    let [x, y, z] = grid;
    console.result(&format!("{chunks} chunks, 0-{}: {x} along x, {y} along y, {z} along z\n", chunks - 1))
}

fn summarise(console: &Console, output: &Path, walls: &[String]) -> Result<(), CliError> {
    if console.is_json() {
        let json = json!({"path": output.to_string_lossy(), "chunks": walls});
        return console.result(&format!("{json:#}\n"));
    }
    console.note(&format!("  chunks    {}  {} with a wall", output.display(), walls.len()));
    Ok(())
}

fn numbers(text: &str) -> Result<Range<usize>, String> {
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    let number = |text: &str| text.parse::<u32>().map(|number| number as usize);
    match (number(first), number(last)) {
        (Ok(first), Ok(last)) if first <= last => Ok(first..last + 1),
        _ => Err("give a number, or the first and the last, such as 20-39".to_owned()),
    }
}
