//! The page that `plume preview` writes, as a browser shows it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::{gltf, holds};
use crate::plume::Plume;
use crate::tools::{self, Result, root};

/// Whether a folder contains the page.
pub(super) fn is_page(folder: &Path) -> bool {
    holds(folder, &["html"])
}

/// Opens the page and exercises its controls.
pub(super) fn open(folder: &Path) -> Result<Command> {
    let mut command = Command::new("node");
    command.arg(gltf::folder().join("page.mjs")).arg(folder);
    Ok(command)
}

/// Writes the page of the first sample to a separate folder.
pub(super) fn write(plume: &Plume) -> Result<PathBuf> {
    let folder = root().join("target/interop/page");
    fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    plume.output(&["preview", "samples/cave.toml", "--output", "target/interop/page/cave.html"])?;
    Ok(folder)
}

/// Injected faults of the page, and the expected messages.
const FAULTS: [(&str, &str, &str); 4] = [
    ("gl.drawElements(", "void (", "of the view is drawn"),
    ("camera.yaw -= dx", "camera.yaw -= missing", "the page failed"),
    ("<aside>", "<aside><img src=\"rock.png\">", "it asks for"),
    ("place.z > cut", "false", "cutting it open changes"),
];

/// Opens the page with each of these faults injected.
pub(super) fn check_faults(folder: &Path) -> Result<String> {
    let page = fs::read_to_string(folder.join("cave.html")).map_err(|error| error.to_string())?;
    let faulty = root().join("target/interop/page-with-faults");
    fs::create_dir_all(&faulty).map_err(|error| error.to_string())?;
    for (whole, broken, message) in FAULTS {
        fs::write(faulty.join("cave.html"), page.replace(whole, broken)).map_err(|error| error.to_string())?;
        match tools::run(&mut open(&faulty)?) {
            Err(said) if said.contains(message) => {}
            Err(said) => return Err(format!("without `{whole}`: {said}")),
            Ok(summary) => return Err(format!("did not notice that `{whole}` is gone: {summary}")),
        }
    }
    Ok(format!("noticed {} faults", FAULTS.len()))
}
