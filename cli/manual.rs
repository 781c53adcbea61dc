//! `plume manual`: pages of the manual, for `man`.

use clap::{Args, CommandFactory};
use clap_mangen::Man;

use super::Cli;
use super::fault::CliError;
use super::progress::Console;

/// Prints a page of the manual, for example: plume manual export | man -l -
#[derive(Args)]
pub struct Manual {
    /// The command that it explains [default: plume as a whole]
    command: Option<String>,
}

impl Manual {
    /// Prints the page on stdout.
    ///
    /// # Errors
    /// If there is no such command; those of standard output.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let mut page = Vec::new();
        let written = Man::new(self.explained()?).render(&mut page);
        written.map_err(|error| CliError::Failed(format!("the manual: {error}")))?;
        console.result(&String::from_utf8_lossy(&page))
    }

    fn explained(&self) -> Result<clap::Command, CliError> {
        let mut plume = Cli::command();
        plume.build();
        let Some(name) = &self.command else { return Ok(plume) };
        let known: Vec<&str> = plume.get_subcommands().map(clap::Command::get_name).collect();
        let command = plume.find_subcommand(name).cloned();
        command.ok_or_else(|| CliError::unknown("command", name, known.into_iter()))
    }
}
