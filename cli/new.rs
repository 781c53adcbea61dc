//! `plume new`: prints a recipe to start from.

use clap::Args;

use super::fault::CliError;
use super::progress::Console;
use plume::cave;
use plume::recipe::Recipe;

/// Prints a recipe in which every key is documented.
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
        let recipe = Recipe::from_toml(row.text, row.name.as_ref(), &self.set)?;
        console.result(&recipe.to_toml())
    }
}
