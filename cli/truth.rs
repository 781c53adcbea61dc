//! `plume truth`: ground truth of a cave, a short way to the target of that name.

use std::path::PathBuf;

use clap::Args;

use super::export::Export;
use super::fault::CliError;
use super::progress::Console;
use super::{Host, Source};

/// Makes a cave and writes its ground truth, as `plume export --target truth` does.
#[derive(Args)]
pub struct Truth {
    #[command(flatten)]
    pub(super) source: Source,
    /// Where to write it [default: NAME-truth]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Set an option of the target, for example --option cell_m=0.1; see `plume list options truth`
    #[arg(long, value_name = "KEY=VALUE")]
    option: Vec<String>,
}

impl Truth {
    /// Makes the cave if necessary, then the ground truth.
    ///
    /// # Errors
    /// Bad input, the disk, Ctrl-C.
    pub fn run(&self, console: &Console, host: &Host) -> Result<(), CliError> {
        let option = self.option.iter().map(|option| format!("truth.{option}")).collect();
        Export::of_target("truth", self.source.clone(), self.output.clone(), option).run(console, host)
    }
}
