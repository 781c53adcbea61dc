//! Film strips: a few frames along a path through each rock, each with its depth and its labels.

use crate::tools::{Result, run as run_program};

use super::studio::{Cave, Studio};

/// A cave of each rock, as users are shown it.
const ROCKS: [Cave; 4] = [
    Cave::new("strip-limestone", "samples/cave.toml"),
    Cave::new("strip-basalt", "samples/lava-tube.toml"),
    Cave::new("strip-drilled", "samples/mine.toml"),
    Cave::new("strip-salt", "samples/salt-mine.toml"),
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
