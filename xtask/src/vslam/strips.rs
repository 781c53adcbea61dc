//! Film strips: a few frames along a path through each rock, each with its depth and its labels.

use crate::tools::{Result, run as run_program};

use super::studio::{Cave, Studio};

/// Mined rock in mines, and the caves of the variants.
const ROCKS: [Cave; 4] = [
    super::DEFAULT,
    super::BASALT,
    Cave::new("mine", "samples/mine.toml --set graph.nodes=30"),
    Cave::new("salt-mine", "samples/salt-mine.toml"),
];

const RIG: &str = "tests/interop/slam/rigs/strip.toml";

/// A picture per rock.
pub fn run(studio: &Studio) -> Result<()> {
    for cave in &ROCKS {
        let recording = studio.record(cave, &studio.path(cave, "longest")?, RIG)?;
        let picture = studio.place(&format!("strips/{}.png", cave.name()));
        println!("{}", run_program(studio.script("strip.py").args([&recording, &picture]))?);
    }
    Ok(())
}
