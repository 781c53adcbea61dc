//! Where a package goes, and the one way to write it whole: the target's files, whose it is, and what is in it.

use std::path::PathBuf;

use minijinja::context;
pub use plume_disk::Existing;

pub use self::archive::Archive;
pub use self::folder::Folder;
use crate::bundle::Bundle;
use crate::error::ExportError;
use crate::manifest::Manifest;
use crate::manifest::recorder::RecordingChunks;
use crate::package::{Files, MANIFEST, Package};
use crate::scene::Scene;
use crate::target::{Summary, Target};
use crate::template;

mod archive;
mod folder;
mod pack;
mod user_files;

/// Name of the file that says whose the package is.
pub const LICENSE: &str = "LICENSE.md";

/// Where a package goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The folder or file.
    pub path: PathBuf,
    /// The kind of file that the package becomes, if it does not stay a folder.
    pub bundle: Option<Bundle>,
    /// What to do with what is there already.
    pub existing: Existing,
}

impl Place {
    /// Whether a package can be made here: asked before the long work.
    ///
    /// # Errors
    /// As [`Folder::check`] and [`Archive::check`].
    pub fn check(&self) -> Result<(), ExportError> {
        match self.bundle {
            None => Folder::check(&self.path, self.existing),
            Some(_) => Archive::check(&self.path, self.existing),
        }
    }

    /// Writes the package; it appears whole or not at all. `name` is what was asked for, such as `gazebo`.
    ///
    /// # Errors
    /// When something else is here, the scene cannot be read, or the disk refuses.
    pub fn write(&self, name: &str, target: &dyn Target, scene: &Scene) -> Result<(Summary, Files), ExportError> {
        match self.bundle {
            None => {
                let mut folder = Folder::create(&self.path, self.existing)?;
                let summary = fill(name, target, scene, &mut folder)?;
                Ok((summary, folder.finish()?))
            }
            Some(bundle) => {
                let mut archive = Archive::create(bundle, &self.path, self.existing)?;
                let mut summary = fill(name, target, scene, &mut archive)?;
                if Bundle::COMMON.contains(&bundle) {
                    summary.open = format!("unpack it, then in its folder: {}", summary.open);
                }
                Ok((summary, archive.finish()?))
            }
        }
    }
}

/// Writes a whole package into `out`, which is empty. `name` is what was asked for, such as `gazebo`.
///
/// # Errors
/// As [`Target::export`].
pub fn fill(name: &str, target: &dyn Target, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
    let recording = RecordingChunks::new(scene);
    let recorded = Scene { chunks: &recording, ..scene.clone() };
    let summary = target.export(&recorded, out)?;
    let values = context! {
        name => &scene.name,
        generator => &scene.generator,
        target => name,
        license => env!("CARGO_PKG_LICENSE"),
        repository => env!("CARGO_PKG_REPOSITORY"),
        references => target.references().to_vec(),
    };
    let license = template::fill(LICENSE, include_str!("templates/package/LICENSE.md.jinja"), &values);
    out.text(LICENSE, &license)?;
    let manifest = Manifest::new(name, target, scene, &recording.facts(scene)?, out);
    out.text(MANIFEST, &manifest.to_text()?)?;
    Ok(summary)
}
