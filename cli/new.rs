//! `plume new`: a recipe to start from.

use clap::Args;

use super::fault::CliError;
use super::progress::Console;
use plume::cave;
use plume::recipe::Recipe;

/// Prints a recipe in which every key explains itself.
#[derive(Args)]
pub struct New {
    /// What to start from; `plume list presets` names them
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
    /// When there is no such preset, or a faulty override.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let row = cave::preset(&self.preset)?;
        let recipe = Recipe::from_toml(row.text, row.name.as_ref(), &self.set)?;
        console.result(&recipe.to_toml())
    }
}
