//! The page that `plume preview` writes, as a browser shows it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::{holds, install_browser, node_folder};
use crate::plume::Plume;
use crate::tools::{self, Result, root};

/// Whether the page lies in a folder.
pub(super) fn is_page(folder: &Path) -> bool {
    holds(folder, &["html"])
}

/// Gets the browser.
pub(super) fn make() -> Result<()> {
    install_browser()
}

/// Opens the page and plays with it.
pub(super) fn open(folder: &Path) -> Result<Command> {
    let mut command = Command::new("node");
    command.arg(node_folder().join("page.mjs")).arg(folder);
    Ok(command)
}

/// The page of the first sample, in a folder of its own.
pub(super) fn write(plume: &Plume) -> Result<PathBuf> {
    let folder = root().join("target/judges/page");
    fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    plume.output(&["preview", "samples/cave.toml", "--output", "target/judges/page/cave.html"])?;
    Ok(folder)
}

/// What is replaced in the page, and what must be said of it.
const SPOILS: [(&str, &str, &str); 4] = [
    ("gl.drawElements(", "void (", "of the view is drawn"),
    ("camera.yaw -= dx", "camera.yaw -= missing", "the page failed"),
    ("<aside>", "<aside><img src=\"rock.png\">", "it asks for"),
    ("place.z > cut", "false", "cutting it open changes"),
];

/// Spoils the page in each of these ways and asks the judge.
pub(super) fn spoil(folder: &Path) -> Result<String> {
    let page = fs::read_to_string(folder.join("cave.html")).map_err(|error| error.to_string())?;
    let spoiled = root().join("target/judges/page-spoiled");
    fs::create_dir_all(&spoiled).map_err(|error| error.to_string())?;
    for (whole, broken, complaint) in SPOILS {
        fs::write(spoiled.join("cave.html"), page.replace(whole, broken)).map_err(|error| error.to_string())?;
        match tools::run(&mut open(&spoiled)?) {
            Err(said) if said.contains(complaint) => {}
            Err(said) => return Err(format!("without `{whole}`: {said}")),
            Ok(praise) => return Err(format!("did not notice that `{whole}` is gone: {praise}")),
        }
    }
    Ok(format!("noticed {} faults", SPOILS.len()))
}
