//! `plume new`: prints a recipe to start from.

use clap::Args;

use super::fault::CliError;
use super::progress::Console;
use plume::cave;
use plume::recipe::{Recipe, SCHEMA_ADDRESS};

/// Prints a recipe in which every key is documented. Its first line tells editors where the schema is.
#[derive(Args)]
pub struct New {
    /// What to start from; see `plume list presets`
    #[arg(long, default_value = "cave")]
    preset: String,
    /// Set a key of the recipe, for example --set graph.nodes=100
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
}

impl New {
    /// Prints the recipe on stdout.
    ///
    /// # Errors
    /// If there is no such preset, or an override is faulty.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let row = cave::preset(&self.preset)?;
        let recipe = Recipe::from_preset(row, &self.set)?;
        console.result(&format!("#:schema {SCHEMA_ADDRESS}\n\n{}", recipe.to_toml()))
    }
}
