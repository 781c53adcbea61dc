//! `plume completions`: what a shell needs to complete the command line.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::Cli;
use super::fault::CliError;
use super::progress::Console;

/// Prints completions of the command line, to be kept where the shell looks for them.
#[derive(Args)]
pub struct Completions {
    /// The shell
    shell: Shell,
}

impl Completions {
    /// Prints the completions on stdout.
    ///
    /// # Errors
    /// Those of standard output.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "plume", &mut script);
        console.result(&String::from_utf8_lossy(&script))
    }
}
