//! `plume check`: is a package intact.

use std::path::PathBuf;

use clap::Args;
use plume_exporters::check::{Report, check};
use serde_json::json;

use super::fault::CliError;
use super::progress::Console;
use plume_graph::echo::{plain, sentence};

/// Checks a package: hashes match, no file is missing or extra, every file parses, every reference stays inside and
/// resolves.
#[derive(Args)]
pub struct Check {
    /// A package: a folder, or a zip, mjz, tar.zst or tgz archive, which is not unpacked
    #[arg(value_name = "PACKAGE")]
    package: PathBuf,
}

impl Check {
    /// Prints the faults on stdout, one per line.
    ///
    /// # Errors
    /// If it is not a package, or has faults.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let report = check(&self.package)?;
        if console.is_json() {
            let mut json = json!(report);
            json["whole"] = report.is_whole().into();
            console.result(&format!("{json:#}\n"))?;
        } else {
            console.result(&self.text(&report))?;
        }
        match report.faults.len() {
            0 => Ok(()),
            1 => Err(CliError::Failed(format!("{}: 1 fault", self.package.display()))),
            count => Err(CliError::Failed(format!("{}: {count} faults", self.package.display()))),
        }
    }

    fn text(&self, report: &Report) -> String {
        if report.is_whole() {
            let Report { target, generator, files, bytes, .. } = report;
            let package = self.package.display();
            let (target, generator) = (plain(target), plain(generator));
            return format!("{package}: intact: {target} by {generator}, {files} files, {bytes} bytes\n");
        }
        report.faults.iter().map(|fault| format!("{}: {}\n", sentence(&fault.path), sentence(&fault.what))).collect()
    }
}
