//! `plume certify`: where a robot gets in a cave, and what stops it.

use std::path::{Path, PathBuf};

use clap::Args;
use plume_disk::Existing;

use super::fault::CliError;
use super::progress::Console;
use plume::Cave;
use plume::cave::{self, Certified};
use plume::pipeline::Observer;
use plume::store::StoreError;

/// Certifies where a robot gets in a finished cave, and what stops it.
#[derive(Args)]
pub struct Certify {
    /// A cave folder made by `plume generate`
    #[arg(value_name = "CAVE_DIR")]
    folder: PathBuf,
    /// The robot: one of `plume list robots`, or a TOML file
    #[arg(long, value_name = "ROBOT|FILE", default_value = "husky")]
    robot: String,
    /// The certificate to write, JSON, replacing an existing one
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl Certify {
    /// Prints the certificate and writes what was asked for.
    ///
    /// # Errors
    /// An unknown robot, an unfinished cave, the disk, Ctrl-C.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let robot = cave::robot(&self.robot)?;
        super::signals::listen();
        let cave = Cave::open(&self.folder, console)?;
        let chunks = cave.chunks(console.stop());
        let scene = cave.scene(&chunks);
        let certified = cave.certify(&scene, &robot)?;
        if let Some(output) = &self.output {
            save(output, &format!("{}\n", certified.json()))?;
        }
        if console.is_json() {
            return console.result(&format!("{:#}\n", certified.json()));
        }
        console.result(&text(&certified))
    }
}

fn save(output: &Path, text: &str) -> Result<(), CliError> {
    let written = plume_disk::write_file(output, Existing::Replace, text.as_bytes());
    Ok(written.map(drop).map_err(|source| StoreError::io(output, source))?)
}

fn text(certified: &Certified) -> String {
    format!("{:?}\n", certified.certificate.floor_m2)
}
