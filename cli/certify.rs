//! `plume certify`: where a robot gets in a cave, and what stops it.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use super::access::Threads;
use super::fault::CliError;
use super::output;
use super::progress::Console;
use super::signals;
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
    /// The file to write, replacing an existing one: .json for the whole certificate with all paths, .png for a plan
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// A folder for pictures of what stops the robot: stop_1.png and so on, numbered as printed, replacing existing ones
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,
    #[command(flatten)]
    pub(super) threads: Threads,
}

impl Certify {
    /// Prints the certificate and writes what was asked for.
    ///
    /// # Errors
    /// An unknown robot, an unfinished cave, the disk, Ctrl-C.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let robot = cave::named_robot(&self.robot)?;
        let files = self.output.iter().map(|path| Ok((path, form(path)?))).collect::<Result<Vec<_>, CliError>>()?;
        signals::listen();
        let cave = Cave::open(&self.folder, console)?;
        let chunks = cave.chunks(console.stop());
        let scene = cave.scene(&chunks);
        let certified = cave.certify(&scene, &robot)?;
        for (path, form) in files {
            output::replace(path, &form(&certified))?;
        }
        if let Some(folder) = &self.pictures {
            fs::create_dir_all(folder).map_err(|source| StoreError::io(folder, source))?;
            for (number, picture) in (1..).zip(certified.pictures(console)?) {
                picture.map_or(Ok(()), |png| output::replace(&folder.join(format!("stop_{number}.png")), &png))?;
            }
        }
        let text = if console.is_json() { format!("{:#}\n", certified.json()) } else { certified.text() };
        console.result(&text)
    }
}

/// How a file with this extension is written.
fn form(path: &Path) -> Result<fn(&Certified) -> Vec<u8>, CliError> {
    match path.extension().and_then(OsStr::to_str) {
        Some("json") => Ok(|certified| format!("{}\n", certified.json()).into_bytes()),
        Some("png") => Ok(|certified| certified.plan()),
        _ => Err(CliError::Usage {
            message: format!("{}: certificates cannot be written to files with this extension", path.display()),
            hint: "known extensions: .json, .png".into(),
        }),
    }
}
