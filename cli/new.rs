//! `plume new`: prints a recipe to start from.

use clap::Args;

use super::fault::CliError;
use super::progress::Console;
use plume::cave;
use plume::recipe::SCHEMA_ADDRESS;

/// Prints a recipe in which every key is documented. Its first line tells editors where the schema is.
#[derive(Args)]
pub struct New {
    /// What to start from: a preset (see `plume list presets`), or a recipe file such as own/cave.toml
    #[arg(long, value_name = "PRESET|FILE", default_value = "cave")]
    preset: String,
    /// Set a key of the recipe, for example --set graph.nodes=100
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
}

impl New {
    /// Prints the recipe on stdout.
    ///
    /// # Errors
    /// If there is no such preset or file, or it or an override is faulty.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let recipe = cave::start_from(&self.preset, &self.set)?;
        console.result(&format!("#:schema {SCHEMA_ADDRESS}\n\n{}", recipe.to_placed_toml()))
    }
}
