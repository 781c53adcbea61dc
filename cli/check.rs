//! `plume check`: is a package or a dataset intact.

use std::path::PathBuf;

use clap::Args;
use plume_exporters::check::{Fault, Report, check};
use serde_json::json;

use super::fault::CliError;
use super::progress::Console;
use plume_graph::echo::{plain, sentence};

/// Checks a package: hashes match, no file is missing or extra, every file parses, every reference stays inside and
/// resolves. Checks a dataset, whose packages are all checked: hashes match, no file is missing or extra, no two parts share a
/// seed or a layout.
#[derive(Args)]
pub struct Check {
    /// A package: a folder, or a zip, mjz, tar.zst or tgz archive, which is not unpacked; or the folder of a dataset
    #[arg(value_name = "PACKAGE")]
    package: PathBuf,
}

impl Check {
    /// Prints the faults on stdout, one per line.
    ///
    /// # Errors
    /// If it is neither, or has faults.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        if plume_dataset::is_dataset(&self.package) {
            return self.dataset(console);
        }
        let report = check(&self.package)?;
        if console.is_json() {
            let mut json = json!(report);
            json["whole"] = report.is_whole().into();
            console.result(&format!("{json:#}\n"))?;
        } else {
            console.result(&self.text(&report))?;
        }
        self.outcome(&report.faults)
    }

    fn dataset(&self, console: &Console) -> Result<(), CliError> {
        let plume_dataset::Report { name, caves, files, faults } = plume_dataset::check(&self.package)?;
        if console.is_json() {
            let json =
                json!({"dataset": name, "caves": caves, "files": files, "faults": faults, "whole": faults.is_empty()});
            console.result(&format!("{json:#}\n"))?;
        } else if faults.is_empty() {
            let (folder, name) = (self.package.display(), plain(&name));
            console.result(&format!("{folder}: intact: dataset {name}, {caves} caves, {files} files\n"))?;
        } else {
            console.result(&said(&faults))?;
        }
        self.outcome(&faults)
    }

    fn outcome(&self, faults: &[Fault]) -> Result<(), CliError> {
        match faults.len() {
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
        said(&report.faults)
    }
}

/// Faults, a line each.
fn said(faults: &[Fault]) -> String {
    faults.iter().map(|fault| format!("{}: {}\n", sentence(&fault.path), sentence(&fault.what))).collect()
}
